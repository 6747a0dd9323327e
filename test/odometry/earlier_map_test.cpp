#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/odometry/config_yaml.h"
#include "mba_vo/odometry/odometry.h"
#include "odometry/walk.h"

namespace mba_vo::earlier_map_test {
namespace {

using test::walk;

constexpr std::size_t kMostUntilFound = 24;  // frames: twice the 12 that it takes; they are very blurred

/// What the mapper tells when a loop moves the map.
constexpr const char* kMoved = "a loop was closed";

OdometryConfig options(bool localize_only = false) {
  OdometryConfig options;
  options.mapper.deterministic = true;
  options.mapper.localize_only = localize_only;
  finalize(options);
  return options;
}

/// What was published of a frame: where the camera was in the map.
struct Place {
  std::size_t frame;
  Eigen::Vector3d in_map;
};

std::vector<Place> runOver(Odometry& odometry, std::size_t first, std::size_t count) {
  std::vector<Place> places;
  for (std::size_t i = first; i < first + count; ++i) {
    for (const PublishedImage& image : odometry.process(walk().frames.at(i)).images) {
      const TrackedFrame& tracked = *image.step.message.tracked;
      if (tracked.tracked()) places.push_back({i, (image.step.T_map_odom * image.step.T_odom_camera).translation()});
    }
  }
  return places;
}

Similarity alignmentOf(const std::vector<Place>& places) {
  std::vector<Eigen::Vector3d> estimate, truth;
  for (const Place& place : places) {
    estimate.push_back(place.in_map);
    truth.push_back(walk().truth.at(place.frame).translation());
  }
  return alignPositions(estimate, truth, AlignmentMode::kSim3);
}

/// Root mean square [m].
double errorOf(const std::vector<Place>& places, const Similarity& T_world_map) {
  double sum = 0.0;
  for (const Place& place : places) {
    sum += (T_world_map * place.in_map - walk().truth.at(place.frame).translation()).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(places.size()));
}

/// A run over the first two thirds of the walk, and what it leaves behind.
struct FirstRun {
  std::vector<Place> places;
  std::shared_ptr<const SavedMap> map;

  FirstRun() {
    Odometry odometry(options(), 0);
    places = runOver(odometry, 0, 80);
    map = std::make_shared<SavedMap>(odometry.mapper().savedMap().value());
  }
};

const FirstRun& firstRun() {
  static const FirstRun run;
  return run;
}

std::shared_ptr<const SavedMap> movedBeforeAnyRun() {
  auto map = std::make_shared<SavedMap>(*firstRun().map);
  moveBeforeAnyRun(*map);
  return map;
}

TEST(EarlierMap, ACameraIsFoundInItAndGoesOnInItsFrameAndScale) {
  Odometry odometry(options(), 0);
  odometry.beginIn(movedBeforeAnyRun());
  const std::vector<Place> places = runOver(odometry, 40, 80);
  ASSERT_FALSE(places.empty());
  EXPECT_LE(places.front().frame, 40 + kMostUntilFound);
  EXPECT_GE(places.size(), 80 - kMostUntilFound);
  const Similarity T_world_map = alignmentOf(firstRun().places);
  EXPECT_LT(errorOf(places, T_world_map), 0.0027);  // 1.4 mm; frames 80 to 119 are where the first run was not
}

TEST(EarlierMap, WhatComesIsAddedToIt) {
  Odometry odometry(options(), 0);
  odometry.beginIn(movedBeforeAnyRun());
  runOver(odometry, 40, 80);
  const SavedMap grown = odometry.mapper().savedMap().value();
  EXPECT_GT(grown.keyframes.size(), firstRun().map->keyframes.size());
  for (std::size_t i = 0; i < firstRun().map->keyframes.size(); ++i) {
    const Reference& before = firstRun().map->keyframes[i].reference;
    EXPECT_EQ(grown.keyframes[i].reference.id.keyframe_id, before.id.keyframe_id);
    EXPECT_LT((grown.keyframes[i].reference.T_map_reference.inverse() * before.T_map_reference).log().norm(), 1e-9);
  }
}

TEST(EarlierMap, StaysAsItIsWhereTheCameraIsOnlyToBeLocalised) {
  Odometry odometry(options(true), 0);
  odometry.beginIn(movedBeforeAnyRun());
  EXPECT_FALSE(runOver(odometry, 40, 80).empty());
  const SavedMap kept = odometry.mapper().savedMap().value();
  ASSERT_EQ(kept.keyframes.size(), firstRun().map->keyframes.size());
  for (std::size_t i = 0; i < kept.keyframes.size(); ++i) {
    const Reference &before = firstRun().map->keyframes[i].reference, &after = kept.keyframes[i].reference;
    EXPECT_EQ(after.T_map_reference.log(), before.T_map_reference.log());
    EXPECT_EQ(after.points.size(), before.points.size());
  }
}

TEST(EarlierMap, AResetBeginsInItAgain) {
  Odometry odometry(options(), 0);
  odometry.beginIn(movedBeforeAnyRun());
  ASSERT_FALSE(runOver(odometry, 40, 20).empty());
  const std::vector<TrajectoryEntry> before = odometry.trajectory();
  odometry.reset();
  const std::vector<Place> places = runOver(odometry, 60, 20);
  ASSERT_FALSE(places.empty());
  const std::vector<TrajectoryEntry> all = odometry.trajectory();
  ASSERT_GT(all.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {  // maps come one after the other
    EXPECT_EQ(all[i].frame_sequence, before[i].frame_sequence);
    EXPECT_EQ(all[i].map_id, before[i].map_id);
    EXPECT_LT((all[i].trajectory.T_reference_mid.inverse() * before[i].trajectory.T_reference_mid).log().norm(), 1e-3);
  }
  EXPECT_NE(all.back().map_id, before.back().map_id);
  EXPECT_LE(places.front().frame, 60 + kMostUntilFound);
  EXPECT_LT(errorOf(places, alignmentOf(firstRun().places)), 0.0044);  // 2.3 mm
}

/// From the middle of the walk on, the loaded map is `off` from what odometry makes of the way there. The camera goes
/// there, and back again.
struct RunInABentMap {
  std::vector<Eigen::Vector3d> in_map;  // the camera, of each frame with a pose
  std::vector<SE3> T_odom_camera;
  int moves = 0;
  bool found_where_bent = false;
  std::optional<SavedMap> saved;

  RunInABentMap(const SE3& off, bool close_loops) {
    auto map = std::make_shared<SavedMap>(*movedBeforeAnyRun());
    for (std::size_t i = map->keyframes.size() / 2; i < map->keyframes.size(); ++i) {
      SE3& T = map->keyframes[i].reference.T_map_reference;
      T = off * T;
    }
    OdometryConfig config = options();
    config.mapper.loops.close = close_loops;
    Odometry odometry(config, 0);
    odometry.beginIn(map);
    const std::vector<FrameConstPtr>& frames = test::walkThereAndBack().frames;
    for (std::size_t i = 14; i < frames.size(); ++i) {
      const OdometryResult result = odometry.process(frames[i]);
      for (const PublishedImage& image : result.images) {
        if (!image.step.message.tracked->tracked()) continue;
        T_odom_camera.push_back(image.step.T_odom_camera);
        in_map.push_back((image.step.T_map_odom * image.step.T_odom_camera).translation());
      }
      for (const MapperOutput& output : result.mapping) {
        moves += output.message.find(kMoved) == 0 ? 1 : 0;
        const std::size_t by = output.message.find("by keyframe ");
        if (by == std::string::npos || !in_map.empty()) continue;  // only where the run begins
        found_where_bent = std::stoul(output.message.substr(by + 12)) >= map->keyframes.size() / 2;
      }
    }
    saved = odometry.mapper().savedMap();
  }
};

TEST(EarlierMap, LoopsWithItMoveTheMapAndNotTheOdometry) {
  const SE3 off(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.06, 0.0, 0.0));
  const RunInABentMap without(off, false), with(off, true);
  EXPECT_EQ(without.moves, 0);
  EXPECT_GE(with.moves, 1);
  EXPECT_LE(with.moves, 10) << "what nobody would see is not worth a step";
  ASSERT_EQ(with.in_map.size(), without.in_map.size());
  double furthest = 0.0;  // towards where the other half of the map is
  for (std::size_t i = 0; i < with.in_map.size(); ++i) {
    const double moved = with.in_map[i].x() - without.in_map[i].x();
    furthest = std::max(furthest, with.found_where_bent ? -moved : moved);
    EXPECT_EQ(with.T_odom_camera[i].log(), without.T_odom_camera[i].log());
  }
  EXPECT_EQ(with.in_map.front(), without.in_map.front());
  ASSERT_EQ(with.saved->keyframes.size(), without.saved->keyframes.size());
  double most = 0.0;
  for (std::size_t k = 0; k < with.saved->keyframes.size(); ++k) {
    most = std::max(most, (with.saved->keyframes[k].reference.T_map_reference.translation() -
                           without.saved->keyframes[k].reference.T_map_reference.translation())
                              .norm());
  }
  const ReferencePoint& before = firstRun().map->keyframes.front().reference.points.front();
  const ReferencePoint& after = with.saved->keyframes.front().reference.points.front();
  EXPECT_NEAR(after.inverse_depth / before.inverse_depth, 1.0F, 1e-6F) << "a loaded map keeps its unit of length";
  EXPECT_GT(most, 0.3 * off.translation().x()) << "what is saved has the loops";
  EXPECT_GT(furthest, 0.3 * off.translation().x()) << "towards where the map has what is seen";
  EXPECT_LT(furthest, 1.2 * off.translation().x());
}

TEST(EarlierMap, AnotherOneTakesItsPlace) {
  auto other = std::make_shared<SavedMap>(*movedBeforeAnyRun());
  other->keyframes.erase(other->keyframes.begin() + 3, other->keyframes.end());
  Odometry odometry(options(), 0);
  odometry.beginIn(movedBeforeAnyRun());
  ASSERT_FALSE(runOver(odometry, 40, 20).empty());
  odometry.beginIn(other);
  runOver(odometry, 60, 1);
  EXPECT_EQ(odometry.mapper().savedMap().value().keyframes.size(), 3U);
}

TEST(EarlierMap, WithoutKeyframesIsRefused) {
  Mapper mapper(options().mapper);
  EXPECT_THROW(mapper.beginIn(SavedMap()), std::invalid_argument);
}

TEST(EarlierMap, ImagesOfAnotherSizeAreToldAndBeginAMapOfTheirOwn) {
  for (const bool localize_only : {false, true}) {
    Mapper mapper(options(localize_only).mapper);
    mapper.beginIn(*movedBeforeAnyRun());
    auto frame = std::make_shared<Frame>(*walk().frames.at(40));
    const ImageLevel& whole = frame->pyramid.level(0);
    PinholeCamera camera = whole.camera;
    camera.width = 300;
    camera.height = 200;
    frame->pyramid = ImagePyramid(whole.intensity(cv::Rect(0, 0, 300, 200)).clone(), camera, 4);
    auto tracked = std::make_shared<TrackedFrame>();
    tracked->frame = frame;
    const MapperOutput output = mapper.process(tracked);
    EXPECT_NE(output.message.find("images of 376x240 pixels, these have 300x200"), std::string::npos) << output.message;
    EXPECT_EQ(output.is_news, !localize_only);
    EXPECT_EQ(mapper.savedMap().has_value(), localize_only);
  }
}

/// The frame as it is where the machine does not keep up (`image.binning`).
FrameConstPtr binnedFrame(const Frame& whole) {
  auto frame = std::make_shared<Frame>(whole);
  const ImageLevel& half = whole.pyramid.level(1);
  frame->pyramid = ImagePyramid(half.intensity, half.camera, whole.pyramid.levels() - 1);
  return frame;
}

TEST(EarlierMap, ACameraWhoseImagesAreBinnedIsFoundInIt) {
  Odometry odometry(options(), 0);
  odometry.beginIn(movedBeforeAnyRun());
  for (std::size_t i = 40; i < 80; ++i) odometry.process(binnedFrame(*walk().frames.at(i)));
  const SavedMap grown = odometry.mapper().savedMap().value();
  ASSERT_GT(grown.keyframes.size(), firstRun().map->keyframes.size());
  EXPECT_EQ(2 * grown.keyframes.back().camera.width, grown.keyframes.front().camera.width);
}

TEST(EarlierMap, KeepsItsUnitOfLength) {
  std::vector<Sim3> poses;
  for (int i = 0; i < 3; ++i)
    poses.emplace_back(SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1.0 + i, 0, 0)), 2.0);
  keepUnit(poses);
  EXPECT_DOUBLE_EQ(poses.front().scale(), 1.0);
  EXPECT_DOUBLE_EQ(poses.front().translation().x(), 1.0);
  EXPECT_DOUBLE_EQ(poses.back().translation().x(), 2.0);
}

TEST(EarlierMap, WhereAKeyframeIsPlacedAllThatIsRelativeToItGrows) {
  SavedMap map = *firstRun().map;
  ArchivedKeyframe& keyframe = map.keyframes.front();
  const Reference before = keyframe.reference;
  place(keyframe, Sim3(before.T_map_reference, 2.0));
  EXPECT_EQ(keyframe.reference.motion.velocity.head<3>(), 2.0 * before.motion.velocity.head<3>());
  EXPECT_EQ(keyframe.reference.motion.velocity.tail<3>(), before.motion.velocity.tail<3>());
  EXPECT_EQ(keyframe.reference.image_xi.head<3>(), 2.0 * before.image_xi.head<3>());
  EXPECT_FLOAT_EQ(keyframe.reference.points.front().inverse_depth, 0.5F * before.points.front().inverse_depth);
  EXPECT_FLOAT_EQ(keyframe.reference.points.front().variance, 0.25F * before.points.front().variance);
}

}  // namespace
}  // namespace mba_vo::earlier_map_test
