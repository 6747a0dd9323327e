#pragma once

#include <string>

#include "mba_vo/evaluation/evaluator.h"

namespace mba_vo {

/// One curve of a plot. The report must outlive the call.
struct PlottedEstimate {
  std::string name;  // in the legend
  const EvaluationReport* report = nullptr;
};

/// Draws aligned trajectories, the first in red and on top of a blue one, with the whole ground truth, seen from above
/// and from the side, equal scale on both axes; none is joined across dropped frames. Up is the axis of the
/// ground-truth frame closest to the camera's mean upward direction. The ending of `file`, .png or .svg, chooses the
/// format. Throws std::invalid_argument or std::runtime_error naming the file.
void plotTrajectories(const std::string& file, const std::vector<PoseRecord>& groundtruth,
                      const std::vector<PlottedEstimate>& estimates);
/// The same for a single one.
void plotTrajectory(const std::string& file, const std::vector<PoseRecord>& groundtruth,
                    const EvaluationReport& report);

/// Ticks at multiples of 1, 2 or 5 times a power of ten, about `count` of them, within [low, high].
std::vector<double> roundTicks(double low, double high, int count);

}  // namespace mba_vo
