#include "mba_vo/relocalization/keyframe_archive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

constexpr int kWidth = 48;     // [px] most of a thumbnail
constexpr double kBlur = 1.2;  // [px]
constexpr int kStep = 2;       // [px] of the search, refined afterwards
constexpr float kInvalid = 255.0F;

/// [grey levels], NaN = invalid.
cv::Mat1f toIntensity(const cv::Mat1b& image) {
  cv::Mat1f intensity;
  image.convertTo(intensity, CV_32F);
  intensity.setTo(std::nanf(""), image == kInvalid);
  return intensity;
}

}  // namespace

Thumbnail::Thumbnail(const ImagePyramid& pyramid) {
  int level = 0;
  while (level + 1 < pyramid.levels() && pyramid.level(level).intensity.cols > kWidth) ++level;
  px_per_pixel_ = static_cast<double>(1 << level);
  image_ = pyramid.level(level).intensity.clone();
  const cv::Mat valid = image_ == image_;  // NaN differs from itself
  image_.setTo(static_cast<float>(cv::mean(image_, valid)[0]), ~valid);
  cv::GaussianBlur(image_, image_, {}, kBlur);
}

double Thumbnail::correlation(const Thumbnail& other, const cv::Point& shift) const {
  const cv::Rect here = cv::Rect({0, 0}, image_.size()) & (cv::Rect({0, 0}, other.image_.size()) - shift);
  if (here.width < image_.cols / 2 || here.height < image_.rows / 2) return -1.0;
  const cv::Mat1f a = image_(here);
  const cv::Mat1f b = other.image_(here + shift);
  cv::Scalar mean_a, mean_b, sigma_a, sigma_b;
  cv::meanStdDev(a, mean_a, sigma_a);
  cv::meanStdDev(b, mean_b, sigma_b);
  const double scatter = sigma_a[0] * sigma_b[0];
  if (!(scatter > 0.0)) return -1.0;
  return (a.dot(b) / static_cast<double>(a.total()) - mean_a[0] * mean_b[0]) / scatter;
}

Thumbnail::Match Thumbnail::compare(const Thumbnail& other) const {
  Match best;
  if (image_.empty() || image_.size() != other.image_.size()) return best;
  cv::Point at;
  const auto search = [&](const cv::Point& centre, const cv::Point& range, int step) {
    for (int y = centre.y - range.y; y <= centre.y + range.y; y += step) {
      for (int x = centre.x - range.x; x <= centre.x + range.x; x += step) {
        const double value = correlation(other, {x, y});
        if (value <= best.correlation) continue;
        best.correlation = value;
        at = {x, y};
      }
    }
  };
  search({0, 0}, {image_.cols / 3 / kStep * kStep, image_.rows / 3 / kStep * kStep}, kStep);
  search(at, {kStep - 1, kStep - 1}, 1);
  best.shift_px = px_per_pixel_ * Eigen::Vector2d(at.x, at.y);
  return best;
}

ArchivedKeyframe::ArchivedKeyframe(const Reference& of, const Frame& frame)
    : reference(of),
      frame_sequence(frame.sequence),
      stamp_ns(frame.stamp_ns),
      camera(of.pyramid->level(0).camera),
      levels(of.pyramid->levels()),
      image_exposure(of.pyramid->showsTheSameAs(frame.pyramid) ? of.exposure : 0.0),
      thumbnail(*of.pyramid) {
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
      image_exposure(exposure),
      thumbnail(ImagePyramid(toIntensity(image), camera, levels)) {}

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

void KeyframeArchive::add(const ArchivedKeyframe& keyframe) {
  keyframes_.insert_or_assign(keyframe.reference.id.keyframe_id, keyframe);
  while (keyframes_.size() > max_keyframes_) dropMostRedundant();
}

void KeyframeArchive::update(const Reference& reference) {
  const auto found = keyframes_.find(reference.id.keyframe_id);
  if (found != keyframes_.end()) found->second.update(reference);
}

void KeyframeArchive::replace(const Reference& reference, const Frame& frame) {
  if (keyframes_.count(reference.id.keyframe_id) > 0) add(reference, frame);
}

void KeyframeArchive::dropMostRedundant() {
  auto redundant = keyframes_.begin();
  double most_alike = -2.0;
  for (auto k = keyframes_.begin(); k != keyframes_.end() && std::next(k) != keyframes_.end(); ++k) {
    const double alike = k->second.thumbnail.correlation(std::next(k)->second.thumbnail, {0, 0});
    if (alike <= most_alike) continue;
    most_alike = alike;
    redundant = k;
  }
  keyframes_.erase(redundant);
}

}  // namespace mba_vo
