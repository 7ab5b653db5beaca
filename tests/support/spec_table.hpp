#pragma once
// The tables of spec/<module>/*.csv as rows of named fields, for tests that walk every row of one. Numbers
// are written as spec/<module>/notes.md says: 0AH and FFFFH are hexadecimal, 10 is decimal.

#include <cctype>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "paths.hpp"

namespace canopus::scenario {

struct SpecRow {
  std::string place;  ///< "od.csv:17 Error register"
  std::map<std::string, std::string, std::less<>> fields;

  [[nodiscard]] const std::string& operator[](std::string_view name) const {
    const auto found = fields.find(name);
    if (found == fields.end()) {
      ADD_FAILURE() << place << ": no column " << name;
      static const std::string empty;
      return empty;
    }
    return found->second;
  }
  /// A decimal or, in another column, hexadecimal number.
  [[nodiscard]] unsigned number(std::string_view name, int base = 10) const {
    return static_cast<unsigned>(std::stoul((*this)[name], nullptr, base));
  }
};

/// Fields of one line; "a, ""b""" is one field: a, "b".
inline std::vector<std::string> split_csv(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

/// All rows of spec/<module>/<file>.
inline std::vector<SpecRow> spec_rows(const std::string& module, const std::string& file) {
  std::ifstream in(std::string(CANOPUS_SOURCE_DIR) + "/spec/" + module + "/" + file);
  EXPECT_TRUE(in) << file;
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = split_csv(line);
  std::vector<SpecRow> rows;
  for (unsigned number = 2; std::getline(in, line); ++number) {
    const std::vector<std::string> fields = split_csv(line);
    SpecRow row{.place = file + ":" + std::to_string(number), .fields = {}};
    EXPECT_EQ(fields.size(), names.size()) << row.place;
    for (std::size_t i = 0; i < fields.size() && i < names.size(); ++i) row.fields[names[i]] = fields[i];
    if (row.fields.contains("name")) row.place += " " + row.fields["name"];
    rows.push_back(std::move(row));
  }
  EXPECT_FALSE(rows.empty()) << file;
  return rows;
}

/// "0195H" and "0195h" = 0195H, "-60" = -60, "FEH (405)" = FEH; nothing when it does not begin with a number.
inline std::optional<std::int64_t> spec_number(std::string_view text) {
  const std::string word(text.substr(0, text.find(' ')));
  if (word.empty() || (std::isxdigit(static_cast<unsigned char>(word[0])) == 0 && word[0] != '-')) return {};
  const bool hex = word.back() == 'H' || word.back() == 'h';
  if (!hex && std::isxdigit(static_cast<unsigned char>(word[0])) != 0 &&
      std::isdigit(static_cast<unsigned char>(word[0])) == 0)
    return {};
  std::size_t used = 0;
  const std::int64_t value = std::stoll(word, &used, hex ? 16 : 10);
  if (used + (hex ? 1 : 0) != word.size()) return {};
  return value;
}

}  // namespace canopus::scenario
