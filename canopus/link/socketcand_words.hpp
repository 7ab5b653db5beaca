#pragma once
// The words of a socketcand element, for the server's and the client's side.

#include <cstdint>
#include <expected>
#include <string_view>

#include "canopus/ascii/words.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/link/broadcast_manager.hpp"

namespace canopus::link {

/// Ends of lines are blanks, too: some clients send them between elements.
[[nodiscard]] constexpr bool is_blank(char c) noexcept {
  return ascii::is_blank(c) || c == '\r' || c == '\n';
}

/// Takes the next word off the front of `text`; empty when there is none.
[[nodiscard]] inline std::string_view next_word(std::string_view& text) noexcept {
  return ascii::next_word(text, is_blank);
}

inline constexpr std::size_t most_data = 8;  ///< bytes of a frame

/// What was expected in place of words.
using Expected = std::string_view;

/// Takes an identifier off the front: 1 to 8 hexadecimal digits, 8 of an extended one.
[[nodiscard]] std::expected<CanIdentifier, Expected> take_identifier(std::string_view& words);
/// Takes seconds and microseconds off the front: "1 500000".
[[nodiscard]] std::expected<can::Duration, Expected> take_interval(std::string_view& words);
/// Takes data bytes off the front, the first into bits 0 to 7.
[[nodiscard]] std::expected<BroadcastManager::Content, Expected> take_content(std::string_view& words,
                                                                              std::size_t bytes);
/// A frame and nothing behind it: "123 2 11 22"; of a remote one its length alone: "123 2".
[[nodiscard]] std::expected<can::Frame, Expected> read_frame_words(std::string_view words, bool remote);

}  // namespace canopus::link
