#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace mba_vo {

/// As stored, colour and depth, except that webp knows no grey images. Empty if it cannot be read.
cv::Mat readImageFile(const std::filesystem::path& file);

/// Whether its extension is that of an image.
bool isImageName(const std::filesystem::path& file);

}  // namespace mba_vo
