#include "mba_vo/initialization/reference_motion.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::reference_motion_test {
namespace {

constexpr double kRowTime = 110e-6;  // [s] 240 rows in 26 ms, as a webcam
constexpr double kExposure = 0.004;  // [s]
constexpr double kStep = 1.0 / 30;   // [s] between the images
constexpr double kRate = 12.0;       // [rad/s]

/// A camera with a rolling shutter that swings before the room; the reference is seen at `phase` [rad] of that.
struct Swing {
  Vector6 width = (Vector6() << 0.04, 0.01, 0, 0.05, 0.08, 0.03).finished();
  double phase = 0.0;
  SE3 T_world_centre = test::roomView(40).T_world_mid;

  SE3 pose(double t) const { return T_world_centre * SE3::exp(std::sin(kRate * t + phase) * width); }
  BodyMotion motion() const { return {kRate * std::cos(phase) * width, -kRate * kRate * std::sin(phase) * width}; }
};

/// The image before, the reference and the one after, with poses as wrong as an initialiser's.
InitialMap mapOf(const Swing& swing, unsigned seed) {
  SimulationConfig config = test::roomConfig();
  config.row_time = kRowTime;
  const Simulator simulator(config, sharedRoom());
  PinholeCamera camera = test::roomSimulator().camera();
  camera.row_time = kRowTime;
  const auto pose = [&](double t) { return swing.pose(t); };
  const auto frameAt = [&](double t) {
    const SimulatedFrame rendered = simulator.renderExposure(pose, t, kExposure, seed);
    auto frame =
        std::make_shared<Frame>(*test::makeFrame(test::toFloat(rendered.blurred), std::llround(1e9 * t), kExposure));
    frame->pyramid = ImagePyramid(test::toFloat(rendered.blurred), camera, 5);
    return frame;
  };
  test::Random random(seed);
  InitialMap map;
  map.reference = frameAt(0.0);
  const SimulatedFrame own = simulator.renderExposure(pose, 0.0, kExposure, seed);
  map.points = test::makeReference(own, test::toFloat(own.blurred))->points;
  for (const double t : {-kStep, kStep}) {
    map.poses.push_back({frameAt(t), swing.pose(0.0).inverse() * swing.pose(t) * random.pose(6e-3, 5e-3)});
  }
  return map;
}

/// By which the first or the last row is misplaced in the image, by the turn alone [px].
double rowError(const BodyMotion& found, const BodyMotion& truth) {
  const PinholeCamera camera = test::roomSimulator().camera();
  const double t = 0.5 * kRowTime * camera.height;
  double largest = 0.0;
  for (const double row : {-t, t}) {
    const Eigen::Vector3d error = (found.until(row) - truth.until(row)).tail<3>();
    largest = std::max(largest, camera.fx * error.norm());
  }
  return largest;
}

TEST(ReferenceMotion, ComesFromTheNeighboursOfTheReferenceInTime) {
  constexpr std::int64_t kInterval = 37'000'000;  // [ns]
  const auto frameAt = [](std::int64_t ns) {
    auto frame = std::make_shared<Frame>();
    frame->mid_exposure_ns = ns;
    return frame;
  };
  const Vector6 v = (Vector6() << 0.3, -0.1, 0.2, 0.5, 1.0, -0.7).finished();
  InitialMap map;
  map.reference = frameAt(5 * kInterval);
  for (const std::int64_t i : {1, 3, 4, 6, 7, 9}) {
    // Only the two neighbours move along v; the others would spoil a mean over all.
    const SE3 pose =
        i == 4 || i == 6 ? SE3::exp(1e-9 * static_cast<double>((i - 5) * kInterval) * v) : SE3::exp(2.0 * v);
    map.poses.push_back({frameAt(i * kInterval), pose});
  }
  EXPECT_LT((referenceMotion(map, {}).velocity - v).norm(), 1e-9);
  map.poses.erase(map.poses.begin() + 3, map.poses.end());  // the reference is the newest frame
  EXPECT_LT((referenceMotion(map, {}).velocity - v).norm(), 1e-9);
  map.poses.clear();
  EXPECT_EQ(referenceMotion(map, {}).velocity.norm(), 0.0);
}

TEST(ReferenceMotion, OfARollingShutterIsThatOfTheImagesRatherThanOfTheirPoses) {
  for (const double phase : {0.3, 1.2, 2.5}) {
    Swing swing;
    swing.phase = phase;
    const InitialMap map = mapOf(swing, 3);
    InitialMap unseen = map;  // as if by a global shutter
    unseen.reference = test::makeFrame(test::toFloat(test::roomView(40).sharp), 0, kExposure);
    const double by_poses = rowError(referenceMotion(unseen, {}), swing.motion());
    const double by_images = rowError(referenceMotion(map, {}), swing.motion());
    EXPECT_GT(by_poses, 0.25) << "phase " << phase;
    EXPECT_LT(by_images, 0.6 * by_poses) << "phase " << phase;
  }
}

}  // namespace
}  // namespace mba_vo::reference_motion_test
