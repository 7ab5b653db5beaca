#pragma once
// The text of an EDS as sections, keys and values with their line numbers.

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/eds/problems.hpp"

namespace canopus::eds {

/// Most bytes of a text of sections and keys, to bound memory; the largest known has 0.2 MB.
constexpr std::size_t largest_ini_text = std::size_t{4} << 20;
/// Why a text of this size is refused; empty: it is not.
[[nodiscard]] std::string size_problem(std::size_t bytes, std::size_t most);

/// Key=value.
struct Item {
  std::string folded_key;  ///< words.hpp
  std::string key;         ///< as written
  std::string value;       ///< as written, without blanks around it; may be empty
  unsigned line = 0;
  unsigned column = 0;  ///< of the value
};

struct Section {
  std::string folded_name;
  std::string name;  ///< as written
  unsigned line = 0;
  std::vector<Item> items;  ///< in the order of the file, each key once

  /// The key (folded), or nullptr. An empty value counts as found.
  [[nodiscard]] const Item* find(std::string_view folded_key) const noexcept;
  /// The same, or nullptr when it is there but has no value.
  [[nodiscard]] const Item* find_value(std::string_view folded_key) const noexcept;
};

class IniFile {
 public:
  /// Takes any bytes; of too many it has no section. Where a section comes twice, the later one adds keys; of a
  /// key that comes twice in a section, the first one counts.
  IniFile(std::string_view text, Problems& problems);
  /// From sections of another source; no two have the same folded name.
  explicit IniFile(std::vector<Section> sections);

  [[nodiscard]] const std::vector<Section>& sections() const noexcept { return sections_; }
  /// The section (folded), or nullptr.
  [[nodiscard]] const Section* find(std::string_view folded_name) const noexcept;
  /// The section of this name or of a misspelling of it that is no other section's name; warns of the latter.
  [[nodiscard]] const Section* find_or_misspelt(std::string_view folded_name, std::string_view shown,
                                                Problems& problems) const;
  /// Lines that are neither section, key nor comment; and the first of them.
  [[nodiscard]] std::size_t strange_lines() const noexcept { return strange_lines_; }
  [[nodiscard]] unsigned first_strange_line() const noexcept { return first_strange_line_; }
  [[nodiscard]] unsigned line_count() const noexcept { return line_count_; }

 private:
  void read_line(std::string_view line, unsigned number, Problems& problems);
  void begin_section(std::string_view line, unsigned number, Problems& problems);
  void add_item(std::string_view line, std::size_t equals, unsigned number, Problems& problems);
  /// The item of the current section that has this key already, or nullptr.
  [[nodiscard]] const Item* known_item(const Section& section, std::string_view folded_key);

  std::vector<Section> sections_;
  std::map<std::string, std::size_t, std::less<>> section_numbers_;
  std::size_t current_ = 0;  // number of the section that is being read, + 1
  std::map<std::string, std::size_t, std::less<>> item_numbers_;  // of that section, once it has many
  bool has_bytes_to_skip_ = false;                                // zero bytes, or a DOS end of file
  std::size_t strange_lines_ = 0;
  unsigned first_strange_line_ = 1;
  unsigned line_count_ = 0;
};

}  // namespace canopus::eds
