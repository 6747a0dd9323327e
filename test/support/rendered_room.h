#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "mba_vo/image/frame.h"
#include "mba_vo/image/point_selector.h"
#include "mba_vo/tracking/reference.h"
#include "simulation/test_scenes.h"
#include "support/test_frames.h"

namespace mba_vo::test {

/// The room of seed 1 seen at 376x240, with sharp images and depths.
inline SimulationConfig roomConfig() {
  SimulationConfig config;
  config.resize(376, 240);
  config.sharp = config.depth = true;
  return config;
}

inline const Simulator& roomSimulator() {
  static const Simulator simulator(roomConfig(), sharedRoom());
  return simulator;
}

/// One of its frames.
inline SimulatedFrame roomView(int index) {
  static const FrameCache cache = testFrames(roomConfig());
  return testFrame(roomSimulator(), index, cache);
}

inline cv::Mat1f toFloat(const cv::Mat1b& image) {
  cv::Mat1f result;
  image.convertTo(result, CV_32F);
  return result;
}

inline cv::Mat1f scaled(const cv::Mat1f& image, double gain, double offset = 0.0) {
  cv::Mat1f result;
  image.convertTo(result, CV_32F, gain, offset);
  return result;
}

/// As a camera of that vignette would take it.
inline cv::Mat1f darkened(const cv::Mat1f& image, const CalibrationCorrection::Vignette& vignette) {
  const PinholeCamera camera = roomSimulator().camera();
  cv::Mat1f result = image.clone();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      result(y, x) *= static_cast<float>(std::exp(vignette.dot(vignetteJacobian(camera, {x, y}))));
    }
  }
  return result;
}

/// Motion with constant velocity, T_world_mid at t = 0.
inline PoseFunction constantVelocity(const SE3& T_world_mid, const Vector6& velocity) {
  return [=](double t) { return T_world_mid * SE3::exp(t * velocity); };
}

inline FrameConstPtr makeFrame(const cv::Mat1f& intensity, std::int64_t mid_exposure_ns, std::optional<double> exposure,
                               std::uint64_t sequence = 0) {
  auto frame = std::make_shared<Frame>();
  frame->sequence = sequence;
  frame->stamp_ns = frame->mid_exposure_ns = mid_exposure_ns;
  frame->exposure = exposure;
  frame->pyramid = ImagePyramid(intensity, roomSimulator().camera(), 5);
  return frame;
}

/// The same frame with another exposure.
inline FrameConstPtr withExposure(const Frame& frame, std::optional<double> exposure) {
  auto other = std::make_shared<Frame>(frame);
  other->exposure = exposure;
  return other;
}

inline FrameConstPtr makeFrame(const SimulatedFrame& rendered, std::optional<double> exposure) {
  return makeFrame(toFloat(rendered.blurred), rendered.mid_exposure_ns, exposure, rendered.id);
}

/// Reference with the true depths at selected points of `image`, which was seen at mid-exposure of `rendered`.
inline std::shared_ptr<Reference> makeReference(const SimulatedFrame& rendered, const cv::Mat1f& image,
                                                int points = 1200) {
  auto reference = std::make_shared<Reference>();
  reference->id = {1, 0, 0};
  reference->mid_exposure_ns = rendered.mid_exposure_ns;
  reference->pyramid = std::make_shared<const ImagePyramid>(image, roomSimulator().camera(), 5);
  for (const Eigen::Vector2i& pixel : selectPoints(*reference->pyramid, points, {})) {
    const float inverse_depth = 1.0F / rendered.depth(pixel.y(), pixel.x());
    const float sigma = 0.01F * inverse_depth;
    reference->points.push_back({pixel.cast<float>(), inverse_depth, sigma * sigma});
  }
  reference->T_map_keyframe[0] = SE3();
  return reference;
}

/// Mean distance in the image between where the scene, known by the reference's true depths, appears by two poses [px].
inline double meanReprojectionError(const cv::Mat1f& depth, const SE3& T_reference_a, const SE3& T_reference_b) {
  const PinholeCamera camera = roomSimulator().camera();
  double sum = 0.0;
  int count = 0;
  for (int y = 5; y < camera.height; y += 10) {
    for (int x = 5; x < camera.width; x += 10) {
      const Eigen::Vector3d P = static_cast<double>(depth(y, x)) * camera.unproject({x, y});
      const Eigen::Vector3d a = T_reference_a.inverse() * P;
      const Eigen::Vector3d b = T_reference_b.inverse() * P;
      if (a.z() <= 0.1 || b.z() <= 0.1 || !camera.contains(camera.project(a))) continue;
      sum += (camera.project(a) - camera.project(b)).norm();
      ++count;
    }
  }
  return count > 0 ? sum / count : 1e9;
}

/// Motion of the image within an exposure for points 2 m before the camera along the border of the image [px].
inline std::vector<Eigen::Vector2d> borderMotion(const SE3& T_start_end) {
  const PinholeCamera camera = roomSimulator().camera();
  std::vector<Eigen::Vector2d> motion;
  for (int i = 0; i <= 8; ++i) {
    const double x = (camera.width - 1) * i / 8.0;
    const double y = (camera.height - 1) * i / 8.0;
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(x, 0.0), Eigen::Vector2d(x, camera.height - 1.0),
                                         Eigen::Vector2d(0.0, y), Eigen::Vector2d(camera.width - 1.0, y)}) {
      motion.push_back(camera.project(T_start_end.inverse() * (2.0 * camera.unproject(pixel))) - pixel);
    }
  }
  return motion;
}

/// How the motion within an exposure differs from the truth along the image's border [px].
struct BorderError {
  double mean = 0.0;
  double true_length = 0.0;  // mean
};

inline BorderError borderError(const SE3& T_start_end, const SE3& T_start_end_truth) {
  const auto motion = borderMotion(T_start_end);
  const auto truth = borderMotion(T_start_end_truth);
  BorderError error;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    error.mean += (motion[i] - truth[i]).norm() / static_cast<double>(truth.size());
    error.true_length += truth[i].norm() / static_cast<double>(truth.size());
  }
  return error;
}

}  // namespace mba_vo::test
