#pragma once

#include <string>

#include "mba_vo/relocalization/saved_map.h"

namespace mba_vo {

/// A map in one file: a head with the version and a checksum, then the keyframes, their images compressed without loss.
/// The file is whole at any time: it is written beside its place and then moved there. Poses are T_map_keyframe, as in
/// SavedMap; times of mid-exposure are those of moveBeforeAnyRun.
/// Throws std::runtime_error naming the file, and why, if it cannot be written or the map has no keyframe.
void writeMap(const std::string& file, SavedMap map);

/// At least one keyframe, all of one camera, binned or not. Throws std::runtime_error naming the file and what is
/// wrong: it cannot be read, is no map, is of a later version, is cut off or damaged.
SavedMap readMap(const std::string& file);

}  // namespace mba_vo
