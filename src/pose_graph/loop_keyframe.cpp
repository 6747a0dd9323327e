#include "mba_vo/pose_graph/loop_keyframe.h"

namespace mba_vo {
namespace {

constexpr int kWidest = 400;     // [px] of an image that is kept
constexpr int kLeastLevels = 3;  // that are left to align it with

}  // namespace

ArchivedKeyframeConstPtr archiveForLoops(const Reference& reference, const Frame& frame) {
  const ImagePyramid& pyramid = *reference.pyramid;
  int level = 0;
  while (pyramid.level(level).intensity.cols > kWidest && pyramid.levels() - level > kLeastLevels) ++level;
  if (level == 0) return std::make_shared<const ArchivedKeyframe>(reference, frame);
  const ImageLevel& image = pyramid.level(level);
  Reference smaller = reference;
  Frame shown;
  shown.sequence = frame.sequence;
  shown.stamp_ns = frame.stamp_ns;
  // The constructor asks whether both show the same image.
  shown.pyramid = ImagePyramid(image.intensity, image.camera, pyramid.levels() - level, image.gain);
  smaller.pyramid = pyramid.showsTheSameAs(frame.pyramid)
                        ? std::make_shared<const ImagePyramid>(shown.pyramid)
                        : std::make_shared<const ImagePyramid>(image.intensity.clone(), image.camera,
                                                               pyramid.levels() - level, image.gain);
  const float shrink = 1.0F / static_cast<float>(1 << level);
  // Pixel centres are at integers.
  for (ReferencePoint& point : smaller.points) point.pixel = (point.pixel.array() + 0.5F) * shrink - 0.5F;
  return std::make_shared<const ArchivedKeyframe>(smaller, shown);
}

ArchivedKeyframeConstPtr archiveForLoops(const ArchivedKeyframe& keyframe) {
  const FrameConstPtr frame = keyframe.restoreFrame();
  return archiveForLoops(*keyframe.restoreReference(frame), *frame);
}

std::size_t bytesOf(const ArchivedKeyframe& keyframe) {
  return sizeof(ArchivedKeyframe) + keyframe.image.total() +
         keyframe.reference.points.capacity() * sizeof(ReferencePoint) +
         keyframe.reference.T_map_keyframe.size() * sizeof(std::pair<const KeyframeId, SE3>);
}

}  // namespace mba_vo
