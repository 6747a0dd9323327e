#include <filesystem>
#include <fstream>
#include <sstream>

#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <opencv2/imgcodecs.hpp>

#include "mba_vo/ros/bag_image_writer.h"
#include "mba_vo/ros/bag_reader.h"
#include "mba_vo/ros/bag_sink.h"

namespace mba_vo {
namespace {

constexpr std::int64_t kStart = 1'600'000'000'123'456'789;
constexpr std::int64_t kInterval = 40'000'000;

CameraCalibration testCalibration() {
  CameraCalibration calibration;
  calibration.width = 32;
  calibration.height = 20;
  calibration.fx = 30.5;
  calibration.fy = 31.5;
  calibration.cx = 15.25;
  calibration.cy = 9.75;
  calibration.distortion = {0.1, -0.2, 0.001, 0.002, 0.03};
  return calibration;
}

cv::Mat1b testImage(int index) {
  cv::Mat1b image(20, 32);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image(y, x) = static_cast<unsigned char>((7 * x + 13 * y + 31 * index) % 256);
    }
  }
  return image;
}

class BagTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    file_ = (std::filesystem::temp_directory_path() / ("mba_vo_bag_test_" + name + ".bag")).string();
  }
  void TearDown() override { std::filesystem::remove(file_); }

  std::string errorOf(const BagTopics& topics) const {
    try {
      openBag(file_, topics);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  std::string file_;
};

SimulatedFrame testFrame(int index) {
  SimulatedFrame frame;
  frame.id = static_cast<std::uint64_t>(index);
  frame.mid_exposure_ns = kStart + index * kInterval;
  frame.exposure = 0.02;
  frame.blurred = testImage(index);
  frame.T_world_mid = SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(index, 2.0, 3.0));
  return frame;
}

TEST_F(BagTest, SimulatedSequenceReadsBackUnchanged) {
  const auto sink = makeBagSink(file_, testCalibration());
  for (int i = 0; i < 5; ++i) {
    sink->write(testFrame(i));
  }
  sink->finish();

  const auto reader = openBag(file_, {});
  EXPECT_EQ(reader->size(), 5U);
  const CameraCalibration calibration = reader->calibration();
  EXPECT_EQ(calibration.width, 32);
  EXPECT_EQ(calibration.height, 20);
  EXPECT_DOUBLE_EQ(calibration.fx, 30.5);
  EXPECT_DOUBLE_EQ(calibration.cy, 9.75);
  EXPECT_EQ(calibration.distortion, testCalibration().distortion);
  for (int i = 0; i < 5; ++i) {
    const auto image = reader->next();
    ASSERT_TRUE(image.has_value());
    EXPECT_EQ(image->sequence, static_cast<std::uint64_t>(i));
    EXPECT_EQ(image->mid_exposure_ns, kStart + i * kInterval);
    ASSERT_TRUE(image->exposure.has_value());
    EXPECT_DOUBLE_EQ(*image->exposure, 0.02);
    EXPECT_EQ(cv::norm(image->image, testImage(i), cv::NORM_INF), 0.0);
  }
  EXPECT_FALSE(reader->next().has_value());
}

TEST_F(BagTest, GroundTruthIsRecordedButNeverTakenForInput) {
  const auto sink = makeBagSink(file_, testCalibration());
  SimulatedFrame frame = testFrame(1);
  frame.sharp = testImage(9);
  frame.depth = cv::Mat1f(20, 32, 2.0F);
  sink->write(frame);
  sink->finish();
  EXPECT_EQ(openBag(file_, {})->size(), 1U);  // images of floats are depths
  BagTopics with_depth;
  with_depth.depth = BagImageWriter::kDepthTopic;
  EXPECT_EQ(openBag(file_, with_depth)->next()->depth(7, 8), 2.0F);

  rosbag::Bag bag(file_);
  rosbag::View view(bag, rosbag::TopicQuery("/groundtruth/pose"));
  ASSERT_EQ(view.size(), 1U);
  const auto pose = view.begin()->instantiate<geometry_msgs::PoseStamped>();
  EXPECT_EQ(pose->header.stamp.toNSec(), static_cast<std::uint64_t>(frame.mid_exposure_ns));
  EXPECT_DOUBLE_EQ(pose->pose.position.x, 1.0);
}

TEST_F(BagTest, DepthImagesComeWithTheImageThatIsNearestInTime) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kStart);
  for (int i = 0; i < 4; ++i) {
    writer.write(kStart + i * kInterval, 0.02, testImage(i));
    if (i == 1) writer.writeImage(BagImageWriter::kDepthTopic, cv::Mat1f(20, 32, 2.5F));
    if (i == 3) writer.writeImage("/camera/depth_mm", cv::Mat1w(20, 32, static_cast<std::uint16_t>(2000)));
  }
  writer.close();
  BagTopics topics;
  EXPECT_NE(errorOf(topics), "");  // 16-bit images might be of light: there is a choice
  topics.image = "/camera/image_raw";
  EXPECT_TRUE(openBag(file_, topics)->next()->depth.empty());
  const auto depthsOf = [&] {
    const auto reader = openBag(file_, topics);
    std::vector<float> depths;
    while (const auto image = reader->next()) depths.push_back(image->depth.empty() ? 0.0F : image->depth(3, 4));
    return depths;
  };
  topics.depth = BagImageWriter::kDepthTopic;
  EXPECT_EQ(depthsOf(), (std::vector<float>{0.0F, 2.5F, 0.0F, 0.0F}));
  topics.depth_tolerance = 0.05;
  EXPECT_EQ(depthsOf(), (std::vector<float>{2.5F, 2.5F, 2.5F, 0.0F}));
  topics.depth = "/camera/depth_mm";
  EXPECT_EQ(depthsOf(), (std::vector<float>{0.0F, 0.0F, 2.0F, 2.0F}));
  topics.depth = "/camera/exposure";
  EXPECT_NE(errorOf(topics).find("/camera/exposure"), std::string::npos);
}

TEST_F(BagTest, StampReferenceIsHonouredOnBothSides) {
  for (const auto reference : {StampReference::kStart, StampReference::kMiddle, StampReference::kEnd}) {
    BagImageWriter writer(file_, testCalibration(), reference);
    writer.write(kStart, 0.02, testImage(0));
    writer.close();
    BagTopics topics;
    topics.stamp_reference = reference;
    const auto image = openBag(file_, topics)->next();
    EXPECT_EQ(image->mid_exposure_ns, kStart) << toString(reference);
    const std::int64_t offset = reference == StampReference::kStart ? -10'000'000
                                : reference == StampReference::kEnd ? 10'000'000
                                                                    : 0;
    EXPECT_EQ(image->stamp_ns, kStart + offset) << toString(reference);
  }
}

TEST_F(BagTest, UnknownExposureStaysUnknown) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kEnd);
  writer.write(kStart, std::nullopt, testImage(0));
  writer.close();
  const auto image = openBag(file_, {})->next();
  EXPECT_FALSE(image->exposure.has_value());
  EXPECT_EQ(image->mid_exposure_ns, image->stamp_ns);
}

TEST_F(BagTest, ColourAndSixteenBitImagesAreAccepted) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kMiddle);
  writer.write(kStart, std::nullopt, cv::Mat(20, 32, CV_8UC3, cv::Scalar(10, 20, 30)));
  writer.write(kStart + kInterval, std::nullopt, cv::Mat(20, 32, CV_16UC1, cv::Scalar(40000)));
  writer.close();
  const auto reader = openBag(file_, {});
  EXPECT_EQ(reader->next()->image.at<cv::Vec3b>(3, 3), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(reader->next()->image.at<std::uint16_t>(3, 3), 40000);
}

/// Publishes what the writer has written last as image_transport does.
void writeCompressed(BagImageWriter& writer, const std::string& format, const std::string& suffix,
                     const cv::Mat& image) {
  sensor_msgs::CompressedImage message;
  message.header = writer.header();
  message.format = format;
  cv::imencode(suffix, image, message.data);
  writer.writeMessage("/camera/image_raw/compressed", message);
}

/// Images that are read from a topic; all with the same stamps and exposures.
std::vector<CameraImage> readAll(const std::string& file, const std::string& topic) {
  BagTopics topics;
  topics.image = topic;
  const auto reader = openBag(file, topics);
  std::vector<CameraImage> images;
  while (auto image = reader->next()) images.push_back(*image);
  return images;
}

TEST_F(BagTest, CompressedImagesAreTheirDecodedTwins) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kStart);
  cv::Mat1w deep;
  testImage(1).convertTo(deep, CV_16U, 200.0);
  cv::Mat3b colour(20, 32);
  cv::randu(colour, 0, 255);
  const std::pair<cv::Mat, std::string> inputs[] = {{testImage(0), "mono8; png compressed "},
                                                    {deep, "mono16; png compressed "},
                                                    {colour, "rgb8; png compressed bgr8"},
                                                    {testImage(3), "png"}};
  int index = 0;
  for (const auto& [image, format] : inputs) {
    writer.write(kStart + kInterval * index++, 0.02, image);
    writeCompressed(writer, format, ".png", image);
  }
  writer.close();
  const auto raw = readAll(file_, "/camera/image_raw");
  const auto compressed = readAll(file_, "/camera/image_raw/compressed");
  ASSERT_EQ(raw.size(), std::size(inputs));
  ASSERT_EQ(compressed.size(), raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    ASSERT_EQ(compressed[i].image.type(), raw[i].image.type()) << i;
    EXPECT_EQ(cv::norm(compressed[i].image, raw[i].image, cv::NORM_INF), 0.0) << i;
    EXPECT_EQ(compressed[i].stamp_ns, raw[i].stamp_ns);
    EXPECT_EQ(compressed[i].mid_exposure_ns, raw[i].mid_exposure_ns);
    EXPECT_EQ(compressed[i].exposure, raw[i].exposure);
    EXPECT_EQ(compressed[i].sequence, raw[i].sequence);
  }
}

TEST_F(BagTest, DepthsThatAreCompressedAreNotTakenForImages) {
  BagImageWriter writer(file_, testCalibration(), StampReference::kMiddle);
  writer.write(kStart, std::nullopt, testImage(0));
  sensor_msgs::CompressedImage depth;
  depth.format = "16UC1; compressedDepth png";
  writer.writeMessage("/depth/image_raw/compressedDepth", depth);
  writer.close();
  EXPECT_EQ(openBag(file_, {})->size(), 1U);
}

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
}  // namespace mba_vo
