#include "mba_vo/mapping/initial_vignette.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>

#include "mba_vo/solver/residual_spread.h"

namespace mba_vo {
namespace {

constexpr int kLeastWidth = 32;       // whose pixels are large enough for what blur and perspective do to a point
constexpr float kDarkest = 8.0F;      // [grey levels] below, the logarithm tells of the noise
constexpr float kBrightest = 240.0F;  // [grey levels] above, pixels may be saturated
constexpr int kIterations = 5;
constexpr double kOutlier = 2.0;  // [standard deviations] Huber's threshold

constexpr double kLeastInformation = 1.0;  // with little motion outwards, the powers of the radius look alike

constexpr int kDim = CalibrationCorrection::kVignetteDim;
using Vignette = CalibrationCorrection::Vignette;
using Matrix = Eigen::Matrix<double, kDim, kDim>;

/// Log of the brightness of one point in one frame over that in the reference, and its derivative by the vignette.
struct Observation {
  double log_ratio;
  Vignette J;
  double weight = 1.0;
};

std::optional<float> brightnessAt(const ImageLevel& level, const Eigen::Vector2d& pixel) {
  if (!level.camera.contains(pixel, 1.0)) return std::nullopt;
  const int x = static_cast<int>(pixel.x());
  const int y = static_cast<int>(pixel.y());
  const auto fx = static_cast<float>(pixel.x() - x);
  const auto fy = static_cast<float>(pixel.y() - y);
  const cv::Mat1f& I = level.intensity;
  const float value = (1.0F - fy) * ((1.0F - fx) * I(y, x) + fx * I(y, x + 1)) +
                      fy * ((1.0F - fx) * I(y + 1, x) + fx * I(y + 1, x + 1));
  const auto gain = static_cast<float>(level.gain);
  return value > gain * kDarkest && value < gain * kBrightest ? std::optional<float>(value) : std::nullopt;
}

std::vector<Observation> observe(const InitialMap& initial, const InitialMap::Pose& pose) {
  int coarse = std::min(initial.reference->pyramid.levels(), pose.frame->pyramid.levels()) - 1;
  while (coarse > 0 && initial.reference->pyramid.level(coarse).camera.width < kLeastWidth) --coarse;
  const ImageLevel& reference = initial.reference->pyramid.level(coarse);
  const ImageLevel& frame = pose.frame->pyramid.level(coarse);
  const SE3 T_frame_reference = pose.T_reference_frame.inverse();
  std::vector<Observation> observations;
  for (const ReferencePoint& point : initial.points) {
    const Eigen::Vector3d ray = initial.reference->pyramid.level(0).camera.unproject(point.pixel.cast<double>());
    const Eigen::Vector3d seen = T_frame_reference * (ray / static_cast<double>(point.inverse_depth));
    if (seen.z() <= 0.0) continue;
    const Eigen::Vector2d from = reference.camera.project(ray);
    const Eigen::Vector2d to = frame.camera.project(seen);
    const std::optional<float> before = brightnessAt(reference, from);
    const std::optional<float> after = brightnessAt(frame, to);
    if (!before || !after) continue;
    observations.push_back({std::log(static_cast<double>(*after / *before)),
                            vignetteJacobian(frame.camera, to) - vignetteJacobian(reference.camera, from)});
  }
  return observations;
}

/// The gain of the frame eliminated.
void subtractMean(std::vector<Observation>& observations) {
  double weight = 0.0;
  double log_ratio = 0.0;
  Vignette J = Vignette::Zero();
  for (const Observation& o : observations) {
    weight += o.weight;
    log_ratio += o.weight * o.log_ratio;
    J += o.weight * o.J;
  }
  for (Observation& o : observations) {
    o.log_ratio -= log_ratio / weight;
    o.J -= J / weight;
  }
}

}  // namespace

CalibrationSystem linearizeInitialVignette(const InitialMap& initial, const CalibrationCorrection& present) {
  std::vector<std::vector<Observation>> frames;
  for (const InitialMap::Pose& pose : initial.poses) {
    if (pose.frame->correction == present) frames.push_back(observe(initial, pose));
  }
  CalibrationSystem system;
  Vignette lacking = Vignette::Zero();
  for (int i = 0; i < kIterations; ++i) {
    std::vector<float> sizes;
    for (std::vector<Observation>& frame : frames) {
      subtractMean(frame);
      for (const Observation& o : frame) sizes.push_back(static_cast<float>(std::abs(o.log_ratio - o.J.dot(lacking))));
    }
    const double sigma = residualSpread(sizes);
    if (!(sigma > 0.0)) return {};
    Matrix H = Matrix::Zero();
    Vignette b = Vignette::Zero();
    for (std::vector<Observation>& frame : frames) {
      for (Observation& o : frame) {
        const double size = std::abs(o.log_ratio - o.J.dot(lacking)) / sigma;
        o.weight = size > kOutlier ? kOutlier / size : 1.0;
        H += o.weight / (sigma * sigma) * o.J * o.J.transpose();
        b -= o.weight / (sigma * sigma) * o.log_ratio * o.J;
      }
    }
    system.H.bottomRightCorner<kDim, kDim>() = H;
    system.b.tail<kDim>() = b;
    lacking = -(H + kLeastInformation * Matrix::Identity()).ldlt().solve(b);
  }
  return system;
}

}  // namespace mba_vo
