#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "mba_vo/image/image_pyramid.h"
#include "mba_vo/tracking/reference.h"

namespace mba_vo {

/// What a view looks like, in so few pixels that motion blur of a tenth of the image hardly changes it: the image in
/// 32 x 20 pixels, and in 16 x 10. 3.4 KB.
struct PlaceDescriptor {
  static constexpr int kWidth = 16, kHeight = 10;  // [px] coarse; the finer one has twice as many
  static constexpr int kPixels = kWidth * kHeight;
  /// Views are compared at shifts of an even number of coarse pixels, up to 6 to the sides and 4 up and down: the
  /// camera may have turned.
  static constexpr int kShiftsX = 7, kShiftsY = 5;
  static constexpr int kShifts = kShiftsX * kShiftsY;

  explicit PlaceDescriptor(const ImagePyramid& pyramid);

  std::array<float, kPixels> coarse;
  std::array<float, 4 * kPixels> fine;
  /// By shift: 1 / the norm of what is left of `coarse` when the other view is shifted, its mean removed; 0 where
  /// nothing is to be seen there.
  std::array<float, kShifts> inverse_norm;
  float px_per_pixel_x, px_per_pixel_y;  // of a coarse pixel [px of the finest level]
};

/// A keyframe that looks like a view.
struct PlaceCandidate {
  KeyframeId keyframe = 0;
  double correlation = -1.0;                           // of the finer images at the best shift
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  // what is here in the view, is there + shift in the keyframe
};

/// Descriptors of keyframes, all of which are compared with a view.
class PlaceIndex {
 public:
  void add(KeyframeId keyframe, const PlaceDescriptor& descriptor);
  void remove(KeyframeId keyframe);
  std::size_t size() const { return keyframes_.size(); }

  /// The `most` keyframes, of those that are wanted, that look most like the view, the likest first.
  std::vector<PlaceCandidate> search(const PlaceDescriptor& view, std::size_t most,
                                     const std::function<bool(KeyframeId)>& isWanted) const;

  static constexpr std::size_t kLanes = 16;

 private:
  /// The coarse images of 16 keyframes, interleaved: sums over their pixels then need no rearrangement.
  struct Block {
    std::array<float, PlaceDescriptor::kPixels * kLanes> pixels{};
    std::array<float, PlaceDescriptor::kShifts * kLanes> inverse_norms{};
  };
  struct Entry {
    KeyframeId keyframe;
    std::array<float, 4 * PlaceDescriptor::kPixels> fine;
  };
  void put(std::size_t place, const PlaceDescriptor& descriptor);
  void move(std::size_t from, std::size_t to);

  std::vector<Entry> keyframes_;
  std::vector<Block> blocks_;
};

}  // namespace mba_vo
