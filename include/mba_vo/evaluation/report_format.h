#pragma once

#include <cstddef>
#include <ostream>
#include <string>

#include "mba_vo/evaluation/alignment.h"
#include "mba_vo/evaluation/statistics.h"

namespace mba_vo {

/// "-" if not finite.
std::string fixedText(double value, int decimals);
/// 0 of nothing.
double percent(std::size_t part, std::size_t whole);
const char* toString(AlignmentMode mode);

/// Names of the columns that writeStatisticsRow fills.
void writeStatisticsHeader(std::ostream& out);
void writeStatisticsRow(std::ostream& out, const std::string& name, const Statistics& statistics, int decimals);

/// With full precision; .nan if not finite.
std::string yamlNumber(double value);
void writeYamlStatistics(std::ostream& out, const std::string& indent, const std::string& name,
                         const Statistics& statistics);

}  // namespace mba_vo
