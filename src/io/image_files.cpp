#include "mba_vo/io/image_files.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

std::string lowerCaseExtension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

bool isImageName(const fs::path& file) {
  const std::set<std::string> extensions{".webp", ".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".tif", ".tiff"};
  return extensions.count(lowerCaseExtension(file)) != 0;
}

std::map<std::string, fs::path> imagesByName(const fs::path& folder) {
  std::map<std::string, fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (isImageName(entry.path())) images[entry.path().stem().string()] = entry.path();
  }
  return images;
}

cv::Mat readImage(const fs::path& file) {
  const int flags = lowerCaseExtension(file) == ".webp" ? cv::IMREAD_GRAYSCALE : cv::IMREAD_UNCHANGED;
  try {
    return cv::imread(file.string(), flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

void writePng(const fs::path& file, const cv::Mat& image) {
  std::vector<unsigned char> png;
  cv::imencode(".png", image, png);
  writeFile(file.string(), [&png](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  });
}

}  // namespace mba_vo
