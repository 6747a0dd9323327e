#pragma once

#include <cmath>
#include <memory>

#include "mba_vo/deblur/deblurrer.h"
#include "support/rendered_room.h"

namespace mba_vo::test {

constexpr double kTwoFramesExposure = 0.02;  // [s]

inline double psnr(const cv::Mat1f& image, const cv::Mat1b& truth) {
  const cv::Mat1f difference(image - toFloat(truth));
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(difference.total()) / difference.dot(difference));
}

/// A keyframe of the room and a frame near it, each blurred by the renderer along a motion of its own.
struct TwoFrames {
  SimulatedFrame keyframe, neighbour;
  DeblurInput input;  // with the true motions and depths
};

inline std::shared_ptr<const ImagePyramid> pyramidOf(const cv::Mat1f& image) {
  return std::make_shared<const ImagePyramid>(image, roomSimulator().camera(), 3);
}

inline TwoFrames makeTwoFrames(const Vector6& velocity, const SE3& T_keyframe_neighbour,
                               const Vector6& neighbour_velocity) {
  TwoFrames frames;
  const SE3 origin = roomSimulator().pose(1.0);
  frames.keyframe = roomSimulator().renderExposure(constantVelocity(origin, velocity), 0.0, kTwoFramesExposure, 1);
  frames.neighbour = roomSimulator().renderExposure(constantVelocity(origin * T_keyframe_neighbour, neighbour_velocity),
                                                    0.0, kTwoFramesExposure, 2);
  frames.input.image = pyramidOf(toFloat(frames.keyframe.blurred));
  frames.input.motion = {SE3(), velocity, kTwoFramesExposure};
  const cv::Mat1f& depth = frames.keyframe.depth;
  for (int y = 4; y < depth.rows; y += 7) {
    for (int x = 4; x < depth.cols; x += 7) {
      frames.input.depths.push_back({{static_cast<float>(x), static_cast<float>(y)}, 1.0F / depth(y, x)});
    }
  }
  DeblurNeighbour neighbour;
  neighbour.image = pyramidOf(toFloat(frames.neighbour.blurred));
  neighbour.sequence = 42;
  neighbour.motion = {T_keyframe_neighbour, neighbour_velocity, kTwoFramesExposure};
  frames.input.neighbours.push_back(neighbour);
  return frames;
}

/// Turned and moved on a little, as from one frame to the next.
inline SE3 nextFrame() { return SE3::exp((Vector6() << 0.03, -0.01, 0.02, 0.015, -0.02, 0.06).finished()); }

/// Some 12 px of blur sideways in one image, and up in the other.
inline const TwoFrames& crossedFrames() {
  static const TwoFrames frames = makeTwoFrames((Vector6() << 0.1, 0.2, 0.1, 0.1, 2.8, 0.3).finished(), nextFrame(),
                                                (Vector6() << 0.1, 0.1, 0.1, 2.8, 0.2, -0.3).finished());
  return frames;
}

/// Exact inverse depth of every pixel of the keyframe [1/m].
inline cv::Mat1f trueInverseDepth(const SimulatedFrame& frame) {
  cv::Mat1f inverse;
  cv::divide(1.0, frame.depth, inverse);
  return inverse;
}

inline BlurGeometry geometryOf(const TwoFrames& frames) {
  const PinholeCamera camera = roomSimulator().camera();
  return {camera, camera, frames.input.neighbours[0].motion, frames.input.motion.velocity};
}

}  // namespace mba_vo::test
