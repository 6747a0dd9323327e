// Compares a run, as published and as saved, or a single trajectory with ground truth: ATE, RPE, rotation error,
// availability, consistency, dropped frames, motion within the exposure.
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "mba_vo/datasets/ground_truth.h"
#include "mba_vo/evaluation/causal_report.h"
#include "mba_vo/evaluation/evaluator.h"
#include "mba_vo/evaluation/report_writer.h"
#include "mba_vo/evaluation/run_report_writer.h"
#include "mba_vo/evaluation/trajectory_plot.h"
#include "mba_vo/io/trajectory_writer.h"

namespace {

struct Arguments {
  std::string groundtruth_file;
  mba_vo::GroundTruthOptions groundtruth;
  std::string run_folder;
  std::string estimate_file;
  std::string frames_file;
  std::string plot_file;
  std::string yaml_file;
  double time_offset = 0.0;  // [s]
  mba_vo::RunOptions options;
};

void describe(CLI::App& app, Arguments& arguments) {
  mba_vo::EvaluationOptions& options = arguments.options.evaluation;
  app.add_option("--groundtruth", arguments.groundtruth_file,
                 "true trajectory: TUM form (8 columns) or with start and end poses (16 columns), data.csv of an ASL "
                 "folder, or the folder of a recording that has one")
      ->required();
  app.add_option("--calibration", arguments.groundtruth.calibration_file,
                 "file that tells where the camera is on the body (ASL, Kalibr), in place of the recording's")
      ->check(CLI::ExistingFile);
  app.add_option("--camera", arguments.groundtruth.camera, "which of several cameras: cam0, cam1, ...");
  auto* input = app.add_option_group("input");
  auto* run = input->add_option("--run", arguments.run_folder,
                                "output folder of a run: judged by what it published when it published it");
  auto* estimate = input->add_option("--estimate", arguments.estimate_file, "a single trajectory, same two forms");
  input->require_option(1);
  const std::map<std::string, mba_vo::AlignmentMode> modes{{"sim3", mba_vo::AlignmentMode::kSim3},
                                                           {"se3", mba_vo::AlignmentMode::kSE3}};
  app.add_option("--alignment", options.alignment, "sim3 (default: with scale) or se3")
      ->transform(CLI::CheckedTransformer(modes));
  app.add_option("--frames", arguments.frames_file,
                 "frames.csv of a single trajectory: dropped frames are counted among its frames")
      ->needs(estimate);
  app.add_option("--depth", arguments.options.depth,
                 "median depth of the scene for the first parallax [m]; without it from the scale of the map")
      ->check(CLI::Range(1e-6, 1e6))
      ->needs(run);
  app.add_option("--nees-times", arguments.options.nees_times,
                 "after the first pose, at which the covariance is compared with the error [s]: 1,5,10")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1e6))
      ->needs(run);
  app.add_option("--time-offset", arguments.time_offset,
                 "by how much the stamps of the ground truth are late [s]; it is taken off them")
      ->capture_default_str()
      ->check(CLI::Range(-1e10, 1e10));
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

/// By the clock of the estimate.
std::vector<mba_vo::PoseRecord> readGroundTruth(const Arguments& arguments) {
  std::vector<mba_vo::PoseRecord> poses = mba_vo::readGroundTruth(arguments.groundtruth_file, arguments.groundtruth);
  for (mba_vo::PoseRecord& pose : poses) pose.time -= arguments.time_offset;
  return poses;
}

void evaluateSingle(const Arguments& arguments) {
  const auto groundtruth = readGroundTruth(arguments);
  const auto estimate = mba_vo::readPoseFile(arguments.estimate_file);
  const auto frames =
      arguments.frames_file.empty() ? std::vector<mba_vo::LoggedFrame>() : mba_vo::readFrameLog(arguments.frames_file);
  const mba_vo::EvaluationReport report =
      mba_vo::evaluateTrajectory(groundtruth, estimate, frames, arguments.options.evaluation);
  mba_vo::writeTable(report, std::cout);
  if (!arguments.plot_file.empty()) {
    mba_vo::plotTrajectory(arguments.plot_file, groundtruth, report);
  }
  if (!arguments.yaml_file.empty()) {
    mba_vo::writeFile(arguments.yaml_file, [&](std::ostream& out) { mba_vo::writeYaml(report, out); });
  }
}

std::vector<mba_vo::PlottedEstimate> plottedEstimates(const mba_vo::RunReport& report) {
  std::vector<mba_vo::PlottedEstimate> estimates;
  if (report.trajectory.report) {
    estimates.push_back({"online", &*report.trajectory.report});
  }
  if (report.smoothed.report) {
    estimates.push_back({"smoothed", &*report.smoothed.report});
  }
  return estimates;
}

void evaluateRunFolder(const Arguments& arguments) {
  const auto groundtruth = readGroundTruth(arguments);
  const bool exposures = groundtruth.front().exposure.has_value();
  const mba_vo::RunFolder run =
      mba_vo::readRunFolder(arguments.run_folder, exposures ? mba_vo::PoseForm::kExposures : mba_vo::PoseForm::kPoses);
  const mba_vo::RunReport report = mba_vo::evaluateRun(groundtruth, run, arguments.options);
  mba_vo::writeRunTable(report, std::cout);
  if (!arguments.plot_file.empty()) {
    mba_vo::plotTrajectories(arguments.plot_file, groundtruth, plottedEstimates(report));
  }
  if (!arguments.yaml_file.empty()) {
    mba_vo::writeFile(arguments.yaml_file, [&](std::ostream& out) { mba_vo::writeRunYaml(report, out); });
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares a run or a single trajectory with ground truth.", "mba_vo_evaluate");
  Arguments arguments;
  describe(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    arguments.run_folder.empty() ? evaluateSingle(arguments) : evaluateRunFolder(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_evaluate: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
