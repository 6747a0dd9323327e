#pragma once

#include <chrono>
#include <string>

#include "mapper_worker.h"

namespace mba_vo {

constexpr std::chrono::seconds kSaveTimeout(60);

/// Write what the mapper knows into `folder`, which is made if need be, and return what was written where. Throw
/// std::runtime_error if the mapper does not answer within `timeout`, there is nothing to write, or it cannot be
/// written.

/// trajectory.txt and exposure_trajectory.txt, after all frames that wait now.
std::string saveTrajectory(const std::string& folder, MapperWorker& worker,
                           std::chrono::seconds timeout = kSaveTimeout);
/// points.ply, of the present map.
std::string savePoints(const std::string& folder, MapperWorker& worker, std::chrono::seconds timeout = kSaveTimeout);

}  // namespace mba_vo
