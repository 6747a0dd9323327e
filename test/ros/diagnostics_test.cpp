#include "mba_vo/ros/diagnostics.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mba_vo::diagnostics_test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;
using testing::HasSubstr;

/// A second in which 30 images were tracked.
TrackerHealth goodTracker() {
  TrackerHealth health;
  health.before.frames_in = health.before.frames_tracked = 60;
  health.now.frames_in = health.now.frames_tracked = 90;
  health.now.state = Status::TRACKING;
  health.now.exposure_source = "topic";
  health.now.exposure = 0.012;
  health.now.image_width = 320;
  health.now.image_height = 240;
  health.now.exposure_ratio = std::numeric_limits<double>::quiet_NaN();
  health.seconds = 1.0;
  health.latency = 0.02;
  health.calibration = "640x480";
  return health;
}

MapperHealth goodMapper() {
  MapperHealth health;
  health.now.map_id = 1;
  health.now.phase = "refining";
  health.now.frames_in = health.now.frames_processed = 30;
  health.seconds = 2.0;
  health.busy_seconds = 1.0;
  return health;
}

DiagnosticStatusWrapper input(const TrackerHealth& health) {
  DiagnosticStatusWrapper diagnostic;
  diagnoseInput(health, diagnostic);
  return diagnostic;
}

DiagnosticStatusWrapper tracking(const TrackerHealth& health) {
  DiagnosticStatusWrapper diagnostic;
  diagnoseTracking(health, diagnostic);
  return diagnostic;
}

DiagnosticStatusWrapper mapping(const MapperHealth& health) {
  DiagnosticStatusWrapper diagnostic;
  diagnoseMapping(health, diagnostic);
  return diagnostic;
}

std::string valueOf(const DiagnosticStatus& diagnostic, const std::string& key) {
  for (const auto& value : diagnostic.values) {
    if (value.key == key) return value.value;
  }
  return "no " + key;
}

TEST(Diagnostics, AllIsWell) {
  const DiagnosticStatus images = input(goodTracker());
  EXPECT_EQ(images.level, DiagnosticStatus::OK) << images.message;
  EXPECT_EQ(valueOf(images, "image rate [1/s]"), "30");
  EXPECT_EQ(valueOf(images, "exposure source"), "topic");
  EXPECT_EQ(valueOf(images, "exposure [ms]"), "12");
  EXPECT_EQ(valueOf(images, "calibration"), "640x480");
  EXPECT_EQ(valueOf(images, "worked on at"), "320x240");
  const DiagnosticStatus poses = tracking(goodTracker());
  EXPECT_EQ(poses.level, DiagnosticStatus::OK) << poses.message;
  EXPECT_EQ(valueOf(poses, "latency [ms]"), "20");
  EXPECT_EQ(valueOf(poses, "state"), "tracking");
  const DiagnosticStatus map = mapping(goodMapper());
  EXPECT_EQ(map.level, DiagnosticStatus::OK) << map.message;
  EXPECT_EQ(valueOf(map, "load"), "50 %");
  EXPECT_EQ(valueOf(map, "state"), "refining");
}

TEST(Diagnostics, ImagesThatDoNotComeOrAreOfNoUse) {
  TrackerHealth health = goodTracker();
  health.missing_input = "no image on /camera/image_raw for 3 s";
  EXPECT_EQ(input(health).level, DiagnosticStatus::ERROR);
  EXPECT_EQ(input(health).message, health.missing_input);

  health = goodTracker();
  health.now.frames_rejected = 30;
  health.now.reason = "its stamp is zero";
  EXPECT_EQ(input(health).level, DiagnosticStatus::ERROR);
  EXPECT_THAT(input(health).message, HasSubstr("its stamp is zero"));
  health.now.frames_rejected = 3;
  EXPECT_EQ(input(health).level, DiagnosticStatus::WARN);
  EXPECT_THAT(input(health).message, HasSubstr("3 of 30 images rejected"));
  health.before.frames_rejected = 3;
  EXPECT_EQ(input(health).level, DiagnosticStatus::OK) << "that was before";
  health.now.frames_missing = 2;
  EXPECT_EQ(input(health).level, DiagnosticStatus::WARN);
  EXPECT_THAT(input(health).message, HasSubstr("2 images never arrived"));
}

TEST(Diagnostics, ExposuresThatAreContradicted) {
  TrackerHealth health = goodTracker();
  health.now.exposure_source = "estimated";
  EXPECT_EQ(input(health).level, DiagnosticStatus::OK);
  health.now.exposure_source = "corrected";
  health.now.exposure_ratio = 0.5;
  EXPECT_EQ(input(health).level, DiagnosticStatus::WARN);
  EXPECT_THAT(input(health).message, HasSubstr("0.5"));
}

TEST(Diagnostics, StatesOfTheTracking) {
  TrackerHealth health = goodTracker();
  health.now.state = Status::LOST;
  health.now.reason = "black image";
  EXPECT_EQ(tracking(health).level, DiagnosticStatus::ERROR);
  EXPECT_EQ(tracking(health).message, "lost: black image");
  for (const auto state : {Status::WAITING, Status::INITIALIZING, Status::DEGRADED}) {
    health.now.state = state;
    EXPECT_EQ(tracking(health).level, DiagnosticStatus::WARN);
    EXPECT_THAT(tracking(health).message, HasSubstr("black image"));
  }
  health = goodTracker();
  health.now.frames_failed = 1;
  EXPECT_EQ(tracking(health).level, DiagnosticStatus::ERROR);
}

TEST(Diagnostics, ATrackerThatDoesNotKeepUp) {
  TrackerHealth health = goodTracker();
  health.now.frames_shed = 4;
  EXPECT_EQ(tracking(health).level, DiagnosticStatus::WARN);
  EXPECT_THAT(tracking(health).message, HasSubstr("4 images shed"));
  health = goodTracker();
  health.latency = 0.5;
  EXPECT_EQ(tracking(health).level, DiagnosticStatus::WARN);
  EXPECT_THAT(tracking(health).message, HasSubstr("0.50 s"));
  health.now.frames_in = health.before.frames_in + 1;
  EXPECT_EQ(tracking(health).level, DiagnosticStatus::OK) << "one image a second: it was done before the next one came";
  health.latency = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tracking(health).level, DiagnosticStatus::OK) << "not known yet";
}

TEST(Diagnostics, AMapperThatDoesNotKeepUp) {
  MapperHealth health = goodMapper();
  health.busy_seconds = 1.99;
  EXPECT_EQ(mapping(health).level, DiagnosticStatus::WARN);
  EXPECT_EQ(valueOf(mapping(health), "load"), "100 %");
  health.busy_seconds = 5.0;
  EXPECT_EQ(valueOf(mapping(health), "load"), "100 %") << "a long piece of work that began before";
  health = goodMapper();
  health.now.frames_shed = 7;
  EXPECT_EQ(mapping(health).level, DiagnosticStatus::WARN);
  EXPECT_THAT(mapping(health).message, HasSubstr("7 frames shed"));
  health.now.frames_unusable = 1;
  health.now.message = "the mapper failed: x";
  EXPECT_EQ(mapping(health).level, DiagnosticStatus::ERROR);
  EXPECT_THAT(mapping(health).message, HasSubstr("the mapper failed: x"));
}

TEST(Diagnostics, ANodeThatWasRestartedCountsAnew) {
  TrackerHealth health = goodTracker();
  health.before.frames_in = 1000;
  EXPECT_EQ(valueOf(input(health), "image rate [1/s]"), "90");
}

TEST(Diagnostics, ACalibrationIsOneLine) {
  CameraCalibration calibration{640, 480, 460.0, 461.0, 320.0, 240.0, "plumb_bob", {-0.3, 0.1, 0.0, 0.0, 0.0}};
  EXPECT_EQ(describe(calibration), "640x480, fx 460, fy 461, cx 320, cy 240, plumb_bob");
  calibration.distortion = {};
  EXPECT_THAT(describe(calibration), HasSubstr("no distortion"));
}

}  // namespace
}  // namespace mba_vo::diagnostics_test
