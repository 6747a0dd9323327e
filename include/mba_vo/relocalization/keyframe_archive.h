#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/image/frame.h"
#include "mba_vo/relocalization/place_index.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// A keyframe as the archive keeps it: the image in 8 bits, everything else as the tracker had it last.
struct ArchivedKeyframe {
  Reference reference;  // without pyramid
  std::uint64_t frame_sequence = 0;
  std::int64_t stamp_ns = 0;
  PinholeCamera camera;
  int levels = 0;
  cv::Mat1b image;                       // 255 = invalid
  std::optional<double> image_exposure;  // that the image shows: none at all if it was deblurred [s]

  ArchivedKeyframe(const Reference& of, const Frame& frame);
  /// As it was written down. The rest is as in the members.
  ArchivedKeyframe(Reference without_pyramid, std::uint64_t sequence, std::int64_t stamp, const PinholeCamera& of_image,
                   int pyramid_levels, const cv::Mat1b& shown, std::optional<double> exposure);
  /// What is known by now of points, pose and camera; its image is what it was.
  void update(const Reference& newer);
  /// The frame, its pyramid made anew.
  FrameConstPtr restoreFrame() const;
  /// For the tracker, with this frame's pyramid.
  std::shared_ptr<Reference> restoreReference(const FrameConstPtr& frame) const;
};

/// Which of these keyframes, by time, has neighbours that are nearest to it, in place (in units of `depth`) and view:
/// it says least that others do not say. Neither the first nor the last; there must be three.
std::size_t mostRedundant(const std::vector<const Reference*>& keyframes, double depth);

/// Keyframes of a map, those that have left the window too. Where it is full, the one goes that says least.
class KeyframeArchive {
 public:
  explicit KeyframeArchive(int max_keyframes) : max_keyframes_(static_cast<std::size_t>(max_keyframes)) {}

  /// Adds a keyframe, or replaces what is known of it.
  void add(const Reference& reference, const Frame& frame);
  void add(const ArchivedKeyframe& keyframe);
  /// Newer points and pose of a keyframe; its image is what it was. Nothing if it is not kept.
  void update(const Reference& reference);
  /// The keyframe has another image now. Nothing if it is not kept.
  void replace(const Reference& reference, const Frame& frame);
  void clear();

  const std::map<KeyframeId, ArchivedKeyframe>& keyframes() const { return keyframes_; }
  /// What they look like.
  const PlaceIndex& places() const { return places_; }

 private:
  void add(const ArchivedKeyframe& keyframe, const PlaceDescriptor& place);
  void dropMostRedundant();

  std::size_t max_keyframes_;
  std::map<KeyframeId, ArchivedKeyframe> keyframes_;
  PlaceIndex places_;
};

}  // namespace mba_vo
