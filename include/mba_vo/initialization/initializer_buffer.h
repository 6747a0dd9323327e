#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "mba_vo/initialization/initializer_tracker.h"

namespace mba_vo {

/// A buffered frame.
struct BufferedImage {
  InitializerImageConstPtr image;
  ImageMotion motion;                 // from the frame before
  double log_sharpness = 0.0;         // gradient energy relative to the first frame ever buffered
  std::optional<FrameTracks> tracks;  // of the current reference's corners
};

/// The frames of the last seconds, the sharpest of them as reference, and its corners' tracks through the others. The
/// work per added frame is bounded: after a change of the reference the other frames are caught up with over the next
/// ones.
class InitializerBuffer {
 public:
  InitializerBuffer(double seconds, int max_corners) : seconds_(seconds), max_corners_(max_corners) {}

  void add(const FrameConstPtr& frame);
  void clear();

  /// Chooses the reference anew if another frame is clearly sharper, or the newest frames do not see the current one.
  /// One that was given up, and those before it, are not chosen again.
  void updateReference();
  /// Tracks up to `max_images` frames next to those tracked already, forwards in time first. The newest frame is left
  /// to the next call: its blur is known once the motion on both its sides is.
  void updateTracks(int max_images);

  const std::deque<BufferedImage>& images() const { return images_; }
  bool hasReference() const { return tracker_ != nullptr; }
  std::size_t reference() const { return reference_; }
  const ReferenceTracker& tracker() const { return *tracker_; }
  /// Time between the oldest and the newest frame [s].
  double span() const;
  /// Path of the image centre during the exposure [px], 0 if the exposure is unknown.
  double blurLength(std::size_t index) const;

 private:
  void dropOld();
  void setReference(std::size_t index);
  bool trackOne(std::size_t index, std::size_t neighbour);
  Eigen::Vector3d exposureRotation(std::size_t index) const;
  bool sees(std::size_t index) const;

  double seconds_;
  int max_corners_;
  std::deque<BufferedImage> images_;
  std::size_t reference_ = 0;
  std::size_t first_candidate_ = 0;  // for a reference: what the newest frames did not see is none again
  std::unique_ptr<ReferenceTracker> tracker_;
};

}  // namespace mba_vo
