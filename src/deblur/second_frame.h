#pragma once

#include <memory>

#include "level_problem.h"
#include "mba_vo/deblur/deblurrer.h"

namespace mba_vo {

/// The keyframe as one of its levels sees it.
struct KeyframeLevel {
  int level;
  const LevelProblem* problem;
  cv::Mat1f depth;  // of every pixel [1/m]
};

/// The neighbour that helps most with a keyframe, if its image fits.
class SecondFrame {
 public:
  /// `noise`: of the keyframe [grey levels].
  SecondFrame(const DeblurInput& input, const TrajectoryDeblurConfig& config, float noise)
      : input_(input), config_(config), noise_(noise) {}

  /// Chooses a neighbour by the full-resolution `depth` [1/m]. False, with the reason in use(), if none would help.
  bool choose(const cv::Mat1f& depth);
  /// Whether it is where `latent`, the solution of that level without it, blurred along its path, says. Blocks that
  /// are not are left out from then on.
  bool fits(const KeyframeLevel& keyframe, const cv::Mat1f& latent);
  std::unique_ptr<Observation> observe(const KeyframeLevel& keyframe) const;
  /// Whether it is explained by the solution with it on full resolution.
  bool explained(const Observation& observation, const cv::Mat1f& latent);

  const NeighbourUse& use() const { return use_; }

 private:
  bool refuse(const char* reason);
  void leaveOutMisaligned(int level, Observation& observation) const;

  const DeblurInput& input_;
  const TrajectoryDeblurConfig& config_;
  float noise_;
  const DeblurNeighbour* chosen_ = nullptr;
  cv::Mat1f chosen_depth_;     // of every pixel of the neighbour [1/m]
  float chosen_noise_ = 0.0F;  // [grey levels of the keyframe]
  cv::Mat1b misaligned_;       // by block of `checked_level_`
  int checked_level_ = 0;
  NeighbourUse use_;
};

}  // namespace mba_vo
