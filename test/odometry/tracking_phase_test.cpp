#include "mba_vo/odometry/tracking_phase.h"

#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace mba_vo {
namespace {

constexpr TrackingPhase kPhases[] = {TrackingPhase::kNoMap,    TrackingPhase::kCatchingUp, TrackingPhase::kTracking,
                                     TrackingPhase::kRevising, TrackingPhase::kGoingBack,  TrackingPhase::kLost};
constexpr PhaseEvent kEvents[] = {PhaseEvent::kMapBegins,    PhaseEvent::kMapClosed, PhaseEvent::kKeyframe,
                                  PhaseEvent::kRevise,       PhaseEvent::kGoBack,    PhaseEvent::kImageWaits,
                                  PhaseEvent::kNothingWaits, PhaseEvent::kGoOn,      PhaseEvent::kFrameTracked,
                                  PhaseEvent::kFrameLost,    PhaseEvent::kReset};

TEST(TrackingPhase, WhatIsNotInTheTableCannotHappen) {
  std::set<std::pair<TrackingPhase, PhaseEvent>> rows;
  for (const PhaseTransition& row : phaseTransitions()) {
    EXPECT_TRUE(rows.insert({row.from, row.event}).second) << toString(row.from) << ", " << toString(row.event);
    EXPECT_EQ(nextPhase(row.from, row.event), row.to);
  }
  for (const TrackingPhase phase : kPhases) {
    for (const PhaseEvent event : kEvents) {
      if (rows.count({phase, event}) > 0) continue;
      EXPECT_THROW(nextPhase(phase, event), std::logic_error);
    }
  }
}

TEST(TrackingPhase, EveryPhaseCanBeReachedAndLeft) {
  std::set<TrackingPhase> reached = {TrackingPhase::kNoMap};
  for (std::size_t before = 0; before != reached.size();) {
    before = reached.size();
    for (const PhaseTransition& row : phaseTransitions()) {
      if (reached.count(row.from) > 0) reached.insert(row.to);
    }
  }
  EXPECT_EQ(reached.size(), std::size(kPhases));
  for (const TrackingPhase phase : kPhases) {
    EXPECT_EQ(nextPhase(phase, PhaseEvent::kReset), TrackingPhase::kNoMap);
    if (phase == TrackingPhase::kNoMap) continue;
    EXPECT_EQ(nextPhase(phase, PhaseEvent::kMapClosed), TrackingPhase::kNoMap);
  }
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// The cells of the rows of the table that begins with that header.
std::vector<std::vector<std::string>> tableIn(const std::string& file, const std::string& header) {
  std::ifstream stream(file);
  std::vector<std::vector<std::string>> rows;
  bool inside = false;
  for (std::string line; std::getline(stream, line);) {
    if (line == header) {
      inside = true;
      std::getline(stream, line);  // the rule
      continue;
    }
    inside = inside && !line.empty();
    if (!inside) continue;
    std::istringstream cells(line.substr(1));
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, '|');) rows.back().push_back(trimmed(cell));
  }
  return rows;
}

TEST(TrackingPhase, TheDocumentationShowsTheSameTable) {
  const auto rows = tableIn(std::string(MBA_VO_SOURCE_DIR) + "/docs/how_it_works.md", "| phase | event → next phase |");
  std::set<std::vector<std::string>> documented;
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), 2U);
    std::istringstream transitions(row[1]);
    for (std::string one; std::getline(transitions, one, ';');) {
      const auto arrow = one.find("→");
      ASSERT_NE(arrow, std::string::npos) << one;
      documented.insert({row[0], trimmed(one.substr(0, arrow)), trimmed(one.substr(arrow + std::string("→").size()))});
    }
  }
  std::set<std::vector<std::string>> built;
  for (const PhaseTransition& row : phaseTransitions()) {
    built.insert({toString(row.from), toString(row.event), toString(row.to)});
  }
  EXPECT_EQ(documented, built);
}

}  // namespace
}  // namespace mba_vo
