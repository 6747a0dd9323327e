#include "input_conversion.h"

#include "mba_vo/ros/image_conversion.h"

namespace mba_vo {
namespace {

/// Empty, and told why in `problem`, if there is none of any use.
cv::Mat1f depthOf(const InputImage& input, std::string& problem) {
  if (!input.depth) return {};
  const auto& image = *input.message;
  try {
    cv::Mat1f depth = depthFromMessage(input.depth);
    if (depth.cols == static_cast<int>(image.width) && depth.rows == static_cast<int>(image.height)) return depth;
    problem = "depth image is not used: it is " + std::to_string(depth.cols) + "x" + std::to_string(depth.rows) +
              ", the image is " + std::to_string(image.width) + "x" + std::to_string(image.height);
  } catch (const std::invalid_argument& error) {
    problem = std::string("depth image is not used: ") + error.what();
  }
  return {};
}

}  // namespace

CameraImage toCameraImage(const InputImage& input, StampReference stamp_reference) {
  CameraImage image;
  image.sequence = input.sequence;
  image.stamp_ns = toNanoseconds(input.message->header.stamp);
  image.mid_exposure_ns = midExposure(image.stamp_ns, input.exposure, stamp_reference);
  image.exposure = input.exposure;
  image.exposure_from_topic = input.exposure_from_topic;
  image.camera_frame = cameraFrame(input.message->header.frame_id);
  if (image.stamp_ns == 0) {
    image.problem = "its stamp is zero";
    return image;
  }
  image.problem = input.problem;
  if (!image.problem.empty()) return image;
  try {
    const cv_bridge::CvImageConstPtr pixels = toCvImage(input.message);
    image.image = pixels->image;
    image.owner = std::shared_ptr<const void>(pixels.get(), [pixels](const void*) {});
    image.depth = depthOf(input, image.problem);
  } catch (const std::invalid_argument& error) {
    image.problem = error.what();
  }
  return image;
}

}  // namespace mba_vo
