#pragma once

#include <cstddef>
#include <memory>

#include "mba_vo/relocalization/keyframe_archive.h"

namespace mba_vo {

using ArchivedKeyframeConstPtr = std::shared_ptr<const ArchivedKeyframe>;

/// A keyframe as loops need it: its image at most 400 px wide, which is enough to align it and takes a quarter of the
/// memory and of the time.
ArchivedKeyframeConstPtr archiveForLoops(const Reference& reference, const Frame& frame);
/// The same of one that the relocaliser has.
ArchivedKeyframeConstPtr archiveForLoops(const ArchivedKeyframe& keyframe);

/// What it takes in memory.
std::size_t bytesOf(const ArchivedKeyframe& keyframe);

}  // namespace mba_vo
