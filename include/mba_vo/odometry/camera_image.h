#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace mba_vo {

/// One image as the camera sent it, or as it was recorded.
struct CameraImage {
  std::uint64_t sequence = 0;           // number of the image, those that are missing counted
  std::int64_t stamp_ns = 0;            // as it came, whatever it refers to [ns]
  std::int64_t mid_exposure_ns = 0;     // by stamp and exposure [ns]
  std::optional<double> exposure;       // [s]; nullopt = unknown
  cv::Mat image;                        // empty if it could not be read
  std::string problem;                  // why the image is empty, or what is wrong with its depth
  cv::Mat1f depth;                      // z of the image's pixels [m], NaN = unknown; empty = none
  std::string camera_frame{};           // name of the camera's frame; may be empty
  bool exposure_from_topic = false;     // else it was told once for all images
  double arrival = 0.0;                 // when it came in, on the clock of whoever handed it on [s]
  std::shared_ptr<const void> owner{};  // of the pixels, if the images themselves do not own them
};

}  // namespace mba_vo
