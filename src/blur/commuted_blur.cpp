#include "mba_vo/blur/commuted_blur.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace mba_vo {
namespace {

constexpr float kSharpLength = 0.5F;  // [px] shorter paths change nothing worth computing

void copyPatch(const ImageLevel& frame, const Eigen::Vector2d& centre, const PatchPattern& pattern,
               std::array<float, kMaxPatchPixels>& intensity) {
  const int x = static_cast<int>(centre.x());
  const int y = static_cast<int>(centre.y());
  for (std::size_t k = 0; k < static_cast<std::size_t>(pattern.size); ++k) {
    intensity[k] = frame.intensity(y + pattern.dy[k], x + pattern.dx[k]);
  }
}

}  // namespace

CommutedBlur::CommutedBlur(const PinholeCamera& reference_camera, const PinholeCamera& frame_camera,
                           const SE3& T_reference_mid, const Vector6& reference_xi)
    : blurred_(reference_xi.squaredNorm() > 0.0),
      to_reference_(reference_camera, frame_camera, {T_reference_mid, Vector6::Zero(), 1.0}),
      within_reference_(reference_camera, reference_camera, {SE3(), reference_xi, 1.0}) {}

bool CommutedBlur::referencePath(const Eigen::Vector2d& centre, double inverse_depth, const Eigen::Vector2d& slope,
                                 PatchPath& path) const {
  PatchPath transfer;
  PatchPath own;
  if (!to_reference_.makeWithoutPose(centre, inverse_depth, transfer)) return false;
  applySlope(slope, transfer.c0.cast<double>(), transfer, SlopeDerivatives::kInverseDepth);
  if (!within_reference_.makeWithoutPose(transfer.c0.cast<double>(), inverse_depth, own)) return false;
  applySlope(slope, own.c0.cast<double>(), own, SlopeDerivatives::kInverseDepth);
  // The frame's pixel c + A0^-1 m looks where the reference's own pixel displaced by m looks.
  const Eigen::Matrix2f to_frame = transfer.A0.inverse();
  path.c0 = centre.cast<float>();
  path.c1 = to_frame * own.c1;
  path.c2 = to_frame * own.c2;
  path.A0.setIdentity();
  path.A1.setZero();
  return path.c1.allFinite() && path.c2.allFinite();
}

void CommutedBlur::read(const ImageLevel& frame, const Eigen::Vector2d& centre, double inverse_depth,
                        const PatchPattern& pattern, float sample_spacing_px, int max_samples,
                        std::array<float, kMaxPatchPixels>& intensity, const Eigen::Vector2d& slope) const {
  PatchPath path;
  if (!blurred_) {
    copyPatch(frame, centre, pattern, intensity);
  } else if (!referencePath(centre, inverse_depth, slope, path)) {
    intensity.fill(std::numeric_limits<float>::quiet_NaN());
  } else if (path.length() < kSharpLength) {
    copyPatch(frame, centre, pattern, intensity);
  } else {
    reblurParallel(frame, path, pattern, sampleCount(path.length(), sample_spacing_px, max_samples), intensity);
  }
}

}  // namespace mba_vo
