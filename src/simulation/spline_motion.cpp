#include "mba_vo/simulation/spline_motion.h"

#include <algorithm>

namespace mba_vo {

SplineMotion::SplineMotion(const std::vector<TimedPose>& poses) {
  const auto count = static_cast<Eigen::Index>(poses.size());
  values_.resize(count, 7);
  for (Eigen::Index i = 0; i < count; ++i) {
    const TimedPose& pose = poses[static_cast<std::size_t>(i)];
    times_.push_back(pose.t);
    Eigen::Vector4d q = pose.T_world_camera.rotation().coeffs();
    // q and -q are the same rotation; the nearer one keeps the path through the quaternions short.
    if (i > 0 && q.dot(values_.row(i - 1).tail<4>()) < 0.0) q = -q;
    values_.row(i) << pose.T_world_camera.translation().transpose(), q.transpose();
  }
  solveBends();
}

/// Continuity of the slopes at each pose gives one equation in the bends of three neighbours: elimination downwards,
/// substitution upwards.
void SplineMotion::solveBends() {
  const Eigen::Index count = values_.rows();
  bends_ = Rows::Zero(count, 7);  // also the ends of a natural spline
  std::vector<double> upper(static_cast<std::size_t>(count), 0.0);
  const auto step = [&](Eigen::Index i) {
    return times_[static_cast<std::size_t>(i) + 1] - times_[static_cast<std::size_t>(i)];
  };
  for (Eigen::Index i = 1; i + 1 < count; ++i) {
    const double before = step(i - 1);
    const double after = step(i);
    const Row change = (values_.row(i + 1) - values_.row(i)) / after - (values_.row(i) - values_.row(i - 1)) / before;
    const double pivot = 2.0 * (before + after) - before * upper[static_cast<std::size_t>(i) - 1];
    upper[static_cast<std::size_t>(i)] = after / pivot;
    bends_.row(i) = (6.0 * change - before * bends_.row(i - 1)) / pivot;
  }
  for (Eigen::Index i = count - 2; i > 0; --i) {
    bends_.row(i) -= upper[static_cast<std::size_t>(i)] * bends_.row(i + 1);
  }
}

SE3 SplineMotion::pose(double t) const {
  const double at = std::clamp(t, begin(), end());
  const auto next = std::upper_bound(times_.begin() + 1, times_.end() - 1, at);
  const auto i = static_cast<Eigen::Index>(next - times_.begin()) - 1;
  const double step = *next - *(next - 1);
  const double b = (at - *(next - 1)) / step;
  const double a = 1.0 - b;
  const double square = step * step / 6.0;
  const Row value = a * values_.row(i) + b * values_.row(i + 1) + square * (a * a * a - a) * bends_.row(i) +
                    square * (b * b * b - b) * bends_.row(i + 1);
  return {Eigen::Quaterniond(value(6), value(3), value(4), value(5)), value.head<3>().transpose()};
}

}  // namespace mba_vo
