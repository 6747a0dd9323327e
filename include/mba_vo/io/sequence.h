#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "mba_vo/image/depth_image.h"
#include "mba_vo/image/frame_builder.h"
#include "mba_vo/odometry/camera_image.h"

namespace mba_vo {

/// A source of recorded images: a sequence folder or a bag. Never reads ground truth.
class SequenceReader {
 public:
  virtual ~SequenceReader() = default;
  virtual CameraCalibration calibration() const = 0;
  virtual std::size_t size() const = 0;  // images in the sequence
  /// Next image, nullopt at the end. An image that cannot be decoded comes back empty with its `problem`, so that the
  /// rest of the recording is not lost. Throws std::runtime_error naming the file or message if nothing can follow.
  virtual std::optional<CameraImage> next() = 0;
  /// Leaves out the next image; false at the end.
  virtual bool skip() { return next().has_value(); }
};

/// Where the depth images of a sequence folder are.
struct DepthFolder {
  std::string subfolder;                    // empty = there are none
  double units_per_metre = kTumDepthUnits;  // of the pixels
};

/// Opens a sequence folder: a camera file (cameraFileIn, or `camera_file`), times.txt, <images>/<id, six digits by
/// custom>.<webp|png|jpg|...>. A folder of TUM-mono is one, too. Stamps are those of mid-exposure. The exposures of
/// times.txt are those of the sub-folder `images`; for any other sub-folder they are unknown. Depth images
/// <depth>/<id>.png, 16 bit, belong to the image of the same id, pixel by pixel; there may be some for a few images
/// only. `camera`: as for readChosenCamera. Throws std::runtime_error naming what is missing or malformed.
std::unique_ptr<SequenceReader> openSequenceFolder(const std::string& folder, const std::string& images_subfolder,
                                                   const DepthFolder& depth = {}, const std::string& camera_file = "",
                                                   const std::string& camera = "");

}  // namespace mba_vo
