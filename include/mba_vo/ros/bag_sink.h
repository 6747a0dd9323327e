#pragma once

#include <memory>
#include <string>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/simulation/sequence_sink.h"

namespace mba_vo {

/// Writes a simulated sequence as a bag, stamped at mid-exposure: the topics of BagImageWriter and, below /groundtruth,
/// `pose` (geometry_msgs/PoseStamped, camera to world at mid-exposure, optical frame), `exposure_motion`
/// (mba_vo/ExposureMotion), and `image_sharp` and `depth` if the frames carry them.
/// Throws std::runtime_error naming the file if it cannot be written.
std::unique_ptr<SequenceSink> makeBagSink(const std::string& file, const CameraCalibration& calibration);

}  // namespace mba_vo
