#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <opencv2/core.hpp>

namespace mba_vo {

/// Whether its extension is that of an image.
bool isImageName(const std::filesystem::path& file);

/// Name without extension -> file, of every image in `folder`.
std::map<std::string, std::filesystem::path> imagesByName(const std::filesystem::path& folder);

/// Colour and depth as stored, except that webp, which knows no grey images, is read as grey. Empty if it cannot be
/// read.
cv::Mat readImage(const std::filesystem::path& file);

/// Throws std::runtime_error naming the file and the reason (a full disk, permissions) if it cannot be written.
void writePng(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace mba_vo
