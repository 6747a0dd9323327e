#pragma once

#include <ostream>
#include <vector>

#include "mba_vo/io/run_log.h"

namespace mba_vo {

/// frames.csv: one row per input image.
void writeFrames(const std::vector<FrameRecord>& frames, std::ostream& out);

/// Its first line, and one of the others.
void writeFramesHeader(std::ostream& out);
void writeFrame(const FrameRecord& frame, std::ostream& out);

}  // namespace mba_vo
