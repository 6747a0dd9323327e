// Compares an estimated trajectory with ground truth: ATE, RPE, rotation error, dropped frames, motion within the
// exposure.
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "mba_vo/evaluation/evaluator.h"
#include "mba_vo/evaluation/report_writer.h"
#include "mba_vo/evaluation/trajectory_plot.h"

namespace {

struct Arguments {
  std::string groundtruth_file;
  std::string estimate_file;
  std::string frames_file;
  std::string plot_file;
  std::string yaml_file;
  mba_vo::EvaluationOptions options;
};

void describe(CLI::App& app, Arguments& arguments) {
  mba_vo::EvaluationOptions& options = arguments.options;
  app.add_option("--groundtruth", arguments.groundtruth_file,
                 "true trajectory: TUM form (8 columns) or with start and end poses (16 columns)")
      ->required();
  app.add_option("--estimate", arguments.estimate_file, "estimated trajectory, same two forms")->required();
  const std::map<std::string, mba_vo::AlignmentMode> modes{{"sim3", mba_vo::AlignmentMode::kSim3},
                                                           {"se3", mba_vo::AlignmentMode::kSE3}};
  app.add_option("--alignment", options.alignment, "sim3 (default: with scale) or se3")
      ->transform(CLI::CheckedTransformer(modes));
  app.add_option("--frames", arguments.frames_file,
                 "frames.csv of the run: dropped frames are counted among its frames");
  app.add_option("--max-difference", options.max_time_difference,
                 "between the times of an estimate and its ground truth [s]")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10.0));
  app.add_option("--rpe-interval", options.relative_interval, "of the relative pose error [s]")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e4));
  app.add_option("--min-blur", options.min_blur, "frames with less true blur have no direction to compare [px]")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e4));
  app.add_option("--plot", arguments.plot_file, "draw the aligned trajectory from the side and above (.png or .svg)");
  app.add_option("--yaml", arguments.yaml_file, "write all figures to this file");
}

void run(const Arguments& arguments) {
  const auto groundtruth = mba_vo::readPoseFile(arguments.groundtruth_file);
  const auto estimate = mba_vo::readPoseFile(arguments.estimate_file);
  const auto frames =
      arguments.frames_file.empty() ? std::vector<mba_vo::LoggedFrame>() : mba_vo::readFrameLog(arguments.frames_file);
  const mba_vo::EvaluationReport report = mba_vo::evaluateTrajectory(groundtruth, estimate, frames, arguments.options);
  mba_vo::writeTable(report, std::cout);
  if (!arguments.plot_file.empty()) {
    mba_vo::plotTrajectory(arguments.plot_file, groundtruth, report);
  }
  if (!arguments.yaml_file.empty()) {
    std::ofstream yaml(arguments.yaml_file);
    mba_vo::writeYaml(report, yaml);
    if (!yaml.flush()) {
      throw std::runtime_error(arguments.yaml_file + ": cannot be written");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares an estimated trajectory with ground truth.", "mba_vo_evaluate");
  Arguments arguments;
  describe(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_evaluate: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
