#include <geometry_msgs/PoseStamped.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <opencv2/imgcodecs.hpp>

#include "bag_fixture.h"
#include "mba_vo/ros/bag_image_writer.h"

namespace mba_vo::bag_test {
namespace {

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

}  // namespace
}  // namespace mba_vo::bag_test
