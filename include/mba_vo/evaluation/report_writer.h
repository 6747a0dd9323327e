#pragma once

#include <ostream>
#include <string>

#include "mba_vo/evaluation/evaluator.h"

namespace mba_vo {

/// A table for people.
void writeTable(const EvaluationReport& report, std::ostream& out);
/// The same figures as YAML, with full precision; a figure that does not exist is .nan. `indent` goes before each line.
void writeYaml(const EvaluationReport& report, std::ostream& out, const std::string& indent = "");

}  // namespace mba_vo
