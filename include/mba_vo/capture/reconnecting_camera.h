#pragma once

#include <functional>
#include <memory>
#include <string>

#include "mba_vo/capture/camera_source.h"
#include "mba_vo/capture/clock.h"

namespace mba_vo {

/// A camera that may be unplugged and plugged in again. Says LOST and FOUND; numbers and stamps go on.
class ReconnectingCamera : public CameraSource {
 public:
  using Open = std::function<std::unique_ptr<CameraSource>()>;

  /// Opens it at once, and throws what that throws: what never worked is not waited for.
  ReconnectingCamera(Open open, std::shared_ptr<Clock> clock);
  CameraEvent next(std::int64_t timeout_ns) override;

 private:
  CameraEvent tryAgain(std::int64_t timeout_ns);

  Open open_;
  std::shared_ptr<Clock> clock_;
  std::unique_ptr<CameraSource> camera_;  // null while it is lost
  std::int64_t next_try_ns_ = 0;          // monotonic clock
  std::string last_reason_;               // why it could not be opened again
  std::uint64_t first_number_ = 0;        // of the camera as it is open now
  std::uint64_t last_number_ = 0;
};

}  // namespace mba_vo
