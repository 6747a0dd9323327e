#include "mba_vo/inspection/finding.h"

#include <fstream>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace mba_vo::finding_test {
namespace {

/// Names in the first column of the tables of docs/checks.md.
std::multiset<std::string> documentedNames() {
  std::ifstream page(std::string(MBA_VO_SOURCE_DIR) + "/docs/checks.md");
  EXPECT_TRUE(page.good());
  std::multiset<std::string> names;
  const std::regex row("^\\| `([a-z-]+)` \\|.*");
  for (std::string line; std::getline(page, line);) {
    std::smatch match;
    if (std::regex_match(line, match, row)) names.insert(match[1]);
  }
  return names;
}

TEST(Findings, EveryNameIsExplainedOnceAndNothingElse) {
  std::multiset<std::string> names;
  for (const CheckText& check : allChecks()) names.insert(check.name);
  EXPECT_EQ(names, documentedNames());
}

TEST(Findings, EveryCheckHasATextOfItsOwn) {
  std::set<Check> checks;
  for (const CheckText& text : allChecks()) {
    EXPECT_TRUE(checks.insert(text.check).second) << text.name;
    EXPECT_EQ(textOf(text.check).name, std::string(text.name));
    EXPECT_NE(std::string(text.cost), "") << text.name;
    EXPECT_NE(std::string(text.remedy), "") << text.name;
  }
  EXPECT_EQ(checks.size(), static_cast<std::size_t>(Check::kRollingShutter) + 1);  // the last one
}

}  // namespace
}  // namespace mba_vo::finding_test
