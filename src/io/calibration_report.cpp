#include "mba_vo/io/calibration_report.h"

#include <cmath>
#include <filesystem>
#include <iomanip>
#include <stdexcept>
#include <utility>

#include "mba_vo/image/corrected_calibration.h"
#include "mba_vo/image/static_overlay.h"
#include "mba_vo/io/camera_file.h"
#include "mba_vo/io/camera_memory.h"
#include "mba_vo/io/camera_yaml.h"
#include "mba_vo/io/image_files.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

using Correction = CalibrationCorrection;

constexpr double kMicro = 1e6;
constexpr double kPercent = 1e2;
constexpr double kMilli = 1e3;

std::vector<CalibratedNumber> allNumbers(const ToldCamera& told, const CalibrationStudy& study) {
  std::vector<CalibratedNumber> numbers = calibratedNumbers(told, study.estimate);
  if (const auto exposure = calibratedExposure(study.last)) numbers.push_back(*exposure);
  return numbers;
}

void writeFigures(const ToldCamera& told, const CalibrationStudy& study, double fit_error_px, std::ostream& out) {
  const CalibrationEstimate& estimate = study.estimate;
  out << "passes: " << study.passes << "\nsettled: " << (study.settled ? "true" : "false")
      << "\nwindows: " << estimate.windows << "\nchi2: " << estimate.chi2({})
      << "  # of all numbers together, against what was told\ndegrees_of_freedom: "
      << (told.image.vignette_file.empty() ? Correction::kDim : Correction::kGeometryDim)
      << "\ncamera_model_error_px: " << fit_error_px << "  # largest, of camera.yaml\nnumbers:\n";
  for (const CalibratedNumber& n : allNumbers(told, study)) {
    out << "  - {name: \"" << n.name << "\", unit: \"" << n.unit << "\", told: " << n.told << ", found: " << n.found
        << ", sigma: " << n.sigma << ", significance: " << n.significance() << "}\n";
  }
}

/// With a new name, it is written for the camera that camera.yaml describes.
void writeSensor(const std::string& file, const ToldCamera& told, const CameraCalibration& camera,
                 const CalibrationCorrection& correction) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  FrameBuilderConfig image = told.image;
  image.learnt_file = file;
  CalibrationCorrection rest = correction;
  rest.values.head<Correction::kReadout>().setZero();
  CameraMemory memory(image);
  memory.recall(camera);
  memory.keep(rest);
}

}  // namespace

std::vector<CalibratedNumber> calibratedNumbers(const ToldCamera& told, const CalibrationEstimate& estimate) {
  const CameraCalibration& c = told.calibration;
  const auto number = [&](Correction::Index i, const char* name, const char* unit, double from, double scale) {
    const double sigma = std::sqrt(estimate.covariance(i, i));
    return CalibratedNumber{name, unit, from, from + scale * estimate.correction[i], scale * sigma};
  };
  std::vector<CalibratedNumber> numbers{
      number(Correction::kFocal, "focal length", "px", c.fx, c.fx),
      number(Correction::kCentreX, "centre x", "px", c.cx, c.fx),
      number(Correction::kCentreY, "centre y", "px", c.cy, c.fy),
      number(Correction::kK1, "further k1", "", 0.0, 1.0),
      number(Correction::kK2, "further k2", "", 0.0, 1.0),
      number(Correction::kReadout, "row time", "us", kMicro * told.image.row_time, kMicro / c.height)};
  if (told.image.vignette_file.empty()) {
    const auto [light, sigma] = lightAt(1.0, estimate);
    numbers.push_back({"light in the corners", "%", kPercent, kPercent * light, kPercent * sigma});
  }
  return numbers;
}

std::pair<double, double> lightAt(double q, const CalibrationEstimate& estimate) {
  const Correction::Vignette powers(q, q * q, q * q * q);
  constexpr int kVignette = Correction::kVignetteDim;
  const double variance = powers.dot(estimate.covariance.bottomRightCorner<kVignette, kVignette>() * powers);
  const double light = std::exp(estimate.correction.vignette().dot(powers));
  return {light, light * std::sqrt(variance)};
}

std::optional<CalibratedNumber> calibratedExposure(const OfflineResult& result) {
  const ExposureEstimate& estimate = result.exposure;
  if (!std::isfinite(estimate.log_sigma) || estimate.varies) return std::nullopt;
  const ExposureCorrection& known = result.exposure_correction;
  // Of exposures that came, a factor is used only if they are clearly wrong; a single image may lack one nevertheless.
  if (known.missing && known.factor == 1.0 && estimate.used) {
    const double found = kMilli * *known.missing;
    return CalibratedNumber{"exposure", "ms", 0.0, found, found * estimate.log_sigma};
  }
  const double factor = estimate.used ? known.factor : known.factor * estimate.ratio;
  return CalibratedNumber{"exposure over told", "", 1.0, factor, factor * estimate.log_sigma};
}

void printCalibration(const ToldCamera& told, const CalibrationStudy& study, std::ostream& out) {
  out << std::left << std::setw(24) << "" << std::right << std::setw(12) << "told" << std::setw(12) << "found"
      << std::setw(12) << "+-" << std::setw(14) << "significance"
      << "\n";
  for (const CalibratedNumber& n : allNumbers(told, study)) {
    const std::string name = n.name + (n.unit.empty() ? "" : " [" + n.unit + "]");
    out << std::left << std::setw(24) << name << std::right << std::setprecision(5) << std::setw(12) << n.told
        << std::setw(12) << n.found << std::setprecision(2) << std::setw(12) << n.sigma << std::setw(14)
        << n.significance() << "\n";
  }
  const CalibrationEstimate& estimate = study.estimate;
  out << "chi2 " << std::setprecision(4) << estimate.chi2({}) << " against what was told; " << estimate.windows
      << " windows; " << study.passes << " pass(es), "
      << (study.settled ? "the last changed hardly anything" : "the last still changed something") << "\n";
  if (study.last.exposure.varies) out << "exposures were not told, and vary: they are followed from image to image\n";
  if (!study.last.overlay.empty()) {
    out << "static overlay: " << kPercent * shareOf(study.last.overlay) << " % of the image, see mask.png\n";
  }
}

void writeCalibration(const std::string& folder, const ToldCamera& told, const CalibrationStudy& study) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder + ": cannot be made: " + error.message());
  const std::filesystem::path path(folder);
  const CalibrationCorrection correction = study.correction();
  const CorrectedCalibration camera = correctedCalibration(told.calibration, correction);
  const std::string camera_file = (path / "camera.yaml").string();
  writeFile(camera_file, [&](std::ostream& out) { writeCameraYaml(camera.calibration, "calibrated", out); });
  writeSensor((path / "sensor.yaml").string(), told, readCameraFile(camera_file).calibration, correction);
  writeFile((path / "calibration.yaml").string(),
            [&](std::ostream& out) { writeFigures(told, study, camera.error_px, out); });
  if (study.last.overlay.empty()) return;
  writePng(path / "mask.png", ~study.last.overlay);
}

}  // namespace mba_vo
