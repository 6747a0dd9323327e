#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/geometry/calibration_correction.h"

namespace mba_vo {

/// States of one keyframe: translation, rotation, brightness a, b.
inline constexpr int kKeyframeDim = 8;
using Vector8 = Eigen::Matrix<double, 8, 1>;
using Matrix8 = Eigen::Matrix<double, 8, 8>;

/// By how much gradients at the keyframes' states change with the correction of the calibration.
using CalibrationCoupling = Eigen::Matrix<double, Eigen::Dynamic, CalibrationCorrection::kDim>;

/// What marginalised states and points say about the keyframes of the window: the quadratic cost d^T H d + 2 b^T d in
/// the deviation d of the keyframes from their linearisation points.
class MarginalizationPrior {
 public:
  int keyframes() const { return static_cast<int>(connected_.size()); }
  const Eigen::MatrixXd& H() const { return H_; }
  const Eigen::VectorXd& b() const { return b_; }

  /// True if the prior speaks of this keyframe's pose, so that its linearisation point must stay.
  bool connected(int keyframe) const { return connected_[static_cast<std::size_t>(keyframe)]; }
  void connect(int keyframe) { connected_[static_cast<std::size_t>(keyframe)] = true; }

  void appendKeyframe();
  /// Adds d^T H d + 2 b^T d, H symmetric, of the size of all keyframes.
  void add(const Eigen::MatrixXd& H, const Eigen::VectorXd& b);
  /// Adds what `b` grows by with the correction of the calibration: a row for each state of the keyframes.
  void addCalibrationCoupling(const CalibrationCoupling& coupling) { coupling_ += coupling; }
  /// The correction of the calibration, by which what was marginalised is seen, changes by `step`.
  void correctCalibration(const CalibrationCorrection::Vector& step) { b_ += coupling_ * step; }
  /// Adds independent information about the states of one keyframe, with `deviation` = linearisation point - prior
  /// mean.
  void addDiagonal(int keyframe, const Vector8& information, const Vector8& deviation);
  /// The linearisation point of an unconnected keyframe moves by `step`; the cost as a function of the state stays.
  void moveLinearizationPoint(int keyframe, const Vector8& step);

  double cost(const Eigen::VectorXd& d) const;
  /// Adds Hessian and half the gradient at `d`.
  void addTo(const Eigen::VectorXd& d, Eigen::MatrixXd& H, Eigen::VectorXd& b) const;

  /// Eliminates the states of a keyframe (Schur complement), all keyframes with information in common become connected.
  void marginalize(int keyframe);

 private:
  Eigen::MatrixXd H_;
  Eigen::VectorXd b_;
  CalibrationCoupling coupling_;
  double constant_ = 0.0;  // keeps the cost the same when a linearisation point moves
  std::vector<bool> connected_;
};

}  // namespace mba_vo
