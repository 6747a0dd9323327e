#include "mba_vo/ros/compressed_image.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "mba_vo/ros/image_conversion.h"

namespace mba_vo::compressed_image_test {
namespace {

sensor_msgs::CompressedImage compressed(const std::string& format, const std::string& suffix, const cv::Mat& image) {
  sensor_msgs::CompressedImage message;
  message.header.frame_id = "camera";
  message.header.stamp = ros::Time(12, 34);
  message.format = format;
  cv::imencode(suffix, image, message.data);
  return message;
}

cv::Mat noise(int type) {
  cv::Mat image(12, 16, type);
  cv::randu(image, 0, image.depth() == CV_16U ? 65535 : 255);
  return image;
}

cv::Mat decoded(const sensor_msgs::CompressedImage& message) { return toCvImage(decodeImage(message))->image.clone(); }

std::string errorOf(const sensor_msgs::CompressedImage& message) {
  try {
    decodeImage(message);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(CompressedImage, KeepsTheHeader) {
  const auto image = decodeImage(compressed("png", ".png", noise(CV_8UC1)));
  EXPECT_EQ(image->header.frame_id, "camera");
  EXPECT_EQ(image->header.stamp, ros::Time(12, 34));
  EXPECT_EQ(image->width, 16U);
  EXPECT_EQ(image->height, 12U);
}

TEST(CompressedImage, JpegIsWhatOpenCvDecodes) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const auto message = compressed("mono8; jpeg compressed bgr8", ".jpg", noise(type));
    const cv::Mat expected = cv::imdecode(message.data, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(expected.type(), type);
    ASSERT_EQ(decoded(message).type(), type);
    EXPECT_EQ(cv::norm(decoded(message), expected, cv::NORM_INF), 0.0);
  }
}

TEST(CompressedImage, PngIsWhatWasSent) {
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3, CV_8UC4, CV_16UC3}) {
    const cv::Mat image = noise(type);
    const cv::Mat back = decoded(compressed("png", ".png", image));
    ASSERT_EQ(back.type(), type);
    EXPECT_EQ(cv::norm(back, image, cv::NORM_INF), 0.0);
  }
}

TEST(CompressedImage, MosaicsAndColoursInTheirOwnOrderAreReadAsTheyWere) {
  EXPECT_EQ(decodeImage(compressed("bayer_rggb8; png compressed ", ".png", noise(CV_8UC1)))->encoding, "bayer_rggb8");
  EXPECT_EQ(decodeImage(compressed("bayer_grbg16; png compressed ", ".png", noise(CV_16UC1)))->encoding,
            "bayer_grbg16");
  EXPECT_EQ(decodeImage(compressed("rgb8; jpeg compressed bgr8", ".jpg", noise(CV_8UC3)))->encoding, "bgr8");
  EXPECT_EQ(decodeImage(compressed("rgb8; png compressed ", ".png", noise(CV_8UC3)))->encoding, "rgb8");
  EXPECT_EQ(decodeImage(compressed("rgb8; jpeg compressed ", ".jpg", noise(CV_8UC1)))->encoding, "mono8");
}

TEST(CompressedImage, WhatIsNoPictureIsNamed) {
  sensor_msgs::CompressedImage message;
  message.format = "32FC1; compressedDepth png";
  EXPECT_NE(errorOf(message).find("32FC1; compressedDepth png"), std::string::npos);
  message.data = {1, 2, 3, 4};
  EXPECT_NE(errorOf(message).find("4 bytes"), std::string::npos);
  message = compressed("jpeg", ".jpg", noise(CV_8UC1));
  message.data.resize(20);  // the head alone
  EXPECT_NE(errorOf(message).find("jpeg, png"), std::string::npos);
}

}  // namespace
}  // namespace mba_vo::compressed_image_test
