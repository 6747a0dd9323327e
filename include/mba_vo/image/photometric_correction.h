#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

namespace mba_vo {

inline constexpr double kSixteenBitWhite = 65535.0;  // [digital numbers]

/// Photometric calibration in TUM mono form: pixel = response(vignette(x) * irradiance).
struct PhotometricCalibration {
  std::vector<double> inverse_response;  // 256 values, grey level -> irradiance; empty = use gamma
  cv::Mat1f vignette;                    // attenuation in (0, 1], 0 = pixel sees nothing; empty = none
  cv::Mat1b mask;                        // of the camera's image, 0 = the pixel is not used; empty = all are
};

/// Turns camera images into irradiance in linear grey levels: black is 0, full scale in the middle of the vignette 255.
/// Pixels that the vignette darkens to almost nothing become NaN. Saturated pixels are left as they are.
class PhotometricCorrection {
 public:
  /// `gamma`: pixel = irradiance^(1/gamma), used if there is no response. Throws std::invalid_argument for a response
  /// that cannot be inverted or a vignette of another size than `size` or with values outside [0, 1].
  PhotometricCorrection(const PhotometricCalibration& calibration, double gamma, cv::Size size);

  /// `image`: 8-bit, or 16-bit and white at `white_level`, 1, 3 (BGR) or 4 (BGRA) channels; else std::invalid_argument.
  /// Colours are mixed to luma after linearisation, because light adds up in linear terms only.
  cv::Mat1f apply(const cv::Mat& image, double white_level = kSixteenBitWhite) const;

 private:
  std::array<float, 256> linear_;  // grey level -> linear grey level
  cv::Mat1f inverse_vignette_;     // NaN where the pixel sees nothing; empty = none
};

}  // namespace mba_vo
