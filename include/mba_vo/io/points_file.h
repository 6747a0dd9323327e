#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "mba_vo/mapping/local_map.h"

namespace mba_vo {

/// `t_keyframe x y z`: mid-exposure time of the keyframe in which the point was found [s], and its place in the map. A
/// comment `# map N` stands before the first point and wherever the map changes.
void writePoints(const std::vector<MapPoint>& points, std::ostream& out);

/// The same as a point cloud in PLY form (text), grey by intensity, with the keyframe of each point.
void writePointsPly(const std::vector<MapPoint>& points, std::ostream& out);

/// Reads what writePoints wrote, without intensities and keyframe numbers. Throws std::runtime_error naming the file,
/// and the line if one is malformed.
std::vector<MapPoint> readPoints(const std::string& file);

}  // namespace mba_vo
