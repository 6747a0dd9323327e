#pragma once

#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "capture/fake_device.h"
#include "io/temporary_folder.h"
#include "mba_vo/capture/open_camera.h"

namespace mba_vo {

/// A webcam that a test can spoil, and what it takes to use it.
class DeviceCameraTest : public testing::Test {
 protected:
  static constexpr std::int64_t kTimeout = 100'000'000;  // [ns]
  static constexpr std::int64_t kInterval = 33'333'000;  // [ns]

  DeviceCameraTest() { settings_.device.path = "/dev/video0"; }

  std::unique_ptr<CameraSource> open() { return openCamera(settings_, device_, clock_); }
  std::string errorOnOpen() {
    return messageOf([this] { open(); });
  }

  /// The next image; what is told in between is kept in `told_`.
  std::optional<CapturedImage> nextImage(CameraSource& camera) {
    constexpr int kEnough = 200;  // events, 20 s of silence
    for (int i = 0; i < kEnough; ++i) {
      const CameraEvent event = camera.next(kTimeout);
      if (const auto* image = std::get_if<CapturedImage>(&event)) return *image;
      if (const auto* notice = std::get_if<CameraNotice>(&event)) told_ += notice->text + "\n";
    }
    return std::nullopt;
  }
  /// Some images, one interval after the other.
  std::optional<CapturedImage> play(CameraSource& camera, int count) {
    std::optional<CapturedImage> image;
    for (int i = 0; i < count; ++i) {
      clock_->sleepFor(kInterval);
      device_->sendGrey(100, sequence_++);
      image = nextImage(camera);
    }
    return image;
  }

  const std::shared_ptr<FakeClock> clock_ = std::make_shared<FakeClock>();
  const std::shared_ptr<FakeDevice> device_ = std::make_shared<FakeDevice>(clock_);
  CameraSettings settings_;
  std::uint32_t sequence_ = 0;
  std::string told_;
};

}  // namespace mba_vo
