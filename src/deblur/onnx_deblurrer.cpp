#include "mba_vo/deblur/onnx_deblurrer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "mba_vo/deblur/tiles.h"
#include "path_statistics.h"

namespace mba_vo {
namespace {

constexpr float kWhite = 255.0F;  // [grey levels]

[[noreturn]] void fail(const OnnxDeblurConfig& config, const std::string& what) {
  throw std::invalid_argument("mapper.deblur.onnx.model '" + config.model + "': " + what);
}

/// Of intensities; what is below 0 becomes black.
cv::Mat1f power(const cv::Mat1f& image, double exponent) {
  if (exponent == 1.0) return image;
  cv::Mat1f result(cv::max(image, 0.0) / kWhite);
  cv::pow(result, exponent, result);
  result *= kWhite;
  return result;
}

std::string shapeOf(const cv::Mat& blob) {
  std::string shape;
  for (int i = 0; i < blob.dims; ++i) shape += (i > 0 ? "x" : "") + std::to_string(blob.size[i]);
  return shape;
}

/// Mean of the channels.
cv::Mat1f toGrey(const cv::Mat& blob, int channels) {
  const int rows = blob.size[2];
  const int columns = blob.size[3];
  cv::Mat1f grey(rows, columns, 0.0F);
  for (int c = 0; c < channels; ++c) {
    grey += cv::Mat(rows, columns, CV_32F, const_cast<float*>(blob.ptr<float>(0, c)));
  }
  grey /= static_cast<float>(channels);
  return grey;
}

}  // namespace

/// OpenCV's networks keep their state between layers: one image at a time.
class OnnxDeblurrer::Network {
 public:
  explicit Network(const OnnxDeblurConfig& config) : config_(config) {
    if (config.model.empty()) fail(config, "no file is given");
    if (config.channels != 1 && config.channels != 3) {
      fail(config, "channels is " + std::to_string(config.channels) + ", must be 1 or 3");
    }
    if ((config.width == 0) != (config.height == 0)) {
      fail(config, "width is " + std::to_string(config.width) + " and height " + std::to_string(config.height) +
                       ", must both be those of the network, or both 0");
    }
    if (!std::filesystem::is_regular_file(config.model)) fail(config, "no such file");
    try {
      net_ = cv::dnn::readNetFromONNX(config.model);
    } catch (const cv::Exception& error) {
      fail(config, "not an ONNX network that OpenCV can read: " + error.err);
    }
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  }

  /// An image, in linear light, of a size that the network wants.
  cv::Mat1f run(const cv::Mat1f& image) {
    const cv::Mat1f normalised((power(image, 1.0 / config_.gamma) - static_cast<float>(config_.mean)) *
                               static_cast<float>(config_.scale));
    cv::Mat input;
    cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(config_.channels), normalised), input);
    const std::lock_guard<std::mutex> lock(mutex_);
    net_.setInput(cv::dnn::blobFromImage(input));
    const cv::Mat output = net_.forward();
    const std::vector<int> expected{1, config_.channels, image.rows, image.cols};
    if (output.dims != 4 || !std::equal(expected.begin(), expected.end(), output.size.p)) {
      fail(config_, "gives " + shapeOf(output) + " for 1x" + std::to_string(config_.channels) + "x" +
                        std::to_string(image.rows) + "x" + std::to_string(image.cols) + ", must be the same");
    }
    cv::Mat1f result = toGrey(output, config_.channels);
    if (config_.residual) result += normalised;
    result = result / static_cast<float>(config_.scale) + static_cast<float>(config_.mean);
    return power(result, config_.gamma);
  }

  /// The same of any size.
  cv::Mat1f runOnAny(const cv::Mat1f& image) {
    if (config_.width > 0) return runOnTiles(image, Tiles(image.size(), fixedSize(), config_.multiple_of));
    const auto multiple = static_cast<unsigned>(config_.multiple_of);
    const cv::Mat1f filled = fillUp(image, {cv::roundUp(image.cols, multiple), cv::roundUp(image.rows, multiple)});
    return run(filled)(cv::Rect({0, 0}, image.size()));
  }

  cv::Size fixedSize() const { return {config_.width, config_.height}; }

 private:
  static cv::Mat1f fillUp(const cv::Mat1f& image, cv::Size size) {
    cv::Mat1f filled;
    cv::copyMakeBorder(image, filled, 0, size.height - image.rows, 0, size.width - image.cols, cv::BORDER_REFLECT_101);
    return filled;
  }

  cv::Mat1f runOnTiles(const cv::Mat1f& image, const Tiles& tiles) {
    const cv::Mat1f filled = fillUp(image, tiles.padded());
    cv::Mat1f sum(filled.size(), 0.0F);
    cv::Mat1f weights(filled.size(), 0.0F);
    for (const cv::Rect& tile : tiles.all()) {
      const cv::Mat1f weight = tiles.weights(tile);
      sum(tile) += run(filled(tile)).mul(weight);
      weights(tile) += weight;
    }
    sum /= weights;
    return sum(cv::Rect({0, 0}, image.size()));
  }

  OnnxDeblurConfig config_;
  std::mutex mutex_;
  cv::dnn::Net net_;
};

OnnxDeblurrer::OnnxDeblurrer(const OnnxDeblurConfig& config) : network_(std::make_unique<Network>(config)) {
  constexpr int kTrialSide = 64;  // [px]
  const int side = cv::roundUp(kTrialSide, static_cast<unsigned>(config.multiple_of));
  const cv::Size size = config.width > 0 ? network_->fixedSize() : cv::Size(side, side);
  try {
    network_->run(cv::Mat1f(size, 0.5F * kWhite));
  } catch (const cv::Exception& error) {
    fail(config, "does not run on an image of " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                     " px with " + std::to_string(config.channels) + " channel(s); if it takes one size only, " +
                     "width and height must tell it: " + error.err);
  }
}

OnnxDeblurrer::~OnnxDeblurrer() = default;

DeblurResult OnnxDeblurrer::deblur(const DeblurInput& input) const {
  const ImageLevel& level = input.image->level(0);
  cv::Mat1f image = level.intensity.clone();
  cv::patchNaNs(image, 0.0);  // invalid pixels
  cv::Mat1f sharp = network_->runOnAny(image).clone();
  const float white = kWhite * static_cast<float>(level.gain);
  for (int y = 0; y < sharp.rows; ++y) {
    for (int x = 0; x < sharp.cols; ++x) {
      const float before = level.intensity(y, x);
      sharp(y, x) = std::isfinite(before) ? std::clamp(sharp(y, x), 0.0F, std::max(white, before)) : before;
    }
  }
  DeblurResult result;
  result.image = std::make_shared<const ImagePyramid>(sharp, level.camera, input.image->levels(), level.gain);
  result.blur_px = medianBlur(input);
  result.sharpened = true;
  return result;
}

}  // namespace mba_vo
