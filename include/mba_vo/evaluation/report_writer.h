#pragma once

#include <ostream>

#include "mba_vo/evaluation/evaluator.h"

namespace mba_vo {

/// A table for people.
void writeTable(const EvaluationReport& report, std::ostream& out);
/// The same figures as YAML, with full precision; a figure that does not exist is .nan.
void writeYaml(const EvaluationReport& report, std::ostream& out);

}  // namespace mba_vo
