#pragma once
// The rows of spec/me3can1-q/errors.csv.

#include <functional>
#include <set>

#include "scenarios/me3can1_q/scenario.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario {

inline std::vector<SpecRow> rows_of(const std::string& kind, std::size_t expected) {
  std::vector<SpecRow> rows;
  for (SpecRow& row : spec_rows("me3can1-q", "errors.csv")) {
    if (row["kind"] == kind) rows.push_back(std::move(row));
  }
  EXPECT_EQ(rows.size(), expected) << kind;
  return rows;
}

}  // namespace canopus::scenario
