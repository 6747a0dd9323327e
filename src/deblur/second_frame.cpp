#include "second_frame.h"

#include <limits>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "mba_vo/deblur/alignment.h"
#include "mba_vo/deblur/image_noise.h"
#include "mba_vo/deblur/neighbour_choice.h"

namespace mba_vo {
namespace {

constexpr double kLeastGain = 0.5;     // expected, below which it is not worth the time [dB]
constexpr int kFewestBlocks = 8;       // that tell whether it is aligned
constexpr double kLeastOverlap = 0.3;  // of the keyframe's pixels
constexpr float kNoLimit = std::numeric_limits<float>::infinity();

BlurGeometry ownGeometry(const DeblurInput& input) {
  const PinholeCamera& camera = input.image->level(0).camera;
  return {camera, camera, input.motion, input.motion.velocity};
}

}  // namespace

bool SecondFrame::refuse(const char* reason) {
  use_.reason = reason;
  return false;
}

bool SecondFrame::choose(const cv::Mat1f& depth) {
  if (config_.frames < 2) return refuse("not wanted");
  if (input_.image->levels() < 2) return refuse("no coarser level");
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
  const NeighbourLevel neighbour{chosen_, keyframe.level, geometryOf(*chosen_, keyframe.level, own)};
  cv::Mat1f depth = chosen_depth_;
  const cv::Size size = chosen_->image->level(keyframe.level).intensity.size();
  if (size != depth.size()) cv::resize(chosen_depth_, depth, size, 0.0, 0.0, cv::INTER_AREA);
  auto observation = std::make_unique<Observation>(neighbour.geometry, keyframe.depth, keyframe.problem->grid(),
                                                   overlay(neighbour, keyframe.depth, depth), chosen_noise_, kNoLimit);
  leaveOutMisaligned(keyframe.level, *observation);
  return observation;
}

void SecondFrame::leaveOutMisaligned(int level, Observation& observation) const {
  const int block = Alignment::kBlock << (checked_level_ - level);
  for (int r = 0; r < misaligned_.rows; ++r) {
    for (int c = 0; c < misaligned_.cols; ++c) {
      if (misaligned_(r, c) != 0) observation.ignore({block * c, block * r, block, block});
    }
  }
}

bool SecondFrame::fits(const KeyframeLevel& keyframe, const cv::Mat1f& latent) {
  const std::unique_ptr<Observation> observation = observe(keyframe);
  if (observation->pixels() < kLeastOverlap * keyframe.problem->keyframe().pixels()) return refuse("looks elsewhere");
  cv::Mat1f predicted;
  observation->blur().apply(latent, predicted);
  const auto scale = static_cast<float>(1 << keyframe.level);
  const auto limit = static_cast<float>(config_.max_misalignment_px);
  const Alignment alignment =
      measureAlignment(predicted, observation->data().image, observation->data().weight, 2.0F * limit / scale);
  if (alignment.blocks < kFewestBlocks) return refuse("too little to see whether it is aligned");
  use_.shift_px = scale * alignment.shift_px;
  if (use_.shift_px > limit) return refuse("misaligned");
  misaligned_ = alignment.misaligned;
  checked_level_ = keyframe.level;
  return true;
}

bool SecondFrame::explained(const Observation& observation, const cv::Mat1f& latent) {
  use_.residual = observation.residual(latent);
  if (!(use_.residual < static_cast<float>(config_.max_residual))) return refuse("not explained by the result");
  use_.sequence = chosen_->sequence;
  return true;
}

}  // namespace mba_vo
