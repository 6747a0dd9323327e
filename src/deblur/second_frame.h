#pragma once

#include <memory>

#include "mba_vo/deblur/alignment.h"
#include "mba_vo/deblur/commuted_images.h"
#include "mba_vo/deblur/deblurrer.h"
#include "mba_vo/deblur/level_problem.h"

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

  /// Chooses a neighbour by its blur and compares its image, on the level of `keyframe`, with the keyframe's. False,
  /// with the reason in use(), if none would help and fit. `depth`: of full resolution [1/m].
  bool find(const KeyframeLevel& keyframe, const cv::Mat1f& depth);
  std::unique_ptr<Observation> observe(const KeyframeLevel& keyframe) const;
  /// Whether it is explained by `latent`, the solution with it on full resolution.
  bool isExplained(const Observation& observation, const cv::Mat1f& latent);
  /// The result has been made without it after all.
  bool refuse(const char* reason);

  const NeighbourUse& use() const { return use_; }

 private:
  struct Comparison {
    CommutedImages images;
    Alignment alignment;
  };

  bool choose(const cv::Mat1f& depth);
  /// Errors of pose and depths shift the neighbour's image a little; that is measured and taken away, and what of it
  /// is still not like the keyframe is trusted less.
  bool align(const KeyframeLevel& keyframe);
  bool compare(const KeyframeLevel& keyframe, Comparison& comparison);
  double trustIn(const cv::Mat1f& variance, const cv::Mat1f& known) const;

  const DeblurInput& input_;
  const TrajectoryDeblurConfig& config_;
  float noise_;
  const DeblurNeighbour* chosen_ = nullptr;
  cv::Mat1f chosen_depth_;     // of every pixel of the neighbour [1/m]
  float chosen_noise_ = 0.0F;  // [grey levels of the keyframe]
  cv::Mat1f model_variance_;   // of what geometry does not explain in its image [grey levels^2]
  cv::Mat2f correction_;       // of where its pixels are [px of level 0]
  NeighbourUse use_;
};

}  // namespace mba_vo
