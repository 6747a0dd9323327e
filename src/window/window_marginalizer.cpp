#include "mba_vo/window/window_marginalizer.h"

#include <algorithm>

#include "mba_vo/window/imaging_system.h"

namespace mba_vo {
namespace {

constexpr std::size_t kCouplingStride = 4;  // of the points: as good as with 1 on webcams, and a fourth of the time

}  // namespace

bool WindowMarginalizer::wellObserved(const WindowState& state, const PointState& point) const {
  return state.goodResiduals(point) >= std::min(options_.min_good_residuals, state.size() - 1) &&
         point.information * point.inverse_depth * point.inverse_depth >= options_.min_relative_information;
}

void WindowMarginalizer::connectObservers(WindowState& state, const std::vector<int>& points) const {
  for (const int index : points) {
    const PointState& point = state.points[static_cast<std::size_t>(index)];
    state.prior.connect(point.host);
    for (const PatchResidual& residual : point.residuals) {
      if (state.isGood(residual)) state.prior.connect(residual.target);
    }
  }
}

void WindowMarginalizer::marginalizePoints(WindowState& state, const std::vector<int>& points) const {
  std::vector<int> kept;
  std::copy_if(points.begin(), points.end(), std::back_inserter(kept),
               [&](int index) { return wellObserved(state, state.points[static_cast<std::size_t>(index)]); });
  if (!kept.empty()) {
    LinearizedWindow system;
    linearizer_.linearize(state, kept, system);
    const double precision = state.meanPrecision();
    for (std::size_t i = 0; i < kept.size(); ++i) {
      addMeasuredDepth(state.points[static_cast<std::size_t>(kept[i])], precision, static_cast<Eigen::Index>(i),
                       system);
    }
    ReducedSystem reduced;
    SchurComplement().reduce(system, 0.0, reduced);
    // The gradient was taken at the current deviations; the prior keeps it at the linearisation points.
    state.prior.add(reduced.H, reduced.b - reduced.H * state.deltas());
    if (!state.correction_settled) {
      state.prior.addCalibrationCoupling(calibrationCoupling(state, linearizer_, kept, kCouplingStride));
    }
    connectObservers(state, kept);
  }
  std::vector<bool> leaves(state.points.size(), false);
  for (const int index : points) leaves[static_cast<std::size_t>(index)] = true;
  std::vector<PointState> remaining;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (!leaves[i]) remaining.push_back(std::move(state.points[i]));
  }
  state.points = std::move(remaining);
}

void WindowMarginalizer::marginalizeHosted(WindowState& state, int host) const {
  std::vector<int> hosted;
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    if (state.points[i].host == host) hosted.push_back(static_cast<int>(i));
  }
  marginalizePoints(state, hosted);
}

void WindowMarginalizer::marginalizeUnseen(WindowState& state) const {
  const int recent = state.size() - 2;
  if (recent < 1) return;
  std::vector<int> unseen;
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    const PointState& point = state.points[i];
    const bool seen = point.host >= recent ||
                      std::any_of(point.residuals.begin(), point.residuals.end(),
                                  [&](const PatchResidual& r) { return r.target >= recent && state.isGood(r); });
    if (!seen) unseen.push_back(static_cast<int>(i));
  }
  marginalizePoints(state, unseen);
}

void WindowMarginalizer::marginalizeKeyframe(WindowState& state, int keyframe) const {
  state.prior.marginalize(keyframe);
  state.removeKeyframe(keyframe);
}

}  // namespace mba_vo
