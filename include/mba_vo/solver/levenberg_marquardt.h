#pragma once

#include <utility>

#include <Eigen/Cholesky>

#include "mba_vo/solver/normal_equations.h"

namespace mba_vo {

struct LevenbergMarquardtOptions {
  int max_iterations = 12;
  int max_rejections = 4;         // in a row
  double initial_damping = 1e-4;  // relative to the diagonal of the Hessian
  double damping_decrease = 0.2;
  double damping_increase = 8.0;
  double relative_decrease = 1e-4;  // of the cost; an accepted step below it ends the search
  double promised_decrease = 0.0;   // of the cost by the quadratic model; a step below it ends the search
  double min_step = 5e-3;           // in the measure of Problem::stepSize; a smaller step is not tried
  double last_step = 0.0;           // likewise; a smaller step that is not small by damping is the last to be tried
};

/// `Equations`: what Problem::linearize returns, NormalEquations or derived from them.
template <typename State, typename Equations>
struct LevenbergMarquardtSummary {
  State state;
  Equations equations;  // at `state`, undamped
  int iterations = 0;   // evaluations of the problem
  int accepted = 0;
};

/// Minimises a robust cost. `Problem` provides
/// - static constexpr int kStates;
/// - NormalEquations<kStates> linearize(const State&), or a type derived from that: the cost and its quadratic model on
///   a fixed set of data;
/// - bool refresh(const State&): chooses the data anew if the state moved far; true if it did;
/// - State plus(const State&, const Matrix<kStates, 1>&): the state after a step;
/// - double stepSize(const Matrix<kStates, 1>&): size of a step, in the unit of min_step.
/// A step is judged on the same data that it was computed from.
template <typename State, typename Problem>
auto minimize(Problem& problem, const State& initial, const LevenbergMarquardtOptions& options) {
  LevenbergMarquardtSummary<State, decltype(problem.linearize(initial))> summary{initial, problem.linearize(initial), 1,
                                                                                 0};
  double damping = options.initial_damping;
  int rejections = 0;
  while (summary.iterations < options.max_iterations && rejections < options.max_rejections) {
    auto damped = summary.equations.hessian;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::Matrix<double, Problem::kStates, 1> step = -damped.ldlt().solve(summary.equations.gradient);
    if (!step.allFinite()) {
      damping *= options.damping_increase;
      ++rejections;
      continue;
    }
    const double size = problem.stepSize(step);
    if (size < options.min_step) break;
    // Near the minimum the noise of the cost is larger than what is left to gain: trying would only be rejected.
    const double promised = -step.dot(summary.equations.gradient + 0.5 * summary.equations.hessian * step);
    if (promised < options.promised_decrease * summary.equations.cost) break;
    const State candidate = problem.plus(summary.state, step);
    auto equations = problem.linearize(candidate);
    ++summary.iterations;
    const bool is_last = size < options.last_step && damping <= options.initial_damping;
    if (!(equations.cost < summary.equations.cost)) {
      if (is_last) break;
      damping *= options.damping_increase;
      ++rejections;
      continue;
    }
    const double decrease = 1.0 - equations.cost / summary.equations.cost;
    ++summary.accepted;
    rejections = 0;
    damping *= options.damping_decrease;
    summary.state = candidate;
    summary.equations = std::move(equations);
    if (problem.refresh(candidate)) {
      summary.equations = problem.linearize(candidate);
      ++summary.iterations;
    } else if (is_last || decrease < options.relative_decrease) {
      break;
    }
  }
  return summary;
}

}  // namespace mba_vo
