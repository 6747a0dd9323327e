#include "mba_vo/io/recorded_motion.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.h"
#include "mba_vo/io/points_file.h"

namespace mba_vo::recorded_motion_test {
namespace {

constexpr std::int64_t kInterval = 40'000'000;  // [ns]
constexpr double kSeconds = 1e-9 * kInterval;

/// Turns about y, ever faster: angle = 2 t + 5 t^2.
std::vector<RecordedExposure> acceleratedTurn(int frames) {
  std::vector<RecordedExposure> exposures;
  for (int i = 0; i < frames; ++i) {
    const double t = i * kSeconds;
    RecordedExposure e;
    e.mid_exposure_ns = i * kInterval;
    e.map_id = 1;
    e.trajectory.T_reference_mid = SE3::exp((Vector6() << 0, 0, 0, 0, 2 * t + 5 * t * t, 0).finished());
    e.trajectory.velocity(4) = 2 + 10 * t;
    e.trajectory.exposure = 0.02;
    exposures.push_back(e);
  }
  return exposures;
}

TEST(RecordedMotion, HasTheVelocityAndAccelerationOfTheMotion) {
  const auto motion = RecordedMotion(acceleratedTurn(5)).at(2 * kInterval + 300);
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->map_id, 1U);
  EXPECT_NEAR(motion->trajectory.velocity(4), 2 + 10 * 2 * kSeconds, 1e-9);
  EXPECT_NEAR(motion->trajectory.acceleration(4), 10.0, 1e-9);
  EXPECT_EQ(motion->trajectory.exposure, 0.02);
}

/// An error of the velocity that the blur alone tells is mostly held back by the poses.
TEST(RecordedMotion, PosesHoldBackErrorsOfTheBlur) {
  std::vector<RecordedExposure> exposures = acceleratedTurn(5);
  for (RecordedExposure& e : exposures) e.trajectory.velocity(4) += 1.0;
  const auto motion = RecordedMotion(exposures).at(2 * kInterval);
  const double truth = 2 + 10 * 2 * kSeconds;
  EXPECT_LT(motion->trajectory.velocity(4), truth + 0.5);
  EXPECT_NEAR(motion->measured_velocity(4), truth + 1.0, 1e-9);
}

TEST(RecordedMotion, WithoutNeighboursTheMeasuredVelocityStands) {
  std::vector<RecordedExposure> exposures = acceleratedTurn(3);
  exposures[2].map_id = 2;
  const auto motion = RecordedMotion(exposures).at(kInterval);
  EXPECT_EQ(motion->trajectory.velocity, exposures[1].trajectory.velocity);
  EXPECT_EQ(motion->trajectory.acceleration.norm(), 0.0);
}

TEST(RecordedMotion, UnknownTimesHaveNone) {
  EXPECT_FALSE(RecordedMotion(acceleratedTurn(3)).at(kInterval / 2));
  EXPECT_FALSE(RecordedMotion({}).at(0));
}

MapPoint pointAt(double x, double y, double z, std::int64_t ns, MapId map) {
  MapPoint point;
  point.position_map = {x, y, z};
  point.keyframe_ns = ns;
  point.map_id = map;
  return point;
}

TEST(DepthsInFrame, AreThoseOfPointsThatTheFrameCanSee) {
  const PinholeCamera camera{100, 80, 50.0, 50.0, 49.5, 39.5};
  FrameMotion motion;
  motion.map_id = 1;
  motion.trajectory.T_reference_mid = SE3(Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0});
  const std::vector<MapPoint> points{pointAt(1.4, 0.2, 2.0, 100, 1),             // the only good one
                                     pointAt(1.0, 0.0, -2.0, 100, 1),            // behind the camera
                                     pointAt(30.0, 0.0, 2.0, 100, 1),            // beside the image
                                     pointAt(1.0, 0.0, 2.0, 100, 2),             // of another map
                                     pointAt(1.0, 0.0, 2.0, 2'000'000'000, 1)};  // seen much later
  const std::vector<DepthSample> depths = depthsInFrame(points, camera, motion, 0);
  ASSERT_EQ(depths.size(), 1U);
  EXPECT_FLOAT_EQ(depths[0].inverse_depth, 0.5F);
  EXPECT_NEAR(depths[0].pixel.x(), 59.5, 1e-4);
  EXPECT_NEAR(depths[0].pixel.y(), 44.5, 1e-4);
}

TEST(PointsFile, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  const std::vector<MapPoint> points{pointAt(1.25, -2.5, 3.0, 1'305'031'453'500'000'000, 1),
                                     pointAt(0.5, 0.25, 4.0, 1'305'031'454'000'000'000, 3)};
  std::ostringstream text;
  writePoints(points, text);
  const std::vector<MapPoint> read = readPoints(folder.write("points.txt", text.str()));
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].position_map, points[i].position_map);
    EXPECT_EQ(read[i].map_id, points[i].map_id);
    EXPECT_NEAR(static_cast<double>(read[i].keyframe_ns - points[i].keyframe_ns), 0.0, 1000.0);
  }
}

TEST(PointsFile, PlyHasAVertexPerPoint) {
  MapPoint bright = pointAt(1.25, -2.5, 3.0, 1'305'031'453'500'000'000, 1);
  bright.intensity = 300.0F;
  bright.keyframe_id = 7;
  MapPoint grey = pointAt(0.5, 0.25, 4.0, 1'305'031'454'000'000'000, 1);
  grey.intensity = 99.6F;
  std::ostringstream text;
  writePointsPly({bright, grey}, text);
  EXPECT_EQ(text.str().rfind("ply\nformat ascii 1.0\n", 0), 0U);
  EXPECT_THAT(text.str(), testing::HasSubstr("\nelement vertex 2\nproperty float x\n"));
  EXPECT_THAT(text.str(), testing::HasSubstr("end_header\n1.25 -2.5 3 255 255 255 7\n0.5 0.25 4 100 100 100 0\n"));
}

TEST(PointsFile, NamesFileAndLineOfWhatIsWrong) {
  const TemporaryFolder folder;
  EXPECT_THAT(messageOf([] { readPoints("/nonexistent.txt"); }), testing::HasSubstr("/nonexistent.txt"));
  const std::string file = folder.write("points.txt", "# map 1\n1.0 2.0 3.0 4.0\n1.0 2.0 3.0\n");
  EXPECT_THAT(messageOf([&] { readPoints(file); }), testing::HasSubstr(file + ":3"));
}

}  // namespace
}  // namespace mba_vo::recorded_motion_test
