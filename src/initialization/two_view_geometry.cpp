#include "mba_vo/initialization/two_view_geometry.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "mba_vo/geometry/median.h"

namespace mba_vo {
namespace {

constexpr double kMinInFront = 0.75;  // share of points a candidate must put in front of both cameras

cv::Mat cameraMatrix(const PinholeCamera& camera) {
  return (cv::Mat_<double>(3, 3) << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
}

std::vector<cv::Point2d> toCv(const std::vector<Eigen::Vector2d>& pixels) {
  std::vector<cv::Point2d> points;
  points.reserve(pixels.size());
  for (const Eigen::Vector2d& p : pixels) points.emplace_back(p.x(), p.y());
  return points;
}

double shareInFront(const PinholeCamera& camera, const PixelMatches& matches, const SE3& T_b_a) {
  int count = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const double w = triangulateInverseDepth(T_b_a, camera.unproject(matches.a[i]), camera.unproject(matches.b[i]));
    if (w > 0.0) ++count;
  }
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, matches.size()));
}

/// Adds (R, t) or (R, -t), whichever has more points in front.
void addOriented(const PinholeCamera& camera, const PixelMatches& matches, const Eigen::Matrix3d& R,
                 const Eigen::Vector3d& t, std::vector<SE3>& candidates) {
  if (R.determinant() < 0.0 || !(t.norm() > 1e-9)) return;
  const SE3 plus(Eigen::Quaterniond(R), t.normalized());
  const SE3 minus(plus.rotation(), -plus.translation());
  const double share_plus = shareInFront(camera, matches, plus);
  const double share_minus = shareInFront(camera, matches, minus);
  if (std::max(share_plus, share_minus) < kMinInFront) return;
  candidates.push_back(share_plus >= share_minus ? plus : minus);
}

}  // namespace

RotationFit fitRotation(const PinholeCamera& camera, const PixelMatches& matches, const Eigen::Vector3d& guess,
                        int iterations) {
  SE3 R(SE3::exp((Vector6() << Eigen::Vector3d::Zero(), guess).finished()));
  std::vector<double> errors(matches.size(), 0.0);
  for (int k = 0; k <= iterations; ++k) {
    std::vector<Eigen::Vector2d> residuals;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      residuals.push_back(camera.project(R.rotation() * camera.unproject(matches.a[i])) - matches.b[i]);
      errors[i] = residuals.back().norm();
    }
    if (k == iterations || matches.size() < 3) break;
    const double scale = std::max(0.5, 1.5 * median(errors));
    Eigen::Matrix3d H = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const Eigen::Vector3d p = R.rotation() * camera.unproject(matches.a[i]);
      if (p.z() < 1e-3) continue;
      const Eigen::Matrix<double, 2, 3> J = -camera.projectionJacobian(p) * hat(p);
      const double q = errors[i] / scale;
      const double weight = 1.0 / (1.0 + q * q);  // Cauchy
      H += weight * J.transpose() * J;
      g += weight * J.transpose() * residuals[i];
    }
    const Eigen::Vector3d step = -H.ldlt().solve(g);
    R = SE3::exp((Vector6() << Eigen::Vector3d::Zero(), step).finished()) * R;
    if (step.norm() < 1e-6) iterations = k + 1;  // converged: one more pass for the residuals
  }
  return {R.log().tail<3>(), median(errors)};
}

double triangulateInverseDepth(const SE3& T_b_a, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d bt = b.cross(T_b_a.translation());
  const double n = bt.squaredNorm();
  if (n < 1e-12) return 0.0;
  return -bt.dot(b.cross(T_b_a.rotation() * a)) / n;
}

std::vector<SE3> relativePoseCandidates(const PinholeCamera& camera, const PixelMatches& matches, double threshold_px) {
  std::vector<SE3> candidates;
  if (matches.size() < 8) return candidates;
  const std::vector<cv::Point2d> a = toCv(matches.a);
  const std::vector<cv::Point2d> b = toCv(matches.b);
  const cv::Mat K = cameraMatrix(camera);
  const cv::Mat E = cv::findEssentialMat(a, b, K, cv::RANSAC, 0.999, threshold_px, 200);
  if (E.rows == 3 && E.cols == 3) {
    cv::Mat R1, R2, t;
    cv::decomposeEssentialMat(E, R1, R2, t);
    Eigen::Vector3d direction;
    cv::cv2eigen(t, direction);
    for (const cv::Mat& rotation : {R1, R2}) {
      Eigen::Matrix3d R;
      cv::cv2eigen(rotation, R);
      addOriented(camera, matches, R, direction, candidates);
    }
  }
  const cv::Mat H = cv::findHomography(a, b, cv::RANSAC, 2.0 * threshold_px);
  if (!H.empty()) {
    std::vector<cv::Mat> rotations, translations, normals;
    cv::decomposeHomographyMat(H, K, rotations, translations, normals);
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      Eigen::Matrix3d R;
      Eigen::Vector3d t;
      cv::cv2eigen(rotations[i], R);
      cv::cv2eigen(translations[i], t);
      if (i > 0 && cv::norm(rotations[i], rotations[i - 1]) < 1e-9) continue;  // the same with both signs
      addOriented(camera, matches, R, t, candidates);
    }
  }
  return candidates;
}

}  // namespace mba_vo
