#pragma once

#include <ostream>

#include "mba_vo/evaluation/causal_report.h"

namespace mba_vo {

/// A table for people: first what was published when it was published, then the smoothed trajectory.
void writeRunTable(const RunReport& report, std::ostream& out);
/// The same figures as YAML under `causal` and `smoothed`, with full precision; a figure that does not exist is .nan.
void writeRunYaml(const RunReport& report, std::ostream& out);

}  // namespace mba_vo
