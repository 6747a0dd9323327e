#pragma once

#include "mba_vo/image/frame_builder.h"

namespace mba_vo {

/// Reads the files that tell about the pixels of a camera; an empty name means none. In the form of the TUM monoVO data
/// set: `response_file` (pcalib.txt): 256 values, grey level -> irradiance; `vignette_file`: 8- or 16-bit grey image,
/// attenuation relative to its brightest pixel. `mask_file`: 8-bit image. Throws std::runtime_error naming the file and
/// what is wrong.
PhotometricCalibration loadPhotometricCalibration(const FrameBuilderConfig& config);

}  // namespace mba_vo
