// Feeds the tracker with what it cannot use: every image must be accounted for with a reason that names the thing.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <mba_vo/ExposureStamped.h>
#include <sensor_msgs/CameraInfo.h>
#include <boost/make_shared.hpp>

#include "live_odometry.h"
#include "mba_vo/ros/camera_info.h"
#include "mba_vo/ros/conversions.h"

namespace mba_vo {
namespace {

constexpr double kTimeout = 20.0;  // [s]
constexpr std::int64_t kFirstStamp = 1'000'000'000'000;
constexpr std::int64_t kInterval = 50'000'000;

/// A camera that can be told to misbehave, and the nodelets, in a namespace of their own.
class BadInput : public testing::Test {
 protected:
  BadInput()
      : name_(testing::UnitTest::GetInstance()->current_test_info()->name()),
        nh_("/" + name_ + "_camera"),
        images_(nh_.advertise<sensor_msgs::Image>("image_raw", 100)),
        infos_(nh_.advertise<sensor_msgs::CameraInfo>("camera_info", 100)),
        exposures_(nh_.advertise<ExposureStamped>("exposure", 100)) {
    ros::NodeHandle parameters("/" + name_);
    parameters.setParam("extrinsic_wait", 0.0);
    parameters.setParam("calibration_wait", 0.3);
    parameters.setParam("exposure_wait", 0.2);
    parameters.setParam("publish_tf", false);
    odometry_ = std::make_unique<LiveOdometry>("/" + name_, "/" + name_ + "_camera");
    waitForSubscribers(images_);
    waitForSubscribers(infos_);
    waitForSubscribers(exposures_);
  }

  static void waitForSubscribers(const ros::Publisher& publisher) {
    const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(kTimeout);
    while (publisher.getNumSubscribers() == 0 && ros::WallTime::now() < deadline) {
      ros::WallDuration(0.01).sleep();
    }
  }

  void sendCameraInfo(double focal_length = 150.0) {
    CameraCalibration calibration;
    calibration.width = 160;
    calibration.height = 120;
    calibration.fx = calibration.fy = focal_length;
    calibration.cx = 79.5;
    calibration.cy = 59.5;
    infos_.publish(cameraInfoFromCalibration(calibration));
    ros::WallDuration(0.2).sleep();  // it has a queue of its own
  }

  void sendImage(std::int64_t stamp_ns, const std::string& encoding = "mono8", unsigned width = 160,
                 unsigned bytes_per_pixel = 1) {
    grey_ += 3;  // no image repeats another
    sendImageAgain(stamp_ns, encoding, width, bytes_per_pixel);
  }

  /// What the last one showed.
  void sendImageAgain(std::int64_t stamp_ns, const std::string& encoding = "mono8", unsigned width = 160,
                      unsigned bytes_per_pixel = 1) {
    // Handed over as a pointer, the message keeps its sequence number; serialised, it would be given the next one.
    const auto image = boost::make_shared<sensor_msgs::Image>();
    image->header.stamp = toRosTime(stamp_ns);
    image->header.frame_id = "camera";
    image->header.seq = sequence_++;
    image->encoding = encoding;
    image->width = width;
    image->height = 120;
    image->step = width * bytes_per_pixel;
    image->data.assign(image->step * image->height, grey_);
    images_.publish(sensor_msgs::ImageConstPtr(image));
    ++sent_;
  }

  void sendExposure(std::int64_t stamp_ns, double exposure) {
    ExposureStamped message;
    message.header.stamp = toRosTime(stamp_ns);
    message.exposure_time = exposure;
    exposures_.publish(message);
  }

  static std::int64_t stamp(int index) { return kFirstStamp + index * kInterval; }
  bool done() const { return odometry_->waitUntilDone(sent_, kTimeout); }

  /// Whether a status with this image's stamp gives a reason that contains `text`.
  bool hasReason(std::int64_t stamp_ns, const std::string& text) const {
    for (const auto& status : odometry_->outputs().status) {
      if (toNanoseconds(status->header.stamp) == stamp_ns && status->reason.find(text) != std::string::npos) {
        return true;
      }
    }
    return false;
  }

  std::string name_;
  ros::NodeHandle nh_;
  ros::Publisher images_, infos_, exposures_;
  std::unique_ptr<LiveOdometry> odometry_;
  std::uint64_t sent_ = 0;
  std::uint32_t sequence_ = 0;
  std::uint8_t grey_ = 100;
};

TEST_F(BadInput, NoCalibration) {
  sendImage(stamp(0));
  ASSERT_TRUE(done());
  EXPECT_TRUE(hasReason(stamp(0), "/NoCalibration_camera/camera_info"));
  EXPECT_EQ(odometry_->status().frames_rejected, 1U);
  EXPECT_EQ(odometry_->status().state, Status::WAITING);
}

TEST_F(BadInput, UncalibratedCamera) {
  sendCameraInfo(0.0);
  sendImage(stamp(0));
  ASSERT_TRUE(done());
  EXPECT_TRUE(hasReason(stamp(0), "K[0]"));
}

TEST_F(BadInput, CalibrationThatComesLateLosesNoImage) {
  sendImage(stamp(0));
  ros::WallDuration(0.05).sleep();
  sendCameraInfo();
  ASSERT_TRUE(done());
  EXPECT_EQ(odometry_->status().frames_initializing, 1U);
}

TEST_F(BadInput, WrongSize) {
  sendCameraInfo();
  sendImage(stamp(0), "mono8", 200);
  sendImage(stamp(1));
  ASSERT_TRUE(done());
  EXPECT_TRUE(hasReason(stamp(0), "200"));
  EXPECT_EQ(odometry_->status().frames_rejected, 1U);
  EXPECT_EQ(odometry_->status().frames_initializing, 1U);
}

TEST_F(BadInput, ColourAndSixteenBitAreGoodInput) {
  sendCameraInfo();
  sendImage(stamp(0), "rgb8", 160, 3);
  sendImage(stamp(1), "bgr8", 160, 3);
  sendImage(stamp(2), "mono16", 160, 2);
  ASSERT_TRUE(done());
  EXPECT_EQ(odometry_->status().frames_initializing, 3U);
}

TEST_F(BadInput, UnknownEncoding) {
  sendCameraInfo();
  sendImage(stamp(0), "32FC1", 160, 4);
  ASSERT_TRUE(done());
  EXPECT_TRUE(hasReason(stamp(0), "32FC1"));
}

TEST_F(BadInput, StampsThatRepeatOrGoBack) {
  sendCameraInfo();
  sendImage(stamp(2));
  sendImage(stamp(2));
  sendImage(stamp(1));
  sendImage(stamp(3));
  ASSERT_TRUE(done());
  EXPECT_TRUE(hasReason(stamp(2), "repeats"));
  EXPECT_TRUE(hasReason(stamp(1), "before"));
  EXPECT_EQ(odometry_->status().frames_rejected, 2U);
  EXPECT_EQ(odometry_->status().frames_initializing, 2U);
  EXPECT_EQ(odometry_->status().resets, 0U);
}

TEST_F(BadInput, AnImageOnceMoreUnderAnotherStamp) {
  sendCameraInfo();
  sendImage(stamp(0));
  sendImageAgain(stamp(1));
  sendImage(stamp(2));
  ASSERT_TRUE(done());
  EXPECT_TRUE(hasReason(stamp(1), "repeats image"));
  EXPECT_EQ(odometry_->status().frames_repeated, 1U);
  EXPECT_EQ(odometry_->status().frames_initializing, 2U);
}

TEST_F(BadInput, ClockThatStartsAnew) {
  sendCameraInfo();
  sendImage(stamp(100));
  sendImage(stamp(0));
  ASSERT_TRUE(done());
  EXPECT_EQ(odometry_->status().frames_rejected, 0U);
  EXPECT_EQ(odometry_->status().resets, 1U);
}

TEST_F(BadInput, StampOfZero) {
  sendCameraInfo();
  sendImage(0);
  ASSERT_TRUE(done());
  EXPECT_TRUE(hasReason(0, "stamp is zero"));
}

TEST_F(BadInput, ImagesThatNeverArrived) {
  sendCameraInfo();
  sendImage(stamp(0));
  sequence_ += 3;
  sendImage(stamp(4));
  ASSERT_TRUE(done());
  EXPECT_TRUE(odometry_->waitFor([](const Outputs& o) { return o.status.back()->frames_missing == 3; }, kTimeout));
}

TEST_F(BadInput, ExposureThatCannotBeIsTreatedAsUnknown) {
  sendCameraInfo();
  const double exposures[] = {0.01, -0.01, std::numeric_limits<double>::quiet_NaN(), 0.5, 0.01};
  for (int i = 0; i < 5; ++i) {
    sendExposure(stamp(i), exposures[i]);
    ros::WallDuration(0.05).sleep();
    sendImage(stamp(i));
  }
  ASSERT_TRUE(done());
  const Outputs outputs = odometry_->outputs();
  ASSERT_EQ(outputs.tracked_frame.size(), 5U);
  EXPECT_DOUBLE_EQ(outputs.tracked_frame[0]->message.tracked->frame->exposure.value(), 0.01);
  for (const std::size_t i : {1U, 2U, 3U}) {
    EXPECT_FALSE(outputs.tracked_frame[i]->message.tracked->frame->exposure.has_value()) << i;
  }
  EXPECT_DOUBLE_EQ(outputs.tracked_frame[4]->message.tracked->frame->exposure.value(), 0.01);
}

TEST_F(BadInput, NoImageForAWhile) {
  EXPECT_TRUE(odometry_->waitFor(
      [](const Outputs& o) {
        return !o.status.empty() &&
               o.status.back()->reason.find("no image on /NoImageForAWhile_camera/image_raw yet") == 0;
      },
      kTimeout));
  sendCameraInfo();
  sendImage(stamp(0));
  ASSERT_TRUE(done());
  EXPECT_TRUE(odometry_->waitFor(
      [](const Outputs& o) { return o.status.back()->reason.find("image_raw for ") != std::string::npos; }, kTimeout));
}

TEST_F(BadInput, WrongParametersEndTheStart) {
  for (const char* nodelet : {"mba_vo/Tracker", "mba_vo/Mapper"}) {
    nodelet::Loader loader(false);
    ros::NodeHandle parameters("/wrong");
    parameters.setParam("tracker/max_point", 3);
    EXPECT_FALSE(loader.load("/wrong/nodelet", nodelet, {}, {}));
    parameters.deleteParam("tracker");
    EXPECT_TRUE(loader.load("/wrong/tracking", nodelet, {}, {}));
  }
}

TEST_F(BadInput, SummaryFromAnotherProcessIsReportedAndNotUsed) {
  ros::NodeHandle nh("/" + name_);
  ros::Publisher frames = nh.advertise<TrackedFrameSummary>("tracked_frame", 10);
  waitForSubscribers(frames);
  frames.publish(TrackedFrameSummary());
  EXPECT_TRUE(odometry_->waitFor(
      [](const Outputs& o) {
        return o.mapper_status.back()->frames_unusable == 1 &&
               o.mapper_status.back()->message.find("another process") != std::string::npos;
      },
      kTimeout));
  EXPECT_EQ(odometry_->outputs().mapper_status.back()->frames_in, 0U);
}

}  // namespace
}  // namespace mba_vo

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bad_input_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
