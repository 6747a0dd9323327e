#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "mba_vo/ros/bag_reader.h"
#include "mba_vo/ros/bag_sink.h"

namespace mba_vo {

constexpr std::int64_t kStart = 1'600'000'000'123'456'789;
constexpr std::int64_t kInterval = 40'000'000;

inline CameraCalibration testCalibration() {
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

inline cv::Mat1b testImage(int index) {
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

inline SimulatedFrame testFrame(int index) {
  SimulatedFrame frame;
  frame.id = static_cast<std::uint64_t>(index);
  frame.mid_exposure_ns = kStart + index * kInterval;
  frame.exposure = 0.02;
  frame.blurred = testImage(index);
  frame.T_world_mid = SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(index, 2.0, 3.0));
  return frame;
}

}  // namespace mba_vo
