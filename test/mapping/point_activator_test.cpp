#include "mba_vo/mapping/point_activator.h"

#include <cmath>

#include <gtest/gtest.h>

#include "window/planar_scene.h"

namespace mba_vo::point_activator_test {
namespace {

/// Three keyframes of a corner of a room. The first has points with known depths in the upper part of its image, and
/// candidates everywhere, whose depths nobody has searched.
class PointActivatorTest : public testing::Test {
 protected:
  PointActivatorTest() {
    for (KeyframeId id = 0; id < 3; ++id) {
      const auto image = test::pyramidOf(scene_.render(camera_, pose(id)), camera_);
      window_.addKeyframe({id, image, image, pose(id), Vector6::Zero(), Vector6::Zero(), {}});
    }
    for (int y = 12; y < camera_.height - 12; y += 8) {
      for (int x = 12; x < camera_.width - 12; x += 8) {
        if (y < 100) window_.addPoint(0, {x, y}, scene_.inverseDepth(camera_, pose(0), {x, y}));
        ImmaturePoint point;
        point.pixel = {x + 4, y + 4};
        candidates_.push_back(point);
      }
    }
    known_ = window_.pointCount();
  }

  static SE3 pose(KeyframeId id) {
    return SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.08, 0.02, 0.03) * static_cast<double>(id));
  }

  const PinholeCamera camera_ = test::smallCamera();
  const test::PlanarScene scene_ = test::PlanarScene::corner();
  Window window_{WindowConfig{}};
  std::vector<ImmaturePoint> candidates_;
  int known_ = 0;
};

TEST_F(PointActivatorTest, NeedsFoundDepthsAsARule) {
  PointActivator activator(window_, 2, 6.0);
  const std::size_t before = candidates_.size();
  activator.activateFound(0, candidates_);
  EXPECT_EQ(window_.pointCount(), known_);
  EXPECT_EQ(candidates_.size(), before) << "they may still be found";
}

/// From the true depth, which the last search left as uncertain as this: the next keyframe shows that 8 px away for 1.
TEST_F(PointActivatorTest, AFoundDepthIsAsUncertainAsItsInterval) {
  for (const double relative : {0.01, 0.99}) {
    std::vector<ImmaturePoint> found = candidates_;
    for (ImmaturePoint& point : found) {
      const double d = scene_.inverseDepth(camera_, pose(0), point.pixel.cast<double>());
      point.state = ImmaturePoint::State::kGood;
      point.inverse_depth_min = (1.0 - relative) * d;
      point.inverse_depth_max = (1.0 + relative) * d;
      point.quality = 10.0;
    }
    const int before = window_.pointCount();
    PointActivator(window_, 2, 6.0).activateFound(0, found);
    const int added = window_.pointCount() - before;
    if (relative < 0.5) {
      EXPECT_GT(added, 50) << added;
    } else {
      EXPECT_EQ(added, 0);
    }
  }
}

TEST_F(PointActivatorTest, TellsWhenPointsAreShort) {
  const PointActivator activator(window_, 2, 6.0);
  EXPECT_TRUE(activator.isStarving(100 * known_));
  EXPECT_FALSE(activator.isStarving(known_));
}

TEST_F(PointActivatorTest, TellsWhenThereAreEnoughAndWhatThatTook) {
  PointActivator activator(window_, 2, 6.0);
  EXPECT_FALSE(activator.isFull(known_ + 1));
  EXPECT_EQ(activator.residuals(), 0);
  const std::size_t tries = candidates_.size();
  activator.activateGuessed(0, candidates_);
  const int added = window_.pointCount() - known_;
  EXPECT_TRUE(activator.isFull(added));
  EXPECT_FALSE(activator.isFull(known_ + added + 1));
  EXPECT_GE(activator.residuals(), 2 * added) << "two other keyframes";
  EXPECT_LE(activator.residuals(), 2 * static_cast<int>(tries));
}

TEST_F(PointActivatorTest, FindsDepthsFromThoseAround) {
  PointActivator activator(window_, 2, 6.0);
  const std::size_t before = candidates_.size();
  activator.activateGuessed(0, candidates_);
  const int added = window_.pointCount() - known_;
  EXPECT_GT(added, 200);
  EXPECT_EQ(before - candidates_.size(), static_cast<std::size_t>(added)) << "the others keep their chance";
  int right = 0;
  const std::vector<WindowPoint> points = window_.points();
  for (std::size_t i = static_cast<std::size_t>(known_); i < points.size(); ++i) {
    const double truth = scene_.inverseDepth(camera_, pose(0), points[i].pixel);
    right += std::abs(points[i].inverse_depth / truth - 1.0) < 0.05 ? 1 : 0;
  }
  EXPECT_GT(right, added * 9 / 10) << "of " << added;
}

TEST_F(PointActivatorTest, TriesALimitedNumberOfGuesses) {
  std::vector<ImmaturePoint> many;
  for (int y = 12; y < camera_.height - 12; y += 3) {
    for (int x = 12; x < camera_.width - 12; x += 3) {
      many.emplace_back();
      many.back().pixel = {x, y};
    }
  }
  PointActivator activator(window_, 2, 1.0);
  activator.activateGuessed(0, many);
  const int tried = activator.residuals() / 2;  // two other keyframes
  EXPECT_LE(tried, PointActivator::kMostGuesses);
  EXPECT_GT(tried, PointActivator::kMostGuesses / 2);
  activator.activateGuessed(0, many);
  EXPECT_EQ(activator.residuals() / 2, tried) << "of all hosts together";
}

TEST_F(PointActivatorTest, KeepsADistanceBetweenPoints) {
  std::vector<ImmaturePoint> twice = candidates_;
  twice.insert(twice.end(), candidates_.begin(), candidates_.end());
  PointActivator activator(window_, 2, 6.0);
  activator.activateGuessed(0, twice);
  const int added = window_.pointCount() - known_;
  activator.activateGuessed(0, twice);
  EXPECT_LT(window_.pointCount() - known_ - added, added / 4) << "most of their places are taken";
}

}  // namespace
}  // namespace mba_vo::point_activator_test
