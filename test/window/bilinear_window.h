#pragma once

#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "mba_vo/window/window_linearizer.h"
#include "support/random.h"
#include "window/planar_scene.h"

namespace mba_vo::test {

/// I(x, y) = i + j x + k y + l x y: bilinear interpolation and its derivative are exact everywhere.
inline std::shared_ptr<const ImagePyramid> bilinearImage(Random& random, double row_time) {
  PinholeCamera camera = smallCamera();
  camera.row_time = row_time;
  const double j = random.uniform(-0.5, 0.5), k = random.uniform(-0.5, 0.5), l = random.uniform(-4e-3, 4e-3);
  cv::Mat1f image(camera.height, camera.width);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image(y, x) = static_cast<float>(100.0 + j * (x - 160.0) + k * (y - 120.0) + l * (x - 160.0) * (y - 120.0));
    }
  }
  return pyramidOf(image, camera);
}

enum class Exposure { kSharp, kBlurred, kBlurredRolling };

inline WindowState randomState(Random& random, Exposure exposure) {
  const double row_time = exposure == Exposure::kBlurredRolling ? 1e-4 : 0.0;
  WindowState state;
  for (int i = 0; i < 3; ++i) {
    KeyframeState k;
    k.id = static_cast<KeyframeId>(i);
    k.sharp = bilinearImage(random, row_time);
    k.original = bilinearImage(random, row_time);
    if (exposure != Exposure::kSharp) k.xi = random.tangent(0.03, 0.03);
    if (row_time > 0.0) k.velocity = random.tangent(1.0, 1.0);
    k.T_linear = random.pose(0.15, 0.1);
    k.brightness_linear = {random.uniform(-0.2, 0.2), random.uniform(-10.0, 10.0)};
    k.outlier_energy = 1e12;
    state.keyframes.push_back(k);
    state.prior.appendKeyframe();
  }
  for (int i = 0; i < 40; ++i) {
    PointState point;
    point.host = i % 3;
    point.pixel = {random.uniform(60, 260), random.uniform(60, 180)};
    point.inverse_depth = random.uniform(0.3, 1.0);
    for (int t = 0; t < 3; ++t) {
      PatchResidual residual;
      residual.target = t;
      if (t != point.host) point.residuals.push_back(residual);
    }
    state.points.push_back(point);
  }
  return state;
}

inline std::vector<int> allPoints(const WindowState& state) {
  std::vector<int> all(state.points.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// Residuals need pixels before they can be compared.
inline void placePixels(const WindowLinearizer& linearizer, WindowState& state) {
  WindowEvaluation evaluation;
  linearizer.evaluate(state, allPoints(state), evaluation, 0.75F);
}

/// Geometric Jacobians are those of the patch's centre, for all its pixels; with only the centre weighted they are
/// exact.
inline void keepCentre(PatchResidual& residual) {
  residual.weight.fill(0.0F);
  residual.weight[0] = 1.0F;
}

inline void keepCentres(WindowState& state) {
  for (PointState& point : state.points) {
    for (PatchResidual& residual : point.residuals) keepCentre(residual);
  }
}

inline double cost(const WindowLinearizer& linearizer, WindowState state) {
  LinearizedWindow system;
  linearizer.linearize(state, allPoints(state), system);
  double sum = 0.0;
  for (const PointState& point : state.points) {
    for (const PatchResidual& residual : point.residuals) {
      if (!std::isnan(residual.trial_energy)) sum += static_cast<double>(residual.trial_energy);
    }
  }
  return sum;
}

/// A step large enough for images in single precision, small enough for central differences.
inline Vector8 stepSizes() {
  Vector8 h;
  h << Vector6::Constant(2e-3), 2e-3, 0.1;
  return h;
}

/// A fixed number of samples, so that the cost is smooth.
inline ResidualOptions smoothOptions() {
  ResidualOptions options;
  options.sample_spacing_px = 1e-3F;
  options.max_samples = 16;
  return options;
}

}  // namespace mba_vo::test
