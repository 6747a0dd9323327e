#include "mba_vo/ros/image_assembler.h"

#include <cmath>

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

#include "mba_vo/ros/conversions.h"

namespace mba_vo {
namespace {

constexpr std::int64_t kFirstStamp = 1'000'000'000'000;
constexpr std::int64_t kInterval = 40'000'000;

std::int64_t stampOf(int index) { return kFirstStamp + index * kInterval; }

sensor_msgs::ImageConstPtr image(int index, unsigned sender_sequence) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->header.stamp = toRosTime(stampOf(index));
  message->header.seq = sender_sequence;
  return message;
}

ImageAssembler calibratedAssembler(const ImageAssemblerOptions& options = {}) {
  ImageAssembler assembler(options);
  assembler.setCalibrated();
  return assembler;
}

TEST(ImageAssembler, WithoutASenderOfExposuresImagesDoNotWait) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.addImage(image(0, 0), 5.0);
  const auto ready = assembler.takeReady(5.0);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_FALSE(ready[0].exposure.has_value());
  EXPECT_FALSE(ready[0].exposure_from_topic);
}

TEST(ImageAssembler, ImageWaitsForItsExposure) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.expectExposures(true);
  assembler.addImage(image(0, 0), 5.0);
  EXPECT_TRUE(assembler.takeReady(5.01).empty());
  assembler.addExposure(stampOf(0), 0.015);
  const auto ready = assembler.takeReady(5.02);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_DOUBLE_EQ(ready[0].exposure.value(), 0.015);
  EXPECT_TRUE(ready[0].exposure_from_topic);
}

TEST(ImageAssembler, ExposureMayComeFirst) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.addExposure(stampOf(0), 0.015);
  assembler.addImage(image(0, 0), 5.0);
  EXPECT_DOUBLE_EQ(assembler.takeReady(5.0).at(0).exposure.value(), 0.015);
}

TEST(ImageAssembler, TheWaitIsBounded) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.expectExposures(true);
  assembler.addImage(image(0, 0), 5.0);
  EXPECT_TRUE(assembler.takeReady(5.09).empty());
  EXPECT_EQ(assembler.takeReady(5.11).size(), 1U);
}

TEST(ImageAssembler, ExposureOfALaterImageEndsTheWait) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.expectExposures(true);
  assembler.addImage(image(0, 0), 5.0);
  assembler.addExposure(stampOf(1), 0.015);
  const auto ready = assembler.takeReady(5.0);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_FALSE(ready[0].exposure.has_value());
}

TEST(ImageAssembler, NanInTheMessageIsUnknown) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.addExposure(stampOf(0), std::nan(""));
  assembler.addImage(image(0, 0), 5.0);
  const auto ready = assembler.takeReady(5.0);
  EXPECT_FALSE(ready.at(0).exposure.has_value());
}

TEST(ImageAssembler, ParameterOverridesTheTopic) {
  ImageAssemblerOptions options;
  options.fixed_exposure = 0.004;
  ImageAssembler assembler = calibratedAssembler(options);
  assembler.addExposure(stampOf(0), 0.015);
  assembler.addImage(image(0, 0), 5.0);
  const auto ready = assembler.takeReady(5.0);
  EXPECT_DOUBLE_EQ(ready.at(0).exposure.value(), 0.004);
  EXPECT_FALSE(ready.at(0).exposure_from_topic);
}

TEST(ImageAssembler, FirstImagesWaitForTheCalibrationAndKeepTheirOrder) {
  ImageAssembler assembler({});
  assembler.addImage(image(0, 7), 5.0);
  assembler.addImage(image(1, 8), 5.04);
  EXPECT_TRUE(assembler.takeReady(5.1).empty());
  assembler.setCalibrated();
  const auto ready = assembler.takeReady(5.2);
  ASSERT_EQ(ready.size(), 2U);
  EXPECT_EQ(toNanoseconds(ready[0].message->header.stamp), stampOf(0));
  EXPECT_EQ(ready[1].sequence, 1U);
}

TEST(ImageAssembler, WithoutCalibrationImagesComeOutInTheEnd) {
  ImageAssembler assembler({});
  assembler.addImage(image(0, 0), 5.0);
  EXPECT_EQ(assembler.takeReady(6.1).size(), 1U);
}

TEST(ImageAssembler, GapsAreSeenBySequenceNumber) {
  ImageAssemblerOptions options;
  options.first_sequence = 100;
  ImageAssembler assembler = calibratedAssembler(options);
  EXPECT_EQ(assembler.addImage(image(0, 41), 5.0), 0U);
  EXPECT_EQ(assembler.addImage(image(1, 42), 5.0), 0U);
  EXPECT_EQ(assembler.addImage(image(4, 45), 5.0), 2U);
  EXPECT_EQ(assembler.addImage(image(5, 0), 5.0), 0U);  // the sender was restarted
  const auto ready = assembler.takeReady(5.0);
  ASSERT_EQ(ready.size(), 4U);
  EXPECT_EQ(ready[0].sequence, 100U);
  EXPECT_EQ(ready[2].sequence, 104U);
  EXPECT_EQ(ready[3].sequence, 105U);
}

TEST(ImageAssembler, SendersThatDoNotNumberShowNoGaps) {
  ImageAssembler assembler = calibratedAssembler();
  EXPECT_EQ(assembler.addImage(image(0, 0), 5.0), 0U);
  EXPECT_EQ(assembler.addImage(image(1, 0), 5.0), 0U);
  const auto ready = assembler.takeReady(5.0);
  EXPECT_EQ(ready.at(1).sequence, ready.at(0).sequence + 1);
}

}  // namespace
}  // namespace mba_vo
