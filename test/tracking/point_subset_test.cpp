#include "mba_vo/tracking/point_subset.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "support/random.h"
#include "support/rendered_room.h"

namespace mba_vo::point_subset_test {
namespace {

/// Many points on the left half of a rendered view, few on the right.
ReferenceConstPtr unevenReference() {
  const SimulatedFrame view = test::roomView(40);
  auto reference = test::makeReference(view, test::toFloat(view.sharp), 10);
  reference->points.clear();
  test::Random random(1);
  for (int i = 0; i < 6000; ++i) {
    const bool left = i % 20 != 0;
    const Eigen::Vector2d pixel(random.uniform(left ? 8.0 : 188.0, left ? 188.0 : 368.0), random.uniform(8.0, 232.0));
    reference->points.push_back({pixel.cast<float>(), 0.5F, 1e-4F});
  }
  return reference;
}

TEST(PointSubset, IsSpreadEvenlyWhereThePointsAreNot) {
  const ReferenceConstPtr reference = unevenReference();
  constexpr int kMax = 200;
  const std::vector<int> subset = selectEvenSubset(*reference, 0, 9, kMax);
  EXPECT_GT(subset.size(), kMax * 3U / 4U);
  EXPECT_LT(subset.size(), kMax * 5U / 4U);
  EXPECT_EQ(std::set<int>(subset.begin(), subset.end()).size(), subset.size());
  int left = 0;
  for (const int i : subset) left += reference->points.at(static_cast<std::size_t>(i)).pixel.x() < 188.0F ? 1 : 0;
  const double share = static_cast<double>(left) / static_cast<double>(subset.size());
  EXPECT_NEAR(share, 0.5, 0.1);  // of the points themselves, 95 % are on the left
}

TEST(PointSubset, TakesFewerPointsOnCoarseLevelsWherePatchesOverlap) {
  const ReferenceConstPtr reference = unevenReference();
  std::size_t last = 1000;
  for (int level = 0; level < reference->pyramid->levels(); ++level) {
    const std::size_t count = selectEvenSubset(*reference, level, 9, 440).size();
    EXPECT_LE(count, last);
    // Patches of 9x9 pixels of that level may cover each pixel about twice.
    const double pixels = 376.0 * 240.0 / std::pow(4.0, level);
    EXPECT_LT(static_cast<double>(count) * 81.0, 3.5 * pixels) << "level " << level;
    EXPECT_GT(count, 0U);
    last = count;
  }
}

TEST(PointSubset, PrefersStrongGradientsOfTheLevelInUse) {
  const ReferenceConstPtr reference = unevenReference();
  for (const int level : {0, 1, 2}) {
    const cv::Mat1f& image = reference->pyramid->level(level).intensity;
    const auto gradient = [&](int i) {
      const Eigen::Vector2f pixel = reference->points.at(static_cast<std::size_t>(i)).pixel;
      const float scale = 1.0F / static_cast<float>(1 << level);
      const int x = static_cast<int>(std::lround((pixel.x() + 0.5F) * scale - 0.5F));
      const int y = static_cast<int>(std::lround((pixel.y() + 0.5F) * scale - 0.5F));
      return std::hypot(static_cast<double>(image(y, x + 1) - image(y, x - 1)),
                        static_cast<double>(image(y + 1, x) - image(y - 1, x)));
    };
    double chosen = 0.0;
    const std::vector<int> subset = selectEvenSubset(*reference, level, 9, 200);
    for (const int i : subset) chosen += gradient(i) / static_cast<double>(subset.size());
    double all = 0.0;
    for (int i = 0; i < 6000; ++i) all += gradient(i) / 6000.0;
    EXPECT_GT(chosen, 1.5 * all) << "level " << level;
  }
}

TEST(PointSubset, IsDenserWhereOnlyAPartOfTheImageHasPoints) {
  auto reference = std::make_shared<Reference>(*unevenReference());
  auto& points = reference->points;
  const auto away = [](const ReferencePoint& p) { return p.pixel.x() > 90.0F; };
  points.erase(std::remove_if(points.begin(), points.end(), away), points.end());
  constexpr int kMax = 200;
  const std::size_t count = selectEvenSubset(*reference, 0, 9, kMax).size();
  EXPECT_GT(count, kMax / 2U);  // a quarter of the image
  EXPECT_LE(count, static_cast<std::size_t>(kMax));
}

TEST(PointSubset, OfNothingIsNothing) {
  auto reference = std::make_shared<Reference>(*unevenReference());
  reference->points.clear();
  EXPECT_TRUE(selectEvenSubset(*reference, 0, 9, 440).empty());
}

}  // namespace
}  // namespace mba_vo::point_subset_test
