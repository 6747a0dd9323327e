#pragma once

#include <memory>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "support/rendered_room.h"

namespace mba_vo {

/// A rendered view, smoothed so that the derivative of its interpolation is that of the image.
struct SmoothScene {
  std::shared_ptr<Reference> reference;
  FrameConstPtr frame;
  std::vector<int> points;  // away from the border, where no pixel leaves the image
};

inline SmoothScene makeScene(const Vector6& image_xi = Vector6::Zero(), double row_time = 0.0) {
  const SimulatedFrame a = test::roomView(40);
  const SimulatedFrame b = test::roomView(41);
  const auto smooth = [](const cv::Mat1b& image) {
    cv::Mat1f result = test::toFloat(image);
    cv::GaussianBlur(result, result, {0, 0}, 4.0);
    return result;
  };
  SmoothScene scene;
  PinholeCamera camera = test::roomSimulator().camera();
  camera.row_time = row_time;
  scene.reference = test::makeReference(a, smooth(a.sharp), 600);
  scene.reference->pyramid = std::make_shared<const ImagePyramid>(smooth(a.sharp), camera, 5);
  scene.reference->image_xi = image_xi;
  auto frame = std::make_shared<Frame>(*test::makeFrame(smooth(b.blurred), 0, 0.02));
  frame->pyramid = ImagePyramid(smooth(b.blurred), camera, 5);
  scene.frame = frame;
  for (std::size_t i = 0; i < scene.reference->points.size(); ++i) {
    scene.reference->points[i].variance = 0.0F;  // else the weights depend on the state too
    const Eigen::Vector2f pixel = scene.reference->points[i].pixel;
    if (pixel.x() > 60 && pixel.x() < 316 && pixel.y() > 60 && pixel.y() < 180)
      scene.points.push_back(static_cast<int>(i));
  }
  return scene;
}

}  // namespace mba_vo
