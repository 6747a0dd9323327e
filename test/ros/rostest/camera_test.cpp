// The camera nodelet plays a video as a camera would.
#include <cmath>
#include <mutex>

#include <gtest/gtest.h>
#include <mba_vo/ExposureStamped.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <opencv2/videoio.hpp>

#include "io/temporary_folder.h"

namespace mba_vo::camera_test {
namespace {

constexpr double kTimeout = 30.0;  // [s]
constexpr int kImages = 5;

class CameraNodeletTest : public testing::Test {
 protected:
  CameraNodeletTest() : nh_("/camera"), loader_(false) {
    cv::VideoWriter writer(folder_.file("video.avi"), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                           20.0, {64, 48});
    for (int i = 0; i < kImages; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(40 * i)));
    nh_.setParam("device", folder_.file("video.avi"));
    nh_.setParam("camera_info_url", folder_.file("camera.yaml"));  // which there is not
    nh_.setParam("field_of_view", 90.0);
  }
  ~CameraNodeletTest() override { nh_.deleteParam("/camera"); }

  bool load() { return loader_.load("/camera", "mba_vo/Camera", {}, {}); }

  template <typename Message>
  void listen(const std::string& topic, std::vector<boost::shared_ptr<const Message>>& list) {
    const boost::function<void(const boost::shared_ptr<const Message>&)> callback = [this, &list](const auto& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      list.push_back(message);
    };
    subscribers_.push_back(nh_.subscribe<Message>(topic, 100, callback));
  }
  /// Whether all three lists reach `count`.
  bool waitFor(std::size_t count) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kTimeout);
    while (ros::WallTime::now() < deadline) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (images_.size() >= count && infos_.size() >= count && exposures_.size() >= count) return true;
      }
      ros::WallDuration(0.02).sleep();
    }
    return false;
  }
  void listenToAll() {
    listen("camera_info", infos_);
    listen("exposure", exposures_);
    listen("image_raw", images_);  // last: with it playing begins
  }

  const TemporaryFolder folder_;
  ros::NodeHandle nh_;
  std::mutex mutex_;
  std::vector<sensor_msgs::ImageConstPtr> images_;
  std::vector<sensor_msgs::CameraInfoConstPtr> infos_;
  std::vector<ExposureStampedConstPtr> exposures_;
  std::vector<ros::Subscriber> subscribers_;
  nodelet::Loader loader_;
};

TEST_F(CameraNodeletTest, PlaysAVideoWhenSomebodyListens) {
  ASSERT_TRUE(load());
  listenToAll();
  ASSERT_TRUE(waitFor(kImages));
  EXPECT_EQ(images_.size(), static_cast<std::size_t>(kImages));
  for (int i = 0; i < kImages; ++i) {
    EXPECT_EQ(images_[i]->encoding, "mono8");
    EXPECT_EQ(images_[i]->width, 64U);
    EXPECT_NEAR(images_[i]->data.front(), 40 * i, 4);
    EXPECT_EQ(images_[i]->header.frame_id, "camera_optical");
    EXPECT_EQ(infos_[i]->header.stamp, images_[i]->header.stamp);
    EXPECT_EQ(exposures_[i]->header.stamp, images_[i]->header.stamp);
    EXPECT_TRUE(std::isnan(exposures_[i]->exposure_time));
    EXPECT_NEAR((images_[i]->header.stamp - images_[0]->header.stamp).toSec(), i / 20.0, 1e-4);
  }
  EXPECT_NEAR(infos_[0]->K[0], 32.0, 1e-9);                                              // 64 px see 90 degrees
  EXPECT_LT(std::abs((ros::Time::now() - images_[0]->header.stamp).toSec()), kTimeout);  // taken just now
}

/// What is played has 64x48 pixels.
TEST_F(CameraNodeletTest, TakesCalibrationsOfEveryKind) {
  const std::string rig =
      "  camera_model: pinhole\n  distortion_model: equidistant\n  distortion_coeffs: [0.1, 0.02, 0.003, 0.0004]\n"
      "  resolution: [64, 48]\n";
  folder_.write("camchain.yaml",
                "cam0:\n  intrinsics: [51, 51, 31, 23]\n" + rig + "cam1:\n  intrinsics: [52, 53, 31, 23]\n" + rig);
  folder_.write("sensor.yaml",
                "sensor_type: camera\nresolution: [64, 48]\nintrinsics: [54, 55, 31, 23]\n"
                "distortion_model: radial-tangential\ndistortion_coefficients: [-0.2, 0.05, 0.001, 0.002]\n");
  folder_.write("camera.txt", "FOV 56 57 31 23 0.9\n64 48\nnone\n64 48\n");
  folder_.write("camera.yaml",
                "image_width: 64\nimage_height: 48\ncamera_name: camera\ndistortion_model: plumb_bob\n"
                "camera_matrix: {rows: 3, cols: 3, data: [58, 0, 31, 0, 59, 23, 0, 0, 1]}\n"
                "distortion_coefficients: {rows: 1, cols: 5, data: [0.1, 0, 0, 0, 0]}\n"
                "rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n"
                "projection_matrix: {rows: 3, cols: 4, data: [44, 0, 31, 0, 0, 45, 23, 0, 0, 0, 1, 0]}\n");
  struct Expected {
    const char *file, *camera, *model;
    double fx, first, projected;  // first coefficient of the lens; focal length of rectified images
  };
  const Expected kinds[] = {{"camchain.yaml", "", "equidistant", 51.0, 0.1, 51.0},
                            {"camchain.yaml", "cam1", "equidistant", 52.0, 0.1, 52.0},
                            {"sensor.yaml", "", "plumb_bob", 54.0, -0.2, 54.0},
                            {"camera.txt", "", "fov", 56.0, 0.9, 56.0},
                            {"camera.yaml", "", "plumb_bob", 58.0, 0.1, 44.0}};
  for (const Expected& expected : kinds) {
    SCOPED_TRACE(std::string(expected.file) + " " + expected.camera);
    nh_.setParam("camera_info_url", folder_.file(expected.file));
    nh_.setParam("calibration_camera", std::string(expected.camera));
    infos_.clear();
    images_.clear();
    exposures_.clear();
    ASSERT_TRUE(load());
    listenToAll();
    ASSERT_TRUE(waitFor(1));
    subscribers_.clear();
    ASSERT_TRUE(loader_.unload("/camera"));
    EXPECT_EQ(infos_[0]->K[0], expected.fx);
    EXPECT_EQ(infos_[0]->P[0], expected.projected);
    EXPECT_EQ(infos_[0]->distortion_model, expected.model);
    EXPECT_EQ(infos_[0]->D.at(0), expected.first);
  }
}

TEST_F(CameraNodeletTest, IsUnloadedWhilePlayingAndLoadedAgain) {
  nh_.setParam("loop", true);
  ASSERT_TRUE(load());
  listenToAll();
  ASSERT_TRUE(waitFor(2 * kImages));
  ASSERT_TRUE(loader_.unload("/camera"));
  const std::size_t count = images_.size();
  ASSERT_TRUE(load());
  EXPECT_TRUE(waitFor(count + 2));
}

TEST_F(CameraNodeletTest, WhatCannotBeUsedEndsTheStart) {
  const auto wrong = [this](const std::string& key, const auto& value) {
    nh_.setParam(key, value);
    return !load();
  };
  EXPECT_TRUE(wrong("device", "/dev/nothing"));
  nh_.setParam("device", folder_.file("video.avi"));
  EXPECT_TRUE(wrong("devise", "x"));
  nh_.deleteParam("devise");
  EXPECT_TRUE(wrong("exposure", "long"));
  nh_.deleteParam("exposure");
  EXPECT_TRUE(wrong("stamp_reference", "centre"));
  nh_.deleteParam("stamp_reference");
  EXPECT_TRUE(wrong("camera_info_url", "camera.yaml"));
  EXPECT_TRUE(wrong("camera_info_url",
                    folder_.write("spoilt.yaml", "cam0: {intrinsics: [0, 1, 2, 3], resolution: [64, 48]}\n")));
  EXPECT_TRUE(wrong("camera_info_url", "package://mba_vo_that_is_not_there/camera.yaml"));
  nh_.setParam("camera_info_url", folder_.file("camera.yaml"));
  EXPECT_TRUE(wrong("calibration_camera", "cam1")) << "of a calibration that is not there";
  nh_.deleteParam("calibration_camera");
  nh_.deleteParam("camera_info_url");
  EXPECT_TRUE(wrong("camera_name", "my camera"));
  nh_.deleteParam("camera_name");
  EXPECT_TRUE(load());
}

}  // namespace
}  // namespace mba_vo::camera_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "camera_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
