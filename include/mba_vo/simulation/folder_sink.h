#pragma once

#include <fstream>
#include <string>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/simulation/sequence_sink.h"

namespace mba_vo {

/// Writes a sequence folder: camera.yaml, times.txt (exposure 0 = the camera does not tell it), images/, images_sharp/
/// and depth/ when frames carry them, groundtruth.txt, groundtruth_exposure.txt, blur_px.txt.
class FolderSink : public SequenceSink {
 public:
  /// Like `write` and `finish`, throws std::runtime_error naming what cannot be written and why; also when `folder`
  /// already holds a sequence and `overwrite` is false.
  FolderSink(const std::string& folder, const CameraCalibration& calibration, bool overwrite = false);

  void write(const SimulatedFrame& frame) override;
  void finish() override { flush(); }

 private:
  void flush();
  void writeJpeg(const SimulatedFrame& frame) const;
  void writeImage(const std::string& subfolder, const SimulatedFrame& frame, const cv::Mat& image) const;

  std::string folder_;
  std::ofstream times_, groundtruth_, exposures_, blur_;
};

/// Depth images store z in units of 1/5000 m; 0 = beyond 13.1 m.
constexpr double kDepthUnitsPerMetre = 5000.0;

}  // namespace mba_vo
