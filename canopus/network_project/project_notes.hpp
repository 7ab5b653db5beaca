#pragma once
// Notes of the nodes of a network, for which CiA 306 has no key: one small TOML file beside the list, nodelist.notes.toml of
// nodelist.cpj, changed at the requested place and nowhere else.
//
//   [notes]            # of the list's first network; [notes2] of its second one
//   5 = "seal is worn"

#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace canopus::network_project {

class ProjectNotes {
 public:
  static constexpr std::size_t longest = 4000;  ///< bytes of a note

  /// `text`: the file, any bytes; nothing: there is none. `network`: position in the list, from 0.
  ProjectNotes(std::optional<std::string> text, std::size_t network);

  /// For a file that exists but could not be opened; `reason` is the cause.
  [[nodiscard]] static ProjectNotes unreadable(std::string reason);

  /// Why the file cannot be read, and where; empty: it can. It has no notes then and is not changed.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
  [[nodiscard]] unsigned line() const noexcept { return line_; }  ///< from 1

  /// In UTF-8; empty: there is none.
  [[nodiscard]] std::string note(std::uint8_t node_id) const;
  /// Empty takes it out. Fails with a sentence, and changes nothing then.
  [[nodiscard]] std::expected<void, std::string> set(std::uint8_t node_id, std::string_view note);

  /// The file as it is now; nothing: there is none.
  [[nodiscard]] const std::optional<std::string>& text() const noexcept { return text_; }

 private:
  using Notes = std::map<std::uint8_t, std::string>;
  void read();

  std::optional<std::string> text_;
  std::string table_;  // its name
  Notes notes_{};
  std::string problem_{};
  unsigned line_ = 0;
};

/// "line1/nodelist.notes.toml" of "line1/nodelist.cpj".
[[nodiscard]] std::string notes_path(std::string_view list_path);

}  // namespace canopus::network_project
