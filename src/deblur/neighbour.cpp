#include "mba_vo/deblur/neighbour.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "saturation.h"

namespace mba_vo {
namespace {

constexpr int kVisibilityCell = 8;     // of the pixels whose places are computed, the others follow between them [px]
constexpr double kNearest = 1e-6;      // [m]
constexpr double kMostParallax = 1.0;  // by which depths may differ [px]
constexpr float kNowhere = -1e4F;      // [px]
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

/// Where the keyframe's pixels are in the neighbour, by cell.
class Places {
 public:
  Places(const NeighbourLevel& neighbour, const cv::Mat1f& keyframe_depth, const cv::Mat1f& neighbour_depth)
      : maker_(neighbour.geometry),
        T_neighbour_keyframe_(neighbour.geometry.trajectory.T_reference_mid.inverse()),
        camera_(neighbour.geometry.latent_camera),
        keyframe_depth_(keyframe_depth),
        neighbour_depth_(neighbour_depth),
        shift_((camera_.height + kVisibilityCell - 1) / kVisibilityCell,
               (camera_.width + kVisibilityCell - 1) / kVisibilityCell),
        hidden_(shift_.size(), static_cast<uchar>(0)) {
    for (int r = 0; r < shift_.rows; ++r) {
      for (int c = 0; c < shift_.cols; ++c) place(r, c);
    }
  }

  /// Place of every pixel of the keyframe [px]. The correction is small: turning it into the neighbour's axes would
  /// change less than its own error.
  cv::Mat2f map(const cv::Mat2f& correction) const {
    cv::Mat2f map;
    cv::resize(shift_, map, shift_.size() * kVisibilityCell, 0.0, 0.0, cv::INTER_LINEAR);
    map = map(cv::Rect(0, 0, camera_.width, camera_.height)).clone();
    if (!correction.empty()) {
      cv::Mat2f smooth;
      cv::resize(correction, smooth, map.size(), 0.0, 0.0, cv::INTER_LINEAR);
      map += smooth;
    }
    for (int y = 0; y < map.rows; ++y) {
      for (int x = 0; x < map.cols; ++x) {
        cv::Vec2f& place = map(y, x);
        place += cv::Vec2f(static_cast<float>(x), static_cast<float>(y));
        if (!std::isfinite(place[0]) || !std::isfinite(place[1])) place = {kNowhere, kNowhere};
      }
    }
    return map;
  }

  void hide(cv::Mat1f& image) const {
    const cv::Rect all({0, 0}, image.size());
    for (int r = 0; r < hidden_.rows; ++r) {
      for (int c = 0; c < hidden_.cols; ++c) {
        if (hidden_(r, c) != 0)
          image(cv::Rect(kVisibilityCell * c, kVisibilityCell * r, kVisibilityCell, kVisibilityCell) & all)
              .setTo(kNoValue);
      }
    }
  }

 private:
  void place(int r, int c) {
    const Eigen::Vector2d pixel = kVisibilityCell * Eigen::Vector2d(c, r).array() + 0.5 * (kVisibilityCell - 1);
    const double depth = static_cast<double>(at(keyframe_depth_, pixel.cast<float>()));
    LatentPath seen;
    if (!maker_.make(pixel, depth, seen)) {
      shift_(r, c) = {kNoValue, kNoValue};
      hidden_(r, c) = 1;
      return;
    }
    const Eigen::Vector2f shift = seen.pixel - pixel.cast<float>();
    shift_(r, c) = {shift.x(), shift.y()};
    const Eigen::Vector3d point = T_neighbour_keyframe_ * (camera_.unproject(pixel) / depth);
    const double difference = static_cast<double>(at(neighbour_depth_, seen.pixel)) - 1.0 / point.z();
    if (std::abs(difference) * seen.path.J_inverse_depth[0].norm() > kMostParallax) hidden_(r, c) = 1;
  }

  static float at(const cv::Mat1f& image, const Eigen::Vector2f& pixel) {
    const float x = std::clamp(pixel.x(), 0.0F, static_cast<float>(image.cols - 1));
    const float y = std::clamp(pixel.y(), 0.0F, static_cast<float>(image.rows - 1));
    return image(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x)));
  }

  LatentPathMaker maker_;
  SE3 T_neighbour_keyframe_;
  PinholeCamera camera_;
  const cv::Mat1f& keyframe_depth_;
  const cv::Mat1f& neighbour_depth_;
  cv::Mat2f shift_;   // to the place in the neighbour [px]
  cv::Mat1b hidden_;  // 1: behind something else
};

/// In the keyframe's grey levels.
cv::Mat1f withBrightnessUndone(const ImageLevel& level, double gain, double offset) {
  cv::Mat1f image;
  level.intensity.convertTo(image, CV_32F, 1.0 / gain, -offset / gain);
  image.setTo(kNoValue, level.intensity >= level.gain * static_cast<double>(kSaturated));
  return image;
}

}  // namespace

cv::Mat1f denseInverseDepth(const DeblurNeighbour& neighbour, const PinholeCamera& keyframe_camera,
                            const std::vector<DepthSample>& samples) {
  const PinholeCamera& camera = neighbour.image->level(0).camera;
  const SE3 T_neighbour_keyframe = neighbour.motion.T_reference_mid.inverse();
  std::vector<DepthSample> moved;
  moved.reserve(samples.size());
  for (const DepthSample& sample : samples) {
    const double depth = 1.0 / static_cast<double>(sample.inverse_depth);
    const Eigen::Vector3d point =
        T_neighbour_keyframe * (depth * keyframe_camera.unproject(sample.pixel.cast<double>()));
    if (!(point.z() > kNearest)) continue;
    moved.push_back({camera.project(point).cast<float>(), static_cast<float>(1.0 / point.z())});
  }
  return denseInverseDepth(camera, moved);
}

cv::Mat1f overlay(const NeighbourLevel& neighbour, const cv::Mat1f& keyframe_depth, const cv::Mat1f& neighbour_depth) {
  const DeblurNeighbour& n = *neighbour.neighbour;
  const cv::Mat1f image = withBrightnessUndone(n.image->level(neighbour.level), n.gain, n.offset);
  const Places places(neighbour, keyframe_depth, neighbour_depth);
  cv::Mat1f result;
  // Eight taps a side: whatever damps fine detail here would be taken for blur.
  cv::remap(image, result, places.map(neighbour.correction), cv::noArray(), cv::INTER_LANCZOS4, cv::BORDER_CONSTANT,
            kNoValue);
  places.hide(result);
  return result;
}

}  // namespace mba_vo
