#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "mba_vo/image/camera_calibration.h"

namespace mba_vo {

/// What the pixels of one image look like. Shares of white, 0..1, where no unit is told.
struct PixelFacts {
  double mean = 0.0;
  double contrast = 0.0;   // standard deviation
  double saturated = 0.0;  // share of the pixels
  /// By how much gradients at full resolution exceed those at a quarter of it (rms, noise taken off), relative, in the
  /// sharper one of x and y. 0 if there is nothing that is finer.
  double detail = 0.0;
};

/// How an image moved against the one before, by points that were found again in it.
struct MotionFacts {
  double length = 0.0;  // median [px]
  // What differs between first and last row beyond what a turn about the optical axis or an approach explains: motion
  // in x and y per row [px / row]. Rolling shutters cause it where the motion changes.
  double shear_x = 0.0;
  double shear_y = 0.0;
  cv::Point2d flow;  // mean [px]
  /// By how much the points became brighter: logarithm of the median ratio, as recorded. Nullopt where too few of them
  /// are neither dark nor white.
  std::optional<double> brighter;
};

struct ImageFacts {
  std::int64_t stamp_ns = 0;
  cv::Size size;         // empty if it could not be read
  std::string encoding;  // as the recording names it
  std::string problem;   // why it could not be read
  bool bad_encoding = false;
  bool repeats = false;  // an earlier image
  PixelFacts pixels;
  std::optional<MotionFacts> motion;
};

struct ExposureFacts {
  std::int64_t stamp_ns = 0;  // of its image
  double seconds = 0.0;       // as told; NaN = unknown
};

/// All that was seen of one camera.
struct CameraFacts {
  std::vector<ImageFacts> images;        // in the order of the recording
  std::vector<ExposureFacts> exposures;  // the same
  bool tells_exposure = false;           // whether anything in the recording could tell it
  std::optional<CameraCalibration> calibration;
  bool jpeg = false;            // images were compressed so
  bool response_known = false;  // the recording tells how grey values follow the light
  double white_level = 0.0;     // of 16-bit images [digital numbers]; 0 = there are none
};

/// From image to image, by the median of pairs of intervals [s]; 0 if no stamps increase.
double usualInterval(const std::vector<ImageFacts>& images);

/// The quantile `q`, 0..1, of `values`; 0 if there are none.
double quantile(std::vector<double> values, double q);

/// Way of the points of an image within its exposure, the median over the images [px]; 0 if it cannot be told.
double usualBlur(const CameraFacts& facts);

/// The exposure that is nearest to an image in time.
struct MatchedExposure {
  double seconds = 0.0;        // as told; NaN = unknown, or it is not that of the image
  std::int64_t offset_ns = 0;  // its stamp minus the image's
};

/// Between an exposure's stamp and its image's, as in the nodes.
inline constexpr std::int64_t kMatchingStampsNs = 500'000;

/// One for each image; none if there are no exposures.
std::vector<MatchedExposure> matchExposures(const CameraFacts& facts);

/// Median of the exposures that are known and positive [s], as told; 0 if there is none.
double usualExposure(const std::vector<ExposureFacts>& exposures);

}  // namespace mba_vo
