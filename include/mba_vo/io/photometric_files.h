#pragma once

#include <string>

#include "mba_vo/image/photometric_correction.h"

namespace mba_vo {

/// Reads a photometric calibration in the form of the TUM monoVO data set; an empty name means none.
/// `response_file` (pcalib.txt): 256 values, grey level -> irradiance. `vignette_file`: 8- or 16-bit grey image,
/// attenuation relative to its brightest pixel. Throws std::runtime_error naming the file and what is wrong.
PhotometricCalibration loadPhotometricCalibration(const std::string& response_file, const std::string& vignette_file);

}  // namespace mba_vo
