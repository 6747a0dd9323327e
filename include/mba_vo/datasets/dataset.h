#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/io/sequence.h"

namespace mba_vo {

struct DatasetOptions {
  std::string images = "images";  // sub-folder with the images, of a sequence folder
  DepthFolder depth;              // of a sequence folder, TUM RGB-D or ETH3D
  std::string calibration_file;   // in place of the recording's own; empty = that
  std::string camera;             // of several (cam0, cam1, ...), of a folder or a calibration; empty = cam0
};

/// A recording, and what its form tells of the camera beside the calibration.
struct Dataset {
  std::unique_ptr<SequenceReader> reader;
  std::string form;
  std::string response_file;       // pcalib.txt; empty = none
  std::string vignette_file;       // empty = none
  std::vector<std::string> notes;  // shutter, exposure, what was assumed: to be told to the user

  /// Where the configuration names no response (or gamma) or no vignette, it gets those of the recording.
  void configure(FrameBuilderConfig& config) const;
};

/// Whether openDataset takes it for a sequence folder or TUM-mono, which is one, whatever is wrong with it. Throws
/// std::runtime_error if there is no such folder.
bool isSequenceFolder(const std::string& folder, const std::string& images);

/// Opens the folder of a recording; of which form it is shows when one looks at it:
///   - sequence folder of this project, and TUM-mono (images, times.txt and a camera file);
///   - TUM RGB-D (rgb.txt; calibration by the name: fr1, fr2, fr3) and ETH3D SLAM (rgb.txt, calibration.txt);
///   - ASL: EuRoC and TUM-VI (mav0/cam0, or that folder itself);
///   - 7-Scenes (frame-000000.color.png, ...).
/// Stamps are taken for mid-exposure. Never reads ground truth. Throws std::runtime_error naming file and line of what
/// is missing or wrong.
Dataset openDataset(const std::string& folder, const DatasetOptions& options = {});

}  // namespace mba_vo
