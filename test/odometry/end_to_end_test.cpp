#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>

#include <gtest/gtest.h>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/image_intake.h"
#include "mba_vo/odometry/odometry.h"
#include "support/rendered_sequence.h"

namespace mba_vo::end_to_end_test {
namespace {

constexpr double kExposure = 0.03;  // [s] of 37 ms between frames
constexpr int kFrames = 70;

SimulationConfig config() {
  SimulationConfig config = test::sequenceConfig(kExposure);
  config.trajectory_seed = 3;
  return config;
}

const test::RenderedSequence& plainLens() {
  static const test::RenderedSequence sequence = test::renderFrames(config(), 0, kFrames);
  return sequence;
}

/// The same scene and motion through a lens that distorts like a cheap wide one.
const test::RenderedSequence& distortingLens() {
  static const test::RenderedSequence sequence = [] {
    SimulationConfig distorted = config();
    distorted.distortion = {-0.28, 0.07, 2e-4, -3e-4, 0.0};
    return test::renderFrames(distorted, 0, kFrames);
  }();
  return sequence;
}

struct Published {
  std::uint64_t frame_sequence = 0;
  ExposureTrajectory in_map;
};

struct OdometryRun {
  std::vector<TrajectoryEntry> trajectory;
  std::vector<Published> published;
  int initializing_at_first = 0;  // frames before the first tracked one
  int lost = 0;                   // frames without pose after it
  int keyframes = 0;
};

OdometryRun runOdometry(const std::vector<FrameConstPtr>& frames, int reference_delay_frames = 0) {
  OdometryConfig options;
  options.mapper.deterministic = true;
  finalize(options);
  Odometry odometry(options, reference_delay_frames);
  OdometryRun run;
  bool begun = false;
  for (const FrameConstPtr& frame : frames) {
    const OdometryResult result = odometry.process(frame);
    begun = begun || result.tracked()->tracked();
    if (!begun) ++run.initializing_at_first;
    if (begun && !result.tracked()->tracked()) ++run.lost;
    for (const PublishedImage& image : result.images) {
      const TrackedFrameConstPtr& tracked = image.step.message.tracked;
      if (!tracked || !tracked->tracked()) continue;
      const BodyMotion& motion = image.step.motion;
      run.published.push_back(
          {tracked->frame->sequence,
           {image.step.T_map_odom * image.step.T_odom_camera, motion.velocity, kExposure, motion.acceleration}});
    }
    for (const MapperOutput& output : result.mapping) run.keyframes += output.keyframe ? 1 : 0;
  }
  odometry.finish();
  run.trajectory = odometry.trajectory();
  return run;
}

struct Accuracy {
  double ate = 0.0;              // after alignment by similarity, rms [m]
  double median_rotation = 0.0;  // [deg]
  double path = 0.0;             // length of the true path [m]
  double median_motion = 0.0;    // error of the motion within the exposure over its length, median
  int reversed = 0;              // of the frames that turn by more than half a degree in the exposure
  int frames = 0;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

Accuracy compare(const std::vector<TrajectoryEntry>& trajectory, const test::RenderedSequence& sequence) {
  std::map<std::uint64_t, const SimulatedFrame*> truth;
  for (const SimulatedFrame& frame : sequence.frames) truth[frame.id] = &frame;
  std::vector<Eigen::Vector3d> estimated, true_positions;
  for (const TrajectoryEntry& entry : trajectory) {
    estimated.push_back(entry.trajectory.T_reference_mid.translation());
    true_positions.push_back(truth.at(entry.frame_sequence)->T_world_mid.translation());
  }
  const Similarity alignment = alignPositions(estimated, true_positions, AlignmentMode::kSim3);
  Accuracy accuracy;
  std::vector<double> rotations, motions;
  double squares = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const SimulatedFrame& frame = *truth.at(trajectory[i].frame_sequence);
    const SE3 pose = alignment * trajectory[i].trajectory.T_reference_mid;
    squares += (pose.translation() - frame.T_world_mid.translation()).squaredNorm();
    rotations.push_back((pose.inverse() * frame.T_world_mid).log().tail<3>().norm() * 180.0 / M_PI);
    const Eigen::Vector3d turn = trajectory[i].trajectory.xi().tail<3>();
    const Eigen::Vector3d true_turn = (frame.T_world_start.inverse() * frame.T_world_end).log().tail<3>();
    if (true_turn.norm() > 0.5 * M_PI / 180.0) {
      motions.push_back((turn - true_turn).norm() / true_turn.norm());
      accuracy.reversed += turn.dot(true_turn) < 0.0 ? 1 : 0;
    }
    if (i > 0) accuracy.path += (true_positions[i] - true_positions[i - 1]).norm();
  }
  accuracy.frames = static_cast<int>(trajectory.size());
  accuracy.ate = std::sqrt(squares / static_cast<double>(trajectory.size()));
  accuracy.median_rotation = median(rotations);
  accuracy.median_motion = median(motions);
  return accuracy;
}

std::ostream& operator<<(std::ostream& out, const Accuracy& a) {
  return out << "ATE " << a.ate << " m on " << a.path << " m, rotation " << a.median_rotation
             << " deg, motion within the exposure off by " << 100.0 * a.median_motion << " %, " << a.reversed
             << " reversed, " << a.frames << " frames";
}

/// Every frame from the first in the trajectory on has a pose, by time, in one map.
void expectComplete(const OdometryRun& run) {
  ASSERT_FALSE(run.trajectory.empty());
  EXPECT_EQ(run.lost, 0);
  for (std::size_t i = 1; i < run.trajectory.size(); ++i) {
    EXPECT_EQ(run.trajectory[i].frame_sequence, run.trajectory[i - 1].frame_sequence + 1);
    EXPECT_EQ(run.trajectory[i].map_id, run.trajectory[0].map_id);
  }
  EXPECT_EQ(run.trajectory.back().frame_sequence, kFrames - 1U);
  EXPECT_LE(run.trajectory.front().frame_sequence, 3U);
}

/// Rms of what was published, at mid-exposure and at start and end [m], aligned by the places at mid-exposure.
std::pair<double, double> publishedErrors(const OdometryRun& run, const test::RenderedSequence& sequence) {
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const Published& image : run.published) {
    estimated.push_back(image.in_map.T_reference_mid.translation());
    truth.push_back(sequence.frames.at(image.frame_sequence).T_world_mid.translation());
  }
  const Similarity alignment = alignPositions(estimated, truth, AlignmentMode::kSim3);
  const auto squaredError = [&](const SE3& pose, const SE3& true_pose) {
    return ((alignment * pose).translation() - true_pose.translation()).squaredNorm();
  };
  double mid = 0.0, ends = 0.0;
  for (const Published& image : run.published) {
    const SimulatedFrame& frame = sequence.frames.at(image.frame_sequence);
    mid += squaredError(image.in_map.T_reference_mid, frame.T_world_mid);
    ends += 0.5 * squaredError(image.in_map.start(), frame.T_world_start);
    ends += 0.5 * squaredError(image.in_map.end(), frame.T_world_end);
  }
  const auto count = static_cast<double>(run.published.size());
  return {std::sqrt(mid / count), std::sqrt(ends / count)};
}

const OdometryRun& blurredRun() {
  static const OdometryRun run = runOdometry(test::toFrames(plainLens(), false, kExposure));
  return run;
}

TEST(EndToEnd, PublishedStartAndEndAreAsGoodAsThePoseBetween) {
  const auto [mid, ends] = publishedErrors(blurredRun(), plainLens());
  ASSERT_GT(blurredRun().published.size(), kFrames / 2U);
  EXPECT_LT(ends, 1.3 * mid) << "start and end " << ends << " m, mid " << mid << " m";
}

TEST(EndToEnd, TracksABlurredSequence) {
  std::vector<double> blur;
  for (const SimulatedFrame& frame : plainLens().frames) blur.push_back(frame.blur_px);
  ASSERT_GT(median(blur), 4.0);
  expectComplete(blurredRun());
  const Accuracy accuracy = compare(blurredRun().trajectory, plainLens());
  EXPECT_LT(accuracy.ate, 0.003) << accuracy;
  EXPECT_LT(accuracy.median_rotation, 0.5) << accuracy;
  EXPECT_LT(accuracy.median_motion, 0.1) << accuracy;
  EXPECT_LE(accuracy.reversed, 1) << accuracy;
  EXPECT_GE(blurredRun().keyframes, 3);
}

TEST(EndToEnd, WithoutTheBlurModelTheSameImagesAreTrackedClearlyWorse) {
  const OdometryRun run = runOdometry(test::toFrames(plainLens(), false, 0.0));
  const double blur_aware = compare(blurredRun().trajectory, plainLens()).ate;
  if (static_cast<int>(run.trajectory.size()) < kFrames * 4 / 5) return;  // lost
  const Accuracy accuracy = compare(run.trajectory, plainLens());
  EXPECT_GT(accuracy.ate, 3.0 * blur_aware) << accuracy;
}

TEST(EndToEnd, TwoRunsGiveTheSameBytes) {
  const OdometryRun again = runOdometry(test::toFrames(plainLens(), false, kExposure));
  const auto& first = blurredRun().trajectory;
  ASSERT_EQ(again.trajectory.size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    const ExposureTrajectory& a = first[i].trajectory;
    const ExposureTrajectory& b = again.trajectory[i].trajectory;
    EXPECT_EQ(first[i].frame_sequence, again.trajectory[i].frame_sequence);
    EXPECT_EQ(a.T_reference_mid.rotation().coeffs(), b.T_reference_mid.rotation().coeffs());
    EXPECT_EQ(a.T_reference_mid.translation(), b.T_reference_mid.translation());
    EXPECT_EQ(a.velocity, b.velocity);
  }
}

TEST(EndToEnd, ReferencesMayComeLate) {
  const OdometryRun run = runOdometry(test::toFrames(plainLens(), false, kExposure), 3);
  expectComplete(run);
  const Accuracy accuracy = compare(run.trajectory, plainLens());
  EXPECT_LT(accuracy.ate, 0.003) << accuracy;
}

TEST(EndToEnd, TracksTheSharpTwin) {
  const OdometryRun run = runOdometry(test::toFrames(plainLens(), true, 0.0));
  expectComplete(run);
  const Accuracy accuracy = compare(run.trajectory, plainLens());
  EXPECT_LT(accuracy.ate, 0.002) << accuracy;
  EXPECT_LT(accuracy.median_rotation, 0.8) << accuracy;
}

TEST(EndToEnd, ADistortingLensIsAsGood) {
  const OdometryRun run = runOdometry(test::toFrames(distortingLens(), false, kExposure));
  expectComplete(run);
  const Accuracy accuracy = compare(run.trajectory, distortingLens());
  const double undistorted = compare(blurredRun().trajectory, plainLens()).ate;
  EXPECT_LT(accuracy.ate, std::max(1.2 * undistorted, undistorted + 0.003)) << accuracy;
  EXPECT_LT(accuracy.median_motion, 0.15) << accuracy;
}

TEST(EndToEnd, BinnedImagesAreNearlyAsGood) {
  const OdometryRun run = runOdometry(test::toFrames(distortingLens(), false, kExposure, 2));
  expectComplete(run);
  const Accuracy accuracy = compare(run.trajectory, distortingLens());
  EXPECT_LT(accuracy.ate, 0.006) << accuracy;
  EXPECT_LT(accuracy.median_motion, 0.2) << accuracy;
}

TEST(EndToEnd, BinningMayChangeWithinAMap) {
  struct Change {
    int before, after;
    double ate;  // at most [m]
  };
  for (const Change& change : {Change{1, 2, 0.004}, Change{2, 1, 0.0025}}) {
    std::vector<FrameConstPtr> frames = test::toFrames(plainLens(), false, kExposure, change.before);
    const std::vector<FrameConstPtr> later = test::toFrames(plainLens(), false, kExposure, change.after);
    std::copy(later.begin() + kFrames / 2, later.end(), frames.begin() + kFrames / 2);
    const OdometryRun run = runOdometry(frames);
    expectComplete(run);
    const Accuracy accuracy = compare(run.trajectory, plainLens());
    EXPECT_LT(accuracy.ate, change.ate) << accuracy;
  }
}

/// The sequence as a camera of 12 bits gives it, in images of 16 that do not say so.
std::vector<FrameConstPtr> twelveBitFrames() {
  ImageIntake intake({}, {}, false);
  intake.setCalibration(plainLens().calibration, {});
  std::vector<FrameConstPtr> frames;
  for (const SimulatedFrame& f : plainLens().frames) {
    CameraImage image;
    image.sequence = f.id;
    image.stamp_ns = image.mid_exposure_ns = f.mid_exposure_ns;
    image.exposure = kExposure;
    f.blurred.convertTo(image.image, CV_16U, 16.0);
    frames.push_back(intake.take(image).frame);
  }
  return frames;
}

TEST(EndToEnd, TwelveBitsInSixteenAreAsGood) {
  const OdometryRun run = runOdometry(twelveBitFrames());
  expectComplete(run);
  const Accuracy accuracy = compare(run.trajectory, plainLens());
  EXPECT_LT(accuracy.ate, 0.003) << accuracy;
  EXPECT_LT(accuracy.median_motion, 0.1) << accuracy;
}

}  // namespace
}  // namespace mba_vo::end_to_end_test
