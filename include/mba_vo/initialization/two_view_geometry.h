#pragma once

#include <vector>

#include <Eigen/Core>

#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/geometry/se3.h"

namespace mba_vo {

/// Pixels of the same points in two images a and b of one camera.
struct PixelMatches {
  std::vector<Eigen::Vector2d> a;  // [px]
  std::vector<Eigen::Vector2d> b;  // [px]
  std::size_t size() const { return a.size(); }
  void add(const Eigen::Vector2d& pixel_a, const Eigen::Vector2d& pixel_b) {
    a.push_back(pixel_a);
    b.push_back(pixel_b);
  }
};

struct RotationFit {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  // log(R_b_a) [rad]
  double median_residual = 0.0;                        // [px]; what rotation alone does not explain
};

/// Rotation that explains the matches best (robust iteratively reweighted Gauss-Newton, at most `iterations`).
RotationFit fitRotation(const PinholeCamera& camera, const PixelMatches& matches, const Eigen::Vector3d& guess,
                        int iterations = 10);

/// Relative poses T_b_a with |translation| = 1 that the matches admit: from the essential matrix (general scenes) and
/// from the homography (planar scenes), each with most points in front of both cameras. Empty if nothing fits.
std::vector<SE3> relativePoseCandidates(const PinholeCamera& camera, const PixelMatches& matches, double threshold_px);

/// Inverse depth in a of a point seen along rays `a` and `b` (z = 1), by least squares on b x (R a + w t) = 0; may be
/// negative; 0 if the rays give no parallax.
double triangulateInverseDepth(const SE3& T_b_a, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace mba_vo
