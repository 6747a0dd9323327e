#pragma once

#include <memory>
#include <string>

#include "mba_vo/capture/recording.h"

namespace mba_vo {

/// A video that FFmpeg can read. `rate` [Hz]: 0 = its own times. Throws CameraError.
std::unique_ptr<Recording> openVideoFile(const std::string& file, double rate);

}  // namespace mba_vo
