#include "mba_vo/window/imaging_system.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "mba_vo/window/imaging_linearizer.h"

namespace mba_vo {
namespace {

constexpr int kFocal = CalibrationCorrection::kFocal;
constexpr double kDamping = 1e-6;        // relative; settles position, direction and scale
constexpr double kFirstKeyframe = 1e6;   // relative information of the first keyframe, which holds the map
constexpr double kLeastDiagonal = 1e-9;  // keeps states without any information solvable

// Errors of a velocity stay with its keyframe through all the windows that share it. On two recorded motions
// (hand_desk, hand_office) with a rolling shutter and all told, steps that were taken for nothing had chi^2 of 13 to
// 23, where 12.6 counted. By half, steps still spoilt right cameras on fast heads (head_room2 to 4); by a tenth,
// kitchen's wrong one is corrected too late (docs/decisions/2026-11-28-rolling-shutters.md).
constexpr double kRollingEvidence = 0.2;

// Residuals that tell about the calibration: a quarter of those of an ordinary window is more than enough. More of
// them, in the large windows of fast turns, would be no more independent, but make every step of it look significant.
constexpr int kCalibrationResiduals = 2000;
constexpr int kLeastCalibrationStride = 4;  // of the points
constexpr int kRollingStride = 1;           // and about the motion of every keyframe, 1.1 times better than with 2

// Of a focal length that is wrong one Gauss-Newton step finds two thirds: Huber's loss is flatter than its weights say.
// After two more linearisations it is 94 % (docs/decisions/2026-11-30-focal-length-of-a-window.md). Of right cameras
// windows scatter by 0.0004 (desk), 0.0009 (head_room2) and 0.0018 (shake): few of them are moved.
constexpr int kMoves = 2;
constexpr double kWorthMoving = 0.002;    // relative
constexpr double kLeastDepthLeft = 1e-3;  // of an inverse depth, by a move

struct LinearizedImaging {
  ImagingSystem system;
  Eigen::VectorXd states;  // how all that is in the layout follows the focal length [1]
  Eigen::VectorXd depths;  // and the inverse depths of the points
};

/// The keyframes' states eliminated, the velocities moved to where they want to be.
LinearizedImaging eliminateKeyframes(const ReducedSystem& reduced, const ImagingLayout& layout) {
  const int n = layout.correction();
  Eigen::MatrixXd H = reduced.H.topLeftCorner(n, n);
  H.diagonal() *= 1.0 + kDamping;
  H.topLeftCorner<kKeyframeDim, kKeyframeDim>().diagonal() *= kFirstKeyframe;
  const Eigen::VectorXd scale = H.diagonal().cwiseMax(kLeastDiagonal).cwiseSqrt().cwiseInverse();
  H = scale.asDiagonal() * H * scale.asDiagonal();
  // Above the diagonal, where the correction's columns are filled.
  const Eigen::MatrixXd mixed = scale.asDiagonal() * reduced.H.block(0, n, n, kCorrectionDim);
  const Eigen::LDLT<Eigen::MatrixXd> factors(H);
  const Eigen::VectorXd solved = factors.solve(scale.cwiseProduct(reduced.b.head(n)));
  const Eigen::MatrixXd solved_mixed = factors.solve(mixed);
  LinearizedImaging out;
  CalibrationSystem& calibration = out.system.calibration;
  calibration.H = reduced.H.block<kCorrectionDim, kCorrectionDim>(n, n) - mixed.transpose() * solved_mixed;
  calibration.b = reduced.b.segment<kCorrectionDim>(n) - mixed.transpose() * solved;
  out.states = Eigen::VectorXd::Unit(layout.size(), n + kFocal);
  out.states.head(n) = -scale.cwiseProduct(solved_mixed.col(kFocal));
  if (!layout.rolling()) return out;
  calibration.H *= kRollingEvidence;
  calibration.b *= kRollingEvidence;
  const Eigen::VectorXd step = -scale.cwiseProduct(solved) / layout.half_readout;
  for (int k = 0; k < layout.keyframes; ++k) {
    out.system.velocity_steps.emplace_back(step.segment<6>(layout.velocity(k)));
  }
  return out;
}

ImagingLayout layoutOf(const WindowState& state) {
  return {state.size(), 0.5 * std::abs(state.keyframes.front().readoutTime())};
}

LinearizedImaging linearize(WindowState& state, const WindowLinearizer& linearizer, const std::vector<int>& points) {
  WindowEvaluation evaluation;
  linearizer.evaluate(state, points, evaluation);
  const ImagingLayout layout = layoutOf(state);
  const LinearizedWindow system = assembleImaging(state, evaluation, layout);
  ReducedSystem reduced;
  SchurComplement().reduce(system, 0.0, reduced);
  LinearizedImaging out = eliminateKeyframes(reduced, layout);
  out.depths = (system.H_depth.array() > 0.0)
                   .select(-(system.V.leftCols(layout.size()) * out.states).array() / system.H_depth.array(), 0.0);
  return out;
}

/// By which the focal length is wrong, whatever the vignette is.
double focalStep(const CalibrationSystem& system) {
  constexpr int kVignette = CalibrationCorrection::kVignetteDim;
  const auto of_vignette = system.H.bottomRightCorner<kVignette, kVignette>().ldlt();
  const CalibrationCorrection::Vignette mixed = system.H.bottomRows<kVignette>().col(kFocal);
  const CalibrationCorrection::Vignette solved = of_vignette.solve(mixed);
  return -(system.b(kFocal) - solved.dot(system.b.tail<kVignette>())) / (system.H(kFocal, kFocal) - solved.dot(mixed));
}

/// The window as it would be with a focal length that is `step` longer.
void lengthenFocalLength(double step, const LinearizedImaging& imaging, const std::vector<int>& points,
                         WindowState& state) {
  const ImagingLayout layout = layoutOf(state);
  const Eigen::VectorXd moves = step * imaging.states;
  for (int k = 0; k < state.size(); ++k) {
    KeyframeState& keyframe = state.keyframe(k);
    keyframe.delta += moves.segment<kKeyframeDim>(ImagingLayout::pose(k));
    if (layout.rolling()) {
      keyframe.setVelocity(keyframe.velocity + moves.segment<6>(layout.velocity(k)) / layout.half_readout);
    }
    keyframe.lacking.values(kFocal) += step;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    double& depth = state.points[static_cast<std::size_t>(points[i])].inverse_depth;
    depth = std::max(kLeastDepthLeft * depth, depth + step * imaging.depths(static_cast<Eigen::Index>(i)));
  }
}

/// What the residuals say of the calibration, linearised where the focal length is the one that they want; where they
/// are if steps towards it grow.
CalibrationSystem relinearize(const WindowState& state, const WindowLinearizer& linearizer,
                              const std::vector<int>& points, const LinearizedImaging& first) {
  WindowState moved = state;
  LinearizedImaging imaging = first;
  double focal = 0.0;
  double step = focalStep(first.system.calibration);
  for (int i = 0; i < kMoves; ++i) {
    lengthenFocalLength(step, imaging, points, moved);
    focal += step;
    imaging = linearize(moved, linearizer, points);
    const double next = focalStep(imaging.system.calibration);
    if (!(std::abs(next) < std::abs(step))) return first.system.calibration;
    step = next;
  }
  CalibrationSystem& calibration = imaging.system.calibration;
  calibration.b -= focal * calibration.H.col(kFocal);
  return calibration;
}

}  // namespace

ImagingSystem linearizeImaging(WindowState& state, const WindowLinearizer& linearizer, int stride) {
  std::vector<int> chosen;
  for (int i = 0; i < static_cast<int>(state.points.size()); i += stride) chosen.push_back(i);
  if (chosen.empty()) return {};
  const LinearizedImaging imaging = linearize(state, linearizer, chosen);
  ImagingSystem out = imaging.system;
  // With measured depths, which are no residuals, points are elsewhere than the residuals want them.
  if (!state.hasMeasuredDepths() && std::abs(focalStep(out.calibration)) > kWorthMoving) {
    out.calibration = relinearize(state, linearizer, chosen, imaging);
  }
  return out;
}

namespace {

int calibrationStride(const WindowState& state) {
  std::size_t residuals = 0;
  for (const PointState& point : state.points) residuals += point.residuals.size();
  return std::max(kLeastCalibrationStride, static_cast<int>(residuals) / kCalibrationResiduals);
}

}  // namespace

CalibrationSystem refineRowMotions(WindowState& state, const WindowLinearizer& linearizer) {
  const bool rolling = state.keyframes.front().readoutTime() != 0.0;
  const ImagingSystem imaging =
      linearizeImaging(state, linearizer, rolling ? kRollingStride : calibrationStride(state));
  auto step = imaging.velocity_steps.begin();
  for (KeyframeState& k : state.keyframes) {
    if (step != imaging.velocity_steps.end()) k.setVelocity(k.velocity + *step++);
  }
  return imaging.calibration;
}

CalibrationCoupling calibrationCoupling(WindowState& state, const WindowLinearizer& linearizer,
                                        const std::vector<int>& points, std::size_t stride) {
  std::vector<int> chosen;
  for (std::size_t i = 0; i < points.size(); i += stride) chosen.push_back(points[i]);
  WindowEvaluation evaluation;
  linearizer.evaluate(state, chosen, evaluation);
  const ImagingLayout layout{state.size(), 0.0};
  ReducedSystem reduced;
  SchurComplement().reduce(assembleImaging(state, evaluation, layout), 0.0, reduced);
  const double share = static_cast<double>(chosen.size()) / static_cast<double>(points.size());
  return reduced.H.block(0, layout.correction(), layout.correction(), kCorrectionDim) / share;
}

}  // namespace mba_vo
