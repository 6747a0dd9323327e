#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/mapping/mapper.h"
#include "support/rendered_sequence.h"

namespace mba_vo::test {

inline constexpr int kFrames = 80;

/// Sharp images are enough to tell what the mapper does with its input.
inline const std::vector<FrameConstPtr>& frames() {
  static const std::vector<FrameConstPtr> frames = toFrames(renderFrames(sequenceConfig(0.0), 0, kFrames), true, 0.0);
  return frames;
}

inline MapperConfig config() {
  MapperConfig c;
  c.deterministic = true;
  return c;
}

inline TrackedFrameConstPtr report(const FrameConstPtr& frame, TrackingStatus status, const ReferenceId& reference = {},
                                   const SE3& T_reference_mid = {}) {
  auto tracked = std::make_shared<TrackedFrame>();
  tracked->frame = frame;
  tracked->status = status;
  tracked->reference = reference;
  tracked->trajectory.T_reference_mid = T_reference_mid;
  return tracked;
}

/// Frames of other times: the same images, `seconds` later.
inline FrameConstPtr shifted(const FrameConstPtr& frame, double seconds) {
  auto copy = std::make_shared<Frame>(*frame);
  copy->sequence += 1000;
  copy->mid_exposure_ns += std::llround(1e9 * seconds);
  copy->stamp_ns = copy->mid_exposure_ns;
  return copy;
}

/// The same time and another place: an image that no keyframe looks like.
inline FrameConstPtr elsewhere(const FrameConstPtr& frame) {
  auto copy = std::make_shared<Frame>(*frame);
  cv::Mat1f mirrored;
  cv::flip(frame->pyramid.level(0).intensity, mirrored, -1);
  copy->pyramid = ImagePyramid(mirrored, frame->pyramid.level(0).camera, frame->pyramid.levels());
  return copy;
}

/// With all that is done about a keyframe that comes of it.
inline MapperOutput whole(Mapper& mapper, const TrackedFrameConstPtr& frame) {
  MapperOutput output = mapper.process(frame);
  while (mapper.needsRefinement()) output = mapper.refine();
  return output;
}

struct Initialised {
  MapperOutput output;
  int frames_used = 0;
};

/// Feeds images that no tracker could track, until there is a map.
inline Initialised beginMap(Mapper& mapper, const std::vector<FrameConstPtr>& images) {
  Initialised result;
  for (const FrameConstPtr& frame : images) {
    ++result.frames_used;
    result.output = mapper.process(report(frame, TrackingStatus::kInitializing));
    if (result.output.reference) return result;
  }
  ADD_FAILURE() << "no map: " << result.output.message;
  return result;
}

/// And until that is finished, with its second keyframe. The output is that of its beginning.
inline Initialised initialise(Mapper& mapper, const std::vector<FrameConstPtr>& images) {
  const Initialised result = beginMap(mapper, images);
  while (mapper.needsRefinement()) mapper.refine();
  return result;
}

inline Initialised initialise(Mapper& mapper, double shift = 0.0) {
  std::vector<FrameConstPtr> images;
  for (const FrameConstPtr& frame : frames()) images.push_back(shift == 0.0 ? frame : shifted(frame, shift));
  return initialise(mapper, images);
}

}  // namespace mba_vo::test
