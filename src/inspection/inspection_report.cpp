#include "mba_vo/inspection/inspection_report.h"

#include <algorithm>

namespace mba_vo {
namespace {

bool anyProblem(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(), isProblem);
}

void printFindings(std::vector<Finding> findings, std::ostream& out) {
  std::stable_partition(findings.begin(), findings.end(), isProblem);
  for (const Finding& finding : findings) {
    const CheckText& text = textOf(finding.check);
    out << (isProblem(finding) ? "  PROBLEM " : "  note ") << text.name << ": " << finding.what << "\n"
        << "    costs:  " << text.cost << "\n"
        << "    remedy: " << text.remedy << "\n";
  }
}

void printCommands(const Commands& commands, std::ostream& out) {
  if (!commands.options_yaml.empty()) {
    out << "  options.yaml, if that is right:\n    image:\n";
    for (const std::string& line : commands.options_yaml) out << "      " << line << "\n";
  }
  if (!commands.lines.empty()) out << "  to run it:\n";
  for (const std::string& line : commands.lines) out << "    " << line << "\n";
}

}  // namespace

int exitStatus(const InspectionReport& report) {
  constexpr int kUnreadable = 2;
  if (!report.readable) return kUnreadable;
  const bool problems = anyProblem(report.findings) ||
                        std::any_of(report.cameras.begin(), report.cameras.end(),
                                    [](const CameraReport& camera) { return anyProblem(camera.findings); });
  return problems ? 1 : 0;
}

void print(const InspectionReport& report, std::ostream& out) {
  out << report.path << "\n";
  for (const std::string& line : report.contents) out << "  " << line << "\n";
  printFindings(report.findings, out);
  for (const CameraReport& camera : report.cameras) {
    out << "\n" << camera.source.name << "\n";
    for (const std::string& line : describe(camera.facts)) out << "  " << line << "\n";
    printFindings(camera.findings, out);
    printCommands(commandsFor(report, camera), out);
  }
  const int status = exitStatus(report);
  out << "\n" << (status == 0 ? "Nothing is wrong." : "What each name means is told in docs/checks.md.") << "\n";
}

}  // namespace mba_vo
