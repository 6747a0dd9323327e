#include "mba_vo/window/imaging_system.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "mba_vo/solver/point_chunks.h"
#include "mba_vo/window/point_activation.h"

namespace mba_vo {
namespace {

constexpr int kCorrectionDim = CalibrationCorrection::kDim;
constexpr int kCorrectionBlock = 2 * kKeyframeDim;  // the correction's states, filled up to keyframes'
constexpr double kDamping = 1e-6;                   // relative; settles position, direction and scale
constexpr double kFirstKeyframe = 1e6;              // relative information of the first keyframe, which holds the map
constexpr double kLeastDiagonal = 1e-9;             // keeps states without any information solvable
// By which velocities by the frames around, 0.014-0.02 rad/s and 0.01 m/s off along recorded motions, move the first
// and the last row [px]. On hand_desk poses were 1.3 times as far off with 0.04 or 1 instead.
constexpr double kExpectedError = 0.1;
constexpr double kItsHalfReadout = 0.013;  // [s] of those recordings: half of the time from the first row to the last

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

/// Where the states are: those of the keyframes, then their velocities by the rows, then the correction.
struct Layout {
  int keyframes;
  bool rolling;

  static int pose(int keyframe) { return kKeyframeDim * keyframe; }
  int velocity(int keyframe) const { return kKeyframeDim * (keyframes + keyframe); }
  int correction() const { return kKeyframeDim * keyframes * (rolling ? 2 : 1); }
  int size() const { return correction() + kCorrectionBlock; }
};

/// When the rows of target and host were exposed, over half of the time that reading an image takes. A velocity moves
/// a row by as much as that share of it, taken for a pose, would.
struct RowTimes {
  double target = 0.0;
  double host = 0.0;
};

/// Sums over the residuals of one host in one target, weighted by products of their row times.
struct PairSystem {
  enum Weight { kOne, kTarget, kHost, kTargetTarget, kTargetHost, kHostHost };
  std::array<Matrix8, 6> H;
  std::array<CalibrationResidual::Mixed, 3> H_mixed;
  std::array<Vector8, 3> b;
  CalibrationSystem correction;

  PairSystem() {
    H.fill(Matrix8::Zero());
    H_mixed.fill(CalibrationResidual::Mixed::Zero());
    b.fill(Vector8::Zero());
  }
  void add(const CalibrationResidual& residual, const RowTimes& at) {
    const std::array<double, 6> weights{
        1.0, at.target, at.host, at.target * at.target, at.target * at.host, at.host * at.host};
    for (std::size_t i = 0; i < weights.size(); ++i) {
      H[i] += weights[i] * residual.H;
      if (i >= b.size()) continue;
      H_mixed[i] += weights[i] * residual.H_state_correction;
      b[i] += weights[i] * residual.b;
    }
    correction.H += residual.correction.H;
    correction.b += residual.correction.b;
  }
  void operator+=(const PairSystem& other) {
    for (std::size_t i = 0; i < H.size(); ++i) H[i] += other.H[i];
    for (std::size_t i = 0; i < b.size(); ++i) {
      H_mixed[i] += other.H_mixed[i];
      b[i] += other.b[i];
    }
    correction.H += other.correction.H;
    correction.b += other.correction.b;
  }
};

/// J_host of makePairGeometry at the current state instead of the first estimates.
Matrix8 currentHostJacobian(const PairGeometry& pair) {
  Matrix8 J = pair.J_host;
  J.topLeftCorner<6, 6>() = -pair.T_target_host.adjoint();
  return J;
}

/// The blocks of the host at `h`, weighted for the host's part, and of the target at `t`.
void addBlocks(const Matrix8& H, const Matrix8& J_host, int h, int t, LinearizedWindow& out) {
  const Matrix8 mixed = J_host.transpose() * H;
  out.H.block<kKeyframeDim, kKeyframeDim>(h, t) += mixed;
  out.H.block<kKeyframeDim, kKeyframeDim>(t, h) += mixed.transpose();
}

void addPair(const PairSystem& pair, const Matrix8& J_host, int host, int target, const Layout& layout,
             LinearizedWindow& out) {
  using W = PairSystem;
  const std::array<int, 2> h{Layout::pose(host), layout.velocity(host)};
  const std::array<int, 2> t{Layout::pose(target), layout.velocity(target)};
  const std::array<W::Weight, 3> of_target{W::kOne, W::kTarget, W::kTargetTarget};
  const std::array<W::Weight, 3> of_host{W::kOne, W::kHost, W::kHostHost};
  const std::array<std::array<W::Weight, 2>, 2> of_both{{{W::kOne, W::kTarget}, {W::kHost, W::kTargetHost}}};
  const int c = layout.correction();
  const std::size_t kinds = layout.rolling ? 2 : 1;
  for (std::size_t i = 0; i < kinds; ++i) {
    for (std::size_t j = 0; j < kinds; ++j) {
      out.H.block<kKeyframeDim, kKeyframeDim>(t[i], t[j]) += pair.H[of_target[i + j]];
      out.H.block<kKeyframeDim, kKeyframeDim>(h[i], h[j]) += J_host.transpose() * pair.H[of_host[i + j]] * J_host;
      addBlocks(pair.H[of_both[i][j]], J_host, h[i], t[j], out);
    }
    out.H.block<kKeyframeDim, kCorrectionDim>(t[i], c) += pair.H_mixed[of_target[i]];
    out.H.block<kKeyframeDim, kCorrectionDim>(h[i], c) += J_host.transpose() * pair.H_mixed[of_host[i]];
    out.b.segment<kKeyframeDim>(t[i]) += pair.b[of_target[i]];
    out.b.segment<kKeyframeDim>(h[i]) += J_host.transpose() * pair.b[of_host[i]];
  }
  out.H.block<kCorrectionDim, kCorrectionDim>(c, c) += pair.correction.H;
  out.b.segment<kCorrectionDim>(c) += pair.correction.b;
}

void addDepth(const CalibrationResidual& residual, const RowTimes& at, const Matrix8& J_host, int host, int target,
              const Layout& layout, Eigen::Index row, LinearizedWindow& out) {
  const Vector8 in_host = J_host.transpose() * residual.H_state_depth;
  const auto add = [&](int first, const auto& values) {
    out.V.row(row).segment(first, values.size()) += values.transpose();
  };
  add(Layout::pose(target), residual.H_state_depth);
  add(Layout::pose(host), in_host);
  if (layout.rolling) {
    add(layout.velocity(target), Vector8(at.target * residual.H_state_depth));
    add(layout.velocity(host), Vector8(at.host * in_host));
  }
  add(layout.correction(), residual.H_correction_depth);
  out.H_depth(row) += residual.H_depth;
  out.b_depth(row) += residual.b_depth;
}

/// All residuals of the evaluation, at the current state. `half_readout`: of an image [s].
LinearizedWindow assemble(const WindowState& state, const WindowEvaluation& evaluation, const Layout& layout,
                          double half_readout) {
  const int n = state.size();
  const std::vector<PairGeometry>& pairs = evaluation.pairs;
  LinearizedWindow out;
  out.setZero(layout.size(), static_cast<int>(evaluation.points.size()));
  const PointChunks points(evaluation.points.size());
  std::vector<PairSumsOfChunk<PairSystem>> sums(points.count(), PairSumsOfChunk<PairSystem>(pairs.size()));
  std::vector<Matrix8> J_host(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].path) J_host[i] = currentHostJacobian(pairs[i]);
  }
  points.forEachRow([&](std::size_t chunk, std::size_t row) {
    const PointState& point = state.points[static_cast<std::size_t>(evaluation.points[row])];
    std::size_t patch = evaluation.first[row];
    PatchPath path;
    for (const PatchResidual& residual : point.residuals) {
      const PatchComparison& comparison = evaluation.patches[patch++];
      if (!(residual.trial_energy <= state.keyframe(residual.target).outlier_energy)) continue;
      const auto index = static_cast<std::size_t>(point.host * n + residual.target);
      const PairGeometry& pair = pairs[index];
      const Eigen::Vector2d pixel = residual.centre.cast<double>();
      if (!makeCurrentJacobianPath(pair, residual.centre, point, path)) continue;
      const CalibrationResidual terms = assembleCalibration(pair, comparison, path, pixel, point.pixel.y());
      RowTimes at;
      if (layout.rolling) {
        at = {pair.target_camera.rowDelay(pixel.y()) / half_readout,
              pair.host_camera.rowDelay(point.pixel.y()) / half_readout};
      }
      sums[chunk].at(index).add(terms, at);
      addDepth(terms, at, J_host[index], point.host, residual.target, layout, static_cast<Eigen::Index>(row), out);
    }
  });
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int host = static_cast<int>(i) / n;
    const int target = static_cast<int>(i) % n;
    if (!pairs[i].path) continue;
    PairSystem total;
    for (const auto& chunk : sums) chunk.addTo(i, total);
    addPair(total, J_host[i], host, target, layout, out);
  }
  return out;
}

/// A velocity has no part in the brightness, whose places in its block are idle.
void addVelocityPriors(const WindowState& state, const Layout& layout, double half_readout, LinearizedWindow& out) {
  double inverse_depth = 0.0;
  for (const PointState& point : state.points) inverse_depth += point.inverse_depth;
  inverse_depth /= static_cast<double>(state.points.size());
  const double error = kExpectedError * half_readout / kItsHalfReadout;  // [px]
  Vector6 information = Vector6::Constant(kResidualVariance *
                                          std::pow(state.keyframes.front().original->level(0).camera.fx / error, 2.0));
  information.head<3>() *= inverse_depth * inverse_depth;
  for (int k = 0; k < layout.keyframes; ++k) {
    const int v = layout.velocity(k);
    for (const int idle : {v + 6, v + 7}) {
      out.H.row(idle).setZero();
      out.H.col(idle).setZero();
      out.V.col(idle).setZero();
      out.H(idle, idle) = 1.0;
      out.b(idle) = 0.0;
    }
    out.H.diagonal().segment<6>(v) += information;
    out.b.segment<6>(v) +=
        half_readout * information.cwiseProduct(state.keyframe(k).velocity - state.keyframe(k).expected_velocity);
  }
}

/// The keyframes' states eliminated, the velocities moved to where they want to be.
ImagingSystem eliminateKeyframes(const ReducedSystem& reduced, const Layout& layout, double half_readout) {
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
  ImagingSystem out;
  out.calibration.H = reduced.H.block<kCorrectionDim, kCorrectionDim>(n, n) - mixed.transpose() * factors.solve(mixed);
  out.calibration.b = reduced.b.segment<kCorrectionDim>(n) - mixed.transpose() * solved;
  if (!layout.rolling) return out;
  out.calibration.H *= kRollingEvidence;
  out.calibration.b *= kRollingEvidence;
  const Eigen::VectorXd step = -scale.cwiseProduct(solved) / half_readout;
  for (int k = 0; k < layout.keyframes; ++k) out.velocity_steps.emplace_back(step.segment<6>(layout.velocity(k)));
  return out;
}

}  // namespace

ImagingSystem linearizeImaging(WindowState& state, const WindowLinearizer& linearizer, int stride) {
  std::vector<int> chosen;
  for (int i = 0; i < static_cast<int>(state.points.size()); i += stride) chosen.push_back(i);
  if (chosen.empty()) return {};
  WindowEvaluation evaluation;
  linearizer.evaluate(state, chosen, evaluation);
  const double half_readout = 0.5 * std::abs(state.keyframes.front().readoutTime());
  const Layout layout{state.size(), half_readout > 0.0};
  LinearizedWindow system = assemble(state, evaluation, layout, half_readout);
  if (layout.rolling) addVelocityPriors(state, layout, half_readout, system);
  ReducedSystem reduced;
  SchurComplement().reduce(system, 0.0, reduced);
  return eliminateKeyframes(reduced, layout, half_readout);
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
  const Layout layout{state.size(), false};
  ReducedSystem reduced;
  SchurComplement().reduce(assemble(state, evaluation, layout, 0.0), 0.0, reduced);
  const double share = static_cast<double>(chosen.size()) / static_cast<double>(points.size());
  return reduced.H.block(0, layout.correction(), layout.correction(), kCorrectionDim) / share;
}

}  // namespace mba_vo
