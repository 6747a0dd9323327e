#include "mba_vo/image/stamp_smoother.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace mba_vo::stamp_smoother_test {
namespace {

constexpr double kMillisecond = 1e6;  // [ns]
constexpr std::int64_t kStart = 1305031453359684000;

std::int64_t after(double milliseconds) { return kStart + std::llround(kMillisecond * milliseconds); }

std::vector<std::int64_t> smoothed(const std::vector<std::int64_t>& stamps) {
  StampSmoother smoother;
  std::vector<std::int64_t> result;
  for (const std::int64_t stamp : stamps) result.push_back(smoother.smooth(stamp, 1));
  return result;
}

/// Root mean square of how far the time between images is from the period, from image `first` on [ms].
double roughness(const std::vector<std::int64_t>& stamps, double period, std::size_t first) {
  double squares = 0.0;
  for (std::size_t i = first; i < stamps.size(); ++i) {
    const double error = static_cast<double>(stamps[i] - stamps[i - 1]) / kMillisecond - period;
    squares += error * error;
  }
  return std::sqrt(squares / static_cast<double>(stamps.size() - first));
}

void expectIncreasing(const std::vector<std::int64_t>& stamps) {
  for (std::size_t i = 1; i < stamps.size(); ++i) EXPECT_GT(stamps[i], stamps[i - 1]) << i;
}

TEST(StampSmoother, RegularStampsStay) {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 200; ++i) stamps.push_back(after(33.333 * i));
  EXPECT_EQ(smoothed(stamps), stamps);
}

TEST(StampSmoother, StampsInCoarseUnitsStay) {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 200; ++i) stamps.push_back(after(4.0 * std::floor(33.3 * i / 4.0)));
  EXPECT_EQ(smoothed(stamps), stamps);
}

TEST(StampSmoother, AFewPerCentOfJitterStay) {
  std::mt19937 random(1);
  std::normal_distribution<double> jitter(0.0, 1.5);  // [ms] as where a programme takes the newest image by a timer
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 200; ++i) stamps.push_back(after(62.4 * i + jitter(random)));
  EXPECT_EQ(smoothed(stamps), stamps);
}

TEST(StampSmoother, DroppedFramesAreRealGaps) {
  std::mt19937 random(2);
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 300; ++i) {
    if (random() % 3 != 0) stamps.push_back(after(33.333 * i));
  }
  EXPECT_EQ(smoothed(stamps), stamps);
}

TEST(StampSmoother, ChangesOfTheRateStay) {
  std::vector<std::int64_t> stamps;
  double time = 0.0;
  for (const double period : {33.0, 50.0, 66.0, 40.0, 33.0}) {
    for (int i = 0; i < 20; ++i) stamps.push_back(after(time += period));
  }
  EXPECT_EQ(smoothed(stamps), stamps);
}

TEST(StampSmoother, ALateImageNowAndThenStays) {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 200; ++i) stamps.push_back(after(33.0 * i + (i % 20 == 7 ? 15.0 : 0.0)));
  EXPECT_EQ(smoothed(stamps), stamps);
}

TEST(StampSmoother, JitterIsTakenBackToTheRate) {
  for (const double sigma : {5.0, 10.0, 15.0}) {  // [ms]
    std::mt19937 random(3);
    std::normal_distribution<double> jitter(0.0, sigma);
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < 300; ++i) {
      const std::int64_t arrival = after(33.0 * i + 50.0 + std::abs(jitter(random)));
      stamps.push_back(stamps.empty() ? arrival : std::max(arrival, stamps.back() + 200000));  // in order
    }
    const std::vector<std::int64_t> result = smoothed(stamps);
    expectIncreasing(result);
    EXPECT_LT(roughness(result, 33.0, 60), 0.4 * roughness(stamps, 33.0, 60)) << sigma;
  }
}

TEST(StampSmoother, SoAreBursts) {
  std::vector<std::int64_t> stamps;  // by threes
  for (int i = 0; i < 300; ++i) stamps.push_back(after(100.0 * (i / 3) + 1.5 * (i % 3)));
  const std::vector<std::int64_t> result = smoothed(stamps);
  expectIncreasing(result);
  EXPECT_LT(roughness(result, 100.0 / 3.0, 60), 0.2 * roughness(stamps, 100.0 / 3.0, 60));
}

TEST(StampSmoother, AGapAmongJitterIsFollowed) {
  std::mt19937 random(4);
  std::normal_distribution<double> jitter(0.0, 10.0);
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 200; ++i) {
    stamps.push_back(after(33.0 * i + (i < 100 ? 0.0 : 500.0) + std::abs(jitter(random))));
  }
  std::sort(stamps.begin(), stamps.end());
  const std::vector<std::int64_t> result = smoothed(stamps);
  expectIncreasing(result);
  for (std::size_t i = 110; i < stamps.size(); ++i) {
    EXPECT_LT(std::abs(static_cast<double>(result[i] - stamps[i])), 40.0 * kMillisecond) << i;
  }
}

TEST(StampSmoother, NumbersTellWhatIsMissing) {
  std::mt19937 random(5);
  std::normal_distribution<double> jitter(0.0, 10.0);
  StampSmoother smoother;
  double worst = 0.0;  // [ms]
  int last = 0;
  std::int64_t last_ns = 0;
  for (int i = 0; i < 300; ++i) {
    if (i % 10 == 3 || i % 10 == 4) continue;
    const std::int64_t stamp = std::max(after(33.0 * i + std::abs(jitter(random))), last_ns + 200000);
    const std::int64_t better = smoother.smooth(stamp, static_cast<std::uint64_t>(i - last));
    if (i > 60) worst = std::max(worst, std::abs(static_cast<double>(better - after(33.0 * i + 8.0)) / kMillisecond));
    last = i;
    last_ns = stamp;
  }
  EXPECT_LT(worst, 8.0);
}

}  // namespace
}  // namespace mba_vo::stamp_smoother_test
