#include "mba_vo/mapping/window_linearizer.h"

#include <algorithm>

#include "mba_vo/image/parallel_for.h"

namespace mba_vo {
namespace {

constexpr int kMaxChunks = 16;
constexpr int kMinChunkPoints = 64;

}  // namespace

/// Sums of the residuals of one host in one target, in the target's states.
struct PairSums {
  Matrix8 H = Matrix8::Zero();
  Vector8 b = Vector8::Zero();
};

struct WindowLinearizer::Chunk {
  std::vector<PairSums> pairs;  // host * keyframes + target
};

void WindowLinearizer::placePixels(WindowState& state, float max_drift) const {
  const std::vector<PairGeometry> pairs = makePairGeometries(state, reblur_targets_);
  for (PointState& point : state.points) {
    for (PatchResidual& residual : point.residuals) {
      if (residual.has_pixels && residual.drift <= max_drift) continue;
      const PairGeometry& pair = pairs[static_cast<std::size_t>(point.host * state.size() + residual.target)];
      mba_vo::placePixels(pair, point.pixel, point.inverse_depth, options_, residual);
    }
  }
}

void WindowLinearizer::linearizePoint(WindowState& state, const std::vector<PairGeometry>& pairs, PointState& point,
                                      int row, Chunk& chunk, LinearizedWindow& out) const {
  auto V = out.V.row(row);
  Vector8 host_depth = Vector8::Zero();
  double H_depth = 0.0;
  double b_depth = 0.0;
  PatchPath path;
  PatchComparison comparison;
  PatchMoments moments;
  ResidualSystem system;
  for (PatchResidual& residual : point.residuals) {
    residual.trial_energy = kNoEnergy;
    if (!residual.has_pixels) continue;
    const auto index = static_cast<std::size_t>(point.host * state.size() + residual.target);
    const PairGeometry& pair = pairs[index];
    const Eigen::Vector2d centre = residual.centre.cast<double>();
    if (!pair.path->makeWithoutPose(centre, point.inverse_depth, path)) continue;
    residual.drift = projectionDrift(path, point.pixel);
    if (!comparePatch(pair, path, residual, options_, comparison)) continue;
    residual.trial_energy = comparison.energy;
    if (comparison.energy > state.keyframe(residual.target).outlier_energy) continue;
    const FixedMotionPathMaker& jacobian_maker = pair.first_path ? *pair.first_path : *pair.path;
    if (!jacobian_maker.make(centre, point.inverse_depth, path)) continue;
    sumMoments(pair, comparison, moments);
    assembleSystem(moments, path, pair.blurred, system);
    chunk.pairs[index].H += system.H;
    chunk.pairs[index].b += system.b;
    V.segment<kKeyframeDim>(kKeyframeDim * residual.target) += system.H_state_depth.transpose();
    host_depth.noalias() += pair.J_host.transpose().lazyProduct(system.H_state_depth);
    H_depth += system.H_depth;
    b_depth += system.b_depth;
  }
  V.segment<kKeyframeDim>(kKeyframeDim * point.host) += host_depth.transpose();
  out.H_depth(row) = H_depth;
  out.b_depth(row) = b_depth;
}

namespace {

/// Adds the sums of one pair to the blocks of its host and its target.
void addPair(const PairSums& sums, const Matrix8& J_host, int host, int target, LinearizedWindow& out) {
  const int h = kKeyframeDim * host;
  const int t = kKeyframeDim * target;
  const Matrix8 H_host_target = J_host.transpose() * sums.H;
  out.H.block<kKeyframeDim, kKeyframeDim>(t, t) += sums.H;
  out.H.block<kKeyframeDim, kKeyframeDim>(h, h) += H_host_target * J_host;
  out.H.block<kKeyframeDim, kKeyframeDim>(h, t) += H_host_target;
  out.H.block<kKeyframeDim, kKeyframeDim>(t, h) += H_host_target.transpose();
  out.b.segment<kKeyframeDim>(t) += sums.b;
  out.b.segment<kKeyframeDim>(h) += J_host.transpose() * sums.b;
}

}  // namespace

void WindowLinearizer::linearize(WindowState& state, const std::vector<int>& points, LinearizedWindow& out) const {
  const int n = state.size();
  const int count = static_cast<int>(points.size());
  const std::vector<PairGeometry> pairs = makePairGeometries(state, reblur_targets_);
  out.setZero(kKeyframeDim * n, count);

  const int chunk_points = std::max(kMinChunkPoints, (count + kMaxChunks - 1) / kMaxChunks);
  std::vector<Chunk> chunks(static_cast<std::size_t>((count + chunk_points - 1) / chunk_points));
  const auto linearizeChunk = [&](std::size_t c) {
    chunks[c].pairs.resize(pairs.size());
    const int first = static_cast<int>(c) * chunk_points;
    for (int row = first; row < std::min(first + chunk_points, count); ++row) {
      PointState& point = state.points[static_cast<std::size_t>(points[static_cast<std::size_t>(row)])];
      linearizePoint(state, pairs, point, row, chunks[c], out);
    }
  };
  parallelFor(chunks.size(), linearizeChunk);

  for (int h = 0; h < n; ++h) {
    for (int t = 0; t < n; ++t) {
      if (h == t) continue;
      const auto index = static_cast<std::size_t>(h * n + t);
      PairSums total;
      for (const Chunk& chunk : chunks) {
        total.H += chunk.pairs[index].H;
        total.b += chunk.pairs[index].b;
      }
      addPair(total, pairs[index].J_host, h, t, out);
    }
  }
}

}  // namespace mba_vo
