#pragma once

namespace mba_vo {

/// Tells when the tracker cannot keep up with the camera. What counts are images that wait, not times: a simulated live
/// run goes the same way, and offline, where nothing waits, nothing changes.
class TrackingLoad {
 public:
  /// Of an image that is to be tracked: whether later ones wait already. True if that is so too often.
  bool isTooHigh(bool others_wait);

 private:
  double share_ = 0.0;  // of the last images behind which others waited
};

}  // namespace mba_vo
