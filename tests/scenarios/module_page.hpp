#pragma once
// A module's page (docs/modules/<module>.md) against its tables: a line for every row of the buffer table, and none
// besides.

#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/module/memory/buffer_memory.hpp"

#include "paths.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario {

/// Cells of the page's tables, line by line: "| a | b |" is {"a", "b"}.
inline std::vector<std::vector<std::string>> page_lines(const std::string& page) {
  std::ifstream in(std::string(CANOPUS_SOURCE_DIR) + "/docs/modules/" + page);
  EXPECT_TRUE(in) << page;
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("| ")) continue;
    std::vector<std::string> cells;
    for (std::size_t at = 1; at < line.size();) {
      const std::size_t end = line.find(" |", at);
      if (end == std::string::npos) break;
      cells.push_back(line.substr(at + 1, end > at ? end - at - 1 : 0));
      at = end + 2;
    }
    lines.push_back(std::move(cells));
  }
  return lines;
}

/// Range, access, default, whether it is saved, modes of every row. `mode_text` names the modes of a row as the page does;
/// empty: the row is said in words. `prefix` stands before an address.
template <typename ModeText>
void expect_page_has_rows(const std::string& page, std::span<const module::BufferRow> table,
                          ModeText mode_text, const std::string& prefix = "G") {
  std::multimap<std::string, std::vector<std::string>> lines;  // by "first-last modes"
  for (const auto& cells : page_lines(page)) {
    if (cells.size() == 7 && cells[0].starts_with(prefix)) lines.emplace(cells[0] + ' ' + cells[6], cells);
  }
  for (const module::BufferRow& row : table) {
    const std::string mode = mode_text(row);
    if (mode.empty()) continue;
    std::string key = prefix + std::to_string(row.first);
    if (row.first != row.last) key += "-" + prefix + std::to_string(row.last);
    key += ' ' + mode;
    const auto line = lines.find(key);
    ASSERT_NE(line, lines.end()) << key;
    const std::vector<std::string>& cells = line->second;
    const bool writes = row.access != module::WordAccess::read;
    EXPECT_EQ(cells[2], writes ? row.offline_only ? "R/W offline" : "R/W" : "R") << key;
    EXPECT_EQ(spec_number(cells[3]), row.initial) << key;
    EXPECT_EQ(cells[5], row.stored == module::Stored::yes ? "yes" : "no") << key;
    using Kind = module::ValueRange::Kind;
    if (row.range.kind == Kind::between || row.range.kind == Kind::between_signed) {
      EXPECT_EQ(cells[4], row.range.low == row.range.high
                              ? std::to_string(row.range.low)
                              : std::to_string(row.range.low) + (row.range.low < 0 ? " to " : "-") +
                                    std::to_string(row.range.high))
          << key;
    }
    lines.erase(line);
  }
  for (const auto& [key, cells] : lines) ADD_FAILURE() << "no such row: " << key;
}

}  // namespace canopus::scenario
