#include "mba_vo/io/image_file.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>

#include <opencv2/imgcodecs.hpp>

namespace mba_vo {
namespace {

std::string lowerCaseExtension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

cv::Mat readImageFile(const std::filesystem::path& file) {
  const int flags = lowerCaseExtension(file) == ".webp" ? cv::IMREAD_GRAYSCALE : cv::IMREAD_UNCHANGED;
  try {
    return cv::imread(file.string(), flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

bool isImageName(const std::filesystem::path& file) {
  const std::set<std::string> extensions{".webp", ".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".tif", ".tiff"};
  return extensions.count(lowerCaseExtension(file)) != 0;
}

}  // namespace mba_vo
