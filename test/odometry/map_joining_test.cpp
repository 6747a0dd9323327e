#include <algorithm>
#include <set>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "odometry/walk.h"

namespace mba_vo::map_joining_test {
namespace {

constexpr std::size_t kThere = 80;      // frames of the walk, until the camera looks elsewhere
constexpr std::size_t kElsewhere = 50;  // frames: so long that the map is lost for good, and another begins

/// A place that was never seen before, but is no less real: the room in a mirror.
FrameConstPtr mirrored(const Frame& frame) {
  const ImageLevel& level = frame.pyramid.level(0);
  cv::Mat1f image;
  cv::flip(level.intensity, image, 1);
  PinholeCamera camera = level.camera;
  camera.cx = camera.width - 1 - camera.cx;
  auto other = std::make_shared<Frame>(frame);
  other->pyramid = ImagePyramid(image, camera, frame.pyramid.levels());
  return other;
}

/// There, elsewhere, and back the way the camera came.
struct Excursion {
  std::vector<FrameConstPtr> frames;
  std::vector<std::optional<SE3>> truth;  // none elsewhere

  Excursion() {
    const test::Walk& walk = test::walk();
    for (std::size_t i = 0; i < kThere; ++i) add(walk.frames[i], walk.truth[i]);
    for (std::size_t i = 0; i < kElsewhere; ++i) add(mirrored(*walk.frames[kThere - 1 - i]), std::nullopt);
    for (std::size_t i = kThere; i-- > 0;) add(walk.frames[i], walk.truth[i]);
  }

  void add(const FrameConstPtr& shown, const std::optional<SE3>& T_world_camera) {
    const Frame& first = *test::walk().frames[0];
    const std::int64_t interval_ns = test::walk().frames[1]->mid_exposure_ns - first.mid_exposure_ns;
    auto frame = std::make_shared<Frame>(*shown);
    frame->sequence = frames.size();
    frame->stamp_ns = frame->mid_exposure_ns =
        first.mid_exposure_ns + static_cast<std::int64_t>(frames.size()) * interval_ns;
    frames.push_back(frame);
    truth.push_back(T_world_camera);
  }
};

const Excursion& excursion() {
  static const Excursion excursion;
  return excursion;
}

struct Published {
  std::uint64_t frame;
  MapId map;
  SE3 T_map_camera;
  SE3 T_odom_camera;
};

struct Journey {
  std::vector<Published> published;
  std::vector<std::string> joins;  // what was told of them
  std::uint64_t first_join = 0;    // frame
  SmoothedTrajectory smoothed;

  explicit Journey(bool close_loops) {
    OdometryConfig options;
    options.mapper.deterministic = true;
    options.mapper.loops.close = close_loops;
    finalize(options);
    Odometry odometry(options, 0);
    for (const FrameConstPtr& frame : excursion().frames) {
      const OdometryResult result = odometry.process(frame);
      for (const PublishedImage& image : result.images) {
        const TrackedFrame& tracked = *image.step.message.tracked;
        if (!tracked.tracked()) continue;
        published.push_back({frame->sequence, tracked.reference.map_id,
                             image.step.T_map_odom * image.step.T_odom_camera, image.step.T_odom_camera});
      }
      for (const MapperOutput& output : result.mapping) {
        if (output.message.find("was joined to") == std::string::npos) continue;
        joins.push_back(output.message);
        if (joins.size() == 1) first_join = frame->sequence;
      }
    }
    smoothed = odometry.mapper().smoothedTrajectory();
  }
};

const Journey& run() {
  static const Journey journey(false);
  return journey;
}

/// Root mean square of the positions, after the best similarity [m].
double errorOf(const std::vector<Eigen::Vector3d>& estimate, const std::vector<Eigen::Vector3d>& truth) {
  const Similarity alignment = alignPositions(estimate, truth, AlignmentMode::kSim3);
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += (alignment * estimate[i] - truth[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

TEST(MapJoining, WhatWasSeenBeforeTheLossIsOneMapWithWhatIsSeenAfterIt) {
  ASSERT_EQ(run().joins.size(), 1U);
  EXPECT_EQ(run().joins.front().find("map 3 was joined to map 1, whose lengths are taken times "), 0U)
      << run().joins.front();
  std::vector<Eigen::Vector3d> estimate, truth;
  std::set<MapId> maps_of_walk, maps_elsewhere;
  bool before = false, after = false;
  for (const TrajectoryEntry& entry : run().smoothed.entries) {
    const std::optional<SE3>& T_world_camera = excursion().truth.at(entry.frame_sequence);
    (T_world_camera ? maps_of_walk : maps_elsewhere).insert(entry.map_id);
    if (!T_world_camera) continue;
    (entry.frame_sequence < kThere ? before : after) = true;
    estimate.push_back(entry.trajectory.T_reference_mid.translation());
    truth.push_back(T_world_camera->translation());
  }
  EXPECT_TRUE(before && after);
  EXPECT_EQ(maps_of_walk, std::set<MapId>({3}));
  EXPECT_EQ(maps_elsewhere, std::set<MapId>({2})) << "what shows nothing of the others stays for itself";
  EXPECT_GT(truth.size(), 100U);
  EXPECT_LT(errorOf(estimate, truth), 0.0018);
}

TEST(MapJoining, ThePublishedMapIsThatOfBeforeTheLossAndOdometryDoesNotStep) {
  // In the unit of the present map, to which the older poses were scaled.
  std::vector<Eigen::Vector3d> estimate, truth;
  for (const TrajectoryEntry& entry : run().smoothed.entries) {
    if (entry.frame_sequence >= kThere) continue;
    estimate.push_back(entry.trajectory.T_reference_mid.translation());
    truth.push_back(excursion().truth.at(entry.frame_sequence)->translation());
  }
  const Similarity T_world_map = alignPositions(estimate, truth, AlignmentMode::kSim3);
  int joined = 0;
  for (std::size_t i = 1; i < run().published.size(); ++i) {
    const Published &now = run().published[i], &last = run().published[i - 1];
    if (now.map == last.map && now.frame == last.frame + 1) {
      EXPECT_LT((last.T_odom_camera.inverse() * now.T_odom_camera).log().norm(), 0.2) << "frame " << now.frame;
    }
    if (now.map != 3 || now.frame < run().first_join + 5) continue;
    ++joined;
    const SE3& T_world_camera = *excursion().truth.at(now.frame);
    EXPECT_LT((T_world_map * now.T_map_camera.translation() - T_world_camera.translation()).norm(), 0.006);
  }
  EXPECT_GT(joined, 10);
}

TEST(MapJoining, IsTheSameWhereLoopsAreClosed) {
  const Journey closing(true);
  ASSERT_EQ(closing.published.size(), run().published.size());
  for (std::size_t i = 0; i < closing.published.size(); ++i) {
    EXPECT_EQ(closing.published[i].T_odom_camera.log(), run().published[i].T_odom_camera.log());
  }
  EXPECT_GE(closing.joins.size(), 1U);
}

}  // namespace
}  // namespace mba_vo::map_joining_test
