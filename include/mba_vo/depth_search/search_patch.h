#pragma once

#include <array>
#include <optional>

#include "mba_vo/blur/reblur.h"
#include "mba_vo/depth_search/epipolar_line.h"
#include "mba_vo/geometry/calibration_correction.h"
#include "mba_vo/geometry/exposure_trajectory.h"
#include "mba_vo/image/image_pyramid.h"

namespace mba_vo {

/// What the frame should show around the image of a host point: 8 pixels, with their places relative to the point.
struct SearchPatch {
  static constexpr std::size_t kSize = 8;
  bool valid = false;
  std::array<float, kSize> dx{}, dy{};  // [px]
  std::array<float, kSize> value{};     // expected in the frame [grey levels]
  double blur_px = 0.0;                 // length of the path that was averaged, 0 = sharp
};

/// Poses of a camera during its exposure.
struct ExposedPoses {
  ExposedPoses(const RigidMotion& at_start, const RigidMotion& at_mid, const RigidMotion& at_end, bool is_moving)
      : start(at_start), mid(at_mid), end(at_end), moving(is_moving) {}
  explicit ExposedPoses(const ExposureTrajectory& T)
      : ExposedPoses(RigidMotion(T.start()), RigidMotion(T.T_reference_mid), RigidMotion(T.end()),
                     T.xi().squaredNorm() > 0.0) {}

  RigidMotion start, mid, end;
  bool moving;
};

/// Predicts search patches of points of one host for one frame. If the image moves while the shutter is open, the
/// host's pixels are averaged along the path on which the frame's pixel travels over the host (Eq. 6 of the paper); the
/// path depends on the depth that is assumed.
class SearchPatchMaker {
 public:
  /// Paths shorter than `min_blur_px` are taken as sharp. The images must outlive the maker.
  SearchPatchMaker(const ImageLevel& host, const PinholeCamera& frame_camera, const ExposedPoses& T_host_frame,
                   double gain, double offset, const VignetteRatio& vignette, double min_blur_px);

  /// Expected patch at distance `s` on the line of `host_pixel`; invalid where the host has no (valid) pixels.
  /// `spacing_px`: of the samples along the path of the blur.
  SearchPatch make(const Eigen::Vector2i& host_pixel, const EpipolarLine& line, double s, float spacing_px) const;

  /// Path of the point's image over the host during the exposure [px], end minus start; nullopt if the point is behind
  /// the camera at any time.
  std::optional<Eigen::Vector2d> blurVector(const EpipolarLine& line, double s) const;

 private:
  /// Pose of the frame's camera in the host at one moment of the exposure: x_host ~ q + s G x_frame.
  struct Moment {
    Eigen::Matrix3d G;  // K_host R K_frame^-1
    Eigen::Vector3d q;  // K_host p
  };
  struct Hit {
    Eigen::Vector2d pixel;
    Eigen::Matrix2d A;  // d pixel / d frame pixel
  };
  static std::optional<Hit> hit(const Moment& moment, const Eigen::Vector2d& frame_pixel, double inverse_depth);
  bool makePath(const Eigen::Vector2d& frame_pixel, double inverse_depth, PatchPath& path) const;
  SearchPatch makeSharp(const Eigen::Vector2i& host_pixel, const EpipolarLine& line, double inverse_depth,
                        float gain) const;
  SearchPatch makeBlurred(const PatchPath& path, float spacing_px, float gain) const;

  const ImageLevel* host_;
  double gain_;
  float offset_;
  VignetteRatio vignette_;
  double min_blur_px_;
  bool moving_;
  PatchPattern pattern_ = PatchPattern::spread8();
  std::array<Moment, 3> moments_;  // start, middle, end
};

}  // namespace mba_vo
