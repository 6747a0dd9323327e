#include "mba_vo/initialization/initializer_bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr double kBehindPenalty = 50.0;  // residual over sigma charged to a point behind a camera
constexpr double kMinSigma = 0.1;        // [px]
constexpr double kMinDepth = 1e-3;       // of R ray + w t, whose scale is that of a unit ray

double huberLoss(double r, double k) { return r <= k ? 0.5 * r * r : k * (r - 0.5 * k); }
double huberWeight(double r, double k) { return r <= k ? 1.0 : k / r; }

double viewCost(const Bundle& bundle, const BundleView& view, double huber) {
  double cost = 0.0;
  for (const double e : reprojectionErrors(bundle, view)) {
    cost += huberLoss(std::min(e / view.sigma, kBehindPenalty), huber);
  }
  return cost;
}

double totalCost(const Bundle& bundle, double huber) {
  double cost = 0.0;
  for (const BundleView& view : bundle.views) cost += viewCost(bundle, view, huber);
  return cost;
}

/// Normal equations of the bundle with the inverse depths kept apart: they only couple through the poses, and the row
/// time, which comes after them.
struct BundleEquations {
  Eigen::MatrixXd H_poses;
  Eigen::VectorXd g_poses;
  Eigen::VectorXd H_depth;       // by point
  Eigen::VectorXd g_depth;       // by point
  Eigen::MatrixXd H_pose_depth;  // column by point
  int observations = 0;

  /// Adds the derivative of one observation by the row time, whose view's states begin at `view`.
  void addRowTime(Eigen::Index point, Eigen::Index view, const ReprojectionTerm& term, const Eigen::Vector2d& J,
                  double weight) {
    const Eigen::Index at = H_poses.rows() - 1;
    H_poses.block<1, 6>(at, view).noalias() += weight * J.transpose() * term.J_pose;
    H_poses(at, at) += weight * J.squaredNorm();
    g_poses[at] += weight * J.dot(term.residual);
    H_pose_depth(at, point) += weight * J.dot(term.J_inverse_depth);
  }
};

BundleEquations linearize(const Bundle& bundle, double huber) {
  const auto points = static_cast<Eigen::Index>(bundle.rays.size());
  const Eigen::Index dim = 6 * static_cast<Eigen::Index>(bundle.views.size()) + (bundle.findsRowTime() ? 1 : 0);
  BundleEquations eq;
  eq.H_poses = Eigen::MatrixXd::Zero(dim, dim);
  eq.g_poses = Eigen::VectorXd::Zero(dim);
  eq.H_depth = Eigen::VectorXd::Zero(points);
  eq.g_depth = Eigen::VectorXd::Zero(points);
  eq.H_pose_depth = Eigen::MatrixXd::Zero(dim, points);
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    const BundleView& view = bundle.views[v];
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(v);
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    for (Eigen::Index column = 0; column < points; ++column) {
      const auto p = static_cast<std::size_t>(column);
      if (!view.observed[p]) continue;
      const ReprojectionTerm term = reprojectionTerm(bundle.camera, view.T_view_reference, bundle.rays[p],
                                                     bundle.inverse_depth[p], view.pixel[p]);
      if (!term.in_front) continue;
      const double weight = huberWeight(term.residual.norm() / view.sigma, huber) / (view.sigma * view.sigma);
      H.noalias() += weight * term.J_pose.transpose() * term.J_pose;
      g.noalias() += weight * term.J_pose.transpose() * term.residual;
      eq.H_depth[column] += weight * term.J_inverse_depth.squaredNorm();
      eq.g_depth[column] += weight * term.J_inverse_depth.dot(term.residual);
      eq.H_pose_depth.col(column).segment<6>(at) = weight * term.J_pose.transpose() * term.J_inverse_depth;
      if (bundle.findsRowTime()) {
        eq.addRowTime(column, at, term, term.J_ray * bundle.ray_by_row_time[p] - view.pixel_by_row_time[p], weight);
      }
      ++eq.observations;
    }
    eq.H_poses.block<6, 6>(at, at) = H;
    eq.g_poses.segment<6>(at) = g;
  }
  return eq;
}

struct BundleStep {
  Eigen::VectorXd poses;  // and the row time
  Eigen::VectorXd depth;  // by point
};

BundleStep solve(const BundleEquations& eq, double lambda) {
  Eigen::MatrixXd S = eq.H_poses;
  S.diagonal() *= 1.0 + lambda;
  S.diagonal().array() += 1e-9;
  Eigen::VectorXd inverse = ((1.0 + lambda) * eq.H_depth.array() + 1e-9).inverse();
  inverse = (eq.H_depth.array() > 0.0).select(inverse, 0.0);
  const Eigen::MatrixXd scaled = eq.H_pose_depth * inverse.cwiseSqrt().asDiagonal();
  S.selfadjointView<Eigen::Lower>().rankUpdate(scaled, -1.0);
  const Eigen::VectorXd g = eq.g_poses - eq.H_pose_depth * inverse.cwiseProduct(eq.g_depth);
  BundleStep step;
  step.poses = -S.selfadjointView<Eigen::Lower>().ldlt().solve(g);
  step.depth = -inverse.cwiseProduct(eq.g_depth + eq.H_pose_depth.transpose() * step.poses);
  return step;
}

void apply(const BundleStep& step, Bundle& bundle) {
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    SE3& T = bundle.views[v].T_view_reference;
    T = SE3::exp(step.poses.segment<6>(6 * static_cast<Eigen::Index>(v))) * T;
  }
  for (std::size_t p = 0; p < bundle.inverse_depth.size(); ++p) {
    bundle.inverse_depth[p] += step.depth[static_cast<Eigen::Index>(p)];
  }
  if (bundle.findsRowTime()) bundle.setRowTime(bundle.row_time + step.poses[step.poses.size() - 1]);
}

/// What a step changes; copying the observations with every trial would cost more than the step.
struct BundleState {
  explicit BundleState(const Bundle& bundle) : inverse_depth(bundle.inverse_depth), row_time(bundle.row_time) {
    for (const BundleView& view : bundle.views) poses.push_back(view.T_view_reference);
  }
  void restore(Bundle& bundle) const {
    bundle.inverse_depth = inverse_depth;
    for (std::size_t v = 0; v < poses.size(); ++v) bundle.views[v].T_view_reference = poses[v];
    bundle.setRowTime(row_time);
  }
  std::vector<double> inverse_depth;
  double row_time;
  std::vector<SE3> poses;
};

}  // namespace

void Bundle::setRowTime(double seconds) {
  const double change = seconds - row_time;
  row_time = seconds;
  for (std::size_t p = 0; p < ray_by_row_time.size(); ++p) {
    rays[p] += change * ray_by_row_time[p];
    for (BundleView& view : views) view.pixel[p] += change * view.pixel_by_row_time[p];
  }
}

ReprojectionTerm reprojectionTerm(const PinholeCamera& camera, const SE3& T_view_reference, const Eigen::Vector3d& ray,
                                  double inverse_depth, const Eigen::Vector2d& pixel) {
  ReprojectionTerm term;
  const Eigen::Vector3d& t = T_view_reference.translation();
  const Eigen::Vector3d point = T_view_reference.rotation() * ray + inverse_depth * t;
  if (point.z() < kMinDepth) return term;
  term.in_front = true;
  term.residual = camera.project(point) - pixel;
  const Eigen::Matrix<double, 2, 3> J = camera.projectionJacobian(point);
  term.J_pose.leftCols<3>() = inverse_depth * J;
  term.J_pose.rightCols<3>() = -J * hat(point);
  term.J_inverse_depth = J * t;
  term.J_ray = J * T_view_reference.rotationMatrix();
  return term;
}

std::vector<double> reprojectionErrors(const Bundle& bundle, const BundleView& view) {
  std::vector<double> errors;
  errors.reserve(bundle.rays.size());
  const Eigen::Matrix3d R = view.T_view_reference.rotationMatrix();
  for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
    if (!view.observed[p]) continue;
    const Eigen::Vector3d point = R * bundle.rays[p] + bundle.inverse_depth[p] * view.T_view_reference.translation();
    errors.push_back(point.z() < kMinDepth ? std::numeric_limits<double>::infinity()
                                           : (bundle.camera.project(point) - view.pixel[p]).norm());
  }
  return errors;
}

BundleSummary optimizeBundle(Bundle& bundle, const BundleOptions& options) {
  BundleSummary summary;
  double cost = totalCost(bundle, options.huber);
  summary.initial_cost = cost;
  double lambda = 1e-4;
  while (summary.iterations < options.max_iterations) {
    const BundleEquations eq = linearize(bundle, options.huber);
    summary.observations = eq.observations;
    const BundleState before(bundle);
    bool accepted = false;
    double decrease = 0.0;
    while (!accepted && summary.iterations < options.max_iterations) {
      ++summary.iterations;
      apply(solve(eq, lambda), bundle);
      const double trial = totalCost(bundle, options.huber);
      accepted = trial < cost;
      if (accepted) {
        decrease = cost - trial;
        cost = trial;
        lambda = std::max(0.1 * lambda, 1e-9);
      } else {
        before.restore(bundle);
        lambda *= 10.0;
      }
    }
    if (!accepted || decrease <= options.relative_decrease * cost) break;
  }
  summary.final_cost = cost;
  return summary;
}

BundleSummary optimizePose(const Bundle& bundle, BundleView& view, const BundleOptions& options) {
  BundleSummary summary;
  double cost = viewCost(bundle, view, options.huber);
  summary.initial_cost = cost;
  double lambda = 1e-4;
  for (; summary.iterations < options.max_iterations; ++summary.iterations) {
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    summary.observations = 0;
    for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
      if (!view.observed[p]) continue;
      const ReprojectionTerm term = reprojectionTerm(bundle.camera, view.T_view_reference, bundle.rays[p],
                                                     bundle.inverse_depth[p], view.pixel[p]);
      if (!term.in_front) continue;
      const double weight = huberWeight(term.residual.norm() / view.sigma, options.huber);
      H.noalias() += weight * term.J_pose.transpose() * term.J_pose;
      g.noalias() += weight * term.J_pose.transpose() * term.residual;
      ++summary.observations;
    }
    H.diagonal() *= 1.0 + lambda;
    H.diagonal().array() += 1e-9;
    const SE3 before = view.T_view_reference;
    view.T_view_reference = SE3::exp(-H.ldlt().solve(g)) * before;
    const double trial = viewCost(bundle, view, options.huber);
    const double decrease = cost - trial;
    if (decrease > 0.0) {
      cost = trial;
      lambda = std::max(0.1 * lambda, 1e-9);
      if (decrease <= options.relative_decrease * cost) break;
    } else {
      view.T_view_reference = before;
      lambda *= 10.0;
    }
  }
  summary.final_cost = cost;
  return summary;
}

void estimateSigmas(Bundle& bundle) {
  for (BundleView& view : bundle.views) {
    view.sigma = std::max(kMinSigma, median(reprojectionErrors(bundle, view)) / 1.177);
  }
}

std::vector<double> inverseDepthVariances(const Bundle& bundle) {
  std::vector<double> information(bundle.rays.size(), 0.0);
  for (const BundleView& view : bundle.views) {
    for (std::size_t p = 0; p < bundle.rays.size(); ++p) {
      if (!view.observed[p]) continue;
      const ReprojectionTerm term = reprojectionTerm(bundle.camera, view.T_view_reference, bundle.rays[p],
                                                     bundle.inverse_depth[p], view.pixel[p]);
      if (term.in_front) information[p] += term.J_inverse_depth.squaredNorm() / (view.sigma * view.sigma);
    }
  }
  std::vector<double> variances;
  variances.reserve(information.size());
  for (const double i : information) variances.push_back(1.0 / i);
  return variances;
}

void normalizeScale(Bundle& bundle) {
  std::vector<double> seen;
  for (std::size_t p = 0; p < bundle.inverse_depth.size(); ++p) {
    const auto sees = [p](const BundleView& view) { return view.observed[p] != 0; };
    if (std::any_of(bundle.views.begin(), bundle.views.end(), sees)) seen.push_back(bundle.inverse_depth[p]);
  }
  if (seen.empty()) return;
  const double scale = median(std::move(seen));
  if (scale == 0.0) return;
  for (double& w : bundle.inverse_depth) w /= scale;
  for (BundleView& view : bundle.views) {
    const SE3& T = view.T_view_reference;
    view.T_view_reference = SE3(T.rotation(), scale * T.translation());
  }
}

}  // namespace mba_vo
