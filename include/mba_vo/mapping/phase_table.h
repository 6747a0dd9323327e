#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace mba_vo {

/// A row of the table of a state machine: what an event makes of a phase. Phases and events are enumerations with a
/// toString of their own.
template <typename Phase, typename Event>
struct PhaseRow {
  Phase from;
  Event event;
  Phase to;
};

/// All transitions; what is not among them cannot happen.
template <typename Phase, typename Event>
using PhaseTable = std::vector<PhaseRow<Phase, Event>>;

/// Throws std::logic_error naming phase and event if there is no such transition.
template <typename Phase, typename Event>
Phase nextPhase(const PhaseTable<Phase, Event>& table, Phase phase, Event event) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const auto& row) { return row.from == phase && row.event == event; });
  if (found == table.end()) {
    throw std::logic_error(std::string("phase '") + toString(phase) + "': '" + toString(event) + "' cannot happen");
  }
  return found->to;
}

}  // namespace mba_vo
