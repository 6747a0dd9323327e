#include "mba_vo/initialization/initializer_buffer.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace mba_vo {
namespace {

constexpr double kClearlySharper = 0.25;  // log of the gradient energy
constexpr std::size_t kBlindFrames = 8;   // newest tracked frames without sight of the reference: it is given up
constexpr double kMinVisible = 0.25;      // share of the corners tracked in a frame that sees the reference
constexpr std::size_t kMinFrames = 5;     // before a reference is chosen

double seconds(const BufferedImage& entry) { return entry.image->frame->midExposureSeconds(); }

}  // namespace

void InitializerBuffer::clear() {
  images_.clear();
  tracker_.reset();
  reference_ = 0;
  first_candidate_ = 0;
}

double InitializerBuffer::span() const {
  return images_.empty() ? 0.0 : seconds(images_.back()) - seconds(images_.front());
}

void InitializerBuffer::add(const FrameConstPtr& frame) {
  BufferedImage entry;
  entry.image = makeInitializerImage(frame);
  if (!images_.empty()) {
    const BufferedImage& last = images_.back();
    entry.motion = measureMotion(*last.image, *entry.image, last.motion.rotation);
    entry.log_sharpness = last.log_sharpness + entry.motion.sharpness_gain;
  }
  images_.push_back(std::move(entry));
  dropOld();
}

void InitializerBuffer::dropOld() {
  while (images_.size() > 1 && span() > seconds_) {
    images_.pop_front();
    if (first_candidate_ > 0) --first_candidate_;
    if (!tracker_) continue;
    if (reference_ == 0) tracker_.reset();
    if (reference_ > 0) --reference_;
  }
}

bool InitializerBuffer::sees(std::size_t index) const {
  const auto& tracks = images_[index].tracks;
  return tracks && tracks->count >= kMinVisible * static_cast<double>(tracker_->corners().size());
}

void InitializerBuffer::updateReference() {
  if (images_.size() < kMinFrames) return;
  if (tracker_) {
    std::size_t tracked = images_.size();  // end of the tracked frames after the reference
    while (tracked > 0 && !images_[tracked - 1].tracks) --tracked;
    std::size_t blind = 0;
    while (blind < kBlindFrames && tracked > reference_ + blind && !sees(tracked - 1 - blind)) ++blind;
    if (blind == kBlindFrames) {
      first_candidate_ = tracked - blind;
      tracker_.reset();
    }
  }
  const auto sharper = [](const BufferedImage& a, const BufferedImage& b) { return a.log_sharpness < b.log_sharpness; };
  const auto first = images_.begin() + static_cast<std::ptrdiff_t>(first_candidate_);
  const auto best = std::max_element(first, images_.end(), sharper);
  if (tracker_ && best->log_sharpness < images_[reference_].log_sharpness + kClearlySharper) return;
  setReference(static_cast<std::size_t>(best - images_.begin()));
}

void InitializerBuffer::setReference(std::size_t index) {
  reference_ = index;
  tracker_ = std::make_unique<ReferenceTracker>(images_[index].image, max_corners_);
  for (BufferedImage& entry : images_) entry.tracks.reset();
  images_[index].tracks = tracker_->identity();
}

Eigen::Vector3d InitializerBuffer::exposureRotation(std::size_t index) const {
  const double exposure = images_[index].image->frame->exposure.value_or(0.0);
  const bool first = index == 0;
  const bool last = index + 1 == images_.size();
  if (first && last) return Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  if (!first) rotation += images_[index].motion.rotation;
  if (!last) rotation += images_[index + 1].motion.rotation;
  const double elapsed = seconds(images_[last ? index : index + 1]) - seconds(images_[first ? index : index - 1]);
  return std::min(1.0, exposure / elapsed) * rotation;
}

double InitializerBuffer::blurLength(std::size_t index) const {
  const InitializerImage& image = *images_[index].image;
  const Eigen::Vector2d centre(0.5 * image.camera.width, 0.5 * image.camera.height);
  const Eigen::Matrix3d H = rotationHomography(image.camera, exposureRotation(index));
  return static_cast<double>(1 << image.level) * (applyHomography(H, centre) - centre).norm();
}

bool InitializerBuffer::trackOne(std::size_t index, std::size_t neighbour) {
  if (images_[index].tracks || !images_[neighbour].tracks) return false;
  const bool forwards = index > neighbour;
  const Eigen::Matrix3d& H = images_[forwards ? index : neighbour].motion.H_next_previous;
  const Eigen::Matrix3d H_image_neighbour = forwards ? H : Eigen::Matrix3d(H.inverse());
  images_[index].tracks =
      tracker_->track(*images_[index].image, *images_[neighbour].tracks, H_image_neighbour, exposureRotation(index));
  return true;
}

void InitializerBuffer::updateTracks(int max_images) {
  if (!tracker_) return;
  int tracked = 0;
  for (std::size_t i = reference_ + 1; i + 1 < images_.size() && tracked < max_images; ++i) {
    if (trackOne(i, i - 1)) ++tracked;
  }
  for (std::size_t i = reference_; i > 0 && tracked < max_images; --i) {
    if (trackOne(i - 1, i)) ++tracked;
  }
}

}  // namespace mba_vo
