#include "mba_vo/deblur/neighbour_choice.h"

#include <cmath>

#include "mba_vo/geometry/angles.h"

namespace mba_vo {
namespace {

constexpr int kFrequencies = 16;   // from 0 to 1/2 per pixel
constexpr double kGradient = 8.0;  // rms of a sharp image's gradient [grey levels / px]
constexpr int kColumns = 5;        // of places that are looked at
constexpr int kRows = 3;

double squaredSinc(double x) {
  if (std::abs(x) < 1e-4) return 1.0;
  const double s = std::sin(kPi * x) / (kPi * x);
  return s * s;
}

Eigen::Vector2d place(const PinholeCamera& camera, int column, int row) {
  return {(column + 0.5) / kColumns * camera.width, (row + 0.5) / kRows * camera.height};
}

/// Error expected at all places, with the keyframe alone if `neighbour` is null.
double errorOver(const cv::Mat1f& depth, float noise, const BlurGeometry& keyframe, const BlurGeometry* neighbour) {
  const LatentPathMaker own(keyframe);
  const std::optional<LatentPathMaker> other =
      neighbour ? std::make_optional<LatentPathMaker>(*neighbour) : std::nullopt;
  double sum = 0.0;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const Eigen::Vector2d pixel = place(keyframe.latent_camera, c, r);
      const auto w = static_cast<double>(depth(static_cast<int>(pixel.y()), static_cast<int>(pixel.x())));
      LatentPath path;
      if (!own.make(pixel, w, path)) continue;
      std::vector<Eigen::Vector2f> paths{path.path.c1};
      if (other && other->make(pixel, w, path) && neighbour->camera.contains(path.pixel.cast<double>())) {
        paths.push_back(path.path.c1);
      }
      sum += expectedError(paths, noise);
    }
  }
  return sum;
}

}  // namespace

double expectedError(const std::vector<Eigen::Vector2f>& paths, float noise) {
  const double precision = 1.0 / (static_cast<double>(noise) * static_cast<double>(noise));
  constexpr double kStep = 0.5 / kFrequencies;  // [1/px]
  // The gradient's power, (2 pi)^2 |f|^2 times the image's, is the same at all frequencies, an area of 1.
  constexpr double kPower = kGradient * kGradient / (4.0 * kPi * kPi);
  double sum = 0.0;
  for (int i = 0; i < kFrequencies; ++i) {
    for (int j = -kFrequencies; j < kFrequencies; ++j) {
      const Eigen::Vector2d f = kStep * Eigen::Vector2d(j + 0.5, i + 0.5);
      double information = f.squaredNorm() / kPower;
      for (const Eigen::Vector2f& path : paths) information += precision * squaredSinc(f.dot(path.cast<double>()));
      sum += 1.0 / information;
    }
  }
  return sum / (2.0 * kFrequencies * kFrequencies);
}

BlurGeometry geometryOf(const DeblurNeighbour& neighbour, int level, const BlurGeometry& keyframe) {
  return {keyframe.latent_camera, neighbour.image->level(level).camera, neighbour.motion, keyframe.latent_velocity};
}

std::optional<NeighbourChoice> chooseNeighbour(const BlurGeometry& keyframe, const cv::Mat1f& depth, float noise,
                                               const std::vector<DeblurNeighbour>& neighbours) {
  std::optional<NeighbourChoice> best;
  const double alone = errorOver(depth, noise, keyframe, nullptr);
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const DeblurNeighbour& n = neighbours[i];
    if (!n.image || !(n.motion.exposure >= 0.0) || !(n.gain > 0.0)) continue;
    const BlurGeometry geometry = geometryOf(n, 0, keyframe);
    const double gain = 10.0 * std::log10(alone / errorOver(depth, noise, keyframe, &geometry));
    if (!best || gain > best->gain_db) best = NeighbourChoice{i, gain};
  }
  return best;
}

}  // namespace mba_vo
