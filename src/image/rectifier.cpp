#include "mba_vo/image/rectifier.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "mba_vo/image/corrected_calibration.h"
#include "mba_vo/image/fov_lens.h"

namespace mba_vo {
namespace {

constexpr double kMinValidFraction = 0.95;
constexpr double kMinFocalScale = 0.5;
constexpr double kMaxFocalScale = 4.0;

cv::Matx33d cameraMatrix(double fx, double fy, double cx, double cy) {
  return {fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0};
}

/// Radius in the distorted image of a ray `radius` = tan(theta) off the axis, both in focal lengths; radial part only.
double distortedRadius(const CameraCalibration& c, double radius) {
  const auto k = [&](std::size_t i) { return i < c.distortion.size() ? c.distortion[i] : 0.0; };
  if (c.distortion_model == "equidistant") {
    const double theta = std::atan(radius);
    const double t2 = theta * theta;
    return theta * (1.0 + t2 * (k(0) + t2 * (k(1) + t2 * (k(2) + t2 * k(3)))));
  }
  if (c.distortion_model == "fov") return fovDistortedRadius(radius, k(0));
  const double r2 = radius * radius;
  return radius * (1.0 + r2 * (k(0) + r2 * (k(1) + r2 * k(4)))) / (1.0 + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
}

/// Past the radius where a distortion polynomial turns back, it maps rays the camera cannot see into the image. Returns
/// that radius, in focal lengths.
double largestRadius(const CameraCalibration& c) {
  constexpr double kBorderStep = 1e-3;
  constexpr double kEnd = 20.0;
  double previous = 0.0;
  for (double radius = kBorderStep; radius < kEnd; radius += kBorderStep) {
    const double next = distortedRadius(c, radius);
    if (!(next > previous)) return radius - kBorderStep;
    previous = next;
  }
  return kEnd;
}

struct Maps {
  cv::Mat1f x, y;  // where a rectified pixel looks in the distorted image [px], NaN if nowhere
};

/// Maps for a rectified image of `size` with matrix `rectified`, ray by ray, with a correction of the calibration.
Maps makeCorrectedMaps(const CameraCalibration& c, const cv::Matx33d& rectified, cv::Size size, double largest_radius,
                       const CalibrationCorrection& correction) {
  std::vector<cv::Point3d> rays;
  rays.reserve(static_cast<std::size_t>(size.area()));
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const Eigen::Vector2d ideal((u - rectified(0, 2)) / rectified(0, 0), (v - rectified(1, 2)) / rectified(1, 1));
      const Eigen::Vector2d x = correction.apply(ideal);
      rays.emplace_back(x.x(), x.y(), 1.0);
    }
  }
  const std::vector<cv::Point2d> pixels = projectRays(c, rays);
  Maps maps{cv::Mat1f(size), cv::Mat1f(size)};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const int v = static_cast<int>(i) / size.width;
    const int u = static_cast<int>(i) % size.width;
    const bool seen = std::hypot(rays[i].x, rays[i].y) <= largest_radius;
    maps.x(v, u) = seen ? static_cast<float>(pixels[i].x) : std::numeric_limits<float>::quiet_NaN();
    maps.y(v, u) = static_cast<float>(pixels[i].y);
  }
  return maps;
}

/// The same without a correction.
Maps makeMaps(const CameraCalibration& c, const cv::Matx33d& rectified, cv::Size size, double largest_radius) {
  if (c.distortion_model == "fov") return makeCorrectedMaps(c, rectified, size, largest_radius, {});
  const cv::Matx33d distorted = cameraMatrix(c.fx, c.fy, c.cx, c.cy);
  Maps maps;
  cv::Mat x, y;
  if (c.distortion_model == "equidistant") {
    cv::fisheye::initUndistortRectifyMap(distorted, c.distortion, cv::Matx33d::eye(), rectified, size, CV_32FC1, x, y);
  } else {
    cv::initUndistortRectifyMap(distorted, c.distortion, cv::Matx33d::eye(), rectified, size, CV_32FC1, x, y);
  }
  maps.x = x;
  maps.y = y;
  for (int v = 0; v < size.height; ++v) {
    const double ry = (v - rectified(1, 2)) / rectified(1, 1);
    for (int u = 0; u < size.width; ++u) {
      const double rx = (u - rectified(0, 2)) / rectified(0, 0);
      if (std::hypot(rx, ry) > largest_radius) maps.x(v, u) = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return maps;
}

bool isInside(float x, float y, cv::Size size) {
  return x >= 0.0F && y >= 0.0F && x <= static_cast<float>(size.width - 1) && y <= static_cast<float>(size.height - 1);
}

/// Fraction of the rectified pixels that the camera sees if the focal length is scaled, from every 8th pixel.
double validFraction(const CameraCalibration& c, double scale, double largest_radius) {
  constexpr int kStride = 8;
  const cv::Matx33d coarse =
      cameraMatrix(scale * c.fx / kStride, scale * c.fy / kStride, c.cx / kStride, c.cy / kStride);
  const cv::Size coarse_size((c.width - 1) / kStride + 1, (c.height - 1) / kStride + 1);
  const Maps maps = makeMaps(c, coarse, coarse_size, largest_radius);
  int valid = 0;
  for (int v = 0; v < coarse_size.height; ++v) {
    for (int u = 0; u < coarse_size.width; ++u) {
      if (isInside(maps.x(v, u), maps.y(v, u), {c.width, c.height})) ++valid;
    }
  }
  return static_cast<double>(valid) / coarse_size.area();
}

/// Smallest focal scale with enough valid pixels; zooming in never loses any, so bisection finds it.
double chooseFocalScale(const CameraCalibration& c, double largest_radius) {
  double low = kMinFocalScale;
  double high = kMaxFocalScale;
  if (validFraction(c, low, largest_radius) >= kMinValidFraction) return low;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (low + high);
    (validFraction(c, middle, largest_radius) >= kMinValidFraction ? high : low) = middle;
  }
  return high;
}

}  // namespace

Rectifier::Rectifier(const CameraCalibration& calibration, const CalibrationCorrection& correction) {
  validate(calibration);
  const CameraCalibration& c = calibration;
  camera_ = {c.width, c.height, c.fx, c.fy, c.cx, c.cy};
  if (isUndistorted(c) && !correction.correctsLens()) return;

  const double largest_radius = largestRadius(c);
  if (!isUndistorted(c)) {
    const double scale = chooseFocalScale(c, largest_radius);
    camera_.fx *= scale;
    camera_.fy *= scale;
  }
  const cv::Size size(c.width, c.height);
  const cv::Matx33d rectified = cameraMatrix(camera_.fx, camera_.fy, c.cx, c.cy);
  const Maps maps = correction.correctsLens() ? makeCorrectedMaps(c, rectified, size, largest_radius, correction)
                                              : makeMaps(c, rectified, size, largest_radius);
  samples_.reserve(static_cast<std::size_t>(size.area()));
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const float x = maps.x(v, u);
      const float y = maps.y(v, u);
      if (!isInside(x, y, size)) {
        samples_.push_back({-1, 0.0F, 0.0F});
        continue;
      }
      // On the last row or column the footprint is the one before it, with weight 1.
      const int x0 = std::min(static_cast<int>(x), size.width - 2);
      const int y0 = std::min(static_cast<int>(y), size.height - 2);
      samples_.push_back({y0 * size.width + x0, x - static_cast<float>(x0), y - static_cast<float>(y0)});
    }
  }
}

cv::Mat1f Rectifier::rectify(const cv::Mat1f& image) const {
  if (isIdentity()) return image;
  const cv::Mat1f source = image.isContinuous() ? image : cv::Mat1f(image.clone());
  cv::Mat1f result(camera_.height, camera_.width);
  const float* const in = source[0];
  float* out = result[0];
  const int stride = camera_.width;
  for (const Sample& s : samples_) {
    if (s.offset < 0) {
      *out++ = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    const float* const p = in + s.offset;
    const float top = p[0] + s.wx * (p[1] - p[0]);
    const float bottom = p[stride] + s.wx * (p[stride + 1] - p[stride]);
    *out++ = top + s.wy * (bottom - top);
  }
  return result;
}

cv::Mat1f Rectifier::rectifyDepth(const cv::Mat1f& depth) const {
  if (isIdentity()) return depth;
  const cv::Mat1f source = depth.isContinuous() ? depth : cv::Mat1f(depth.clone());
  cv::Mat1f result(camera_.height, camera_.width);
  const float* const in = source[0];
  float* out = result[0];
  for (const Sample& s : samples_) {
    const int nearest = s.offset + (s.wx > 0.5F ? 1 : 0) + (s.wy > 0.5F ? camera_.width : 0);
    *out++ = s.offset < 0 ? std::numeric_limits<float>::quiet_NaN() : in[nearest];
  }
  return result;
}

}  // namespace mba_vo
