#include "mba_vo/relocalization/keyframe_archive.h"

#include <cmath>
#include <iterator>
#include <utility>

#include "mba_vo/geometry/median.h"
#include "mba_vo/tracking/frame_measures.h"

namespace mba_vo {
namespace {

constexpr float kInvalid = 255.0F;

/// [grey levels], NaN = invalid.
cv::Mat1f toIntensity(const cv::Mat1b& image) {
  cv::Mat1f intensity;
  image.convertTo(intensity, CV_32F);
  intensity.setTo(std::nanf(""), image == kInvalid);
  return intensity;
}

}  // namespace

ArchivedKeyframe::ArchivedKeyframe(const Reference& of, const Frame& frame)
    : reference(of),
      frame_sequence(frame.sequence),
      stamp_ns(frame.stamp_ns),
      camera(of.pyramid->level(0).camera),
      levels(of.pyramid->levels()),
      image_exposure(of.pyramid->showsTheSameAs(frame.pyramid) ? of.exposure : 0.0) {
  const cv::Mat1f& original = of.pyramid->level(0).intensity;
  cv::Mat intensity;
  cv::min(original, static_cast<double>(kInvalid) - 1.0, intensity);
  const cv::Mat valid = original == original;  // NaN differs from itself
  intensity.setTo(kInvalid, ~valid);
  intensity.convertTo(image, CV_8U);
  reference.pyramid.reset();
  reference.hint.reset();
}

ArchivedKeyframe::ArchivedKeyframe(Reference without_pyramid, std::uint64_t sequence, std::int64_t stamp,
                                   const PinholeCamera& of_image, int pyramid_levels, const cv::Mat1b& shown,
                                   std::optional<double> exposure)
    : reference(std::move(without_pyramid)),
      frame_sequence(sequence),
      stamp_ns(stamp),
      camera(of_image),
      levels(pyramid_levels),
      image(shown),
      image_exposure(exposure) {}

void ArchivedKeyframe::update(const Reference& newer) {
  camera = newer.pyramid->level(0).camera;
  reference = newer;
  reference.pyramid.reset();
  reference.hint.reset();
}

FrameConstPtr ArchivedKeyframe::restoreFrame() const {
  auto frame = std::make_shared<Frame>();
  frame->sequence = frame_sequence;
  frame->stamp_ns = stamp_ns;
  frame->mid_exposure_ns = reference.mid_exposure_ns;
  frame->exposure = image_exposure;
  frame->pyramid = ImagePyramid(toIntensity(image), camera, levels);
  // Its camera has been corrected since the image was made; what only pixels can have of a correction is as it was.
  const CalibrationCorrection since = reference.image_correction.lacks(reference.correction);
  frame->correction.values = reference.image_correction.values + pinholePart(since, camera).values;
  return frame;
}

std::shared_ptr<Reference> ArchivedKeyframe::restoreReference(const FrameConstPtr& frame) const {
  auto restored = std::make_shared<Reference>(reference);
  restored->pyramid = std::shared_ptr<const ImagePyramid>(frame, &frame->pyramid);
  return restored;
}

std::size_t mostRedundant(const std::vector<const Reference*>& keyframes, double depth) {
  const auto between = [&](std::size_t first, std::size_t second) {
    const Vector6 way = (keyframes[first]->T_map_reference.inverse() * keyframes[second]->T_map_reference).log();
    return way.head<3>().norm() / depth + way.tail<3>().norm();
  };
  std::size_t redundant = 1;
  double least = HUGE_VAL;
  for (std::size_t k = 1; k + 1 < keyframes.size(); ++k) {
    const double way = between(k - 1, k) + between(k, k + 1);
    if (way >= least) continue;
    least = way;
    redundant = k;
  }
  return redundant;
}

void KeyframeArchive::add(const Reference& reference, const Frame& frame) {
  add(ArchivedKeyframe(reference, frame), PlaceDescriptor(*reference.pyramid));
}

void KeyframeArchive::add(const ArchivedKeyframe& keyframe) {
  add(keyframe, PlaceDescriptor(keyframe.restoreFrame()->pyramid));
}

void KeyframeArchive::add(const ArchivedKeyframe& keyframe, const PlaceDescriptor& place) {
  if (max_keyframes_ == 0) return;
  const KeyframeId id = keyframe.reference.id.keyframe_id;
  keyframes_.insert_or_assign(id, keyframe);
  places_.add(id, place);
  while (keyframes_.size() > max_keyframes_) dropMostRedundant();
}

void KeyframeArchive::update(const Reference& reference) {
  const auto found = keyframes_.find(reference.id.keyframe_id);
  if (found != keyframes_.end()) found->second.update(reference);
}

void KeyframeArchive::replace(const Reference& reference, const Frame& frame) {
  if (keyframes_.count(reference.id.keyframe_id) > 0) add(reference, frame);
}

void KeyframeArchive::clear() {
  keyframes_.clear();
  places_ = {};
}

void KeyframeArchive::dropMostRedundant() {
  auto redundant = keyframes_.begin();
  if (keyframes_.size() > 2) {
    std::vector<const Reference*> references;
    std::vector<double> depths;
    for (const auto& [id, keyframe] : keyframes_) {
      references.push_back(&keyframe.reference);
      depths.push_back(medianDepth(keyframe.reference));
    }
    std::advance(redundant, mostRedundant(references, median(depths)));
  }
  places_.remove(redundant->first);
  keyframes_.erase(redundant);
}

}  // namespace mba_vo
