#pragma once

#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "mba_vo/mapping/phase_table.h"

namespace mba_vo::test {

/// Each row holds, once, and nothing else can happen.
template <typename Phase, typename Event>
void expectNothingElse(const PhaseTable<Phase, Event>& table, const std::set<Phase>& phases,
                       const std::set<Event>& events) {
  std::set<std::pair<Phase, Event>> rows;
  for (const auto& row : table) {
    EXPECT_TRUE(rows.insert({row.from, row.event}).second) << toString(row.from) << ", " << toString(row.event);
    EXPECT_EQ(nextPhase(table, row.from, row.event), row.to);
  }
  for (const Phase phase : phases) {
    for (const Event event : events) {
      if (rows.count({phase, event}) > 0) continue;
      EXPECT_THROW(nextPhase(table, phase, event), std::logic_error);
    }
  }
}

template <typename Phase, typename Event>
std::set<Phase> reachableFrom(const PhaseTable<Phase, Event>& table, Phase first) {
  std::set<Phase> reached = {first};
  for (std::size_t before = 0; before != reached.size();) {
    before = reached.size();
    for (const auto& row : table) {
      if (reached.count(row.from) > 0) reached.insert(row.to);
    }
  }
  return reached;
}

inline std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// The cells of the rows of the table that begins with that header.
inline std::vector<std::vector<std::string>> tableIn(const std::string& file, const std::string& header) {
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

/// The table in docs/how_it_works.md that begins with that header has the same rows.
template <typename Phase, typename Event>
void expectDocumented(const PhaseTable<Phase, Event>& table, const std::string& header) {
  std::set<std::vector<std::string>> documented;
  for (const auto& row : tableIn(std::string(MBA_VO_SOURCE_DIR) + "/docs/how_it_works.md", header)) {
    ASSERT_EQ(row.size(), 2U);
    std::istringstream transitions(row[1]);
    for (std::string one; std::getline(transitions, one, ';');) {
      const auto arrow = one.find("→");
      ASSERT_NE(arrow, std::string::npos) << one;
      documented.insert({row[0], trimmed(one.substr(0, arrow)), trimmed(one.substr(arrow + std::string("→").size()))});
    }
  }
  std::set<std::vector<std::string>> built;
  for (const auto& row : table) built.insert({toString(row.from), toString(row.event), toString(row.to)});
  EXPECT_EQ(documented, built);
}

}  // namespace mba_vo::test
