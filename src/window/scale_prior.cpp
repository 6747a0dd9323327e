#include "mba_vo/window/scale_prior.h"

namespace mba_vo {
namespace {

constexpr double kSamePlace = 1e-9;  // [m]

}  // namespace

void ScalePrior::choose(const WindowState& state) {
  for (int i = 1; i < state.size(); ++i) {
    const Eigen::Vector3d between =
        state.keyframe(i).T_map_keyframe().translation() - state.keyframe(0).T_map_keyframe().translation();
    if (between.norm() <= std::max(distance_, kSamePlace)) continue;
    distance_ = between.norm();
    first_ = state.keyframe(0).id;
    second_ = state.keyframe(i).id;
  }
}

double ScalePrior::cost(const WindowState& state) const {
  if (!active()) return 0.0;
  const SE3 T_first = state.keyframe(state.indexOf(first_)).T_map_keyframe();
  const SE3 T_second = state.keyframe(state.indexOf(second_)).T_map_keyframe();
  const double r = (T_second.translation() - T_first.translation()).norm() / distance_ - 1.0;
  return weight_ * r * r;
}

void ScalePrior::addTo(const WindowState& state, Eigen::MatrixXd& H, Eigen::VectorXd& b) const {
  if (!active()) return;
  const int i = state.indexOf(first_);
  const int j = state.indexOf(second_);
  const KeyframeState& first = state.keyframe(i);
  const KeyframeState& second = state.keyframe(j);
  const Eigen::Vector3d direction =
      (second.T_linear.translation() - first.T_linear.translation()).normalized() / distance_;
  Eigen::VectorXd J = Eigen::VectorXd::Zero(b.size());
  // Right increments: the translation moves by R rho.
  J.segment<3>(kKeyframeDim * j) = second.T_linear.rotation().inverse() * direction;
  J.segment<3>(kKeyframeDim * i) = -(first.T_linear.rotation().inverse() * direction);
  const double r =
      (second.T_map_keyframe().translation() - first.T_map_keyframe().translation()).norm() / distance_ - 1.0;
  H += weight_ * J * J.transpose();
  b += weight_ * r * J;
}

void ScalePrior::moveToPrior(WindowState& state) {
  if (!active()) return;
  const Eigen::Index n = kKeyframeDim * state.size();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  addTo(state, H, b);
  state.prior.add(H, b - H * state.deltas());
  state.prior.connect(state.indexOf(first_));
  state.prior.connect(state.indexOf(second_));
  distance_ = 0.0;
}

}  // namespace mba_vo
