#include "mba_vo/deblur/level_problem.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "saturation.h"

namespace mba_vo {
namespace {

constexpr int kSpareReach = 3;  // beyond the longest path that was looked at [px]

LatentGrid gridWithin(const PinholeCamera& camera, float reach) {
  return BlurOperator::gridFor(camera, static_cast<int>(std::ceil(reach)) + kSpareReach);
}

}  // namespace

Observation::Observation(const BlurGeometry& geometry, const cv::Mat1f& inverse_depth, const LatentGrid& grid,
                         const cv::Mat1f& image, float noise, float limit)
    : blur_(geometry, inverse_depth, grid),
      data_{&blur_, cv::Mat1f(blur_.observedSize(), 0.0F), cv::Mat1f(blur_.observedSize(), 0.0F)} {
  const float weight = 1.0F / (noise * noise);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const float value = image(y, x);
      if (!std::isfinite(value)) continue;
      data_.image(y, x) = value;
      if (value < limit) data_.weight(y, x) = weight * blur_.seen()(y, x);
    }
  }
}

void Observation::distrust(const cv::Mat1f& variance) {
  cv::Mat1f added;
  cv::resize(variance, added, data_.weight.size(), 0.0, 0.0, cv::INTER_LINEAR);
  for (int y = 0; y < added.rows; ++y) {
    for (int x = 0; x < added.cols; ++x) data_.weight(y, x) /= 1.0F + data_.weight(y, x) * added(y, x);
  }
}

float Observation::residual(const cv::Mat1f& latent) const {
  cv::Mat1f difference;
  blur_.apply(latent, difference);
  difference -= data_.image;
  const double sum = difference.mul(data_.weight).dot(difference);
  return static_cast<float>(std::sqrt(sum / std::max(1, pixels())));
}

LevelProblem::LevelProblem(const ImageLevel& level, const ExposureTrajectory& motion, const cv::Mat1f& depth,
                           float reach, float noise)
    : size_(level.intensity.size()),
      keyframe_({level.camera, level.camera, motion, motion.velocity}, depth, gridWithin(level.camera, reach),
                level.intensity, noise, static_cast<float>(level.gain) * kSaturated) {}

cv::Mat1f LevelProblem::blurredStart() const {
  const cv::Mat1f image = keyframe_.data().image(cv::Rect({0, 0}, size_));
  cv::Mat1f start;
  const int margin = grid().margin;
  cv::copyMakeBorder(image, start, margin, grid().size.height - margin - size_.height, margin,
                     grid().size.width - margin - size_.width, cv::BORDER_REPLICATE);
  return start;
}

cv::Mat1f LevelProblem::startFrom(const LevelProblem& coarse, const cv::Mat1f& solution) const {
  cv::Mat1f fine;
  cv::resize(solution, fine, solution.size() * 2, 0.0, 0.0, cv::INTER_LINEAR);
  const int offset = 2 * coarse.grid().margin - grid().margin;
  return fine(cv::Rect({offset, offset}, grid().size)).clone();
}

void LevelProblem::solve(const HalfQuadraticConfig& config, const Observation* neighbour, cv::Mat1f& latent) const {
  std::vector<BlurredObservation> observations{keyframe_.data()};
  if (neighbour) observations.push_back(neighbour->data());
  solveHalfQuadratic(observations, config, latent);
}

cv::Mat1f LevelProblem::image(const cv::Mat1f& latent) const {
  return latent(cv::Rect({grid().margin, grid().margin}, size_)).clone();
}

}  // namespace mba_vo
