#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/io/sequence.h"

namespace mba_vo {

/// One image of a folder.
struct ListedImage {
  std::int64_t mid_exposure_ns = 0;
  std::optional<double> exposure;    // [s] as written, even if impossible; nullopt = unknown
  std::filesystem::path file;        // exists
  std::filesystem::path depth = {};  // 16-bit image of the same pixels; empty = none
};

/// All that a folder of images says, whatever its form.
struct ImageList {
  CameraCalibration calibration;
  std::string calibration_name;  // of its file, for messages
  std::vector<ListedImage> images;
  double depth_units = kTumDepthUnits;  // per metre
};

/// Reads the images one by one. Its next() throws std::runtime_error naming an image of another size than the
/// calibration's.
std::unique_ptr<SequenceReader> readListed(ImageList list);

/// Throws std::runtime_error naming the folder if there is none. Where a packed one lies beside it, how to unpack it.
void requireFolder(const std::filesystem::path& folder);

}  // namespace mba_vo
