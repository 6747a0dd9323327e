#pragma once

#include <string>

#include "mba_vo/image/frame.h"

namespace mba_vo {

/// Tells images that show nothing, or nothing new for a while. That a recorder now and then writes an image twice is
/// common, and does no harm but that the pose is one of before.
class ImageCheck {
 public:
  /// What is wrong with the next image; empty if all is well.
  std::string problemOf(const FrameConstPtr& frame);
  /// True if the last image was the same as the one before.
  bool repeated() const { return repeated_; }
  void reset() { first_.reset(); }

 private:
  bool repeated_ = false;
  FrameConstPtr first_;  // of the newest images, if they are all the same
};

}  // namespace mba_vo
