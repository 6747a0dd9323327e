#include "mba_vo/io/photometric_files.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

namespace mba_vo {
namespace {

std::vector<double> loadResponse(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw std::runtime_error(file + ": cannot be read");
  }
  constexpr std::size_t kGreyLevels = 256;
  std::vector<double> values;
  for (std::string word; stream >> word;) {
    std::size_t used = 0;
    double value = 0.0;
    try {
      value = std::stod(word, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used != word.size() || !std::isfinite(value)) {
      throw std::runtime_error(file + ": '" + word + "' is not a finite number");
    }
    if (!values.empty() && value <= values.back()) {
      throw std::runtime_error(file + ": value " + std::to_string(values.size()) + " is " + word +
                               ", must be greater than the value before it");
    }
    values.push_back(value);
  }
  if (values.size() != kGreyLevels) {
    throw std::runtime_error(file + ": " + std::to_string(values.size()) + " values, must be 256");
  }
  return values;
}

cv::Mat1f loadVignette(const std::string& file) {
  const cv::Mat image = cv::imread(file, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
  if (image.empty()) {
    throw std::runtime_error(file + ": not a readable image");
  }
  double brightest = 0.0;
  cv::minMaxLoc(image, nullptr, &brightest);
  if (brightest <= 0.0) {
    throw std::runtime_error(file + ": the vignette is black all over");
  }
  cv::Mat1f vignette;
  image.convertTo(vignette, CV_32F, 1.0 / brightest);
  return vignette;
}

cv::Mat1b loadMask(const std::string& file) {
  cv::Mat image = cv::imread(file, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
  if (image.empty()) {
    throw std::runtime_error(file + ": not a readable image");
  }
  if (image.depth() != CV_8U) {
    throw std::runtime_error(file + ": mask of type " + cv::typeToString(image.type()) + ", must have 8 bits");
  }
  if (cv::countNonZero(image) == 0) {
    throw std::runtime_error(file + ": the mask is black all over, no pixel would be used");
  }
  return image;
}

}  // namespace

PhotometricCalibration loadPhotometricCalibration(const FrameBuilderConfig& config) {
  PhotometricCalibration calibration;
  if (!config.response_file.empty()) {
    calibration.inverse_response = loadResponse(config.response_file);
  }
  if (!config.vignette_file.empty()) {
    calibration.vignette = loadVignette(config.vignette_file);
  }
  if (!config.mask_file.empty()) {
    calibration.mask = loadMask(config.mask_file);
  }
  return calibration;
}

}  // namespace mba_vo
