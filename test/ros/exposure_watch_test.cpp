#include "mba_vo/ros/exposure_watch.h"

#include <gtest/gtest.h>

namespace mba_vo::exposure_watch_test {
namespace {

constexpr std::int64_t kInterval = 40'000'000;  // [ns]

/// What is said after some images with this exposure [s].
std::string adviceOn(std::optional<double> exposure, bool unmatched = false,
                     int images = static_cast<int>(ExposureWatch::kImages)) {
  ExposureWatch watch("/exposure");
  for (int i = 1; i <= images; ++i) watch.add(i * kInterval, exposure, unmatched);
  return watch.advice();
}

TEST(ExposureWatch, SaysNothingOfExposuresThatCanBe) {
  for (const double exposure : {0.0, 100e-6, 0.01, 0.04}) EXPECT_EQ(adviceOn(exposure), "") << exposure;
  EXPECT_EQ(adviceOn(std::nullopt), "");
}

TEST(ExposureWatch, OtherUnitsAreNamed) {
  EXPECT_NE(adviceOn(12.0).find("milliseconds, it is 0.012 s (unit 1e-3)"), std::string::npos) << adviceOn(12.0);
  EXPECT_NE(adviceOn(12e3).find("microseconds, it is 0.012 s (unit 1e-6)"), std::string::npos) << adviceOn(12e3);
  EXPECT_NE(adviceOn(12e6).find("nanoseconds, it is 0.012 s (unit 1e-9)"), std::string::npos) << adviceOn(12e6);
  EXPECT_NE(adviceOn(12e-6).find("1000 times as long would be 0.012 s"), std::string::npos) << adviceOn(12e-6);
  EXPECT_NE(adviceOn(0.1).find("/exposure is 0.1 s, but images are 0.04 s apart"), std::string::npos);
}

TEST(ExposureWatch, AFewImagesAreNoReason) {
  EXPECT_EQ(adviceOn(12.0, false, 5), "");
  ExposureWatch watch("/exposure");
  for (int i = 1; i <= 10; ++i) watch.add(i * kInterval, i % 4 == 0 ? 12.0 : 0.012, false);
  EXPECT_EQ(watch.advice(), "");
}

TEST(ExposureWatch, ExposuresThatBelongToNoImageAreNoticed) {
  EXPECT_NE(adviceOn(std::nullopt, true).find("none has the stamp of an image"), std::string::npos);
}

TEST(ExposureWatch, AnotherRecordingBeginsAnew) {
  ExposureWatch watch("/exposure");
  for (int i = 1; i <= 10; ++i) watch.add(i * kInterval, 12.0, false);
  watch.add(kInterval, 0.012, false);
  EXPECT_EQ(watch.advice(), "");
}

}  // namespace
}  // namespace mba_vo::exposure_watch_test
