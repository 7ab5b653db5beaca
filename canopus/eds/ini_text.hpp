#pragma once
// An EDS, DCF or project file that is changed at the requested places and nowhere else: comments, unknown keys, the
// order, blanks, line ends and the encoding stay byte for byte.

#include <cstddef>
#include <expected>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/eds/encoding.hpp"

namespace canopus::eds {

/// Sections and keys are matched as by IniFile: case, blanks, underscores and hyphens do not matter. Of a key
/// that comes twice the first one counts, and is the one that is changed.
class IniText {
 public:
  /// Takes any bytes. Of a text that is not read (problem()) nothing is found, and nothing is changed.
  explicit IniText(std::string_view text);

  /// The file as it is now. Unchanged, these are the bytes it was made from.
  [[nodiscard]] std::string text() const;

  /// Why the text is not read: it is UTF-16 with damaged letters, or larger than largest_ini_text; empty: it is.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  /// A sentence about an encoding that is not plain UTF-8; empty: it is.
  [[nodiscard]] std::string encoding_note() const;

  /// The value, without blanks around it, in UTF-8; empty when the key has none. Nothing: no such key.
  [[nodiscard]] std::optional<std::string> value(std::string_view section, std::string_view key) const;
  /// Its line, from 1; 0: no such key.
  [[nodiscard]] unsigned line(std::string_view section, std::string_view key) const;
  [[nodiscard]] bool has_section(std::string_view section) const;
  /// The line of its first bracket, from 1; 0: no such section.
  [[nodiscard]] unsigned section_line(std::string_view section) const;
  /// All sections, folded (words.hpp), in the order of the file, each once.
  [[nodiscard]] const std::vector<std::string>& sections() const noexcept { return section_names_; }
  /// The keys of a section, folded, in the order of the file, each once.
  [[nodiscard]] std::vector<std::string> keys(std::string_view section) const;

  /// Gives a key this value: one line differs afterwards, or none when it had it. A comment behind a number
  /// stays when the new value is a number. A key that is not there is added as the section's last one, a
  /// section that is not there at the end of the file; both are then written as given here. Refused, with the
  /// reason and without any change: a value or name that would not be read again as it was given, text that the
  /// file's encoding cannot represent, and a text that is not read.
  [[nodiscard]] std::expected<void, std::string> set(std::string_view section, std::string_view key,
                                                     std::string_view value);
  /// Takes the lines of a key out; no such key: nothing happens.
  [[nodiscard]] std::expected<void, std::string> remove(std::string_view section, std::string_view key);

 private:
  struct Section {
    std::size_t header = 0;                                 // its first line, from 0
    std::size_t last = 0;                                   // the last line that counts
    std::map<std::string, std::size_t, std::less<>> lines;  // by folded key, from 0
  };
  struct Span {  // of a value in its line
    std::size_t begin = 0;
    std::size_t end = 0;
  };

  /// The bytes of the file alone say in which encoding it is.
  [[nodiscard]] bool is_guessed() const noexcept { return encoding_ ? encoding_->is_guess : !is_utf8_; }
  /// Becomes the changed text, unless that would be read in another encoding.
  [[nodiscard]] std::expected<void, std::string> accept(IniText changed);
  [[nodiscard]] std::expected<void, std::string> set_value(std::string_view section, std::string_view key,
                                                           std::string_view value);
  [[nodiscard]] std::expected<void, std::string> remove_lines(std::string_view section, std::string_view key);
  void read_places();
  /// The file as UTF-8, or in Windows Latin where it is that.
  [[nodiscard]] std::string decoded_text() const;
  [[nodiscard]] const std::size_t* find(std::string_view section, std::string_view key) const;
  [[nodiscard]] static Span value_span(std::string_view line) noexcept;
  [[nodiscard]] std::string_view line_end() const noexcept;
  /// Ends a line that has no end; false: it had one.
  bool give_end(std::string& line) const;
  [[nodiscard]] std::expected<std::string, std::string> encoded(std::string_view value) const;
  void insert(std::size_t position, std::string line);
  void append_section(std::string_view name, std::string first_line);

  std::string mark_;                // UTF-8 byte order mark, or nothing
  std::vector<std::string> lines_;  // each with its end
  std::string tail_;                // a DOS end of file and what is behind it
  char end_character_ = '\n';       // what ends a line, perhaps behind a carriage return
  std::string problem_;
  std::optional<Encoding>
      encoding_;  // of the file, whose lines are UTF-8 here; none: they are the file's bytes
  bool is_utf8_ = true;
  std::map<std::string, Section, std::less<>> sections_;  // by folded name
  std::vector<std::string> section_names_;
};

}  // namespace canopus::eds
