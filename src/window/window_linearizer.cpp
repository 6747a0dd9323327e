#include "mba_vo/window/window_linearizer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mba_vo/image/parallel_for.h"
#include "mba_vo/solver/point_chunks.h"
#include "mba_vo/solver/residual_spread.h"

namespace mba_vo {
namespace {

const PairGeometry& pairOf(const std::vector<PairGeometry>& pairs, const WindowState& state, const PointState& point,
                           const PatchResidual& residual) {
  return pairs[static_cast<std::size_t>(point.host * state.size() + residual.target)];
}

bool isGoodTrial(const WindowState& state, const PatchResidual& residual) {
  return residual.trial_energy <= state.keyframe(residual.target).outlier_energy;  // false for kNoEnergy
}

}  // namespace

void WindowEvaluation::keepOnly(const std::vector<int>& some) {
  std::vector<std::size_t> kept;
  auto point = points.begin();
  for (const int number : some) {
    point = std::find(point, points.end(), number);
    kept.push_back(first[static_cast<std::size_t>(point - points.begin())]);
  }
  points = some;
  first = std::move(kept);
}

/// Sums of the residuals of one host in one target, in the target's states.
struct WindowLinearizer::PairSums {
  Matrix8 H = Matrix8::Zero();
  Vector8 b = Vector8::Zero();

  void operator+=(const PairSums& other) {
    H += other.H;
    b += other.b;
  }
  void addTo(LinearizedWindow& out, const Matrix8& J_host, int host, int target) const;
};

class WindowLinearizer::Chunk : public PairSumsOfChunk<PairSums> {
 public:
  using PairSumsOfChunk::PairSumsOfChunk;
};

void WindowLinearizer::evaluateResidual(const PairGeometry& pair, const PointState& point, PatchResidual& residual,
                                        PatchComparison& comparison) const {
  residual.trial_energy = kNoEnergy;
  PatchPath path;
  if (!residual.has_pixels || !makePath(pair, residual.centre, point, path)) return;
  residual.drift = projectionDrift(path, point.pixel);
  if (!comparePatch(pair, path, residual, options_, comparison)) return;
  residual.trial_energy = comparison.energy;
  residual.misfit = comparison.misfit;
}

/// New pixels, if there are none or the projection has drifted away from them.
bool WindowLinearizer::place(const PairGeometry& pair, const PointState& point, float max_drift,
                             PatchResidual& residual) const {
  if (residual.has_pixels && residual.drift <= max_drift) return false;
  placePixels(pair, point.pixel, point.inverse_depth, options_, residual, point.slope);
  return true;
}

template <typename Body>
void WindowLinearizer::forEachResidual(WindowState& state, WindowEvaluation& evaluation, const Body& body) {
  PointChunks(evaluation.points.size()).forEachRow([&](std::size_t /*chunk*/, std::size_t row) {
    PointState& point = state.points[static_cast<std::size_t>(evaluation.points[row])];
    std::size_t patch = evaluation.first[row];
    for (PatchResidual& residual : point.residuals) {
      body(pairOf(evaluation.pairs, state, point, residual), point, residual, evaluation.patches[patch++]);
    }
  });
}

void WindowLinearizer::evaluate(WindowState& state, const std::vector<int>& points, WindowEvaluation& out,
                                std::optional<float> max_drift) const {
  out.points = points;
  out.pairs = makePairGeometries(state, reblur_targets_, points);
  out.first.clear();
  std::size_t residuals = 0;
  for (const int i : points) {
    out.first.push_back(residuals);
    residuals += state.points[static_cast<std::size_t>(i)].residuals.size();
  }
  out.patches.resize(residuals);
  forEachResidual(
      state, out,
      [&](const PairGeometry& pair, const PointState& point, PatchResidual& residual, PatchComparison& comparison) {
        if (max_drift) place(pair, point, *max_drift, residual);
        evaluateResidual(pair, point, residual, comparison);
      });
}

void WindowLinearizer::replacePixels(WindowState& state, float max_drift, WindowEvaluation& evaluation) const {
  forEachResidual(
      state, evaluation,
      [&](const PairGeometry& pair, const PointState& point, PatchResidual& residual, PatchComparison& comparison) {
        if (place(pair, point, max_drift, residual)) evaluateResidual(pair, point, residual, comparison);
      });
}

void WindowLinearizer::followResiduals(WindowState& state, WindowEvaluation& evaluation) const {
  std::vector<std::vector<const PatchComparison*>> into(state.keyframes.size());  // valid ones, by target
  for (std::size_t row = 0; row < evaluation.points.size(); ++row) {
    std::size_t patch = evaluation.first[row];
    for (const PatchResidual& residual : state.points[static_cast<std::size_t>(evaluation.points[row])].residuals) {
      const PatchComparison& comparison = evaluation.patches[patch++];
      if (!std::isnan(residual.trial_energy)) into[static_cast<std::size_t>(residual.target)].push_back(&comparison);
    }
  }
  parallelFor(into.size(), [&](std::size_t i) {
    std::vector<float> sizes;
    sizes.reserve(kResidualPixels * into[i].size());
    for (const PatchComparison* comparison : into[i]) {
      for (const float r : comparison->r) sizes.push_back(std::abs(r));
    }
    if (sizes.empty()) return;
    const double spread = residualSpread(sizes);
    const double largest = static_cast<double>(options_.huber_threshold);
    state.keyframes[i].huber_threshold = static_cast<float>(huberThreshold(spread, largest));
    state.keyframes[i].precision = static_cast<float>(residualPrecision(spread));
  });
  for (std::size_t i = 0; i < evaluation.pairs.size(); ++i) {
    const KeyframeState& target = state.keyframes[i % state.keyframes.size()];
    evaluation.pairs[i].huber_threshold = target.huber_threshold;
    evaluation.pairs[i].precision = target.precision;
  }
  forEachResidual(
      state, evaluation,
      [&](const PairGeometry& pair, const PointState& /*point*/, PatchResidual& residual, PatchComparison& comparison) {
        if (std::isnan(residual.trial_energy)) return;
        weighComparison(pair, residual, options_, comparison);
        residual.trial_energy = comparison.energy;
      });
}

void WindowLinearizer::assemblePoint(const WindowState& state, const WindowEvaluation& evaluation, int row,
                                     Chunk& chunk, LinearizedWindow& out) {
  const auto index = static_cast<std::size_t>(row);
  const PointState& point = state.points[static_cast<std::size_t>(evaluation.points[index])];
  std::size_t patch = evaluation.first[index];
  auto V = out.V.row(row);
  Vector8 host_depth = Vector8::Zero();
  double H_depth = 0.0;
  double b_depth = 0.0;
  PatchPath path;
  ResidualSystem system;
  for (const PatchResidual& residual : point.residuals) {
    const PatchComparison& comparison = evaluation.patches[patch++];
    if (!isGoodTrial(state, residual)) continue;
    const PairGeometry& pair = pairOf(evaluation.pairs, state, point, residual);
    if (!makeJacobianPath(pair, residual.centre, point, path)) continue;
    assembleSystem(comparison, path, pair.blurred, system);
    PairSums& sums = chunk.at(static_cast<std::size_t>(&pair - evaluation.pairs.data()));
    sums.H += system.H;
    sums.b += system.b;
    V.segment<kKeyframeDim>(kKeyframeDim * residual.target) += system.H_state_depth.transpose();
    host_depth.noalias() += pair.J_host.transpose().lazyProduct(system.H_state_depth);
    H_depth += system.H_depth;
    b_depth += system.b_depth;
  }
  V.segment<kKeyframeDim>(kKeyframeDim * point.host) += host_depth.transpose();
  out.H_depth(row) = H_depth;
  out.b_depth(row) = b_depth;
}

void WindowLinearizer::assembleDepths(const WindowState& state, const WindowEvaluation& evaluation,
                                      Eigen::VectorXd& H_depth) const {
  H_depth.setZero(static_cast<Eigen::Index>(evaluation.points.size()));
  PointChunks(evaluation.points.size()).forEachRow([&](std::size_t /*chunk*/, std::size_t row) {
    const PointState& point = state.points[static_cast<std::size_t>(evaluation.points[row])];
    std::size_t patch = evaluation.first[row];
    PatchPath path;
    for (const PatchResidual& residual : point.residuals) {
      const PatchComparison& comparison = evaluation.patches[patch++];
      if (!isGoodTrial(state, residual)) continue;
      const PairGeometry& pair = pairOf(evaluation.pairs, state, point, residual);
      if (!makeJacobianPath(pair, residual.centre, point, path)) continue;
      H_depth(static_cast<Eigen::Index>(row)) += assembleDepth(comparison, path, pair.blurred).H;
    }
  });
}

/// To the blocks of its host and its target.
void WindowLinearizer::PairSums::addTo(LinearizedWindow& out, const Matrix8& J_host, int host, int target) const {
  const int h = kKeyframeDim * host;
  const int t = kKeyframeDim * target;
  const Matrix8 H_host_target = J_host.transpose() * H;
  out.H.block<kKeyframeDim, kKeyframeDim>(t, t) += H;
  out.H.block<kKeyframeDim, kKeyframeDim>(h, h) += H_host_target * J_host;
  out.H.block<kKeyframeDim, kKeyframeDim>(h, t) += H_host_target;
  out.H.block<kKeyframeDim, kKeyframeDim>(t, h) += H_host_target.transpose();
  out.b.segment<kKeyframeDim>(t) += b;
  out.b.segment<kKeyframeDim>(h) += J_host.transpose() * b;
}

void WindowLinearizer::assemble(const WindowState& state, const WindowEvaluation& evaluation,
                                LinearizedWindow& out) const {
  const int n = state.size();
  const std::vector<PairGeometry>& pairs = evaluation.pairs;
  out.setZero(kKeyframeDim * n, static_cast<int>(evaluation.points.size()));
  const PointChunks points(evaluation.points.size());
  std::vector<Chunk> chunks(points.count(), Chunk(pairs.size()));
  points.forEachRow([&](std::size_t chunk, std::size_t row) {
    assemblePoint(state, evaluation, static_cast<int>(row), chunks[chunk], out);
  });

  for (int h = 0; h < n; ++h) {
    for (int t = 0; t < n; ++t) {
      const auto index = static_cast<std::size_t>(h * n + t);
      if (!pairs[index].path) continue;  // without residuals
      PairSums total;
      for (const Chunk& chunk : chunks) chunk.addTo(index, total);
      total.addTo(out, pairs[index].J_host, h, t);
    }
  }
}

void WindowLinearizer::linearize(WindowState& state, const std::vector<int>& points, LinearizedWindow& out) const {
  WindowEvaluation evaluation;
  evaluate(state, points, evaluation);
  assemble(state, evaluation, out);
}

}  // namespace mba_vo
