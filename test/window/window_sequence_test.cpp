#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/window/window.h"
#include "support/random.h"
#include "window/planar_scene.h"

namespace mba_vo::window_sequence_test {
namespace {

using test::PlanarScene;

constexpr KeyframeId kKeyframes = 15;

SE3 poseAt(KeyframeId i) {
  const double t = static_cast<double>(i);
  Vector6 v;
  v << 0.05 * t - 0.35, 0.05 * std::sin(0.8 * t), 0.04 * std::sin(0.6 * t), 0.03 * std::sin(0.9 * t), -0.012 * t,
      0.02 * std::cos(t);
  return SE3::exp(v);
}

/// Feeds a window with keyframes whose poses and depths are guessed with errors, as the mapper does, and returns where
/// each keyframe was when it left the window.
class SlidingRun {
 public:
  explicit SlidingRun(const WindowConfig& config, KeyframeId keyframes = kKeyframes)
      : window_(config), keyframes_(keyframes) {}

  /// The focal length is taken for 3 % too long, until it is corrected with keyframe `when`.
  void correctFocalLength(KeyframeId when) {
    told_.fx *= 1.03;
    told_.fy *= 1.03;
    correct_with_ = when;
  }
  /// A small correction before there is anything: that of the focal length will not be the first.
  void correctAtOnce() {
    CalibrationCorrection small;
    small.values(CalibrationCorrection::kFocal) = 1e-9;
    window_.setCorrection(small);
  }
  /// The correction comes unexpectedly: what is marginalised before it does not follow.
  void settle() { settled_ = true; }

  std::vector<SE3> run() {
    for (KeyframeId id = 0; id < keyframes_; ++id) {
      addKeyframe(id);
      if (settled_ && id < correct_with_) window_.settleCorrection();
      if (id == correct_with_) {
        CalibrationCorrection right;
        right.values(CalibrationCorrection::kFocal) = 1.0 / 1.03 - 1.0;
        window_.setCorrection(right);
      }
      if (id < 2) continue;
      optimize(10);
      activatePoints(id - 1);
      optimize(6);
      for (const KeyframeId old : window_.keyframesToMarginalize()) {
        poses_[old] = window_.T_map_keyframe(old);
        window_.marginalize(old);
        marginalized_ = true;
      }
      largest_window_ = std::max(largest_window_, window_.keyframes().size());
    }
    for (const KeyframeId id : window_.keyframes()) poses_[id] = window_.T_map_keyframe(id);
    return poses_;
  }

  std::size_t largestWindow() const { return largest_window_; }
  /// That an optimisation moved all but the newest keyframe by in the mean, once one had been marginalised [m].
  double largestShift() const { return largest_shift_; }

 private:
  Eigen::Vector3d centreOfOldKeyframes() const {
    std::vector<KeyframeId> ids = window_.keyframes();
    ids.pop_back();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const KeyframeId id : ids) sum += window_.T_map_keyframe(id).translation();
    return sum / static_cast<double>(ids.size());
  }

  void optimize(int iterations) {
    const Eigen::Vector3d before = centreOfOldKeyframes();
    window_.optimize(iterations);
    if (marginalized_) largest_shift_ = std::max(largest_shift_, (centreOfOldKeyframes() - before).norm());
  }

  void addKeyframe(KeyframeId id) {
    truth_.push_back(poseAt(id));
    SE3 guess = truth_.back();
    if (id > 0) {
      guess = window_.T_map_keyframe(id - 1) * truth_[id - 1].inverse() * truth_[id] *
              SE3::exp(random_.tangent(0.004, 0.002));
    }
    poses_.push_back(guess);
    const auto image = test::pyramidOf(scene_.render(camera_, truth_.back()), told_);
    window_.addKeyframe({id, image, image, guess, Vector6::Zero(), Vector6::Zero(), {}});
    window_.addResidualsTo(id);
    if (id == 0) forEachPoint(id, [&](const Eigen::Vector2d& x, double d) { window_.addPoint(id, x, d); });
  }

  void activatePoints(KeyframeId id) {
    std::vector<NewPoint> points;
    forEachPoint(id, [&](const Eigen::Vector2d& x, double d) { points.push_back({id, x, d}); });
    const std::vector<bool> added = window_.activatePoints(points);
    activated_ += static_cast<int>(std::count(added.begin(), added.end(), true));
  }

  template <typename F>
  void forEachPoint(KeyframeId id, const F& f) {
    for (int y = 10; y < camera_.height - 10; y += 20) {
      for (int x = 10; x < camera_.width - 10; x += 20) {
        const double d = scene_.inverseDepth(camera_, truth_[id], {x, y});
        f({x, y}, d * std::exp(random_.normal(0.04)));
      }
    }
  }

  PlanarScene scene_ = PlanarScene::corner();
  PinholeCamera camera_ = test::smallCamera();
  PinholeCamera told_ = camera_;
  KeyframeId correct_with_ = std::numeric_limits<KeyframeId>::max();  // never
  bool settled_ = false;
  test::Random random_{5};
  Window window_;
  KeyframeId keyframes_;
  std::vector<SE3> truth_;
  std::vector<SE3> poses_;
  std::size_t largest_window_ = 0;
  bool marginalized_ = false;
  double largest_shift_ = 0.0;
  int activated_ = 0;
};

TEST(WindowSequence, MarginalizationKeepsEstimatesConsistent) {
  std::vector<SE3> truth;
  for (KeyframeId i = 0; i < kKeyframes; ++i) truth.push_back(poseAt(i));
  for (const int size : {5, 7}) {
    WindowConfig config;
    config.max_keyframes = config.min_keyframes = size;
    SlidingRun run(config);
    const std::vector<double> errors = test::alignedPositionErrors(truth, run.run());
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 4e-3) << "window of " << size;
    EXPECT_LE(run.largestWindow(), static_cast<std::size_t>(size));
  }
}

/// Mean position error of the keyframes from the correction of the calibration on.
double errorAfterCorrection(const std::function<void(SlidingRun&)>& prepare, KeyframeId corrected = 9) {
  WindowConfig config;
  config.max_keyframes = config.min_keyframes = 5;
  const KeyframeId keyframes = corrected + 6;
  SlidingRun run(config, keyframes);
  prepare(run);
  run.correctFocalLength(corrected);
  const std::vector<SE3> poses = run.run();
  std::vector<SE3> truth, found;
  for (KeyframeId i = corrected; i < keyframes; ++i) {
    truth.push_back(poseAt(i));
    found.push_back(poses[i]);
  }
  const std::vector<double> errors = test::alignedPositionErrors(truth, found);
  return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
}

TEST(WindowSequence, WhatWasMarginalizedFollowsTheCalibrationOrIsForgotten) {
  const double forgotten = errorAfterCorrection([](SlidingRun& run) { run.settle(); });
  const double followed = errorAfterCorrection([](SlidingRun& run) { run.correctAtOnce(); });
  const double left = errorAfterCorrection([](SlidingRun& run) {
    run.correctAtOnce();
    run.settle();
  });
  EXPECT_LT(followed, 1e-3);
  EXPECT_LT(forgotten, 1e-3);
  EXPECT_GT(left, 1.5 * std::max(followed, forgotten));
}

/// In a hard turn there may be nothing else that knows the scale.
TEST(WindowSequence, WhatWasMarginalizedIsNotForgottenLate) {
  constexpr KeyframeId kLate = 15;
  const double followed = errorAfterCorrection([](SlidingRun&) {}, kLate);
  const double left = errorAfterCorrection([](SlidingRun& run) { run.settle(); }, kLate);
  EXPECT_LT(followed, 1e-3);
  EXPECT_GT(left, 1.5 * followed);
}

TEST(WindowSequence, OptimisationsLeaveTheWindowWhereItIs) {
  SlidingRun run{WindowConfig()};
  run.run();
  EXPECT_LT(run.largestShift(), 1e-9);
}

}  // namespace
}  // namespace mba_vo::window_sequence_test
