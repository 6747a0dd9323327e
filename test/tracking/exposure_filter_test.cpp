#include "mba_vo/tracking/exposure_filter.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::exposure_filter_test {
namespace {

constexpr double kInterval = 1.0 / 15.0;  // [s] between samples
constexpr double kSigma = 0.1;            // of their logarithm
constexpr double kGuessSigma = 0.8;

struct Errors {
  double rms = 0.0;
  double nees = 0.0;  // mean of squared error over variance
  bool varies = false;
};

/// Follows `truth`, log exposure by time, with samples whose every tenth is far off; judged from the second second on.
Errors follow(const std::function<double(double)>& truth, unsigned seed) {
  test::Random random(seed);
  ExposureFilter filter(0.0, kGuessSigma);
  Errors errors;
  int count = 0;
  for (int i = 0; i < 300; ++i) {
    const double t = kInterval * i;
    const double noise = 0.5 * kSigma * std::sqrt(12.0) * random.uniform(-1.0, 1.0);
    filter.add(t, truth(t) + noise + (i % 10 == 9 ? 0.8 : 0.0), kSigma);
    if (t < 1.0) continue;
    const ExposureFilter::Estimate next = filter.at(t + kInterval);
    const double error = next.log_exposure - truth(t + kInterval);
    errors.rms += error * error;
    errors.nees += error * error / (next.sigma * next.sigma);
    ++count;
  }
  errors.rms = std::sqrt(errors.rms / count);
  errors.nees /= count;
  errors.varies = filter.varies();
  return errors;
}

TEST(ExposureFilter, SettlesOnASteadyExposure) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Errors errors = follow([](double) { return -0.7; }, seed);
    EXPECT_LT(errors.rms, 0.07) << "seed " << seed;
    EXPECT_FALSE(errors.varies);
  }
}

// Four times as long and back again within five seconds.
TEST(ExposureFilter, FollowsAnExposureThatVaries) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Errors errors = follow([](double t) { return 0.69 * std::sin(2.0 * 3.14159 * t / 5.0); }, seed);
    EXPECT_LT(errors.rms, 0.15) << "seed " << seed;
    EXPECT_LT(errors.nees, 3.0) << "seed " << seed;
    EXPECT_TRUE(errors.varies);
  }
}

TEST(ExposureFilter, KnowsLessTheLongerNothingComes) {
  ExposureFilter filter(0.0, kGuessSigma);
  for (int i = 0; i < 50; ++i) filter.add(0.1 * i, std::sin(0.3 * i), 0.05);
  const ExposureFilter::Estimate soon = filter.at(5.0);
  const ExposureFilter::Estimate late = filter.at(8.0);
  const ExposureFilter::Estimate later = filter.at(20.0);
  EXPECT_GT(late.sigma, 3.0 * soon.sigma);
  EXPECT_GT(later.sigma, late.sigma);
  EXPECT_EQ(late.log_exposure, later.log_exposure) << "the rate is not believed for long";
}

TEST(ExposureFilter, SaysTheGuessBeforeTheFirstSample) {
  const ExposureFilter filter(0.3, kGuessSigma);
  EXPECT_EQ(filter.samples(), 0);
  EXPECT_EQ(filter.at(100.0).log_exposure, 0.3);
  EXPECT_EQ(filter.at(100.0).sigma, kGuessSigma);
}

TEST(ExposureFilter, KnowsThePastBetterLater) {
  const auto truth = [](double t) { return 0.69 * std::sin(2.0 * 3.14159 * t / 5.0); };
  for (unsigned seed = 1; seed <= 5; ++seed) {
    test::Random random(seed);
    ExposureFilter filter(0.0, kGuessSigma);
    double then = 0.0;
    for (int i = 0; i < 60; ++i) {
      const double t = kInterval * i;
      filter.add(t, truth(t) + random.normal(kSigma), kSigma);
      then += std::pow(filter.at(t).log_exposure - truth(t), 2.0);
    }
    double later = 0.0;
    const std::vector<ExposureHistory::Entry> smoothed = filter.smoothed();
    ASSERT_EQ(smoothed.size(), 60U);
    for (const ExposureHistory::Entry& entry : smoothed) later += std::pow(entry.log_exposure - truth(entry.time), 2.0);
    EXPECT_LT(later, 0.5 * then) << "seed " << seed;
  }
}

}  // namespace
}  // namespace mba_vo::exposure_filter_test
