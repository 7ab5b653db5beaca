#pragma once
// The live table as text, for tests.

#include <string>
#include <vector>

#include "canopus/cli/run/live_table.hpp"
#include "canopus/cli/run/table_layout.hpp"

namespace canopus::cli {

inline std::vector<std::string> texts(const TablePicture& picture) {
  std::vector<std::string> lines;
  for (const TableLine& line : picture.lines) {
    std::string text = text_of(line);
    text.erase(text.find_last_not_of(' ') + 1);
    lines.push_back(std::move(text));
  }
  return lines;
}

inline std::string text_of(const TablePicture& picture) {
  std::string all;
  for (const std::string& line : texts(picture)) all += line + "\n";
  return all;
}

/// What the table shows of a plant.
inline std::string shown(LiveTable& table, can::Time now, TableSize size, TableView view = {}) {
  return text_of(lay_out(table.state(now, {}), view, size));
}

}  // namespace canopus::cli
