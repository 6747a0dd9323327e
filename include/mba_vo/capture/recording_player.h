#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "mba_vo/capture/camera_source.h"
#include "mba_vo/capture/clock.h"
#include "mba_vo/capture/recording.h"

namespace mba_vo {

/// Plays a recording as a camera would have sent it: every image when its exposure is over, stamped as if it were taken
/// now. None is left out where reading them takes too long: they come late then, and that is told.
class RecordingPlayer : public CameraSource {
 public:
  /// With `loop` it begins again at the end, one interval after the last image. `color`: BGR as recorded, else grey.
  RecordingPlayer(std::unique_ptr<Recording> recording, std::shared_ptr<Clock> clock, bool loop, bool color);
  CameraEvent next(std::int64_t timeout_ns) override;
  std::string calibrationFile() const override { return recording_->calibrationFile(); }

 private:
  void begin();
  /// Reads the image that is due next; false at the end.
  bool read();
  CameraEvent handOver(std::int64_t lateness_ns);

  std::unique_ptr<Recording> recording_;
  std::shared_ptr<Clock> clock_;
  bool loop_, color_;
  std::deque<CameraNotice> notices_;
  std::optional<RecordedImage> waiting_;
  bool begun_ = false, any_ = false, ended_ = false;
  std::int64_t monotonic_offset_ = 0;      // monotonic clock minus the recording's [ns]
  std::int64_t wall_offset_ = 0;           // wall clock minus the recording's [ns]
  std::int64_t last_time_ns_ = 0;          // of the recording
  std::int64_t interval_ns_ = 0;           // between the last two images
  std::optional<std::int64_t> told_late_;  // monotonic clock [ns]
  std::uint64_t number_ = 0;
};

}  // namespace mba_vo
