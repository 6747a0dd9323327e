#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "mba_vo/odometry/tracking_loop.h"
#include "support/rendered_room.h"
#include "support/rendered_sequence.h"

namespace mba_vo::test {

inline constexpr int kFirst = 40;  // of the frames in use
inline constexpr int kCount = 16;

inline const std::vector<SimulatedFrame>& views() {
  static const std::vector<SimulatedFrame> views = renderFrames(roomConfig(), kFirst, kCount).frames;
  return views;
}

inline const SimulatedFrame& view(int index) { return views().at(static_cast<std::size_t>(index)); }
inline FrameConstPtr frame(int index) { return makeFrame(view(index), view(index).exposure); }

inline SE3 truth(int from, int to) { return view(from).T_world_mid.inverse() * view(to).T_world_mid; }

inline ExposureTrajectory trueTrajectory(int reference, int index) {
  const SimulatedFrame& v = view(index);
  return {truth(reference, index), (v.T_world_start.inverse() * v.T_world_end).log() / v.exposure, v.exposure};
}

/// Reference with true depths about a frame, at `T_map_reference`; the hint tells of frame `hint`.
inline std::shared_ptr<Reference> makeReference(MapId map, KeyframeId keyframe, int index, const SE3& T_map_reference,
                                                std::optional<int> hint = {}) {
  auto reference = makeReference(view(index), toFloat(view(index).sharp));
  reference->id = {map, keyframe, 0};
  reference->T_map_reference = T_map_reference;
  reference->T_map_keyframe = {{keyframe, T_map_reference}};
  if (hint) {
    reference->cause = ReferenceCause::kMapBegins;
    reference->hint = {view(*hint).id, view(*hint).mid_exposure_ns, trueTrajectory(index, *hint)};
  }
  return reference;
}

/// What the mapper sends when it gives up the map of `reference`.
inline ReferenceConstPtr closed(const Reference& reference, const std::string& reason) {
  auto last = std::make_shared<Reference>(reference);
  last->cause = ReferenceCause::kMapClosed;
  last->closed_because = reason;
  return last;
}

/// Takes the reference and tracks all that waited for it.
inline std::vector<TrackedFrameConstPtr> adopt(TrackingLoop& loop, const ReferenceConstPtr& reference) {
  std::vector<TrackedFrameConstPtr> late;
  if (!loop.take(reference)) return late;
  while (TrackedFrameConstPtr tracked = loop.trackWaiting()) late.push_back(std::move(tracked));
  return late;
}

inline SE3 someCorrection() {
  Vector6 correction;
  correction << 0.3, -0.2, 0.1, 0.05, 0.2, -0.1;
  return SE3::exp(correction);
}

inline double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

/// 5 mm and 5 mrad: about a pixel.
inline constexpr double kClose = 5e-3;

inline FrameConstPtr later(const cv::Mat1f& image, double seconds_later) {
  return makeFrame(image, view(kCount - 1).mid_exposure_ns + std::llround(1e9 * seconds_later), 0.02, 500);
}

/// An image of another place; no two are the same.
inline FrameConstPtr elsewhere(double seconds_later) {
  static int seed = 0;
  cv::Mat1f image(240, 376);
  cv::RNG(static_cast<std::uint64_t>(++seed)).fill(image, cv::RNG::NORMAL, 100.0, 60.0);
  cv::blur(image, image, {9, 9});
  return later(scaled(image, 4.0, -300.0), seconds_later);
}

/// Asks for keyframes early, so that a few frames are enough to leave a reference's view.
inline OdometryConfig demanding() {
  OdometryConfig config;
  config.keyframe.flow_px = 5.0;
  config.keyframe.parallax_px = 5.0;
  config.keyframe.patience = 0.0;
  return config;
}

/// T_map_odom T_odom_camera is where the camera is in the map, by its reference.
inline void expectConsistent(const TrackingLoop& loop, const TrackedFrame& tracked) {
  const SE3 T_map_camera = loop.reference()->T_map_reference * tracked.trajectory.T_reference_mid;
  EXPECT_LT(distance(loop.T_map_odom() * loop.T_odom_camera(), T_map_camera), 1e-9);
}

}  // namespace mba_vo::test
