#include "mba_vo/deblur/trajectory_deblurrer.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "mba_vo/deblur/half_quadratic_solver.h"
#include "mba_vo/deblur/image_noise.h"

namespace mba_vo {
namespace {

constexpr float kSaturated = 254.0F;     // [grey levels] from here on a pixel tells only that it is bright
constexpr int kSpareReach = 3;           // beyond the longest path that was looked at [px]
constexpr int kGridStep = 32;            // between the paths that are looked at [px]
constexpr float kLongestReach = 150.0F;  // of a path from its pixel [px]

/// Paths all over the image.
struct PathStatistics {
  float median = 0.0F;        // length [px]
  float disagreement = 0.0F;  // median distance between the ends by one and the other velocity, twice [px]
  float reach = 0.0F;         // furthest from the pixel [px]
};

float median(std::vector<float>& values) {
  if (values.empty()) return 0.0F;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<Eigen::Vector2i> gridOf(const PinholeCamera& camera) {
  std::vector<Eigen::Vector2i> grid;
  for (int y = 0; y < camera.height - 1 + kGridStep; y += kGridStep) {
    for (int x = 0; x < camera.width - 1 + kGridStep; x += kGridStep) {
      grid.emplace_back(std::min(x, camera.width - 1), std::min(y, camera.height - 1));
    }
  }
  return grid;
}

PathStatistics measurePaths(const PinholeCamera& camera, const DeblurInput& input, const cv::Mat1f& depth) {
  ExposureTrajectory other = input.motion;
  other.velocity = input.other_velocity.value_or(input.motion.velocity);
  const FixedMotionPathMaker maker(camera, camera, input.motion, {input.motion.velocity, input.motion.velocity});
  const FixedMotionPathMaker other_maker(camera, camera, other, {other.velocity, other.velocity});
  PathStatistics result;
  std::vector<float> lengths;
  std::vector<float> differences;
  for (const Eigen::Vector2i& place : gridOf(camera)) {
    const Eigen::Vector2d pixel = place.cast<double>();
    const auto w = static_cast<double>(depth(place.y(), place.x()));
    PatchPath path;
    PatchPath other_path;
    if (!maker.makeWithoutPose(pixel, w, path, pixel.y())) continue;
    if (!other_maker.makeWithoutPose(pixel, w, other_path, pixel.y())) continue;
    lengths.push_back(path.length());
    differences.push_back((path.c1 - other_path.c1).norm());
    const Eigen::Vector2f half = 0.5F * path.c1;
    const Eigen::Vector2f bend = 0.25F * path.c2;
    result.reach = std::max({result.reach, (bend + half).norm(), (bend - half).norm()});
  }
  result.median = median(lengths);
  result.disagreement = median(differences);
  return result;
}

cv::Rect imageOn(const LatentGrid& grid, cv::Size image) { return {{grid.margin, grid.margin}, image}; }

/// One level of the image as the solver takes it.
class LevelProblem {
 public:
  LevelProblem(const ImageLevel& level, const ExposureTrajectory& motion, const cv::Mat1f& depth, float reach,
               float noise)
      : size_(level.intensity.size()),
        blur_({level.camera, level.camera, motion}, depth,
              BlurOperator::gridFor(level.camera, static_cast<int>(std::ceil(reach)) + kSpareReach)) {
    observation_.blur = &blur_;
    observation_.image = cv::Mat1f(blur_.observedSize(), 0.0F);
    observation_.weight = cv::Mat1f(blur_.observedSize(), 0.0F);
    const float weight = 1.0F / (noise * noise);
    for (int y = 0; y < size_.height; ++y) {
      for (int x = 0; x < size_.width; ++x) {
        const float value = level.intensity(y, x);
        if (!std::isfinite(value)) continue;
        observation_.image(y, x) = value;
        if (value < kSaturated) observation_.weight(y, x) = weight * blur_.seen()(y, x);
      }
    }
  }
  LevelProblem(const LevelProblem&) = delete;  // observation_ points to blur_
  LevelProblem& operator=(const LevelProblem&) = delete;

  /// The blurred image itself, its border continued.
  cv::Mat1f blurredStart() const {
    const LatentGrid& grid = blur_.grid();
    const cv::Mat1f image = observation_.image(cv::Rect({0, 0}, size_));
    cv::Mat1f start;
    cv::copyMakeBorder(image, start, grid.margin, grid.size.height - grid.margin - size_.height, grid.margin,
                       grid.size.width - grid.margin - size_.width, cv::BORDER_REPLICATE);
    return start;
  }

  /// The solution of the level with half the resolution, on this level's grid.
  cv::Mat1f startFrom(const LevelProblem& coarse, const cv::Mat1f& solution) const {
    cv::Mat1f fine;
    cv::resize(solution, fine, solution.size() * 2, 0.0, 0.0, cv::INTER_LINEAR);
    const int offset = 2 * coarse.blur_.grid().margin - blur_.grid().margin;
    return fine(cv::Rect({offset, offset}, blur_.grid().size)).clone();
  }

  void solve(const HalfQuadraticConfig& config, cv::Mat1f& latent) const {
    solveHalfQuadratic({observation_}, config, latent);
  }

  /// Rms of `latent` blurred again minus the image [standard deviations of the noise].
  float residual(const cv::Mat1f& latent) const {
    cv::Mat1f difference;
    blur_.apply(latent, difference);
    difference -= observation_.image;
    const double sum = difference.mul(observation_.weight).dot(difference);
    return static_cast<float>(std::sqrt(sum / std::max(1, cv::countNonZero(observation_.weight))));
  }

  cv::Mat1f image(const cv::Mat1f& latent) const { return latent(imageOn(blur_.grid(), size_)).clone(); }

 private:
  cv::Size size_;
  BlurOperator blur_;
  BlurredObservation observation_;
};

DeblurResult leaveAs(DeblurResult result, const char* reason) {
  result.reason = reason;
  return result;
}

/// Light is not negative, and no brighter than the camera can see. What is not valid stays so.
void bound(const cv::Mat1f& input, cv::Mat1f& image) {
  constexpr float kWhite = 255.0F;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const float before = input(y, x);
      image(y, x) = std::isfinite(before) ? std::clamp(image(y, x), 0.0F, std::max(kWhite, before)) : before;
    }
  }
}

cv::Mat1f solveOnHalfResolution(const DeblurInput& input, const cv::Mat1f& depth, float reach, float noise,
                                const HalfQuadraticConfig& config, const LevelProblem& fine) {
  const ImageLevel& level = input.image->level(1);
  cv::Mat1f coarse_depth;
  cv::resize(depth, coarse_depth, level.intensity.size(), 0.0, 0.0, cv::INTER_AREA);
  const LevelProblem coarse(level, input.motion, coarse_depth, 0.5F * reach, noise);
  cv::Mat1f latent = coarse.blurredStart();
  coarse.solve(config, latent);
  return fine.startFrom(coarse, latent);
}

}  // namespace

DeblurResult TrajectoryDeblurrer::deblur(const DeblurInput& input) const {
  DeblurResult result;
  result.image = input.image;
  const ImageLevel& level = input.image->level(0);
  const cv::Mat1f depth = denseInverseDepth(level.camera, input.depths);
  if (depth.empty()) return leaveAs(std::move(result), "no depths");
  const PathStatistics paths = measurePaths(level.camera, input, depth);
  result.blur_px = paths.median;
  if (paths.median < static_cast<float>(config_.min_blur_px)) return leaveAs(std::move(result), "sharp enough");
  if (paths.disagreement > static_cast<float>(config_.max_disagreement) * paths.median) {
    return leaveAs(std::move(result), "motion uncertain");
  }
  if (paths.reach > kLongestReach) return leaveAs(std::move(result), "blurred too much");

  HalfQuadraticConfig solver;
  solver.prior_weight = static_cast<float>(config_.prior_weight);
  solver.steps = config_.steps;
  solver.iterations = config_.iterations;
  const float noise = estimateNoise(level.intensity);
  const LevelProblem problem(level, input.motion, depth, paths.reach, noise);
  cv::Mat1f latent = input.image->levels() > 1
                         ? solveOnHalfResolution(input, depth, paths.reach, noise, solver, problem)
                         : problem.blurredStart();
  problem.solve(solver, latent);
  result.residual = problem.residual(latent);
  if (!(result.residual < static_cast<float>(config_.max_residual))) {
    return leaveAs(std::move(result), "not like the input when blurred again");
  }
  cv::Mat1f sharp = problem.image(latent);
  bound(level.intensity, sharp);
  result.image = std::make_shared<const ImagePyramid>(sharp, level.camera, input.image->levels());
  result.sharpened = true;
  return result;
}

}  // namespace mba_vo
