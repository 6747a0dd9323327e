#include "point_errors.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mba_vo::study {
namespace {

constexpr double kRight = 2.0;  // [px]

/// Depths around a pixel, those of the two surfaces at an edge [m].
std::vector<double> depthsAt(const cv::Mat1f& depth, const Eigen::Vector2f& pixel) {
  const auto x = static_cast<int>(std::lround(pixel.x()));
  const auto y = static_cast<int>(std::lround(pixel.y()));
  std::vector<double> depths;
  for (int row = y - 1; row <= y + 1; ++row) {
    for (int column = x - 1; column <= x + 1; ++column) {
      const bool inside = row >= 0 && column >= 0 && row < depth.rows && column < depth.cols;
      if (inside && depth(row, column) > 0.0F) depths.push_back(static_cast<double>(depth(row, column)));
    }
  }
  return depths;
}

class Sum {
 public:
  explicit Sum(const Reported& reported)
      : camera_(reported.reference->pyramid->level(0).camera),
        T_estimated_(reported.tracked->trajectory.T_reference_mid.inverse()) {}

  const PinholeCamera& camera() const { return camera_; }
  bool sees(const Eigen::Vector3d& truth) const { return truth.z() > 0.0 && camera_.contains(camera_.project(truth)); }

  /// Of a point of the reference, given where it truly is in the frame [px].
  double error(const Eigen::Vector3d& in_reference, const Eigen::Vector3d& truth) const {
    const Eigen::Vector3d estimate = T_estimated_ * in_reference;
    if (estimate.z() <= 0.0) return camera_.width;
    return std::min<double>(camera_.width, (camera_.project(estimate) - camera_.project(truth)).norm());
  }
  void add(double error) {
    ++points_;
    right_ += error <= kRight ? 1 : 0;
    sum_ += error;
  }
  PointErrors mean() const {
    if (points_ == 0) return {static_cast<double>(camera_.width), 0.0};
    return {sum_ / points_, static_cast<double>(right_) / points_};
  }

 private:
  PinholeCamera camera_;
  SE3 T_estimated_;
  int points_ = 0;
  int right_ = 0;
  double sum_ = 0.0;
};

Eigen::Vector3d inReference(const PinholeCamera& camera, const ReferencePoint& point) {
  return camera.unproject(point.pixel.cast<double>()) / static_cast<double>(point.inverse_depth);
}

}  // namespace

PointErrors errorsOfPose(const Reported& reported, const SE3& T_reference_frame, double scale) {
  Sum sum(reported);
  const SE3 T_true = SE3(T_reference_frame.rotation(), T_reference_frame.translation() / scale).inverse();
  for (const ReferencePoint& point : reported.reference->points) {
    const Eigen::Vector3d in_reference = inReference(sum.camera(), point);
    const Eigen::Vector3d truth = T_true * in_reference;
    if (sum.sees(truth)) sum.add(sum.error(in_reference, truth));
  }
  return sum.mean();
}

PointErrors errorsOfSurface(const Reported& reported, const SE3& T_reference_frame, const cv::Mat1f& depth) {
  Sum sum(reported);
  const SE3 T_true = T_reference_frame.inverse();
  for (const ReferencePoint& point : reported.reference->points) {
    const Eigen::Vector3d in_reference = inReference(sum.camera(), point);
    const Eigen::Vector3d ray = sum.camera().unproject(point.pixel.cast<double>());
    double least = -1.0;
    for (const double z : depthsAt(depth, point.pixel)) {
      const Eigen::Vector3d truth = T_true * (z * ray);
      if (!sum.sees(truth)) continue;
      const double error = sum.error(in_reference, truth);
      least = least < 0.0 ? error : std::min(least, error);
    }
    if (least >= 0.0) sum.add(least);
  }
  return sum.mean();
}

double scaleOfPoints(const Reference& reference, const cv::Mat1f& depth) {
  std::vector<double> ratios;
  for (const ReferencePoint& point : reference.points) {
    for (const double z : depthsAt(depth, point.pixel)) ratios.push_back(z * static_cast<double>(point.inverse_depth));
  }
  if (ratios.empty()) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

}  // namespace mba_vo::study
