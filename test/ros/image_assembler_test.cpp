#include "mba_vo/ros/image_assembler.h"

#include <cmath>

#include <gtest/gtest.h>
#include <boost/make_shared.hpp>

#include "mba_vo/ros/conversions.h"

namespace mba_vo::image_assembler_test {
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

TEST(ImageAssembler, WithoutSendersOfExposuresAndDepthsImagesDoNotWait) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.addImage(image(0, 0), 5.0);
  const auto ready = assembler.takeReady(5.0);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_FALSE(ready[0].exposure.has_value());
  EXPECT_FALSE(ready[0].exposure_from_topic);
  EXPECT_FALSE(ready[0].depth);
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

TEST(ImageAssembler, ExposuresThatBelongToNoImageAreNoticed) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.addExposure(stampOf(0) + kInterval / 2, 0.015);
  assembler.addExposure(stampOf(1), 0.015);
  assembler.addImage(image(0, 0), 5.0);
  assembler.addImage(image(1, 1), 5.0);
  const auto ready = assembler.takeReady(5.0);
  ASSERT_EQ(ready.size(), 2U);
  EXPECT_TRUE(ready[0].exposure_unmatched);
  EXPECT_FALSE(ready[1].exposure_unmatched);
}

TEST(ImageAssembler, AnImageThatCouldNotBeDecodedKeepsItsPlaceAndItsReason) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.addImage(image(0, 0), 5.0, "not a picture");
  assembler.addImage(image(1, 1), 5.0);
  const auto ready = assembler.takeReady(5.0);
  ASSERT_EQ(ready.size(), 2U);
  EXPECT_EQ(ready[0].problem, "not a picture");
  EXPECT_EQ(ready[1].problem, "");
  EXPECT_EQ(ready[1].sequence, 1U);
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

sensor_msgs::ImageConstPtr depthOf(int index, std::int64_t offset_ns = 0) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->header.stamp = toRosTime(stampOf(index) + offset_ns);
  return message;
}

TEST(ImageAssembler, ImageWaitsForItsDepthWhereTheyCome) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.addDepth(depthOf(0), 5.0);
  assembler.addImage(image(0, 0), 5.0);
  EXPECT_EQ(assembler.takeReady(5.0).at(0).depth->header.stamp, toRosTime(stampOf(0)));
  assembler.addImage(image(1, 1), 5.04);
  EXPECT_TRUE(assembler.takeReady(5.05).empty());
  assembler.addDepth(depthOf(1, 3'000'000), 5.06);
  const auto ready = assembler.takeReady(5.06);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_EQ(ready[0].depth->header.stamp, toRosTime(stampOf(1) + 3'000'000));
}

TEST(ImageAssembler, TheWaitForDepthIsBoundedAndEndsWithTheDepths) {
  ImageAssembler assembler = calibratedAssembler();
  assembler.addDepth(depthOf(0), 5.0);
  assembler.addImage(image(1, 0), 5.04);
  EXPECT_TRUE(assembler.takeReady(5.08).empty());
  const auto ready = assembler.takeReady(5.1);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_FALSE(ready[0].depth);  // 40 ms away
  assembler.addImage(image(30, 1), 6.2);
  EXPECT_EQ(assembler.takeReady(6.2).size(), 1U);
}

TEST(ImageAssembler, TheNearestDepthWithinTheToleranceCounts) {
  ImageAssembler assembler = calibratedAssembler();
  for (const std::int64_t offset : {-15'000'000, -5'000'000, 9'000'000}) assembler.addDepth(depthOf(3, offset), 5.0);
  assembler.addImage(image(3, 0), 5.0);
  EXPECT_EQ(assembler.takeReady(5.0).at(0).depth->header.stamp, toRosTime(stampOf(3) - 5'000'000));
  for (int i = 0; i < 100; ++i) assembler.addDepth(depthOf(i), 5.0);  // a bag begins anew, its clock goes back
  assembler.addImage(image(99, 1), 5.0);
  EXPECT_TRUE(assembler.takeReady(5.0).at(0).depth);
}

TEST(DepthLookup, IsBoundedAndForgetsAnotherClock) {
  DepthLookup lookup(0.01);
  for (int i = 0; i < 100; ++i) lookup.add(depthOf(i));
  EXPECT_EQ(lookup.size(), DepthLookup::kMaxEntries);
  EXPECT_TRUE(lookup.find(stampOf(99)));
  EXPECT_FALSE(lookup.find(stampOf(10)));
  lookup.add(depthOf(2));
  EXPECT_TRUE(lookup.find(stampOf(2)));
  EXPECT_EQ(lookup.size(), 1U);
}

TEST(DepthLookup, ReadsMetresAndMillimetres) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->width = 2;
  message->height = 1;
  message->encoding = "16UC1";
  message->step = 4;
  message->data = {0xDC, 0x05, 0, 0};  // 1500, 0
  cv::Mat1f depth = depthFromMessage(message);
  EXPECT_FLOAT_EQ(depth(0, 0), 1.5F);
  EXPECT_TRUE(std::isnan(depth(0, 1)));
  message->encoding = "32FC1";
  message->step = 8;
  message->data = {0, 0, 0x20, 0x40, 0, 0, 0xC0, 0x7F};  // 2.5, NaN
  depth = depthFromMessage(message);
  EXPECT_EQ(depth(0, 0), 2.5F);
  EXPECT_TRUE(std::isnan(depth(0, 1)));
  message->encoding = "rgb8";
  EXPECT_THROW(depthFromMessage(message), std::invalid_argument);
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
  ImageAssembler assembler = calibratedAssembler();
  EXPECT_EQ(assembler.addImage(image(0, 41), 5.0), 0U);
  EXPECT_EQ(assembler.addImage(image(1, 42), 5.0), 0U);
  EXPECT_EQ(assembler.addImage(image(4, 45), 5.0), 2U);
  EXPECT_EQ(assembler.addImage(image(5, 0), 5.0), 0U);  // the sender was restarted
  const auto ready = assembler.takeReady(5.0);
  ASSERT_EQ(ready.size(), 4U);
  EXPECT_EQ(ready[0].sequence, 0U);
  EXPECT_EQ(ready[2].sequence, 4U);
  EXPECT_EQ(ready[3].sequence, 5U);
}

TEST(ImageAssembler, SendersThatDoNotNumberShowNoGaps) {
  ImageAssembler assembler = calibratedAssembler();
  EXPECT_EQ(assembler.addImage(image(0, 0), 5.0), 0U);
  EXPECT_EQ(assembler.addImage(image(1, 0), 5.0), 0U);
  const auto ready = assembler.takeReady(5.0);
  EXPECT_EQ(ready.at(1).sequence, ready.at(0).sequence + 1);
}

}  // namespace
}  // namespace mba_vo::image_assembler_test
