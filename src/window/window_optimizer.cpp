#include "mba_vo/window/window_optimizer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mba_vo/window/settling.h"

namespace mba_vo {
namespace {

constexpr double kThresholdQuantile = 0.7;  // of the root energies of a keyframe's residuals
constexpr double kThresholdFactor = 1.5;    // of that quantile
constexpr int kMaxBadRounds = 3;
constexpr int kMaxOutOfBoundsRounds = 2;
constexpr double kMaxDepthFactor = 3.0;  // by which one step may change an inverse depth
constexpr double kSettledPx = 0.3;       // docs/decisions/2026-11-28-settled-points.md
constexpr int kLeastKeyframes = 5;       // of a window whose points may settle: a young one may be far from its minimum

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

struct WindowOptimizer::Step {
  Eigen::VectorXd keyframes;
  Eigen::VectorXd depths;  // of the points that are evaluated
};

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

void WindowOptimizer::evaluate(WindowState& state) { linearizer_.evaluate(state, moving_, evaluation_); }

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
  settled_.clear();
  if (state.size() < 2) return;  // nothing to compare; points wait for a second keyframe
  max_iterations_ = max_iterations;
  lambda_ = options_.initial_lambda;
  penalty_.emplace(state);
  moving_.resize(state.points.size());
  std::iota(moving_.begin(), moving_.end(), 0);
  linearizer_.evaluate(state, moving_, evaluation_, options_.max_drift_px);
  linearizer_.followResiduals(state, evaluation_);
  acceptEnergies(state);
  updateOutlierThresholds(state);
  linearizer_.assemble(state, evaluation_, system_);
  summary_.initial_cost = photometricCost(state) + otherCost(state, scale_prior);
}

/// The step of the damped system; false if there is none.
bool WindowOptimizer::solve(const WindowState& state, const ScalePrior& scale_prior, Step& step) {
  const Eigen::MatrixXd H = system_.H;
  const Eigen::VectorXd b = system_.b;
  const Eigen::VectorXd H_depth = system_.H_depth;
  const Eigen::VectorXd b_depth = system_.b_depth;
  settled_.addTo(system_.H, system_.b);
  state.prior.addTo(state.deltas(), system_.H, system_.b);
  scale_prior.addTo(state, system_.H, system_.b);
  const double precision = state.meanPrecision();
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const PointState& point = state.points[static_cast<std::size_t>(moving_[i])];
    penalty_->addTo(point, static_cast<Eigen::Index>(i), system_);
    addMeasuredDepth(point, precision, static_cast<Eigen::Index>(i), system_);
  }
  schur_.reduce(system_, lambda_, reduced_);
  const bool solved = solver_.solve(reduced_.H, reduced_.b, step.keyframes);
  if (solved) step.depths = schur_.solveDepths(system_, step.keyframes);
  system_.H = H;
  system_.b = b;
  system_.H_depth = H_depth;
  system_.b_depth = b_depth;
  return solved;
}

/// Points that a step hardly moves are not evaluated any more, if that saves something. What is not quadratic in their
/// depths needs their depths at every step.
void WindowOptimizer::settle(WindowState& state, Step& step) {
  std::vector<bool> settles = hardlyMove(state, evaluation_.pairs, step.keyframes, step.depths, kSettledPx);
  std::vector<int> moving;
  for (std::size_t i = 0; i < settles.size(); ++i) {
    const PointState& point = state.points[i];
    settles[i] = settles[i] && !point.measured.known() && !penalty_->concerns(point);
    if (!settles[i]) moving.push_back(static_cast<int>(i));
  }
  if (2 * moving.size() > settles.size()) return;
  moving_ = std::move(moving);
  evaluation_.keepOnly(moving_);
  LinearizedWindow system;
  linearizer_.assemble(state, evaluation_, system);
  for (std::size_t i = 0; i < settles.size(); ++i) {
    if (settles[i]) state.points[i].information = system_.H_depth(static_cast<Eigen::Index>(i));
  }
  settled_.settle(system_, settles, system);
  system_ = std::move(system);
  for (std::size_t i = 0; i < moving_.size(); ++i) step.depths(static_cast<Eigen::Index>(i)) = step.depths(moving_[i]);
}

void WindowOptimizer::move(WindowState& state, const Step& step) {
  step_norm_ = 0.0;
  for (int i = 0; i < state.size(); ++i) {
    const Vector8 delta = step.keyframes.segment<kKeyframeDim>(kKeyframeDim * i);
    state.keyframe(i).delta += delta;
    step_norm_ = std::max(step_norm_, delta.head<6>().norm());
  }
  state.relinearize();
  settled_.move(step.keyframes);
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    double& d = state.points[static_cast<std::size_t>(moving_[i])].inverse_depth;
    d = std::clamp(d + step.depths(static_cast<Eigen::Index>(i)), d / kMaxDepthFactor, d * kMaxDepthFactor);
  }
}

/// Settled points get the depths that suit the keyframes.
void WindowOptimizer::placeSettled(WindowState& state) const {
  if (!settled_.any()) return;
  const Eigen::VectorXd steps = settled_.depthSteps();
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    double& d = state.points[i].inverse_depth;
    d = std::clamp(d + steps(static_cast<Eigen::Index>(i)), d / kMaxDepthFactor, d * kMaxDepthFactor);
  }
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
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    state.points[static_cast<std::size_t>(moving_[i])].information = system_.H_depth(static_cast<Eigen::Index>(i));
  }
  for (PointState& point : state.points) {
    point.information += measuredDepthTerm(point.measured, point.inverse_depth, precision).H;
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
  Step step;
  const bool solved = solve(state, scale_prior, step);
  bool better = solved;
  double change = 0.0;
  if (solved) {
    const double settled_cost = settled_.costChange();  // 0 with the depths that points have when they settle
    // A step that is damped tells nothing of those to come.
    const bool may_settle = state.size() >= kLeastKeyframes && lambda_ <= options_.initial_lambda;
    if (may_settle && !settled_.any()) settle(state, step);
    move(state, step);
    evaluate(state);
    change = costChange(state) + settled_.costChange() - settled_cost + otherCost(state, scale_prior) - other_cost;
    better = change < 0.0;
  }
  if (!better) {
    backup.restore(state);
    if (solved) settled_.move(-step.keyframes);
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
    placeSettled(state);
    summary_.final_cost = photometricCost(state) + settled_.costChange() + otherCost(state, scale_prior);
    summarize(state);
  }
  penalty_.reset();
  return summary_;
}

}  // namespace mba_vo
