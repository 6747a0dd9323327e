#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "mba_vo/image/depth_image.h"
#include "mba_vo/image/frame_builder.h"

namespace mba_vo {

/// One image of a recorded sequence as it was recorded.
struct SequenceImage {
  std::uint64_t sequence = 0;        // position in the sequence, skipped images counted
  std::int64_t stamp_ns = 0;         // as recorded [ns]
  std::int64_t mid_exposure_ns = 0;  // [ns]
  std::optional<double> exposure;    // [s]; nullopt = unknown
  cv::Mat image;                     // empty if it could not be read
  std::string problem;               // why the image is empty, or what is wrong with its depth
  cv::Mat1f depth;                   // z of the image's pixels [m], NaN = unknown; empty = none
};

/// A source of recorded images: a sequence folder or a bag. Never reads ground truth.
class SequenceReader {
 public:
  virtual ~SequenceReader() = default;
  virtual CameraCalibration calibration() const = 0;
  virtual std::size_t size() const = 0;  // images in the sequence
  /// Next image, nullopt at the end. An image that cannot be decoded comes back empty with its `problem`, so that the
  /// rest of the recording is not lost. Throws std::runtime_error naming the file or message if nothing can follow.
  virtual std::optional<SequenceImage> next() = 0;
  /// Leaves out the next image; false at the end.
  virtual bool skip() { return next().has_value(); }
};

/// Where the depth images of a sequence folder are.
struct DepthFolder {
  std::string subfolder;                    // empty = there are none
  double units_per_metre = kTumDepthUnits;  // of the pixels
};

/// Opens a sequence folder: camera.yaml, times.txt, <images>/<id, six digits>.<webp|png|jpg|...>. Stamps are those of
/// mid-exposure. The exposures of times.txt are those of the sub-folder `images`; for any other sub-folder they are
/// unknown. Depth images <depth>/<id, six digits>.png, 16 bit, belong to the image of the same id, pixel by pixel;
/// there may be some for a few images only. Throws std::runtime_error naming what is missing or malformed.
std::unique_ptr<SequenceReader> openSequenceFolder(const std::string& folder, const std::string& images_subfolder,
                                                   const DepthFolder& depth = {});

}  // namespace mba_vo
