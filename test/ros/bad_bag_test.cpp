#include <fstream>
#include <sstream>

#include <rosbag/view.h>
#include <sensor_msgs/Image.h>

#include "bag_fixture.h"
#include "mba_vo/ros/bag_image_writer.h"

namespace mba_vo::bad_bag_test {
namespace {

TEST_F(BagTest, AnImageThatCannotBeReadIsReportedAndTheNextOneFollows) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kMiddle);
  writer.write(kStart, std::nullopt, cv::Mat1f(20, 32, 1.0F));
  writer.write(kStart + kInterval, std::nullopt, testImage(0));
  writer.close();
  const auto reader = openBag(file_, {});
  const auto broken = reader->next();
  EXPECT_TRUE(broken->image.empty());
  EXPECT_NE(broken->problem.find("32FC1"), std::string::npos) << broken->problem;
  EXPECT_EQ(broken->stamp_ns, kStart);
  EXPECT_EQ(reader->next()->sequence, 1U);
}

TEST_F(BagTest, SeveralImageTopicsAskForAName) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kMiddle);
  writer.write(kStart, std::nullopt, testImage(0));
  writer.writeImage("/right/image_raw", testImage(1));
  writer.close();
  const std::string error = errorOf({});
  EXPECT_NE(error.find("/camera/image_raw, /right/image_raw"), std::string::npos) << error;
  BagTopics topics;
  topics.image = "/right/image_raw";
  EXPECT_EQ(cv::norm(openBag(file_, topics)->next()->image, testImage(1), cv::NORM_INF), 0.0);
  topics.image = "/left/image_raw";
  EXPECT_NE(errorOf(topics).find("/left/image_raw"), std::string::npos) << errorOf(topics);
}

TEST_F(BagTest, UncalibratedCameraIsNamed) {
  CameraCalibration calibration = testCalibration();
  calibration.fx = 0.0;
  BagImageWriter writer(file_, calibration, StampReference::kMiddle);
  writer.write(kStart, std::nullopt, testImage(0));
  writer.close();
  const std::string error = errorOf({});
  EXPECT_NE(error.find("/camera/camera_info"), std::string::npos) << error;
  EXPECT_NE(error.find("K[0]"), std::string::npos) << error;
}

/// As the bags of EuRoC are.
TEST_F(BagTest, ABagWithoutCameraInfoIsReadWithACalibrationOfItsOwn) {
  rosbag::Bag bag(file_, rosbag::bagmode::Write);
  sensor_msgs::Image image;
  image.header.stamp = ros::Time(1600000000, 5);
  image.width = image.step = 32;
  image.height = 20;
  image.encoding = "mono8";
  image.data.assign(32 * 20, 77);
  bag.write("/cam0/image_raw", image.header.stamp, image);
  bag.close();
  EXPECT_NE(errorOf({}).find("--calibration"), std::string::npos) << errorOf({});
  BagTopics topics;
  topics.calibration = testCalibration();
  const auto reader = openBag(file_, topics);
  EXPECT_EQ(reader->calibration().fx, 30.5);
  EXPECT_EQ(reader->next()->image.at<unsigned char>(3, 3), 77);
}

TEST_F(BagTest, MissingAndBrokenFilesAreNamed) {
  EXPECT_NE(errorOf({}).find(file_), std::string::npos);
  std::ofstream(file_) << "this is no bag";
  EXPECT_NE(errorOf({}).find(file_), std::string::npos);
  EXPECT_THROW(makeBagSink("/nonexistent/folder/x.bag", testCalibration()), std::runtime_error);
}

TEST_F(BagTest, BagsThatAreCutOffAskForReindexing) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kMiddle);
  for (int i = 0; i < 5; ++i) writer.write(kStart + i * kInterval, std::nullopt, testImage(i));
  writer.close();
  const auto whole = std::filesystem::file_size(file_);
  for (const std::uintmax_t cut : {std::uintmax_t{10}, whole / 3, whole - 5000}) {
    std::filesystem::resize_file(file_, whole - cut);
    EXPECT_NE(errorOf({}).find("'rosbag reindex " + file_ + "' saves what is in it"), std::string::npos) << errorOf({});
  }
  std::filesystem::resize_file(file_, 0);
  EXPECT_EQ(errorOf({}).find("reindex"), std::string::npos) << errorOf({});
}

TEST_F(BagTest, BagsOfARecorderThatWasKilledAskForReindexing) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kMiddle);
  writer.write(kStart, std::nullopt, testImage(0));
  writer.close();
  std::stringstream bytes;
  bytes << std::ifstream(file_).rdbuf();
  std::string unindexed = bytes.str();  // where the index is, is written when the recording ends
  const std::size_t position = unindexed.find("index_pos=") + std::string("index_pos=").size();
  unindexed.replace(position, sizeof(std::uint64_t), sizeof(std::uint64_t), '\0');
  std::ofstream(file_) << unindexed;
  EXPECT_NE(errorOf({}).find("rosbag reindex"), std::string::npos) << errorOf({});
}

TEST_F(BagTest, AFullDiskIsNamed) {
  std::string message;
  try {
    BagImageWriter writer("/dev/full", testCalibration(), StampReference::kMiddle);
    for (int i = 0; i < 5; ++i) writer.write(kStart + i * kInterval, std::nullopt, testImage(i));
    writer.close();
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  EXPECT_EQ(message.find("bag '/dev/full' cannot be written: "), 0U) << message;
  EXPECT_NE(message.find("No space left on device"), std::string::npos) << message;
}

TEST_F(BagTest, TimesThatABagCannotHoldAreRefused) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kMiddle);
  EXPECT_THROW(writer.write(0, std::nullopt, testImage(0)), std::runtime_error);
  EXPECT_THROW(writer.write(std::int64_t{1} << 62, std::nullopt, testImage(0)), std::runtime_error);
}

}  // namespace
}  // namespace mba_vo::bad_bag_test
