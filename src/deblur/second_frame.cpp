#include "second_frame.h"

#include <algorithm>
#include <limits>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "mba_vo/deblur/alignment.h"
#include "mba_vo/deblur/commuted_images.h"
#include "mba_vo/deblur/neighbour_choice.h"
#include "mba_vo/geometry/median.h"
#include "mba_vo/image/image_noise.h"

namespace mba_vo {
namespace {

constexpr double kLeastGain = 0.5;         // expected, below which it is not worth the time [dB]
constexpr std::size_t kFewestBlocks = 16;  // that tell whether it is aligned
constexpr int kCorrections = 2;            // each from the shifts that the one before has left
constexpr double kLeastTrust = 0.2;        // share of its information below which it is not worth the time
constexpr double kLeastOverlap = 0.3;      // of the keyframe's pixels
constexpr float kNoLimit = std::numeric_limits<float>::infinity();

BlurGeometry ownGeometry(const DeblurInput& input) {
  const PinholeCamera& camera = input.image->level(0).camera;
  return {camera, camera, input.motion, input.motion.velocity};
}

/// From one value per block to one per pixel.
cv::Mat2f byPixel(const cv::Mat2f& blocks, cv::Size size) {
  cv::Mat2f pixels;
  cv::resize(blocks, pixels, blocks.size() * Alignment::kBlock, 0.0, 0.0, cv::INTER_LINEAR);
  return pixels(cv::Rect({0, 0}, size)).clone();
}

}  // namespace

bool SecondFrame::refuse(const char* reason) {
  use_.sequence.reset();
  use_.reason = reason;
  return false;
}

bool SecondFrame::choose(const cv::Mat1f& depth) {
  if (config_.frames < 2) return refuse("not wanted");
  if (input_.neighbours.empty()) return refuse("no neighbour");
  const std::optional<NeighbourChoice> choice = chooseNeighbour(ownGeometry(input_), depth, noise_, input_.neighbours);
  if (!choice) return refuse("no usable neighbour");
  use_.expected_gain_db = static_cast<float>(choice->gain_db);
  if (choice->gain_db < kLeastGain) return refuse("blurred alike");
  chosen_ = &input_.neighbours[choice->index];
  chosen_depth_ = denseInverseDepth(*chosen_, input_.image->level(0).camera, input_.depths);
  if (chosen_depth_.empty()) return refuse("no depths");
  chosen_noise_ = estimateNoise(chosen_->image->level(0).intensity) / static_cast<float>(chosen_->gain);
  return true;
}

std::unique_ptr<Observation> SecondFrame::observe(const KeyframeLevel& keyframe) const {
  const PinholeCamera& camera = input_.image->level(keyframe.level).camera;
  const BlurGeometry own{camera, camera, input_.motion, input_.motion.velocity};
  NeighbourLevel neighbour{chosen_, keyframe.level, geometryOf(*chosen_, keyframe.level, own), {}};
  if (!correction_.empty()) neighbour.correction = cv::Mat2f(correction_ / static_cast<double>(1 << keyframe.level));
  cv::Mat1f depth = chosen_depth_;
  const cv::Size size = chosen_->image->level(keyframe.level).intensity.size();
  if (size != depth.size()) cv::resize(chosen_depth_, depth, size, 0.0, 0.0, cv::INTER_AREA);
  auto observation = std::make_unique<Observation>(neighbour.geometry, keyframe.depth, keyframe.problem->grid(),
                                                   overlay(neighbour, keyframe.depth, depth), chosen_noise_, kNoLimit);
  if (!model_variance_.empty()) observation->distrust(model_variance_);
  return observation;
}

bool SecondFrame::compare(const KeyframeLevel& keyframe, Comparison& comparison) {
  const Observation& own = keyframe.problem->keyframe();
  comparison.images = commute(own, *observe(keyframe));
  const double overlap = cv::sum(comparison.images.known)[0] / std::max(1, own.pixels());
  if (overlap < kLeastOverlap) return refuse("looks elsewhere");
  const CommutedImages& images = comparison.images;
  comparison.alignment = measureAlignment(images.keyframe, images.neighbour, images.known);
  return true;
}

bool SecondFrame::align(const KeyframeLevel& keyframe) {
  const auto scale = static_cast<float>(1 << keyframe.level);
  Comparison comparison;
  for (int i = 0; i < kCorrections; ++i) {
    if (!compare(keyframe, comparison)) return false;
    if (i == 0) {
      std::vector<float> shifts = comparison.alignment.knownShifts();
      if (shifts.size() < kFewestBlocks) return refuse("too little to see whether it is aligned");
      use_.shift_px = scale * median(shifts);
      if (use_.shift_px > static_cast<float>(config_.max_misalignment_px)) return refuse("misaligned");
    }
    const cv::Size size = input_.image->level(keyframe.level).intensity.size();
    const cv::Mat2f change(byPixel(smoothShifts(comparison.alignment), size) * static_cast<double>(-scale));
    correction_ = correction_.empty() ? change : cv::Mat2f(correction_ + change);
  }
  if (!compare(keyframe, comparison)) return false;
  const cv::Mat1f variance = modelVariance(comparison.images, noise_, chosen_noise_);
  if (trustIn(variance, comparison.images.known) < kLeastTrust) return refuse("not like the keyframe");
  model_variance_ = variance;
  return true;
}

/// Share of the neighbour's information that is left.
double SecondFrame::trustIn(const cv::Mat1f& variance, const cv::Mat1f& known) const {
  const double noise = static_cast<double>(chosen_noise_ * chosen_noise_);
  cv::Mat1f trust;
  cv::divide(noise, cv::Mat1f(variance + noise), trust);
  return trust.dot(known) / std::max(1.0, cv::sum(known)[0]);
}

bool SecondFrame::find(const KeyframeLevel& keyframe, const cv::Mat1f& depth) {
  if (!choose(depth)) return false;
  if (chosen_->image->levels() <= keyframe.level) return refuse("no coarser level");
  return align(keyframe);
}

bool SecondFrame::isExplained(const Observation& observation, const cv::Mat1f& latent) {
  use_.residual = observation.residual(latent);
  if (!(use_.residual < static_cast<float>(config_.max_residual))) return refuse("not explained by the result");
  use_.sequence = chosen_->sequence;
  return true;
}

}  // namespace mba_vo
