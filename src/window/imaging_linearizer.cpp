#include "mba_vo/window/imaging_linearizer.h"

#include <array>
#include <cmath>

#include "mba_vo/solver/point_chunks.h"
#include "mba_vo/window/calibration_system.h"
#include "mba_vo/window/point_activation.h"

namespace mba_vo {
namespace {

// By which velocities by the frames around, 0.014-0.02 rad/s and 0.01 m/s off along recorded motions, move the first
// and the last row [px]. On hand_desk poses were 1.3 times as far off with 0.04 or 1 instead.
constexpr double kExpectedError = 0.1;
constexpr double kItsHalfReadout = 0.013;  // [s] of those recordings: half of the time from the first row to the last

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

void addPair(const PairSystem& pair, const Matrix8& J_host, int host, int target, const ImagingLayout& layout,
             LinearizedWindow& out) {
  using W = PairSystem;
  const std::array<int, 2> h{ImagingLayout::pose(host), layout.velocity(host)};
  const std::array<int, 2> t{ImagingLayout::pose(target), layout.velocity(target)};
  const std::array<W::Weight, 3> of_target{W::kOne, W::kTarget, W::kTargetTarget};
  const std::array<W::Weight, 3> of_host{W::kOne, W::kHost, W::kHostHost};
  const std::array<std::array<W::Weight, 2>, 2> of_both{{{W::kOne, W::kTarget}, {W::kHost, W::kTargetHost}}};
  const int c = layout.correction();
  const std::size_t kinds = layout.rolling() ? 2 : 1;
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
              const ImagingLayout& layout, Eigen::Index row, LinearizedWindow& out) {
  const Vector8 in_host = J_host.transpose() * residual.H_state_depth;
  const auto add = [&](int first, const auto& values) {
    out.V.row(row).segment(first, values.size()) += values.transpose();
  };
  add(ImagingLayout::pose(target), residual.H_state_depth);
  add(ImagingLayout::pose(host), in_host);
  if (layout.rolling()) {
    add(layout.velocity(target), Vector8(at.target * residual.H_state_depth));
    add(layout.velocity(host), Vector8(at.host * in_host));
  }
  add(layout.correction(), residual.H_correction_depth);
  out.H_depth(row) += residual.H_depth;
  out.b_depth(row) += residual.b_depth;
}

/// A velocity has no part in the brightness, whose places in its block are idle.
void addVelocityPriors(const WindowState& state, const ImagingLayout& layout, LinearizedWindow& out) {
  double inverse_depth = 0.0;
  for (const PointState& point : state.points) inverse_depth += point.inverse_depth;
  inverse_depth /= static_cast<double>(state.points.size());
  const double error = kExpectedError * layout.half_readout / kItsHalfReadout;  // [px]
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
    out.b.segment<6>(v) += layout.half_readout *
                           information.cwiseProduct(state.keyframe(k).velocity - state.keyframe(k).expected_velocity);
  }
}

}  // namespace

LinearizedWindow assembleImaging(const WindowState& state, const WindowEvaluation& evaluation,
                                 const ImagingLayout& layout) {
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
      if (layout.rolling()) {
        at = {pair.target_camera.rowDelay(pixel.y()) / layout.half_readout,
              pair.host_camera.rowDelay(point.pixel.y()) / layout.half_readout};
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
  if (layout.rolling()) addVelocityPriors(state, layout, out);
  return out;
}

}  // namespace mba_vo
