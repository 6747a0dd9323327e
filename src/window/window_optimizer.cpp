#include "mba_vo/window/window_optimizer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mba_vo {
namespace {

constexpr double kThresholdQuantile = 0.7;  // of the root energies of a keyframe's residuals
constexpr double kThresholdFactor = 1.5;    // of that quantile
constexpr int kMaxBadRounds = 3;
constexpr int kMaxOutOfBoundsRounds = 2;
constexpr double kMaxDepthFactor = 3.0;  // by which one step may change an inverse depth

double truncated(float energy, double limit) { return std::min(static_cast<double>(energy), limit); }

/// A patch all of whose pixels are at the Huber threshold is always acceptable; beyond that a residual is compared with
/// the others of its keyframe. The two are averaged, so that neither a perfect nor a bad keyframe runs away.
double outlierEnergy(std::vector<float>& energies, double huber_threshold, double precision) {
  const double acceptable = huber_threshold * std::sqrt(precision * kResidualPixels);
  if (energies.empty()) return acceptable * acceptable;
  const auto rank =
      energies.begin() + static_cast<std::ptrdiff_t>(kThresholdQuantile * static_cast<double>(energies.size() - 1));
  std::nth_element(energies.begin(), rank, energies.end());
  const double root = 0.5 * acceptable + 0.5 * kThresholdFactor * std::sqrt(static_cast<double>(*rank));
  return root * root;
}

}  // namespace

/// State before a step.
struct WindowOptimizer::Backup {
  std::vector<KeyframeState> keyframes;
  std::vector<double> inverse_depths;
  std::vector<float> misfits;  // of the residuals, point by point
  MarginalizationPrior prior;

  explicit Backup(const WindowState& state) : keyframes(state.keyframes), prior(state.prior) {
    for (const PointState& p : state.points) {
      inverse_depths.push_back(p.inverse_depth);
      for (const PatchResidual& r : p.residuals) misfits.push_back(r.misfit);
    }
  }
  void restore(WindowState& state) const {
    state.keyframes = keyframes;
    state.prior = prior;
    auto misfit = misfits.begin();
    for (std::size_t i = 0; i < inverse_depths.size(); ++i) {
      state.points[i].inverse_depth = inverse_depths[i];
      for (PatchResidual& r : state.points[i].residuals) r.misfit = *misfit++;
    }
  }
};

double WindowOptimizer::photometricCost(const WindowState& state) {
  double cost = 0.0;
  for (const PointState& point : state.points) {
    for (const PatchResidual& residual : point.residuals) {
      if (std::isnan(residual.energy)) continue;
      cost += truncated(residual.energy, state.keyframe(residual.target).outlier_energy);
    }
  }
  return cost;
}

/// Change of the photometric cost; a residual that left an image keeps its old cost, so that leaving never pays.
double WindowOptimizer::costChange(const WindowState& state) const {
  double change = 0.0;
  for (const PointState& point : state.points) {
    for (const PatchResidual& residual : point.residuals) {
      if (std::isnan(residual.energy) || std::isnan(residual.trial_energy)) continue;
      const double limit = state.keyframe(residual.target).outlier_energy;
      change += truncated(residual.trial_energy, limit) - truncated(residual.energy, limit);
    }
  }
  return change;
}

void WindowOptimizer::evaluateAll(WindowState& state) {
  std::vector<int> all(state.points.size());
  std::iota(all.begin(), all.end(), 0);
  linearizer_.evaluate(state, all, evaluation_);
}

void WindowOptimizer::acceptEnergies(WindowState& state) const {
  for (PointState& point : state.points) {
    for (PatchResidual& residual : point.residuals) residual.energy = residual.trial_energy;
  }
}

void WindowOptimizer::updateOutlierThresholds(WindowState& state) const {
  std::vector<std::vector<float>> energies(state.keyframes.size());
  for (const PointState& point : state.points) {
    for (const PatchResidual& residual : point.residuals) {
      if (std::isnan(residual.energy)) continue;
      energies[static_cast<std::size_t>(residual.target)].push_back(residual.energy);
    }
  }
  for (std::size_t i = 0; i < energies.size(); ++i) {
    KeyframeState& keyframe = state.keyframes[i];
    const double huber_threshold = std::min(huber_threshold_, static_cast<double>(keyframe.huber_threshold));
    keyframe.outlier_energy = outlierEnergy(energies[i], huber_threshold, static_cast<double>(keyframe.precision));
  }
}

/// Of what is no photometric residual.
double WindowOptimizer::otherCost(const WindowState& state, const ScalePrior& scale_prior) const {
  return state.prior.cost(state.deltas()) + scale_prior.cost(state) + penalty_->cost(state) + measuredDepthCost(state);
}

void WindowOptimizer::begin(WindowState& state, const ScalePrior& scale_prior, int max_iterations) {
  summary_ = {};
  penalty_.reset();
  if (state.size() < 2) return;  // nothing to compare; points wait for a second keyframe
  max_iterations_ = max_iterations;
  lambda_ = options_.initial_lambda;
  penalty_.emplace(state);
  linearizer_.placePixels(state, options_.max_drift_px);
  evaluateAll(state);
  linearizer_.followResiduals(state, evaluation_);
  acceptEnergies(state);
  updateOutlierThresholds(state);
  linearizer_.assemble(state, evaluation_, system_);
  summary_.initial_cost = photometricCost(state) + otherCost(state, scale_prior);
}

/// Moves the state by the step of the damped system; false if there is none.
bool WindowOptimizer::step(WindowState& state, const ScalePrior& scale_prior) {
  const Eigen::MatrixXd H = system_.H;
  const Eigen::VectorXd b = system_.b;
  const Eigen::VectorXd H_depth = system_.H_depth;
  const Eigen::VectorXd b_depth = system_.b_depth;
  state.prior.addTo(state.deltas(), system_.H, system_.b);
  scale_prior.addTo(state, system_.H, system_.b);
  penalty_->addTo(state, system_);
  const double precision = state.meanPrecision();
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    addMeasuredDepth(state.points[i], precision, static_cast<Eigen::Index>(i), system_);
  }
  schur_.reduce(system_, lambda_, reduced_);
  Eigen::VectorXd x;
  const bool solved = solver_.solve(reduced_.H, reduced_.b, x);
  Eigen::VectorXd depth_steps;
  if (solved) depth_steps = schur_.solveDepths(system_, x);
  system_.H = H;
  system_.b = b;
  system_.H_depth = H_depth;
  system_.b_depth = b_depth;
  if (!solved) return false;
  step_norm_ = 0.0;
  for (int i = 0; i < state.size(); ++i) {
    const Vector8 delta = x.segment<kKeyframeDim>(kKeyframeDim * i);
    state.keyframe(i).delta += delta;
    step_norm_ = std::max(step_norm_, delta.head<6>().norm());
  }
  state.relinearize();
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    double& d = state.points[i].inverse_depth;
    d = std::clamp(d + depth_steps(static_cast<Eigen::Index>(i)), d / kMaxDepthFactor, d * kMaxDepthFactor);
  }
  return true;
}

/// Takes the step just evaluated. Thresholds and pixels follow the state.
void WindowOptimizer::accept(WindowState& state) {
  acceptEnergies(state);
  updateOutlierThresholds(state);
  linearizer_.replacePixels(state, options_.max_drift_px, evaluation_);
  acceptEnergies(state);
}

/// And drops what has been bad for too long.
void WindowOptimizer::summarize(WindowState& state) {
  const double precision = state.meanPrecision();
  double energy = 0.0;
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    PointState& point = state.points[i];
    point.information = system_.H_depth(static_cast<Eigen::Index>(i)) +
                        measuredDepthTerm(point.measured, point.inverse_depth, precision).H;
    for (PatchResidual& residual : point.residuals) {
      const bool good = state.isGood(residual);
      residual.bad_rounds = good ? 0 : residual.bad_rounds + 1;
      summary_.residuals += good ? 1 : 0;
      energy += good ? static_cast<double>(residual.misfit) : 0.0;
    }
    auto& residuals = point.residuals;
    residuals.erase(std::remove_if(residuals.begin(), residuals.end(),
                                   [](const PatchResidual& r) {
                                     return r.bad_rounds >=
                                            (std::isnan(r.energy) ? kMaxOutOfBoundsRounds : kMaxBadRounds);
                                   }),
                    residuals.end());
  }
  summary_.depths = compareDepths(state);
  summary_.rms = std::sqrt(energy / std::max(1, summary_.residuals * kResidualPixels));
  state.points.erase(std::remove_if(state.points.begin(), state.points.end(),
                                    [&](const PointState& p) {
                                      return state.goodResiduals(p) == 0 || !penalty_->isPlausible(p.inverse_depth);
                                    }),
                     state.points.end());
}

bool WindowOptimizer::iterate(WindowState& state, const ScalePrior& scale_prior) {
  if (!penalty_ || summary_.iterations >= max_iterations_ || lambda_ > options_.max_lambda) return false;
  ++summary_.iterations;
  const Backup backup(state);
  const double other_cost = otherCost(state, scale_prior);
  bool better = step(state, scale_prior);
  double change = 0.0;
  if (better) {
    evaluateAll(state);
    change = costChange(state) + otherCost(state, scale_prior) - other_cost;
    better = change < 0.0;
  }
  if (!better) {
    backup.restore(state);
    lambda_ = std::max(lambda_, options_.initial_lambda) * 10.0;
    return summary_.iterations < max_iterations_ && lambda_ <= options_.max_lambda;
  }
  accept(state);
  lambda_ = std::max(0.1 * lambda_, options_.min_lambda);
  const bool converged =
      -change < options_.min_relative_decrease * photometricCost(state) || step_norm_ < options_.min_step;
  if (converged || summary_.iterations == max_iterations_) {
    linearizer_.assembleDepths(state, evaluation_, system_.H_depth);
    return false;
  }
  linearizer_.assemble(state, evaluation_, system_);
  return true;
}

WindowSummary WindowOptimizer::finish(WindowState& state, const ScalePrior& scale_prior) {
  if (penalty_) {
    summary_.final_cost = photometricCost(state) + otherCost(state, scale_prior);
    summarize(state);
  }
  penalty_.reset();
  return summary_;
}

}  // namespace mba_vo
