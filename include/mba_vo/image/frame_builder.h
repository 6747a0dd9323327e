#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "mba_vo/image/camera_calibration.h"
#include "mba_vo/image/frame.h"
#include "mba_vo/image/photometric_correction.h"

namespace mba_vo {

struct FrameBuilderConfig {
  int binning = 0;
  int pyramid_levels = 6;
  double gamma = 1.0;  // pixel = irradiance^(1/gamma); 1 = linear camera
  std::string response_file;
  std::string vignette_file;
  std::string mask_file;
  bool find_overlay = true;
  std::string learnt_file;
  double white_level = 0.0;
  double row_time = 0.0;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("binning", c.binning, 0, 8,
      "pixels a side that are averaged to one; 0 = 1, but 2 above 600,000 pixels, and twice as many as soon as a live "
      "run does not keep up");
    v("pyramid_levels", c.pyramid_levels, 1, 8, "most image pyramid levels");
    v("gamma", c.gamma, 0.1, 10.0, "gamma of the camera, 1 = linear; ignored if response_file is set");
    v("response_file", c.response_file, "response in TUM mono form (pcalib.txt: 256 values), empty = none");
    v("vignette_file", c.vignette_file, "vignette image in TUM mono form, empty = none");
    v("mask_file", c.mask_file,
      "8-bit image of the size of the camera's; pixels that are 0 there are not used; empty = none");
    v("find_overlay", c.find_overlay,
      "find what does not move with the scene (watermark, dead pixels, parts of the vehicle), and do not use it");
    v("learnt_file", c.learnt_file,
      "what runs learn of the camera is kept in this file, and the next run begins with it; empty = forgotten");
    v("white_level", c.white_level, 0.0, 65535.0,
      "value of a saturated pixel in 16-bit images [digital numbers], 0 = the lowest of 10, 12, 14 or 16 bits that "
      "holds all");
    v("row_time", c.row_time, -1e-3, 1e-3, "rolling shutter: time from one row to the next [s], 0 = global shutter");
  }
};

/// Makes Frames from camera images: grey, photometrically linear, binned, rectified, with pyramid.
class FrameBuilder {
 public:
  /// Throws std::invalid_argument naming the offending value for an impossible calibration or configuration.
  FrameBuilder(const CameraCalibration& calibration, const PhotometricCalibration& photometric,
               const FrameBuilderConfig& config);
  ~FrameBuilder();
  FrameBuilder(FrameBuilder&&) noexcept;

  /// From the next image on, the calibration is corrected so.
  void correct(const CalibrationCorrection& correction);

  /// From the next image on, 16-bit images are white at this value [digital numbers].
  void setWhiteLevel(double white_level);
  /// From the next image on, intensities are multiplied by it.
  void setGain(double gain);

  /// Camera of the binned and rectified images. Only its row time changes with a correction.
  const PinholeCamera& camera() const;

  /// From the next image on, pixels of the camera's images that are not 0 in it are not used. Of their size; empty =
  /// all of them are, but for the mask. It must not be written any more.
  void setOverlay(const cv::Mat1b& overlay);
  /// 255 where pixels of the camera's images are not used; empty = nowhere.
  const cv::Mat1b& unused() const;

  /// `image`: 8- or 16-bit (white at 65535 unless told otherwise), 1, 3 (BGR) or 4 channels, of the calibration's size,
  /// else std::invalid_argument. `depth`: of the same pixels [m], NaN = unknown, of the same size; empty = none. It
  /// must not be written any more.
  FrameConstPtr build(const cv::Mat& image, std::uint64_t sequence, std::int64_t stamp_ns, std::int64_t mid_exposure_ns,
                      std::optional<double> exposure, const cv::Mat1f& depth = cv::Mat1f()) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
