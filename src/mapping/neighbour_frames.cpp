#include "mba_vo/mapping/neighbour_frames.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace mba_vo {
namespace {

constexpr std::size_t kNeighbours = 4;  // two before the keyframe, itself, and the one after
constexpr std::uint64_t kFurthest = 2;  // [frames] from the keyframe

bool isReliable(const TrackedFrame& frame) {
  return frame.status == TrackingStatus::kTracking && !frame.provisional && frame.frame->exposure.value_or(0.0) > 0.0;
}

bool isNear(std::uint64_t a, std::uint64_t b) { return a != b && (a > b ? a - b : b - a) <= kFurthest; }

}  // namespace

void NeighbourFrames::add(const TrackedFrameConstPtr& frame) {
  const auto isSame = [&](const TrackedFrameConstPtr& known) {
    return known->frame->sequence == frame->frame->sequence;
  };
  const auto known = std::find_if(frames_.begin(), frames_.end(), isSame);
  if (known != frames_.end()) {
    *known = frame;
    return;
  }
  if (!frames_.empty() && frame->frame->mid_exposure_ns < frames_.back()->frame->mid_exposure_ns) return;
  frames_.push_back(frame);
  if (frames_.size() > kNeighbours) frames_.pop_front();
}

std::vector<DeblurNeighbour> NeighbourFrames::around(const Reference& keyframe, std::uint64_t sequence,
                                                     const LocalMap& map) const {
  std::vector<DeblurNeighbour> neighbours;
  for (const TrackedFrameConstPtr& tracked : frames_) {
    const FrameConstPtr& frame = tracked->frame;
    if (!isReliable(*tracked) || tracked->reference.map_id != map.id() || !isNear(frame->sequence, sequence)) continue;
    DeblurNeighbour neighbour;
    neighbour.image = std::shared_ptr<const ImagePyramid>(frame, &frame->pyramid);
    neighbour.sequence = frame->sequence;
    neighbour.motion = tracked->trajectory;
    neighbour.motion.T_reference_mid = keyframe.T_map_reference.inverse() * map.T_map_camera(*tracked);
    neighbour.gain = std::exp(tracked->brightness.a - keyframe.brightness.a);
    neighbour.offset = tracked->brightness.b - neighbour.gain * keyframe.brightness.b;
    neighbours.push_back(neighbour);
  }
  return neighbours;
}

}  // namespace mba_vo
