#include "mba_vo/image/point_selector.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

namespace mba_vo::point_selector_test {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

ImagePyramid makePyramid(const std::function<double(int, int)>& intensity, double noise = 1.0) {
  cv::Mat1f image(kHeight, kWidth);
  std::mt19937 rng(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) image(y, x) = static_cast<float>(intensity(x, y) + noise * normal(rng));
  }
  return {image, {kWidth, kHeight, 400.0, 400.0, 319.5, 239.5}, 4};
}

/// Soft-edged blobs of about 20 px everywhere.
double texture(int x, int y) {
  return 128.0 + 90.0 * std::tanh(3.0 * std::sin(0.31 * x + 0.05 * y) * std::cos(0.27 * y));
}

/// Points in every cell of an 8x6 grid.
std::vector<int> occupancy(const std::vector<Eigen::Vector2i>& points) {
  std::vector<int> cells(48, 0);
  for (const Eigen::Vector2i& p : points) ++cells[static_cast<std::size_t>(p.y() / 80 * 8 + p.x() / 80)];
  return cells;
}

double gradientAt(const cv::Mat1f& image, const Eigen::Vector2i& p) {
  return 0.5 * std::hypot(image(p.y(), p.x() + 1) - image(p.y(), p.x() - 1),
                          image(p.y() + 1, p.x()) - image(p.y() - 1, p.x()));
}

TEST(PointSelector, DeliversTheNumberAskedFor) {
  const ImagePyramid pyramid = makePyramid(texture);
  for (const int count : {200, 600, 1500, 3000}) {
    const double found = static_cast<double>(selectPoints(pyramid, count, {}).size());
    EXPECT_NEAR(found / count, 1.0, 0.15) << count;
  }
}

TEST(PointSelector, NoiseIsNotTakenForTexture) {
  const auto edge = [](int x, int) { return x < 320 ? 60.0 : 180.0; };
  const std::vector<Eigen::Vector2i> points = selectPoints(makePyramid(edge, 8.0), 300, {});
  ASSERT_FALSE(points.empty());
  for (const Eigen::Vector2i& p : points) EXPECT_NEAR(p.x(), 319.5, 6.0);
}

TEST(PointSelector, SpreadsEvenly) {
  const std::vector<Eigen::Vector2i> points = selectPoints(makePyramid(texture), 1500, {});
  for (const int n : occupancy(points)) {
    EXPECT_GT(n, 1500 / 48 / 2);
    EXPECT_LT(n, 1500 / 48 * 2);
  }
}

TEST(PointSelector, PointsAreDistinctAndInsideTheBorder) {
  PointSelectorConfig config;
  config.border = 20;
  const std::vector<Eigen::Vector2i> points = selectPoints(makePyramid(texture), 1500, config);
  std::set<std::pair<int, int>> seen;
  for (const Eigen::Vector2i& p : points) {
    EXPECT_TRUE(seen.insert({p.x(), p.y()}).second);
    EXPECT_GE(std::min({p.x(), p.y(), kWidth - 1 - p.x(), kHeight - 1 - p.y()}), 20);
  }
}

TEST(PointSelector, PlainImageGivesNone) {
  EXPECT_TRUE(selectPoints(makePyramid([](int, int) { return 100.0; }), 1500, {}).empty());
  EXPECT_TRUE(selectPoints(makePyramid([](int x, int y) { return 0.2 * x + 0.1 * y; }), 1500, {}).empty());
}

TEST(PointSelector, TexturedHalfOnly) {
  const std::vector<Eigen::Vector2i> points =
      selectPoints(makePyramid([](int x, int y) { return x < kWidth / 2 ? texture(x, y) : 128.0; }), 1000, {});
  EXPECT_GT(points.size(), 850U);
  for (const Eigen::Vector2i& p : points) EXPECT_LE(p.x(), kWidth / 2 + 1);
}

TEST(PointSelector, ThresholdAdaptsToContrast) {
  // Weak stripes (gradient up to 12) on the left; on the right the same stripes on a busy background of gradient 30.
  const auto stripes = [](int x) { return 48.0 * std::sin(0.25 * x); };
  const auto busy = [](int x, int y) {
    return 40.0 * std::sin(0.9 * x + 0.6 * y) + 40.0 * std::sin(0.9 * y - 0.6 * x);
  };
  const auto scene = [&](int x, int y) { return 128.0 + (x < kWidth / 2 ? stripes(x) * (y % 96 < 32) : busy(x, y)); };
  const ImagePyramid pyramid = makePyramid(scene);
  const std::vector<Eigen::Vector2i> points = selectPoints(pyramid, 1200, {});
  int left = 0;
  int right = 0;
  double weakest_left = 1e9;
  double weakest_right = 1e9;
  for (const Eigen::Vector2i& p : points) {
    const double gradient = gradientAt(pyramid.level(0).intensity, p);
    if (p.x() < kWidth / 2 - 64) {
      ++left;
      weakest_left = std::min(weakest_left, gradient);
    } else if (p.x() > kWidth / 2 + 64) {
      ++right;
      weakest_right = std::min(weakest_right, gradient);
    }
  }
  EXPECT_GT(left, 100);
  EXPECT_GT(right, 300);
  EXPECT_LT(weakest_left, 13.0);
  EXPECT_GT(weakest_right, 20.0);
}

TEST(PointSelector, SmoothShadingIsFoundOnCoarserLevels) {
  // Waves of 60 px: 4.2 grey levels per px on level 0, not enough; 8.4 on level 1 and 16.8 on level 2.
  const ImagePyramid pyramid = makePyramid(
      [](int x, int y) { return 128.0 + 40.0 * std::sin(0.105 * x) * (std::abs(y - 240) < 60 ? 1.0 : 0.0); });
  PointSelectorConfig finest_only;
  finest_only.coarse_margin_factor = 100.0;
  EXPECT_GT(selectPoints(pyramid, 400, {}).size(), selectPoints(pyramid, 400, finest_only).size());
}

TEST(PointSelector, BareCeilingCountsBesideItsEdge) {
  const auto ceiling = [](int x, int y) {
    return y < 360 ? 80.0 + 5.0 * std::sin(0.13 * x) * std::sin(0.17 * y) : 180.0;
  };
  const auto awayFromEdge = [&](bool faint_texture) {
    PointSelectorConfig config;
    config.faint_texture = faint_texture;
    const std::vector<Eigen::Vector2i> points = selectPoints(makePyramid(ceiling), 1000, config);
    return std::count_if(points.begin(), points.end(), [](const auto& p) { return p.y() < 340; });
  };
  EXPECT_GT(awayFromEdge(true), 500);
  EXPECT_EQ(awayFromEdge(false), 0);
}

TEST(PointSelector, NoiseIsNoFaintTexture) {
  PointSelectorConfig config;
  config.faint_texture = true;
  for (const double noise : {0.3, 1.0, 4.0}) {
    EXPECT_LT(selectPoints(makePyramid([](int, int) { return 100.0; }, noise), 1500, config).size(), 5U) << noise;
  }
}

TEST(PointSelector, AvoidsInvalidPixels) {
  cv::Mat1f image = makePyramid(texture).level(0).intensity.clone();
  image(cv::Rect(200, 100, 150, 90)).setTo(std::numeric_limits<float>::quiet_NaN());
  image(400, 500) = std::numeric_limits<float>::quiet_NaN();
  const ImagePyramid pyramid(image, {kWidth, kHeight, 400.0, 400.0, 319.5, 239.5}, 4);
  const std::vector<Eigen::Vector2i> points = selectPoints(pyramid, 3000, {});
  EXPECT_GT(points.size(), 2500U);
  for (const Eigen::Vector2i& p : points) {
    for (int dy = -8; dy <= 8; ++dy) {
      for (int dx = -8; dx <= 8; ++dx) ASSERT_FALSE(std::isnan(image(p.y() + dy, p.x() + dx))) << p.transpose();
    }
  }
}

TEST(PointSelector, RepresentsEdgesOfAllDirections) {
  // Small patches, by turns of strong vertical and weaker horizontal edges, several in every cell: by magnitude alone
  // only the vertical ones would count.
  const ImagePyramid pyramid = makePyramid([](int x, int y) {
    if (x % 16 > 9 || y % 16 > 9) return 128.0;
    const double window = std::sin(M_PI * (x % 16) / 9.0) * std::sin(M_PI * (y % 16) / 9.0);
    const bool vertical = (x / 16 + y / 16) % 2 == 0;
    return 128.0 + window * (vertical ? 60.0 * std::sin(0.9 * (x % 16 - 4.5)) : 50.0 * std::sin(0.9 * (y % 16 - 4.5)));
  });
  int mainly_horizontal = 0;
  const std::vector<Eigen::Vector2i> points = selectPoints(pyramid, 200, {});
  const cv::Mat1f& image = pyramid.level(0).intensity;
  for (const Eigen::Vector2i& p : points) {
    const float gx = image(p.y(), p.x() + 1) - image(p.y(), p.x() - 1);
    const float gy = image(p.y() + 1, p.x()) - image(p.y() - 1, p.x());
    if (std::abs(gx) > 2.0F * std::abs(gy) || std::abs(gy) > 2.0F * std::abs(gx)) {
      mainly_horizontal += std::abs(gy) > std::abs(gx);
    }
  }
  EXPECT_GT(mainly_horizontal, static_cast<int>(points.size()) / 8);
}

TEST(PointSelector, SameInputSamePoints) {
  const ImagePyramid pyramid = makePyramid(texture);
  EXPECT_EQ(selectPoints(pyramid, 1500, {}), selectPoints(pyramid, 1500, {}));
}

TEST(PointSelector, RejectsBadArguments) {
  EXPECT_THROW(selectPoints(ImagePyramid(), 100, {}), std::invalid_argument);
  EXPECT_THROW(selectPoints(makePyramid(texture), -1, {}), std::invalid_argument);
  PointSelectorConfig config;
  config.border = -1;
  EXPECT_THROW(selectPoints(makePyramid(texture), 100, config), std::invalid_argument);
  EXPECT_TRUE(selectPoints(makePyramid(texture), 0, {}).empty());
}

}  // namespace
}  // namespace mba_vo::point_selector_test
