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

/// The map in which `worker` goes on, to be used again; `name`: absolute, relative to `folder`, or empty: map.mba_vo.
std::string saveMap(const std::string& folder, const std::string& name, MapperWorker& worker,
                    std::chrono::seconds timeout = kSaveTimeout);
/// Lets `worker` begin anew in a map that was saved so. Throws if it cannot be read; what there is then goes on.
std::string loadMap(const std::string& folder, const std::string& name, MapperWorker& worker);

}  // namespace mba_vo
