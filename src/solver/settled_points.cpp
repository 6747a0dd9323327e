#include "mba_vo/solver/settled_points.h"

#include <utility>

namespace mba_vo {

void SettledPoints::settle(LinearizedWindow& system, const std::vector<bool>& settles, const LinearizedWindow& others) {
  any_ = true;
  std::swap(system_, system);
  system_.H -= others.H;
  system_.b -= others.b;
  depth_gain_ = 0.0;
  for (std::size_t i = 0; i < settles.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (!settles[i]) system_.H_depth(row) = system_.b_depth(row) = 0.0;
    const double b = system_.b_depth(row);
    if (b != 0.0) depth_gain_ += b * b / system_.H_depth(row);
  }
  schur_.reduce(system_, 0.0, reduced_);
  moved_.setZero(system_.b.size());
}

void SettledPoints::move(const Eigen::VectorXd& step) {
  if (any_) moved_ += step;
}

double SettledPoints::costChange() const {
  if (!any_) return 0.0;
  return moved_.dot(reduced_.H * moved_ + 2.0 * reduced_.b) - depth_gain_;
}

void SettledPoints::addTo(Eigen::MatrixXd& H, Eigen::VectorXd& b) const {
  if (!any_) return;
  H += reduced_.H;
  b += reduced_.b + reduced_.H * moved_;
}

}  // namespace mba_vo
