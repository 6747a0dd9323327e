#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/image/frame.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// A small, blurred, brightness-free version of an image, by which views are compared.
class Thumbnail {
 public:
  explicit Thumbnail(const ImagePyramid& pyramid);

  struct Match {
    double correlation = -1.0;                           // of the best shift
    Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  // what is here, is there + shift [px of the finest level]
  };
  /// The shift, at most half the image, at which the two are most alike.
  Match compare(const Thumbnail& other) const;
  /// Of the pixels p here and p + shift there; -1 if they have less than half the image in common.
  double correlation(const Thumbnail& other, const cv::Point& shift) const;

 private:
  cv::Mat1f image_;
  double px_per_pixel_ = 1.0;
};

/// A keyframe as the archive keeps it: the image in 8 bits, everything else as the tracker had it last.
struct ArchivedKeyframe {
  Reference reference;  // without pyramid
  std::uint64_t frame_sequence = 0;
  std::int64_t stamp_ns = 0;
  PinholeCamera camera;
  int levels = 0;
  cv::Mat1b image;                       // 255 = invalid
  std::optional<double> image_exposure;  // that the image shows: none at all if it was deblurred [s]
  Thumbnail thumbnail;

  ArchivedKeyframe(const Reference& of, const Frame& frame);
  /// As it was written down. The rest is as in the members.
  ArchivedKeyframe(Reference without_pyramid, std::uint64_t frame_sequence, std::int64_t stamp_ns,
                   const PinholeCamera& camera, int levels, const cv::Mat1b& image,
                   std::optional<double> image_exposure);
  /// What is known by now of points, pose and camera; its image is what it was.
  void update(const Reference& newer);
  /// The frame, its pyramid made anew.
  FrameConstPtr restoreFrame() const;
  /// For the tracker, with this frame's pyramid.
  std::shared_ptr<Reference> restoreReference(const FrameConstPtr& frame) const;
};

/// Keyframes of a map, those that have left the window too. Where it is full, the one goes that looks most like
/// another.
class KeyframeArchive {
 public:
  explicit KeyframeArchive(int max_keyframes) : max_keyframes_(static_cast<std::size_t>(max_keyframes)) {}

  /// Adds a keyframe, or replaces what is known of it.
  void add(const Reference& reference, const Frame& frame) { add(ArchivedKeyframe(reference, frame)); }
  void add(const ArchivedKeyframe& keyframe);
  /// Newer points and pose of a keyframe; its image is what it was. Nothing if it is not kept.
  void update(const Reference& reference);
  /// The keyframe has another image now. Nothing if it is not kept.
  void replace(const Reference& reference, const Frame& frame);
  void clear() { keyframes_.clear(); }

  const std::map<KeyframeId, ArchivedKeyframe>& keyframes() const { return keyframes_; }

 private:
  void dropMostRedundant();

  std::size_t max_keyframes_;
  std::map<KeyframeId, ArchivedKeyframe> keyframes_;
};

}  // namespace mba_vo
