#pragma once
// The file of the page's users, one a line: name, role, and hash of the password, with spaces or tabs between. Lines that are
// empty or begin with '#' are for people.
//
//   # shift leader
//   anna  operate  $y$j9T$eoxdHNUvDBmB4WZu4OzWQ1$6b8p...

#include <cstddef>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/web/access/user.hpp"

namespace canopus::web {

struct WebAccount {
  std::string name{};
  WebRole role = WebRole::look;
  std::string hash{};
  std::size_t line = 0;  ///< in the file, from 1
};

inline constexpr std::size_t longest_users_file = 256 * 1024;  ///< bytes
inline constexpr std::size_t most_users = 1000;

/// 1 to 32 letters, digits and `. _ - @` of ASCII, a letter or digit first.
[[nodiscard]] bool is_user_name(std::string_view text) noexcept;
/// "look", "operate", "configure"; the error names what was expected.
[[nodiscard]] std::expected<WebRole, std::string> parse_web_role(std::string_view text);

/// The errors begin with `file`, and the line where one is wrong.
[[nodiscard]] std::expected<std::vector<WebAccount>, std::string> parse_web_users(std::string_view text,
                                                                                  const std::string& file);
/// The text of a regular file that nobody but its owner (who runs the program, or root) can write, and only his group can read.
[[nodiscard]] std::expected<std::string, std::string> read_web_users_text(const std::string& file);
/// Both.
[[nodiscard]] std::expected<std::vector<WebAccount>, std::string> read_web_users(const std::string& file);

}  // namespace canopus::web
