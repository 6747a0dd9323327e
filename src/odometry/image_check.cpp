#include "mba_vo/odometry/image_check.h"

#include "mba_vo/image/image_content.h"

namespace mba_vo {
namespace {

constexpr double kLongestRepeat = 0.15;  // [s]

}  // namespace

std::string ImageCheck::problemOf(const FrameConstPtr& frame) {
  repeated_ = first_ && isRepeated(first_->pyramid, frame->pyramid);
  if (!repeated_) first_ = frame;
  if (!hasContent(frame->pyramid)) return "the image shows nothing: black, saturated, or the lens is covered";
  const double same = 1e-9 * static_cast<double>(frame->mid_exposure_ns - first_->mid_exposure_ns);
  return same > kLongestRepeat ? "the image has been the same for too long: frozen" : "";
}

}  // namespace mba_vo
