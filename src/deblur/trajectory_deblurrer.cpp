#include "mba_vo/deblur/trajectory_deblurrer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "mba_vo/deblur/level_problem.h"
#include "mba_vo/image/image_noise.h"
#include "path_statistics.h"
#include "second_frame.h"

namespace mba_vo {
namespace {

constexpr float kLongestReach = 150.0F;  // of a path from its pixel [px]

DeblurResult leaveAs(DeblurResult result, const char* reason) {
  result.reason = reason;
  return result;
}

/// Light is not negative, and no brighter than the camera can see. What is not valid stays so.
void bound(const ImageLevel& input, cv::Mat1f& image) {
  const auto white = static_cast<float>(255.0 * input.gain);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const float before = input.intensity(y, x);
      image(y, x) = std::isfinite(before) ? std::clamp(image(y, x), 0.0F, std::max(white, before)) : before;
    }
  }
}

HalfQuadraticConfig solverConfig(const TrajectoryDeblurConfig& config) {
  HalfQuadraticConfig solver;
  solver.prior_weight = static_cast<float>(config.prior_weight);
  solver.steps = config.steps;
  solver.iterations = config.iterations;
  return solver;
}

/// The equations of one keyframe, and how they are solved: on half the resolution first, with a second frame if it
/// fits.
class Solution {
 public:
  Solution(const DeblurInput& input, const TrajectoryDeblurConfig& config, const cv::Mat1f& depth, float reach)
      : input_(input),
        solver_(solverConfig(config)),
        max_residual_(static_cast<float>(config.max_residual)),
        reach_(reach),
        noise_(estimateNoise(input.image->level(0).intensity)),
        problem_(input.image->level(0), input.motion, depth, reach, noise_),
        fine_{0, &problem_, depth},
        second_(input, config, noise_) {}

  void run() {
    if (input_.image->levels() == 1) {
      second_.refuse("no coarser level");
      latent_ = problem_.blurredStart();
      problem_.solve(solver_, nullptr, latent_);
      return;
    }
    const ImageLevel& level = input_.image->level(1);
    cv::Mat1f depth;
    cv::resize(fine_.depth, depth, level.intensity.size(), 0.0, 0.0, cv::INTER_AREA);
    const LevelProblem problem(level, input_.motion, depth, 0.5F * reach_, noise_);
    const KeyframeLevel coarse{1, &problem, depth};
    if (second_.find(coarse, fine_.depth) && solve(coarse, true)) return;
    solve(coarse, false);
  }

  float residual() const { return problem_.keyframe().residual(latent_); }
  cv::Mat1f image() const { return problem_.image(latent_); }
  const NeighbourUse& neighbour() const { return second_.use(); }

 private:
  /// False if the second frame is not explained by the solution, or the keyframe no longer is.
  bool solve(const KeyframeLevel& coarse, bool with_second) {
    cv::Mat1f solution = coarse.problem->blurredStart();
    const auto coarse_second = with_second ? second_.observe(coarse) : nullptr;
    coarse.problem->solve(solver_, coarse_second.get(), solution);
    latent_ = problem_.startFrom(*coarse.problem, solution);
    const auto second = with_second ? second_.observe(fine_) : nullptr;
    problem_.solve(solver_, second.get(), latent_);
    if (!with_second) return true;
    if (!second_.isExplained(*second, latent_)) return false;
    return residual() < max_residual_ || second_.refuse("the keyframe is not explained with it");
  }

  const DeblurInput& input_;
  HalfQuadraticConfig solver_;
  float max_residual_;
  float reach_;
  float noise_;
  LevelProblem problem_;
  KeyframeLevel fine_;
  SecondFrame second_;
  cv::Mat1f latent_;
};

}  // namespace

DeblurResult TrajectoryDeblurrer::deblur(const DeblurInput& input) const {
  DeblurResult result;
  result.image = input.image;
  const ImageLevel& level = input.image->level(0);
  const cv::Mat1f depth = denseInverseDepth(level.camera, input.depths);
  if (depth.empty()) return leaveAs(std::move(result), "no depths");
  const PathStatistics paths = measurePaths(input, depth);
  result.blur_px = paths.median;
  if (paths.median < static_cast<float>(config_.min_blur_px)) return leaveAs(std::move(result), "sharp enough");
  if (paths.disagreement > static_cast<float>(config_.max_disagreement) * paths.median) {
    return leaveAs(std::move(result), "motion uncertain");
  }
  if (paths.reach > kLongestReach) return leaveAs(std::move(result), "blurred too much");

  Solution solution(input, config_, depth, paths.reach);
  solution.run();
  result.residual = solution.residual();
  result.neighbour = solution.neighbour();
  if (!(result.residual < static_cast<float>(config_.max_residual))) {
    return leaveAs(std::move(result), "not like the input when blurred again");
  }
  cv::Mat1f sharp = solution.image();
  bound(level, sharp);
  result.image = std::make_shared<const ImagePyramid>(sharp, level.camera, input.image->levels(), level.gain);
  result.sharpened = true;
  return result;
}

}  // namespace mba_vo
