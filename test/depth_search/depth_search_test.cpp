#include "mba_vo/depth_search/depth_search.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "depth_search/depth_statistics.h"
#include "depth_search/textured_wall_scene.h"
#include "mba_vo/image/point_selector.h"

namespace mba_vo::depth_search_test {
namespace {

using test::DepthStatistics;
using test::evaluateDepths;
using test::PlaneScene;
using test::searchDepth;
using test::WaveTexture;
using State = ImmaturePoint::State;

const PinholeCamera kCamera{320, 240, 220.0, 220.0, 159.5, 119.5};
constexpr double kNoise = 1.0;  // [grey levels]

/// A wall about 2 m away, turned about the vertical; the host is the world's origin.
PlaneScene slantedWall(unsigned seed) { return {kCamera, {{{0.1, 0.03, 0.5}, WaveTexture(seed)}}}; }

ExposureTrajectory sharpAt(const Vector6& xi) { return {SE3::exp(xi), Vector6::Zero(), 0.0}; }

Vector6 twist(double x, double y, double z, double rx, double ry, double rz) {
  Vector6 xi;
  xi << x, y, z, rx, ry, rz;
  return xi;
}

std::vector<ImmaturePoint> choosePoints(const ImagePyramid& host, int count) {
  std::vector<ImmaturePoint> points;
  for (const Eigen::Vector2i& pixel : selectPoints(host, count, {})) {
    points.push_back(makeImmaturePoint(host, pixel, {}));
  }
  return points;
}

/// Frames of a camera that moves away from the host, ever further.
std::vector<ExposureTrajectory> receding(int count, double xi_scale = 0.0) {
  std::vector<ExposureTrajectory> trajectories;
  for (int i = 1; i <= count; ++i) {
    ExposureTrajectory trajectory = sharpAt(i * twist(0.03, 0.008, i % 2 == 0 ? 0.01 : -0.01, 0.006, -0.012, 0.01));
    trajectory.exposure = 0.02;
    trajectory.velocity = xi_scale / 0.02 * twist(0.02, 0.01, 0.005, 0.025, -0.03, 0.02);
    trajectories.push_back(trajectory);
  }
  return trajectories;
}

TEST(DepthSearch, ConvergesOnASlantedWall) {
  const PlaneScene scene = slantedWall(1);
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  std::vector<ImmaturePoint> points = choosePoints(host, 600);
  ASSERT_GT(points.size(), 500U);
  for (const ExposureTrajectory& T_host : receding(6)) {
    const ImagePyramid frame = scene.render(T_host, 1, kNoise, 11);
    const DepthSearcher searcher(host, frame, T_host, 1.0, 0.0, {});
    for (ImmaturePoint& point : points) searcher.search(point);
  }
  const DepthStatistics statistics = evaluateDepths(scene, points, 0.02);
  EXPECT_GT(statistics.good, static_cast<int>(points.size()) * 7 / 10);
  EXPECT_GT(statistics.accurate, 0.9);
  EXPECT_GT(statistics.contained, 0.95);
  EXPECT_LT(statistics.median_error, 0.005);
}

TEST(DepthSearch, IntervalsContainTheTruthAlsoWithErroneousPoses) {
  const PlaneScene scene = slantedWall(2);
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  std::mt19937 rng(4);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<ImmaturePoint> points = choosePoints(host, 600);
  for (const ExposureTrajectory& T_host : receding(6)) {
    // About 0.2 px of error by rotation in either direction.
    ExposureTrajectory believed = T_host;
    const double sigma = 0.2 / kCamera.fx;
    believed.T_reference_mid =
        T_host.T_reference_mid * SE3::exp(sigma * twist(0, 0, 0, normal(rng), normal(rng), normal(rng)));
    const ImagePyramid frame = scene.render(T_host, 1, kNoise, 11);
    const DepthSearcher searcher(host, frame, believed, 1.0, 0.0, {});
    for (ImmaturePoint& point : points) searcher.search(point);
  }
  const DepthStatistics statistics = evaluateDepths(scene, points, 0.05);
  EXPECT_GT(statistics.good, static_cast<int>(points.size()) * 6 / 10);
  EXPECT_GT(statistics.contained, 0.95);
  EXPECT_GT(statistics.accurate, 0.9);
}

TEST(DepthSearch, UsesGainAndOffset) {
  const PlaneScene scene = slantedWall(3);
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  const ExposureTrajectory T_host = receding(2).back();
  const ImagePyramid frame = scene.render(T_host, 1, kNoise, 11);
  const ImagePyramid darker(cv::Mat1f(0.6 * frame.level(0).intensity + 20.0), kCamera, 1);
  std::vector<ImmaturePoint> told = choosePoints(host, 300);
  std::vector<ImmaturePoint> untold = told;
  for (ImmaturePoint& point : told) searchDepth(host, darker, T_host, 0.6, 20.0, {}, point);
  for (ImmaturePoint& point : untold) searchDepth(host, darker, T_host, 1.0, 0.0, {}, point);
  EXPECT_GT(evaluateDepths(scene, told, 0.1).good, 2 * evaluateDepths(scene, untold, 0.1).good);
  EXPECT_GT(evaluateDepths(scene, told, 0.1).accurate, 0.85);
}

TEST(DepthSearch, RejectsOccludedPoints) {
  // A panel at 1 m covers in the frame a part of the wall at 3 m that the host sees.
  const PlaneScene scene(kCamera,
                         {{{0.0, 0.0, 1.0 / 3.0}, WaveTexture(5)}, {{0.0, 0.0, 1.0}, WaveTexture(6), -0.3, 0.0}});
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  const ExposureTrajectory T_host = sharpAt(twist(-0.3, 0.0, 0.0, 0.0, 0.0, 0.0));
  const ImagePyramid frame = scene.render(T_host, 1, kNoise, 11);
  int hidden = 0;
  int accepted = 0;
  int seen = 0;
  int found = 0;
  for (ImmaturePoint point : choosePoints(host, 1500)) {
    const Eigen::Vector2d pixel = point.pixel.cast<double>();
    const PlaneScene::Hit hit = scene.cast(SE3(), pixel);
    const Eigen::Vector2d in_frame = kCamera.project(T_host.T_reference_mid.inverse() * hit.point);
    if (hit.depth < 2.0 || !kCamera.contains(in_frame, 10.0)) continue;
    const bool is_hidden = scene.cast(T_host.T_reference_mid, in_frame).depth < 2.0;
    const bool at_edge = std::abs(in_frame.x() - kCamera.project({0.3, 0.0, 1.0}).x()) < 4.0 ||
                         std::abs(in_frame.x() - kCamera.project({0.0, 0.0, 1.0}).x()) < 4.0;
    if (at_edge) continue;
    point.inverse_depth_min = 0.28;
    point.inverse_depth_max = 0.38;
    for (int i = 0; i < 2; ++i) searchDepth(host, frame, T_host, 1.0, 0.0, {}, point);
    const bool is_accepted = point.state != State::kOutlier;
    (is_hidden ? hidden : seen) += 1;
    (is_hidden ? accepted : found) += is_accepted;
  }
  ASSERT_GT(hidden, 60);
  ASSERT_GT(seen, 300);
  EXPECT_LT(accepted, hidden / 5);
  EXPECT_GT(found, seen * 95 / 100);
}

TEST(DepthSearch, OutliersAreNotSearchedAgainAndFailuresAreForgiven) {
  const PlaneScene scene = slantedWall(7);
  const PlaneScene other = slantedWall(8);
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  const ExposureTrajectory T_host = receding(2).back();
  const ImagePyramid right = scene.render(T_host, 1, kNoise, 11);
  const ImagePyramid wrong = other.render(T_host, 1, kNoise, 11);
  int forgiven = 0;
  int outliers = 0;
  for (const ImmaturePoint& point : choosePoints(host, 100)) {
    ImmaturePoint once = point;
    searchDepth(host, wrong, T_host, 1.0, 0.0, {}, once);
    if (once.failures != 1) continue;  // found some resemblance or out of view
    EXPECT_EQ(once.state, State::kBadCondition);
    EXPECT_FALSE(once.hasDepth());
    ImmaturePoint twice = once;
    searchDepth(host, right, T_host, 1.0, 0.0, {}, once);
    if (once.state == State::kGood) {
      ++forgiven;
      EXPECT_EQ(once.failures, 0);
    }
    searchDepth(host, wrong, T_host, 1.0, 0.0, {}, twice);
    ASSERT_EQ(twice.state, State::kOutlier);
    ++outliers;
    searchDepth(host, right, T_host, 1.0, 0.0, {}, twice);
    EXPECT_EQ(twice.state, State::kOutlier);
  }
  EXPECT_GT(outliers, 40);
  EXPECT_GT(forgiven, outliers * 3 / 4);
}

TEST(DepthSearch, ReportsOutOfBoundsAndRecovers) {
  const PlaneScene scene = slantedWall(9);
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  const ExposureTrajectory away = sharpAt(twist(0.05, 0.0, 0.0, 0.0, 0.6, 0.0));
  const ExposureTrajectory near = receding(2).back();
  const ImagePyramid away_frame = scene.render(away, 1, kNoise, 11);
  const ImagePyramid near_frame = scene.render(near, 1, kNoise, 12);
  int out = 0;
  int recovered = 0;
  for (ImmaturePoint point : choosePoints(host, 200)) {
    if (point.pixel.x() > 140) continue;
    searchDepth(host, away_frame, away, 1.0, 0.0, {}, point);
    EXPECT_EQ(point.state, State::kOutOfBounds);
    ++out;
    searchDepth(host, near_frame, near, 1.0, 0.0, {}, point);
    recovered += point.state == State::kGood;
  }
  EXPECT_GT(out, 50);
  EXPECT_GT(recovered, out / 2);
}

TEST(DepthSearch, SkipsShortIntervalsAndPureRotation) {
  const PlaneScene scene = slantedWall(12);
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  ImmaturePoint point = makeImmaturePoint(host, {160, 120}, {});
  point.inverse_depth_min = 0.49;
  point.inverse_depth_max = 0.51;
  const ExposureTrajectory shifted = sharpAt(twist(0.1, 0.0, 0.0, 0.0, 0.0, 0.0));
  searchDepth(host, host, shifted, 1.0, 0.0, {}, point);
  EXPECT_EQ(point.state, State::kSkipped);
  EXPECT_NEAR(point.last_search_length_px, 0.02 * 0.1 * kCamera.fx, 1e-6);
  EXPECT_EQ(point.inverse_depth_min, 0.49);
  EXPECT_EQ(point.inverse_depth_max, 0.51);

  ImmaturePoint unknown = makeImmaturePoint(host, {160, 120}, {});
  searchDepth(host, host, sharpAt(twist(0.0, 0.0, 0.0, 0.01, 0.02, 0.0)), 1.0, 0.0, {}, unknown);
  EXPECT_EQ(unknown.state, State::kBadCondition);
  EXPECT_FALSE(unknown.hasDepth());
}

TEST(DepthSearch, InvalidPixelsAreNoMatch) {
  const PlaneScene scene = slantedWall(13);
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  const ExposureTrajectory T_host = receding(2).back();
  const cv::Mat1f nothing(kCamera.height, kCamera.width, std::numeric_limits<float>::quiet_NaN());
  for (ImmaturePoint point : choosePoints(host, 100)) {
    searchDepth(host, ImagePyramid(nothing, kCamera, 1), T_host, 1.0, 0.0, {}, point);
    EXPECT_NE(point.state, State::kGood);
    EXPECT_FALSE(point.hasDepth());
  }
}

TEST(DepthSearch, RepetitiveTextureHasLowQuality) {
  // Waves of 10 px at 2 m along the epipolar line.
  const auto waves = [](double x, double y) {
    return 128.0 + 60.0 * std::sin(2.0 * M_PI * x / 0.09) + 20.0 * std::sin(2.0 * M_PI * y / 0.2);
  };
  const PlaneScene repetitive(kCamera, {{{0.0, 0.0, 0.5}, waves}});
  const PlaneScene distinct(kCamera, {{{0.0, 0.0, 0.5}, WaveTexture(14)}});
  const ExposureTrajectory T_host = sharpAt(twist(0.12, 0.0, 0.0, 0.0, 0.0, 0.0));
  std::vector<double> fraction_certain;
  for (const PlaneScene* scene : {&repetitive, &distinct}) {
    const ImagePyramid host = scene->render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
    const ImagePyramid frame = scene->render(T_host, 1, kNoise, 11);
    int searched = 0;
    int certain = 0;
    for (ImmaturePoint point : choosePoints(host, 300)) {
      searchDepth(host, frame, T_host, 1.0, 0.0, {}, point);
      if (point.state != State::kGood) continue;
      ++searched;
      certain += point.quality > 3.0;
    }
    ASSERT_GT(searched, 100);
    fraction_certain.push_back(static_cast<double>(certain) / searched);
  }
  EXPECT_LT(fraction_certain[0], 0.1);
  EXPECT_GT(fraction_certain[1], 0.7);
}

TEST(DepthSearch, FindsDepthInBlurredFrames) {
  // About 10 px of motion blur in every frame.
  const PlaneScene scene = slantedWall(15);
  const ImagePyramid host = scene.render(sharpAt(Vector6::Zero()), 1, kNoise, 10);
  DepthSearchConfig sharp_only;
  sharp_only.min_blur_px = 1000.0;
  std::vector<ImmaturePoint> with_blur = choosePoints(host, 600);
  std::vector<ImmaturePoint> without_blur = with_blur;
  for (const ExposureTrajectory& T_host : receding(4, 1.0)) {
    const ImagePyramid frame = scene.render(T_host, 24, kNoise, 11);
    for (ImmaturePoint& point : with_blur) searchDepth(host, frame, T_host, 1.0, 0.0, {}, point);
    for (ImmaturePoint& point : without_blur) searchDepth(host, frame, T_host, 1.0, 0.0, sharp_only, point);
  }
  const DepthStatistics blurred = evaluateDepths(scene, with_blur, 0.05);
  const DepthStatistics sharp = evaluateDepths(scene, without_blur, 0.05);
  EXPECT_GT(blurred.good, static_cast<int>(with_blur.size()) * 7 / 10);
  EXPECT_GT(blurred.accurate, 0.9);
  EXPECT_GT(blurred.contained, 0.95);
  EXPECT_LT(blurred.median_error, 0.01);
  EXPECT_GT(sharp.median_error, 3.0 * blurred.median_error);
  EXPECT_LT(sharp.good * sharp.accurate, 0.6 * blurred.good * blurred.accurate);
}

}  // namespace
}  // namespace mba_vo::depth_search_test
