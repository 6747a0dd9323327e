#pragma once

namespace mba_vo {

/// Tells when the tracker cannot keep up with the camera. What counts are images that wait, not times: a simulated live
/// run goes the same way, and offline, where nothing waits, nothing changes.
class TrackingLoad {
 public:
  /// Of an image that is to be tracked: whether it had to wait for what was done before. True if that is so too often.
  bool isTooHigh(bool waited);

 private:
  double share_ = 0.0;  // of the last images that had to wait
};

}  // namespace mba_vo
