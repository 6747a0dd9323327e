#pragma once

#include <functional>
#include <memory>
#include <string>

#include "mba_vo/datasets/dataset.h"
#include "mba_vo/inspection/inspection_report.h"

namespace mba_vo {

/// Called with how many of how many images have been looked at.
using InspectionProgress = std::function<void(std::size_t, std::size_t)>;

/// Looks at all of a recording in a folder of any form that openDataset knows. In a sequence folder (a camera file,
/// times.txt, <images>/*) it goes on after what is wrong; of other forms the first file that is missing or malformed is
/// told. What cannot be read at all is told in the report, too.
InspectionReport inspectFolder(const std::string& folder, const DatasetOptions& options,
                               const InspectionProgress& progress);

}  // namespace mba_vo
