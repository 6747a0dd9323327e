#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mba_vo/geometry/sim3.h"
#include "mba_vo/relocalization/keyframe_archive.h"
#include "mba_vo/tracking/map_point.h"

namespace mba_vo {

/// A map as it is kept from one run to the next: keyframes by which a camera can be found, and from any of which a
/// window can begin. Their poses are T_map_keyframe, in the frame and the unit of length of the map.
struct SavedMap {
  bool metric = false;                      // the unit of length is the metre
  double usual_error = 0.0;                 // that frames have in this map [px]
  std::vector<ArchivedKeyframe> keyframes;  // by id

  KeyframeId nextKeyframe() const { return keyframes.empty() ? 0 : keyframes.back().reference.id.keyframe_id + 1; }
  std::size_t pointCount() const;
};

/// Keyframes of a run that is over lie before any frame of the next one, whose clock may begin anew: the newest gets
/// this time of mid-exposure, each of the others stays as long before the next as it was, but for a minute at most:
/// runs lie years apart. Stamps stay.
inline constexpr std::int64_t kBeforeAnyRun = -3600'000'000'000;  // [ns]
void moveBeforeAnyRun(SavedMap& map);

/// Where a keyframe is by what was found out later, and how large what is relative to it: its depths and its motion.
void place(ArchivedKeyframe& keyframe, const Sim3& S_map_keyframe);

/// All S_map_keyframe in such a unit of length that the first one's own is the map's, about where that is.
void keepUnit(std::vector<Sim3>& poses);

/// Whether images of both can be of one camera, binned differently (image/binning.h): a run may change to smaller
/// images.
bool canBeOfOneCamera(const PinholeCamera& a, const PinholeCamera& b);

/// At most so many of its points, evenly chosen, for display. A point that several keyframes see comes several times.
std::vector<MapPoint> displayPoints(const SavedMap& saved, MapId map, std::size_t most);

}  // namespace mba_vo
