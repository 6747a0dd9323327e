#include "mba_vo/window/motion_alignment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mba_vo/blur/reblur.h"
#include "mba_vo/geometry/median.h"
#include "mba_vo/geometry/small_adjoint.h"
#include "mba_vo/image/parallel_for.h"
#include "mba_vo/window/point_activation.h"

namespace mba_vo {
namespace {

constexpr std::size_t kLeastAligned = 50;
constexpr std::size_t kMostPatches = 600;     // more would not tell much more
constexpr std::size_t kPatchesPerChunk = 64;  // in one piece of parallel work
constexpr double kMaxDrift = 0.75;            // [px] beyond it a patch gets new pixels
constexpr double kMotionError = 0.5;          // [px] of the motion by the frames around
constexpr int kMostEvaluations = 6;
constexpr double kLeastStep = 0.01;  // [px]
constexpr int kPathRows = 6;         // moments of the gradient with 1, u and u^2

using Products = MomentProducts<16>;
using PathJacobian = Products::Rows<kPathRows>;  // by the pose and by xi, 12 columns

/// What moves the moments of the gradient. An increment of xi moves the camera, `row` exposures after the middle row,
/// by (u + row) J_l(u xi) of it, to first order in xi.
PathJacobian pathJacobian(const PatchPath& path, const Vector6& xi, double row) {
  const Matrix26 J_xi_0 = path.J_pose[0];
  const Matrix26 J_xi_1 = path.J_pose[1] + 0.5 * path.J_pose[0].lazyProduct(smallAdjoint(xi));
  PathJacobian E = PathJacobian::Zero();
  E.leftCols<12>() << path.J_pose[0], row * J_xi_0,  //
      path.J_pose[1], J_xi_0 + row * J_xi_1, Matrix26::Zero(), J_xi_1;
  return E;
}

void multiplyOut(const PatchComparison& c, const ReblurredPatch& reblurred, Products& products) {
  SparsePixels uugx;
  SparsePixels uugy;
  for (std::size_t k = 0; k < kResidualPixels; ++k) {
    uugx[k] = -c.gain * reblurred.uugx[k];
    uugy[k] = -c.gain * reblurred.uugy[k];
  }
  mba_vo::multiplyOut(c.weight, {&c.gx, &c.gy, &c.ugx, &c.ugy, &uugx, &uugy, &c.J_a, &kJacobianOfOffset, &c.r},
                      kPathRows, 12, products);
}

}  // namespace

MotionAlignment::MotionAlignment(const WindowState& state, int target, const ResidualOptions& options)
    : MotionAlignment(state, state.keyframe(target), patchesInto(state, target), options) {}

MotionAlignment::MotionAlignment(const WindowState& state, const KeyframeState& frame, const ResidualOptions& options)
    : MotionAlignment(state, frame, patchesOfAll(state), options) {}

MotionAlignment::MotionAlignment(const WindowState& state, const KeyframeState& target, std::vector<Patch> patches,
                                 const ResidualOptions& options)
    : state_(state),
      target_(target),
      options_(options),
      focal_length_(target.original->level(0).camera.fx),
      patches_(std::move(patches)) {
  std::vector<double> inverse_depths;
  for (const Patch& patch : patches_) inverse_depths.push_back(patch.point->inverse_depth);
  if (!inverse_depths.empty()) median_inverse_depth_ = median(std::move(inverse_depths));
  choosePatches();
}

std::vector<MotionAlignment::Patch> MotionAlignment::patchesInto(const WindowState& state, int target) {
  std::vector<Patch> patches;
  for (const PointState& point : state.points) {
    for (const PatchResidual& residual : point.residuals) {
      if (residual.target == target) patches.push_back({&point, residual});
    }
  }
  return patches;
}

std::vector<MotionAlignment::Patch> MotionAlignment::patchesOfAll(const WindowState& state) {
  std::vector<Patch> patches;
  for (const PointState& point : state.points) patches.push_back({&point, PatchResidual()});
  return patches;
}

void MotionAlignment::choosePatches() {
  if (patches_.size() > kMostPatches) {
    std::vector<Patch> some;
    for (std::size_t i = 0; i < kMostPatches; ++i) some.push_back(patches_[i * patches_.size() / kMostPatches]);
    patches_ = std::move(some);
  }
  refresh(initial());
  const std::vector<PairGeometry> pairs = pairsWith(target_);
  const auto limit = static_cast<float>(target_.outlier_energy);
  PatchPath path;
  PatchComparison comparison;
  const auto cannotBeSeen = [&](Patch& patch) {
    const PairGeometry& pair = pairs[static_cast<std::size_t>(patch.point->host)];
    if (!patch.residual.has_pixels || !makePath(pair, patch.residual.centre, *patch.point, path)) return true;
    if (!comparePatch(pair, path, patch.residual, options_, comparison)) return true;
    patch.residual.energy = std::min(comparison.energy, limit);
    return false;
  };
  patches_.erase(std::remove_if(patches_.begin(), patches_.end(), cannotBeSeen), patches_.end());
}

bool MotionAlignment::isStarving() const { return patches_.size() < kLeastAligned; }

KeyframeMotion MotionAlignment::initial() const { return {target_.T_map_keyframe(), target_.brightness(), target_.xi}; }

KeyframeState MotionAlignment::with(const KeyframeMotion& motion) const {
  KeyframeState keyframe = target_;
  keyframe.T_linear = motion.T_map_keyframe;
  keyframe.brightness_linear = motion.brightness;
  keyframe.delta.setZero();
  keyframe.setMotion(motion.xi);
  return keyframe;
}

std::vector<PairGeometry> MotionAlignment::pairsWith(const KeyframeState& target) const {
  std::vector<PairGeometry> pairs(state_.keyframes.size());
  for (const Patch& patch : patches_) {
    PairGeometry& pair = pairs[static_cast<std::size_t>(patch.point->host)];
    if (!pair.path) pair = makePairGeometry(state_.keyframe(patch.point->host), target, true);
  }
  return pairs;
}

bool MotionAlignment::refresh(const KeyframeMotion& motion) {
  const std::vector<PairGeometry> pairs = pairsWith(with(motion));
  bool moved = false;
  PatchPath path;
  for (Patch& patch : patches_) {
    const PairGeometry& pair = pairs[static_cast<std::size_t>(patch.point->host)];
    PatchResidual& residual = patch.residual;
    const bool near = residual.has_pixels && makePath(pair, residual.centre, *patch.point, path) &&
                      projectionDrift(path, patch.point->pixel) <= kMaxDrift;
    if (near) continue;
    placePixels(pair, patch.point->pixel, patch.point->inverse_depth, options_, residual, patch.point->slope);
    moved = true;
  }
  return moved;
}

void MotionAlignment::addPatch(const Patch& patch, const PairGeometry& pair, const KeyframeState& target,
                               NormalEquations<kStates>& equations) const {
  const double limit = target_.outlier_energy;
  PatchPath path;
  PatchComparison comparison;
  ReblurredPatch reblurred;
  const bool seen = patch.residual.has_pixels &&
                    makeCurrentJacobianPath(pair, patch.residual.centre, *patch.point, path) &&
                    comparePatch(pair, path, patch.residual, options_, comparison, reblurred);
  const double energy = static_cast<double>(seen ? comparison.energy : patch.residual.energy);  // leaving never pays
  equations.cost += 0.5 * std::min(energy, limit);
  if (!seen || energy > limit) return;
  const double exposure = target.exposure();
  const double delay = pair.target_camera.rowDelay(static_cast<double>(patch.residual.centre.y()));
  Products products;
  products.E = pathJacobian(path, target.xi, exposure > 0.0 ? delay / exposure : 0.0);
  multiplyOut(comparison, reblurred, products);
  const auto& S = products.S;
  const auto& H = products.ESE;
  const auto R = products.SE.middleRows<3>(kPathRows);  // J_a, J_b and r with the path
  auto& h = equations.hessian;
  h.topLeftCorner<6, 6>() += H.topLeftCorner<6, 6>();
  h.block<6, 6>(8, 0) += H.block<6, 6>(6, 0);
  h.block<6, 6>(0, 8) += H.block<6, 6>(0, 6);
  h.bottomRightCorner<6, 6>() += H.block<6, 6>(6, 6);
  h.block<2, 6>(6, 0) += R.block<2, 6>(0, 0);
  h.block<6, 2>(0, 6) += R.block<2, 6>(0, 0).transpose();
  h.block<2, 6>(6, 8) += R.block<2, 6>(0, 6);
  h.block<6, 2>(8, 6) += R.block<2, 6>(0, 6).transpose();
  h.block<2, 2>(6, 6) += S.block<2, 2>(kPathRows, kPathRows);
  equations.gradient.head<6>() += R.row(2).head<6>().transpose();
  equations.gradient.tail<6>() += R.row(2).segment<6>(6).transpose();
  equations.gradient.segment<2>(6) += S.block<2, 1>(kPathRows, kPathRows + 2);
}

void MotionAlignment::addPrior(const KeyframeMotion& motion, NormalEquations<kStates>& equations) const {
  const double information = kResidualVariance * std::pow(focal_length_ / kMotionError, 2.0);
  Vector6 informations = Vector6::Constant(information);
  informations.head<3>() *= median_inverse_depth_ * median_inverse_depth_;
  equations.addPrior<6>(8, motion.xi - target_.exposure() * target_.expected_velocity, informations);
}

NormalEquations<MotionAlignment::kStates> MotionAlignment::linearize(const KeyframeMotion& motion) const {
  const KeyframeState target = with(motion);
  const std::vector<PairGeometry> pairs = pairsWith(target);
  std::vector<NormalEquations<kStates>> parts((patches_.size() + kPatchesPerChunk - 1) / kPatchesPerChunk);
  parallelFor(parts.size(), [&](std::size_t part) {
    const std::size_t end = std::min((part + 1) * kPatchesPerChunk, patches_.size());
    for (std::size_t i = part * kPatchesPerChunk; i < end; ++i) {
      const PairGeometry& pair = pairs[static_cast<std::size_t>(patches_[i].point->host)];
      addPatch(patches_[i], pair, target, parts[part]);
    }
  });
  NormalEquations<kStates> sum;
  for (const NormalEquations<kStates>& part : parts) {
    sum.hessian += part.hessian;
    sum.gradient += part.gradient;
    sum.cost += part.cost;
  }
  addPrior(motion, sum);
  return sum;
}

KeyframeMotion MotionAlignment::plus(const KeyframeMotion& motion, const Eigen::Matrix<double, kStates, 1>& step) {
  return {motion.T_map_keyframe * SE3::exp(step.head<6>()),
          {motion.brightness.a + step(6), motion.brightness.b + step(7)},
          motion.xi + step.tail<6>()};
}

double MotionAlignment::stepSize(const Eigen::Matrix<double, kStates, 1>& step) const {
  const auto pixels = [&](const Vector6& motion) {
    return focal_length_ * (median_inverse_depth_ * motion.head<3>().norm() + motion.tail<3>().norm());
  };
  return std::max(pixels(step.head<6>()), pixels(step.tail<6>()));
}

namespace {

std::optional<KeyframeMotion> solve(MotionAlignment& problem) {
  if (problem.isStarving()) return std::nullopt;
  LevenbergMarquardtOptions solver;
  solver.max_iterations = kMostEvaluations;
  solver.min_step = kLeastStep;
  const auto summary = minimize(problem, problem.initial(), solver);
  if (summary.accepted == 0) return std::nullopt;
  return summary.state;
}

}  // namespace

bool alignNewest(WindowState& state, const ResidualOptions& options) {
  const int newest = state.size() - 1;
  if (newest < 1 || state.keyframe(newest).xi.isZero(0.0)) return false;
  MotionAlignment problem(state, newest, options);
  const std::optional<KeyframeMotion> found = solve(problem);
  if (!found) return false;
  KeyframeState& keyframe = state.keyframe(newest);
  keyframe.delta << (keyframe.T_linear.inverse() * found->T_map_keyframe).log(),
      found->brightness.a - keyframe.brightness_linear.a, found->brightness.b - keyframe.brightness_linear.b;
  state.relinearize();
  keyframe.setMotion(found->xi);
  return true;
}

std::optional<KeyframeMotion> alignFrame(const WindowState& state, const KeyframeState& frame,
                                         const ResidualOptions& options) {
  if (frame.xi.isZero(0.0)) return std::nullopt;
  MotionAlignment problem(state, frame, options);
  return solve(problem);
}

}  // namespace mba_vo
