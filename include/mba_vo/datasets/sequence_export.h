#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/evaluation/pose_file.h"
#include "mba_vo/image/frame_builder.h"
#include "mba_vo/odometry/camera_image.h"

namespace mba_vo {

struct ExportOptions {
  std::vector<std::string> forms{"dso", "euroc", "tum"};  // each becomes a folder of this name
  bool rectify = false;                                   // images of an ideal pinhole camera
  bool overwrite = false;                                 // what an earlier export left there
};

/// Which forms there are.
std::vector<std::string> exportForms();

/// What is known of the images beside their pixels.
struct ExportedFrame {
  std::uint64_t sequence = 0;      // in the recording
  std::int64_t stamp_ns = 0;       // mid-exposure [ns]
  std::optional<double> exposure;  // [s]
  bool depth = false;
  double light = 0.0;      // mean [grey levels]
  double saturated = 0.0;  // part of the pixels at either end
  double texture = 0.0;    // mean length of the gradient [grey levels / px]
};

/// Writes a sequence in the forms that other systems read:
///   dso:   images/<index, six digits>.png, times.txt (with exposures), camera.txt, pcalib.txt and vignette.png;
///   euroc: mav0/cam0/data/<ns>.png, data.csv, sensor.yaml, times.txt, dso/cam0/times.txt (exposures, as TUM-VI has
///          them), orb_slam.yaml;
///   tum:   rgb/<s>.png, rgb.txt, depth.txt and associations.txt, camera.yaml, orb_slam.yaml.
/// The true trajectory goes with each. Images have 8 bits. What any other system would stumble upon is left out: images
/// that could not be read, and those not later than the one before.
class SequenceExport {
 public:
  /// Throws std::invalid_argument for a form that is none, or a lens that a form has no place for, and
  /// std::runtime_error if `folder` holds such forms already. `image`: tells response, vignette and white level.
  SequenceExport(const std::string& folder, const CameraCalibration& calibration, const FrameBuilderConfig& image,
                 const ExportOptions& options);
  ~SequenceExport();
  SequenceExport(SequenceExport&&) noexcept;

  /// Throws std::runtime_error naming a file that cannot be written, or an image of another size than the
  /// calibration's.
  void add(const CameraImage& image);

  /// Writes the lists. `truth`: of the camera, may be empty. Throws as `add`, and if no image was taken.
  void finish(const std::vector<PoseRecord>& truth);

  const std::vector<ExportedFrame>& frames() const;
  /// Why images were left out: their numbers with the reason.
  const std::vector<std::string>& leftOut() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
