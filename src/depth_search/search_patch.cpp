#include "mba_vo/depth_search/search_patch.h"

#include <cmath>

namespace mba_vo {
namespace {

constexpr double kMinPatchDepthRatio = 1e-3;  // as a fraction of the depth in the host
constexpr int kMaxBlurSamples = 64;

}  // namespace

SearchPatchMaker::SearchPatchMaker(const ImageLevel& host, const PinholeCamera& frame_camera,
                                   const ExposedPoses& T_host_frame, double gain, double offset,
                                   const VignetteRatio& vignette, double min_blur_px)
    : host_(&host),
      gain_(gain),
      offset_(static_cast<float>(offset)),
      vignette_(vignette),
      min_blur_px_(min_blur_px),
      moving_(T_host_frame.moving) {
  const std::array<const RigidMotion*, 3> poses{&T_host_frame.start, &T_host_frame.mid, &T_host_frame.end};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const HostToFrame inverse(frame_camera, host.camera, *poses[i]);
    moments_[i] = {inverse.H, inverse.h};
  }
}

std::optional<SearchPatchMaker::Hit> SearchPatchMaker::hit(const Moment& moment, const Eigen::Vector2d& frame_pixel,
                                                           double inverse_depth) {
  // P = p + s g lies on the plane z = 1 / inverse_depth; K P = q + s G x and K leaves z as it is.
  const Eigen::Vector3d g = moment.G * frame_pixel.homogeneous();
  if (g.z() < kMinPatchDepthRatio) return std::nullopt;
  const double s = (1.0 - inverse_depth * moment.q.z()) / g.z();  // times inverse_depth: finite for points at infinity
  if (s < kMinPatchDepthRatio) return std::nullopt;
  Hit result;
  result.pixel = inverse_depth * moment.q.head<2>() + s * g.head<2>();
  result.A = s * (moment.G.topLeftCorner<2, 2>() - g.head<2>() / g.z() * moment.G.bottomLeftCorner<1, 2>());
  return result;
}

bool SearchPatchMaker::makePath(const Eigen::Vector2d& frame_pixel, double inverse_depth, PatchPath& path) const {
  const std::optional<Hit> start = hit(moments_[0], frame_pixel, inverse_depth);
  const std::optional<Hit> mid = hit(moments_[1], frame_pixel, inverse_depth);
  const std::optional<Hit> end = hit(moments_[2], frame_pixel, inverse_depth);
  if (!start || !mid || !end) return false;
  path.c0 = mid->pixel.cast<float>();
  path.c1 = (end->pixel - start->pixel).cast<float>();
  path.c2 = (2.0 * (start->pixel + end->pixel) - 4.0 * mid->pixel).cast<float>();
  path.A0 = mid->A.cast<float>();
  path.A1 = (end->A - start->A).cast<float>();
  return true;
}

std::optional<Eigen::Vector2d> SearchPatchMaker::blurVector(const EpipolarLine& line, double s) const {
  if (!moving_) return Eigen::Vector2d::Zero();
  const double inverse_depth = std::max(line.inverseDepthAt(s), 0.0);
  if (!std::isfinite(inverse_depth)) return std::nullopt;
  const Eigen::Vector2d pixel = line.pixelAt(s);
  const std::optional<Hit> start = hit(moments_[0], pixel, inverse_depth);
  const std::optional<Hit> end = hit(moments_[2], pixel, inverse_depth);
  if (!start || !end) return std::nullopt;
  return end->pixel - start->pixel;
}

SearchPatch SearchPatchMaker::make(const Eigen::Vector2i& host_pixel, const EpipolarLine& line, double s,
                                   float spacing_px) const {
  const double inverse_depth = std::max(line.inverseDepthAt(s), 0.0);
  if (!std::isfinite(inverse_depth)) return {};
  const Eigen::Vector2d seen = line.pixelAt(line.distanceOf(inverse_depth));
  const auto gain = static_cast<float>(gain_ * vignette_.at(host_pixel.cast<double>(), seen));
  if (moving_) {
    PatchPath path;  // without derivatives, which nothing here needs
    if (!makePath(seen, inverse_depth, path)) return {};
    if (path.length() > min_blur_px_) return makeBlurred(path, spacing_px, gain);
  }
  return makeSharp(host_pixel, line, inverse_depth, gain);
}

SearchPatch SearchPatchMaker::makeSharp(const Eigen::Vector2i& host_pixel, const EpipolarLine& line,
                                        double inverse_depth, float gain) const {
  SearchPatch patch;
  const cv::Mat1f& image = host_->intensity;
  const int r = pattern_.radius;
  if (host_pixel.x() < r || host_pixel.y() < r || host_pixel.x() >= image.cols - r ||
      host_pixel.y() >= image.rows - r) {
    return patch;
  }
  const Eigen::Matrix2f warp = line.warpAt(inverse_depth).cast<float>();
  float sum = 0.0F;
  for (std::size_t k = 0; k < SearchPatch::kSize; ++k) {
    const Eigen::Vector2f place =
        warp * Eigen::Vector2f(static_cast<float>(pattern_.dx[k]), static_cast<float>(pattern_.dy[k]));
    patch.dx[k] = place.x();
    patch.dy[k] = place.y();
    patch.value[k] = gain * image(host_pixel.y() + pattern_.dy[k], host_pixel.x() + pattern_.dx[k]) + offset_;
    sum += patch.value[k];
  }
  patch.valid = std::isfinite(sum);
  return patch;
}

SearchPatch SearchPatchMaker::makeBlurred(const PatchPath& path, float spacing_px, float gain) const {
  SearchPatch patch;
  ReblurredPatch reblurred;
  reblurPatch(*host_, path, pattern_, sampleCount(path.length(), spacing_px, kMaxBlurSamples), reblurred,
              GradientMoments::kOmitted);
  float sum = 0.0F;
  for (std::size_t k = 0; k < SearchPatch::kSize; ++k) {
    patch.dx[k] = static_cast<float>(pattern_.dx[k]);
    patch.dy[k] = static_cast<float>(pattern_.dy[k]);
    patch.value[k] = gain * reblurred.value[k] + offset_;
    sum += patch.value[k];
  }
  patch.blur_px = static_cast<double>(path.length());
  patch.valid = std::isfinite(sum);
  return patch;
}

}  // namespace mba_vo
