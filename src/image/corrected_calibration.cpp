#include "mba_vo/image/corrected_calibration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <opencv2/calib3d.hpp>

#include "mba_vo/image/fov_lens.h"

namespace mba_vo {
namespace {

constexpr int kColumns = 25;  // of the grid of pixels that is compared
constexpr int kRows = 19;
constexpr int kIterations = 10;
constexpr double kStep = 1e-6;             // of the derivatives, relative to parameters of about 1
constexpr double kSmallestRadius = 1e-12;  // in focal lengths, divided by
constexpr double kWidest = 2.0;            // of the image's half diagonal: rectified images show no rays further out
constexpr double kDamping = 1e-9;          // coefficients that hardly differ in what they do share it

/// fx, fy, cx, cy in focal lengths of the first guess, then the distortion.
using Parameters = Eigen::VectorXd;

class Fit {
 public:
  Fit(const CameraCalibration& calibration, const CalibrationCorrection& correction) : start_(calibration) {
    if (isUndistorted(start_)) {
      start_.distortion_model = "plumb_bob";
      start_.distortion.assign(5, 0.0);
    }
    std::vector<cv::Point3d> corrected;
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const cv::Point2d pixel(column * (start_.width - 1.0) / (kColumns - 1),
                                row * (start_.height - 1.0) / (kRows - 1));
        const Eigen::Vector2d ray = rayOf(pixel);
        if (!(ray.norm() < kWidest * halfDiagonal())) continue;
        const Eigen::Vector2d x = correction.apply(ray);
        rays_.emplace_back(ray.x(), ray.y(), 1.0);
        corrected.emplace_back(x.x(), x.y(), 1.0);
      }
    }
    wanted_ = projectRays(start_, corrected);
  }

  CorrectedCalibration run() const {
    Parameters p = Parameters::Zero(4 + static_cast<Eigen::Index>(start_.distortion.size()));
    for (int i = 0; i < kIterations; ++i) {
      const Eigen::MatrixXd J = jacobian(p);
      Eigen::MatrixXd H = J.transpose() * J;
      H.diagonal() *= 1.0 + kDamping;
      H.diagonal().array() += kDamping;
      p -= H.ldlt().solve(J.transpose() * residuals(p));
    }
    const Eigen::VectorXd rest = residuals(p);
    return {calibrationOf(p), start_.fx * rest.lpNorm<Eigen::Infinity>()};
  }

 private:
  double halfDiagonal() const { return std::hypot(0.5 * start_.width / start_.fx, 0.5 * start_.height / start_.fy); }

  /// Of the told camera's pixel, without knowing the inverse of its distortion in closed form.
  Eigen::Vector2d rayOf(const cv::Point2d& pixel) const {
    const cv::Matx33d K(start_.fx, 0.0, start_.cx, 0.0, start_.fy, start_.cy, 0.0, 0.0, 1.0);
    const std::vector<cv::Point2d> pixels{pixel};
    std::vector<cv::Point2d> rays;
    if (start_.distortion_model == "fov") {
      const cv::Point2d ray = rayOfFovPixel(start_, pixel);
      return {ray.x, ray.y};
    }
    if (start_.distortion_model == "equidistant") {
      cv::fisheye::undistortPoints(pixels, rays, K, start_.distortion);
    } else {
      cv::undistortPoints(pixels, rays, K, start_.distortion);
    }
    return {rays.front().x, rays.front().y};
  }

  /// `p`: what is to be added to the start.
  CameraCalibration calibrationOf(const Parameters& p) const {
    CameraCalibration c = start_;
    c.fx += start_.fx * p(0);
    c.fy += start_.fy * p(1);
    c.cx += start_.fx * p(2);
    c.cy += start_.fy * p(3);
    for (std::size_t i = 0; i < c.distortion.size(); ++i) c.distortion[i] += p(4 + static_cast<Eigen::Index>(i));
    return c;
  }

  /// In focal lengths.
  Eigen::VectorXd residuals(const Parameters& p) const {
    const std::vector<cv::Point2d> seen = projectRays(calibrationOf(p), rays_);
    Eigen::VectorXd r(2 * static_cast<Eigen::Index>(seen.size()));
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const auto k = 2 * static_cast<Eigen::Index>(i);
      r(k) = (seen[i].x - wanted_[i].x) / start_.fx;
      r(k + 1) = (seen[i].y - wanted_[i].y) / start_.fx;
    }
    return r;
  }

  Eigen::MatrixXd jacobian(const Parameters& p) const {
    Eigen::MatrixXd J(2 * static_cast<Eigen::Index>(rays_.size()), p.size());
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      const Parameters step = kStep * Parameters::Unit(p.size(), i);
      J.col(i) = (residuals(p + step) - residuals(p - step)) / (2.0 * kStep);
    }
    return J;
  }

  CameraCalibration start_;
  std::vector<cv::Point3d> rays_;
  std::vector<cv::Point2d> wanted_;  // where the corrected camera sees them [px]
};

}  // namespace

std::vector<cv::Point2d> projectRays(const CameraCalibration& c, const std::vector<cv::Point3d>& rays) {
  const cv::Matx33d K(c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0);
  std::vector<cv::Point2d> pixels;
  if (c.distortion_model == "fov") {
    pixels.reserve(rays.size());
    for (const cv::Point3d& ray : rays) {
      const cv::Point2d x(ray.x / ray.z, ray.y / ray.z);
      const double radius = std::max(cv::norm(x), kSmallestRadius);
      const double scale = fovDistortedRadius(radius, c.distortion[0]) / radius;
      pixels.emplace_back(c.fx * scale * x.x + c.cx, c.fy * scale * x.y + c.cy);
    }
  } else if (c.distortion_model == "equidistant") {
    cv::fisheye::projectPoints(rays, pixels, cv::Vec3d(), cv::Vec3d(), K, c.distortion);
  } else {
    cv::projectPoints(rays, cv::Vec3d(), cv::Vec3d(), K, c.distortion, pixels);
  }
  return pixels;
}

cv::Point2d rayOfFovPixel(const CameraCalibration& c, const cv::Point2d& pixel) {
  const cv::Point2d at((pixel.x - c.cx) / c.fx, (pixel.y - c.cy) / c.fy);
  const double radius = std::max(cv::norm(at), kSmallestRadius);
  return fovUndistortedRadius(radius, c.distortion.at(0)) / radius * at;
}

CorrectedCalibration correctedCalibration(const CameraCalibration& calibration,
                                          const CalibrationCorrection& correction) {
  validate(calibration);
  if (!correction.correctsLens()) return {calibration, 0.0};
  return Fit(calibration, correction).run();
}

}  // namespace mba_vo
