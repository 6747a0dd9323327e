#include "mba_vo/tracking/frame_measures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mba_vo/geometry/median.h"
#include "mba_vo/image/image_content.h"

namespace mba_vo {

FrameMeasures measureFrame(const Reference& reference, const ExposureTrajectory& trajectory) {
  FrameMeasures measures;
  if (reference.points.empty()) return measures;
  const PinholeCamera& camera = reference.pyramid->level(0).camera;
  const SE3 T_mid = trajectory.T_reference_mid.inverse();
  const SE3 T_start = trajectory.start().inverse();
  const SE3 T_end = trajectory.end().inverse();
  std::vector<double> blur;
  double flow2 = 0.0;
  double parallax2 = 0.0;
  for (const ReferencePoint& point : reference.points) {
    const Eigen::Vector2d pixel = point.pixel.cast<double>();
    const Eigen::Vector3d P = camera.unproject(pixel) / static_cast<double>(point.inverse_depth);
    const Eigen::Vector3d mid = T_mid * P;
    const Eigen::Vector3d rotated = T_mid.rotation() * P;
    const Eigen::Vector3d start = T_start * P;
    const Eigen::Vector3d end = T_end * P;
    if (mid.z() <= 0.0 || rotated.z() <= 0.0 || start.z() <= 0.0 || end.z() <= 0.0) continue;
    const Eigen::Vector2d in_frame = camera.project(mid);
    if (!camera.contains(in_frame)) continue;
    flow2 += (in_frame - pixel).squaredNorm();
    parallax2 += (in_frame - camera.project(rotated)).squaredNorm();
    blur.push_back((camera.project(end) - camera.project(start)).norm());
  }
  if (blur.empty()) return measures;
  const auto count = static_cast<double>(blur.size());
  measures.blur_length_px = median(std::move(blur));
  measures.flow_px = std::sqrt(flow2 / count);
  measures.parallax_px = std::sqrt(parallax2 / count);
  measures.visible_fraction = count / static_cast<double>(reference.points.size());
  return measures;
}

double medianDepth(const Reference& reference) {
  std::vector<float> inverse_depths;
  inverse_depths.reserve(reference.points.size());
  for (const ReferencePoint& point : reference.points) inverse_depths.push_back(point.inverse_depth);
  if (inverse_depths.empty()) return 1.0;
  return 1.0 / static_cast<double>(median(std::move(inverse_depths)));
}

double pixelError(const Reference& reference, const std::vector<int>& points, const ImageLevel& frame,
                  const SE3& T_reference_frame, double residual_rms) {
  const SE3 T_frame_reference = T_reference_frame.inverse();
  std::vector<Eigen::Vector2d> patches;
  for (const int index : points) {
    const ReferencePoint& p = reference.points[static_cast<std::size_t>(index)];
    const Eigen::Vector3d in_frame =
        T_frame_reference * (frame.camera.unproject(p.pixel.cast<double>()) / static_cast<double>(p.inverse_depth));
    if (in_frame.z() > 0.0) patches.push_back(frame.camera.project(in_frame));
  }
  const double gradient = rmsGradient(frame, patches);
  return gradient > 0.0 ? residual_rms / gradient : 0.0;
}

}  // namespace mba_vo
