#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "mba_vo/simulation/frame_cache.h"
#include "mba_vo/simulation/simulator.h"
#include "mba_vo/tracking/motion_prior.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo::study {

/// Frames of one class of blur.
struct BlurClass {
  const char* name;
  double exposure;          // [s]
  double least, most;       // mean image motion within the exposure at 2 m [px]
  int frames_per_sequence;  // to be measured, unless told otherwise
};

/// One frame to be tracked, and the truth about it.
struct Case {
  ReferenceConstPtr reference;  // sharp image, true depths
  cv::Mat1f reference_depth;
  FrameConstPtr frame;
  MotionPrior prior;             // constant velocity from the true poses of the two frames before
  MotionPrior skipping;          // the same, the frame before being lost
  SE3 T_reference_mid;           // true
  SE3 T_start_end;               // true motion within the exposure
  double blur_px = 0.0;          // true
  double prior_error_deg = 0.0;  // rotation error of the constant-velocity guess
  bool reversal = false;         // the camera pans or tilts the other way than a frame ago
};

/// A simulated sequence whose frames of one class of blur are tracked, each on its own, relative to the keyframe that
/// the image motion asks for. Images are taken from, and kept in, the cache of mba_vo_simulate.
class Sequence {
 public:
  Sequence(int seed, const BlurClass& blur);

  /// Calls `use` for about `frames` frames of the class, or all if there are fewer, spread over the sequence: all that
  /// some of the keyframes serve. More frames contain the fewer ones.
  void forEach(int frames, const std::function<void(const Case&)>& use);

 private:
  struct Keyframe {
    int index = 0;
    std::vector<int> frames;  // of the class of blur, tracked relative to it
  };
  std::vector<Keyframe> keyframes() const;
  SE3 pose(int index) const { return sharp_.pose(sharp_.time(index)); }
  void loadReference(int index);
  Case makeCase(int index) const;
  MotionPrior priorFrom(int last, int index) const;

  BlurClass blur_;
  std::shared_ptr<const Scene> room_;
  Simulator blurred_, sharp_;
  FrameCache blurred_images_, sharp_images_;
  SimulatedFrame reference_view_;
  ReferenceConstPtr reference_;
};

}  // namespace mba_vo::study
