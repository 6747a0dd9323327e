// Feeds the tracker with what it cannot use: every image must be accounted for with a reason that names the thing.
#include <cmath>
#include <limits>

#include "bad_input.h"

namespace mba_vo::bad_input_test {
namespace {

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
  EXPECT_TRUE(hasReason(stamp(1), "repeats the image of 1000.000000 s"));
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
  EXPECT_NE(odometry_->status().reason.find("1 publishers"), std::string::npos);
  sendCameraInfo();
  sendImage(stamp(0));
  ASSERT_TRUE(done());
  EXPECT_TRUE(odometry_->waitFor(
      [](const Outputs& o) {
        return o.status.back()->reason.find("image_raw for ") != std::string::npos &&
               o.status.back()->state == Status::WAITING;
      },
      kTimeout));
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
}  // namespace mba_vo::bad_input_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bad_input_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
