#include "mba_vo/deblur/folder_deblurrer.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "path_statistics.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

/// The file of a frame, whatever kind of image it is.
std::optional<std::string> fileOf(std::uint64_t sequence, const std::string& folder) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06llu", static_cast<unsigned long long>(sequence));
  for (const char* extension : {".png", ".webp", ".jpg"}) {
    const fs::path file = fs::path(folder) / (std::string(name.data()) + extension);
    if (fs::is_regular_file(file)) return file.string();
  }
  return std::nullopt;
}

}  // namespace

FolderDeblurrer::FolderDeblurrer(const FolderDeblurConfig& config) : config_(config) {
  if (config.images.empty()) throw std::invalid_argument("mapper.deblur.folder.images: no folder is given");
  if (!fs::is_directory(config.images)) {
    throw std::invalid_argument("mapper.deblur.folder.images '" + config.images + "': no such folder");
  }
}

DeblurResult FolderDeblurrer::deblur(const DeblurInput& input) const {
  DeblurResult result;
  result.image = input.image;
  const std::optional<std::string> file = fileOf(input.sequence, config_.images);
  if (!file) {
    result.reason = "no file";
    return result;
  }
  const ImageLevel& level = input.image->level(0);
  const cv::Mat image = cv::imread(*file, cv::IMREAD_GRAYSCALE);
  if (image.size() != level.intensity.size()) {
    throw std::runtime_error(*file + ": not an image of " + std::to_string(level.intensity.cols) + "x" +
                             std::to_string(level.intensity.rows));
  }
  cv::Mat1f sharp;
  image.convertTo(sharp, CV_32F, level.gain);
  const cv::Mat valid = level.intensity == level.intensity;  // NaN differs from itself
  sharp.setTo(std::nanf(""), ~valid);
  result.image = std::make_shared<const ImagePyramid>(sharp, level.camera, input.image->levels(), level.gain);
  result.blur_px = medianBlur(input);
  result.sharpened = true;
  return result;
}

}  // namespace mba_vo
