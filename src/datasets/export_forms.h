#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mba_vo/datasets/sequence_export.h"
#include "mba_vo/image/photometric_correction.h"

namespace mba_vo {

/// All that the lists of an exported sequence tell.
struct ExportContent {
  CameraCalibration calibration;
  double gamma = 1.0;  // where there is no response
  PhotometricCalibration photometric;
  std::vector<ExportedFrame> frames;  // not empty
  std::vector<PoseRecord> truth;

  double rate() const;  // [Hz]
};

/// One form; its files are in a folder of its name.
struct ExportForm {
  const char* name;
  void (*requireLens)(const CameraCalibration& calibration);  // throws std::invalid_argument
  std::string (*image)(const ExportedFrame& frame, std::size_t index);
  std::string (*depth)(const ExportedFrame& frame);  // nullptr: it has none
  std::vector<const char*> (*folders)();             // all that it makes
  void (*writeLists)(const std::filesystem::path& folder, const ExportContent& content);
};

const std::vector<ExportForm>& allExportForms();

/// Lines of one image each: stamp, exposure, light, saturated part, texture.
void writeFrameSheet(const std::vector<ExportedFrame>& frames, std::ostream& out);

}  // namespace mba_vo
