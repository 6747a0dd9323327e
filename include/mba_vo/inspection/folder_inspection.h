#pragma once

#include <functional>
#include <memory>
#include <string>

#include "mba_vo/inspection/inspection_report.h"
#include "mba_vo/io/sequence.h"

namespace mba_vo {

/// Called with how many of how many images have been looked at.
using InspectionProgress = std::function<void(std::size_t, std::size_t)>;

/// Looks at all of a sequence folder (camera.yaml, times.txt, <images>/*), and goes on after what is wrong. What cannot
/// be read at all is told in the report.
InspectionReport inspectFolder(const std::string& folder, const std::string& images_subfolder,
                               const InspectionProgress& progress);

}  // namespace mba_vo
