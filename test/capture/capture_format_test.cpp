#include "mba_vo/capture/capture_format.h"

#include <linux/videodev2.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.h"

namespace mba_vo::capture_format_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

SizeRange single(int width, int height) { return {width, width, 1, height, height, 1}; }

/// A usual webcam: large images only compressed.
std::vector<OfferedFormat> webcam() {
  return {{V4L2_PIX_FMT_MJPEG, single(1280, 720), {{30, 30}}},
          {V4L2_PIX_FMT_MJPEG, single(640, 480), {{30, 30}}},
          {V4L2_PIX_FMT_YUYV, single(640, 480), {{30, 30}, {15, 15}}},
          {V4L2_PIX_FMT_YUYV, single(1280, 720), {{10, 10}}},
          {V4L2_PIX_FMT_H264, single(640, 480), {{30, 30}}}};
}

FormatRequest request(const std::string& pixels, int width, int height, double rate) {
  return {pixels, width, height, rate};
}

std::string chosen(const FormatRequest& request) { return describe(chooseFormat(webcam(), request)); }
std::string refusal(const FormatRequest& request) {
  return messageOf([&] { chooseFormat(webcam(), request); });
}

TEST(CaptureFormat, WhatIsLeftOpenIsChosenForOdometry) {
  EXPECT_EQ(chosen({}), "yuyv 640x480 at 30 Hz");                               // no loss by compression
  EXPECT_EQ(chosen(request("auto", 1280, 720, 0)), "mjpeg 1280x720 at 30 Hz");  // rather than 10 Hz
  EXPECT_EQ(chosen(request("yuyv", 1280, 720, 0)), "yuyv 1280x720 at 10 Hz");
  EXPECT_EQ(chosen(request("auto", 0, 0, 15)), "yuyv 640x480 at 15 Hz");
  EXPECT_EQ(chosen(request("mjpeg", 0, 0, 0)), "mjpeg 640x480 at 30 Hz");
  EXPECT_EQ(chosen(request("auto", 0, 0, 10)), "yuyv 1280x720 at 10 Hz");  // the only one with that rate
}

TEST(CaptureFormat, SizesInStepsAndUnknownRates) {
  const std::vector<OfferedFormat> sensor = {{V4L2_PIX_FMT_GREY, {32, 2592, 16, 32, 1944, 2}, {{5, 90}}}};
  EXPECT_EQ(describe(chooseFormat(sensor, {})), "grey 640x480 at 30 Hz");
  EXPECT_EQ(describe(chooseFormat(sensor, request("auto", 48, 34, 60))), "grey 48x34 at 60 Hz");
  EXPECT_THAT(messageOf([&] { chooseFormat(sensor, request("auto", 50, 34, 0)); }),
              AllOf(HasSubstr("50x34"), HasSubstr("32x32 to 2592x1944 in steps of 16x2")));
  const std::vector<OfferedFormat> silent = {{V4L2_PIX_FMT_YUYV, single(320, 240), {}}};
  EXPECT_EQ(describe(chooseFormat(silent, request("auto", 0, 0, 50))), "yuyv 320x240");
}

TEST(CaptureFormat, WhatIsNotOfferedIsNamedWithWhatIs) {
  EXPECT_THAT(refusal(request("grey", 0, 0, 0)),
              AllOf(HasSubstr("no pixel_format grey"), HasSubstr("mjpeg 1280x720: 30 Hz")));
  EXPECT_THAT(refusal(request("auto", 641, 480, 0)), AllOf(HasSubstr("641x480"), HasSubstr("yuyv 640x480: 30, 15 Hz")));
  const std::string no_rate = refusal(request("yuyv", 1280, 720, 30));
  EXPECT_THAT(no_rate, AllOf(HasSubstr("no rate of 30 Hz"), HasSubstr("yuyv 1280x720: 10 Hz")));
  EXPECT_THAT(no_rate, testing::Not(HasSubstr("640x480")));  // which was not asked for
  EXPECT_THAT(refusal(request("h264", 0, 0, 0)), AllOf(HasSubstr("'h264'"), HasSubstr("mjpeg, yuyv, grey")));
  EXPECT_THAT(refusal(request("auto", 640, 0, 0)), HasSubstr("tell both"));
  EXPECT_THAT(messageOf([] { chooseFormat({webcam().back()}, {}); }),
              AllOf(HasSubstr("none of the pixel formats"), HasSubstr("(H264) 640x480")));
  EXPECT_THAT(messageOf([] { chooseFormat({}, {}); }), HasSubstr("no format at all"));
}

}  // namespace
}  // namespace mba_vo::capture_format_test
