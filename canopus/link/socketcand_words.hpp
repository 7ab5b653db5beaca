#pragma once
// The words of a socketcand element, for the server's and the client's side.

#include <string_view>

#include "canopus/ascii/words.hpp"

namespace canopus::link {

/// Ends of lines are blanks, too: some clients send them between elements.
[[nodiscard]] constexpr bool is_blank(char c) noexcept {
  return ascii::is_blank(c) || c == '\r' || c == '\n';
}

/// Takes the next word off the front of `text`; empty when there is none.
[[nodiscard]] inline std::string_view take_word(std::string_view& text) noexcept {
  return ascii::take_word(text, is_blank);
}

}  // namespace canopus::link
