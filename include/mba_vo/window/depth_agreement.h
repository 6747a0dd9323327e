#pragma once

#include <Eigen/Core>

#include "mba_vo/depth_search/measured_depth.h"

namespace mba_vo {

struct LinearizedWindow;
struct PointState;
struct WindowState;

/// What measured depths contribute to a window: Cauchy's loss of the deviation, so that a measurement that the images
/// contradict by many standard deviations is let go. In units of the photometric cost.
double measuredDepthCost(const WindowState& state);
/// Adds Hessian and half the gradient of the inverse depth of the point in this row of the system; `precision`: that of
/// the window's residuals [1 / grey level^2].
void addMeasuredDepth(const PointState& point, double precision, Eigen::Index row, LinearizedWindow& system);

/// Points with measured depths that the images can tell to be wrong, and how many of them seem right.
struct DepthAgreement {
  int compared = 0;
  int agreeing = 0;

  /// Too many do not: the depth images are not those of these images.
  bool fails() const;
};
/// At the end of an optimisation.
DepthAgreement compareDepths(const WindowState& state);

/// The same for one point.
struct MeasuredDepthTerm {
  double cost = 0.0;
  double H = 0.0;
  double b = 0.0;
};
MeasuredDepthTerm measuredDepthTerm(const MeasuredDepth& measured, double inverse_depth, double precision);

}  // namespace mba_vo
