#include "mba_vo/ros/tracking_image.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr int kPathParts = 6;          // parts of a path: enough for it to look curved
constexpr int kSubPixelBits = 4;       // OpenCV draws at fractions of 1/16 px
constexpr double kNearestShare = 0.4;  // of the median depth and nearer: red
constexpr double kFarthestShare = 2.5;
constexpr double kMinDepth = 1e-6;    // as a share of the point's distance, to be in front of the camera
constexpr double kBrightness = 0.75;  // of the image, so that colours stand out

cv::Point drawingPoint(const Eigen::Vector2d& pixel) {
  constexpr double kScale = 1 << kSubPixelBits;
  return {static_cast<int>(std::lround(kScale * pixel.x())), static_cast<int>(std::lround(kScale * pixel.y()))};
}

/// Red, yellow, green, blue by the logarithm of the depth relative to the median.
std::vector<cv::Vec3b> depthColors(const std::vector<DrawnPoint>& points) {
  std::vector<double> depths;
  for (const DrawnPoint& point : points) depths.push_back(point.depth);
  const double middle = median(std::move(depths));
  const double nearest = std::log(kNearestShare * middle);
  const double farthest = std::log(kFarthestShare * middle);
  cv::Mat1b shades(static_cast<int>(points.size()), 1);
  for (int i = 0; i < shades.rows; ++i) {
    const double far = (std::log(points[static_cast<std::size_t>(i)].depth) - nearest) / (farthest - nearest);
    shades(i, 0) = cv::saturate_cast<uchar>(255.0 * (1.0 - far));
  }
  cv::Mat3b colors;
  cv::applyColorMap(shades, colors, cv::COLORMAP_TURBO);
  return {colors.begin(), colors.end()};
}

cv::Mat3b greyImage(const ImageLevel& level) {
  cv::Mat1f intensity = level.intensity.clone();
  cv::patchNaNs(intensity, 0.0);
  cv::Mat1b grey;
  intensity.convertTo(grey, CV_8U, kBrightness);
  cv::Mat3b image;
  cv::cvtColor(grey, image, cv::COLOR_GRAY2BGR);
  return image;
}

void drawPoints(const std::vector<DrawnPoint>& points, cv::Mat3b& image) {
  if (points.empty()) return;
  const std::vector<cv::Vec3b> colors = depthColors(points);
  const double radius = std::max(1.2, image.cols / 400.0);  // [px]
  const int thickness = image.cols > 1000 ? 2 : 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<cv::Point> path;
    for (const Eigen::Vector2d& pixel : points[i].path) path.push_back(drawingPoint(pixel));
    const cv::Scalar color(colors[i]);
    cv::polylines(image, path, false, color, thickness, cv::LINE_AA, kSubPixelBits);
    cv::circle(image, path.back(), static_cast<int>(std::lround(radius * (1 << kSubPixelBits))), color, cv::FILLED,
               cv::LINE_AA, kSubPixelBits);
  }
}

std::string captionOf(const TrackedFrame& tracked) {
  std::string caption = toString(tracked.status);
  if (!tracked.reason.empty()) caption += ": " + tracked.reason;
  if (!tracked.tracked()) return caption;
  char numbers[64];
  std::snprintf(numbers, sizeof(numbers), "  blur %.1f px in %.1f ms", tracked.measures.blur_length_px,
                1e3 * tracked.trajectory.exposure);
  return caption + numbers;
}

void drawCaption(const std::string& caption, cv::Mat3b& image) {
  const double size = std::max(0.4, image.cols / 1200.0);
  const cv::Point place(image.cols / 80, image.rows - std::max(6, image.rows / 40));
  const cv::Scalar black(0, 0, 0);
  const cv::Scalar white(255, 255, 255);
  cv::putText(image, caption, place, cv::FONT_HERSHEY_SIMPLEX, size, black, 3, cv::LINE_AA);
  cv::putText(image, caption, place, cv::FONT_HERSHEY_SIMPLEX, size, white, 1, cv::LINE_AA);
}

}  // namespace

std::vector<Eigen::Vector2d> blurPath(const Eigen::Vector3d& point_reference, const ExposureTrajectory& trajectory,
                                      const PinholeCamera& camera, int steps) {
  const auto pixelAt = [&](double t) -> std::optional<Eigen::Vector2d> {
    const Eigen::Vector3d point = trajectory.at(t).inverse() * point_reference;
    if (!(point.z() > kMinDepth * point.norm())) return std::nullopt;
    const Eigen::Vector2d pixel = camera.project(point);
    return camera.contains(pixel) ? std::optional(pixel) : std::nullopt;
  };
  const std::optional<Eigen::Vector2d> middle = pixelAt(0.0);
  if (!middle) return {};
  const double delay = camera.rowDelay(middle->y());
  std::vector<Eigen::Vector2d> path;
  for (int i = 0; i <= steps; ++i) {
    const std::optional<Eigen::Vector2d> pixel =
        pixelAt(delay + trajectory.exposure * (static_cast<double>(i) / steps - 0.5));
    if (!pixel) return {};
    path.push_back(*pixel);
  }
  return path;
}

std::vector<DrawnPoint> drawnPoints(const TrackedFrame& tracked, const Reference& reference) {
  std::vector<DrawnPoint> points;
  if (reference.at_infinity) return points;
  const PinholeCamera& camera = tracked.frame->pyramid.level(0).camera;
  const PinholeCamera& reference_camera = reference.pyramid->level(0).camera;
  const SE3 T_camera_reference = tracked.trajectory.T_reference_mid.inverse();
  for (const ReferencePoint& p : reference.points) {
    const Eigen::Vector3d point = reference_camera.unproject(p.pixel.cast<double>()) / p.inverse_depth;
    DrawnPoint drawn{blurPath(point, tracked.trajectory, camera, kPathParts), (T_camera_reference * point).z()};
    if (!drawn.path.empty()) points.push_back(std::move(drawn));
  }
  return points;
}

cv::Mat3b drawTracking(const TrackedFrame& tracked, const ReferenceConstPtr& reference) {
  cv::Mat3b image = greyImage(tracked.frame->pyramid.level(0));
  const bool fits = reference && tracked.tracked() && reference->id.map_id == tracked.reference.map_id &&
                    reference->id.keyframe_id == tracked.reference.keyframe_id;
  if (fits) drawPoints(drawnPoints(tracked, *reference), image);
  drawCaption(captionOf(tracked), image);
  return image;
}

}  // namespace mba_vo
