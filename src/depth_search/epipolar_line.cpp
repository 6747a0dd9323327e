#include "mba_vo/depth_search/epipolar_line.h"

#include <limits>

namespace mba_vo {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMinDepthRatio = 1e-2;  // rays further off the axis of the frame's camera are of no use
constexpr double kMinParallax = 1e-9;    // [px m]

/// K v, column by column.
template <typename Derived>
Derived timesCamera(const PinholeCamera& c, const Eigen::MatrixBase<Derived>& v) {
  Derived product = v;
  product.row(0) = c.fx * v.row(0) + c.cx * v.row(2);
  product.row(1) = c.fy * v.row(1) + c.cy * v.row(2);
  return product;
}

Eigen::Matrix3d timesInverseCamera(const Eigen::Matrix3d& M, const PinholeCamera& c) {
  Eigen::Matrix3d product;
  product.col(0) = M.col(0) * (1.0 / c.fx);
  product.col(1) = M.col(1) * (1.0 / c.fy);
  product.col(2) = M.col(0) * (-c.cx / c.fx) + M.col(1) * (-c.cy / c.fy) + M.col(2);
  return product;
}

}  // namespace

HostToFrame::HostToFrame(const PinholeCamera& host, const PinholeCamera& frame, const RigidMotion& T_frame_host)
    : H(timesInverseCamera(timesCamera(frame, T_frame_host.R), host)), h(timesCamera(frame, T_frame_host.p)) {}

EpipolarLine::EpipolarLine(const HostToFrame& transform, const Eigen::Vector2d& host_pixel)
    : H_(transform.H), origin_(Eigen::Vector2d::Zero()), direction_(Eigen::Vector2d::UnitX()) {
  const Eigen::Vector3d a = H_ * host_pixel.homogeneous();
  infinity_z_ = a.z();
  translation_z_ = transform.h.z();
  if (infinity_z_ < kMinDepthRatio) return;
  origin_ = a.head<2>() / a.z();
  // p(w) = (a + w h) / (a_z + w h_z) = p(0) + w (h - p(0) h_z) / (a_z (1 + w h_z / a_z))
  const Eigen::Vector2d along = (transform.h.head<2>() - origin_ * transform.h.z()) / infinity_z_;
  k_ = along.norm();
  q_ = translation_z_ / infinity_z_;
  if (k_ < kMinParallax) return;
  direction_ = along / k_;
  valid_ = true;
}

double EpipolarLine::distanceOf(double inverse_depth) const {
  const double scale = 1.0 + inverse_depth * q_;
  return scale > 0.0 ? inverse_depth * k_ / scale : kInfinity;
}

double EpipolarLine::inverseDepthAt(double s) const {
  const double remaining = k_ - s * q_;
  return remaining > 0.0 ? s / remaining : kInfinity;
}

Eigen::Matrix2d EpipolarLine::warpAt(double inverse_depth) const {
  const Eigen::Vector2d pixel = pixelAt(distanceOf(inverse_depth));
  return (H_.topLeftCorner<2, 2>() - pixel * H_.bottomLeftCorner<1, 2>()) /
         (infinity_z_ + inverse_depth * translation_z_);
}

}  // namespace mba_vo
