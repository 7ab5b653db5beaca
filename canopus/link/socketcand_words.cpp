#include "canopus/link/socketcand_words.hpp"

#include <span>

#include "canopus/ascii/number.hpp"

namespace canopus::link {

using ascii::parse_number;

std::expected<CanIdentifier, Expected> take_identifier(std::string_view& words) {
  const std::string_view word = next_word(words);
  const auto number = parse_number<std::uint32_t>(word, 16);
  constexpr std::size_t digits_of_extended = 8;
  if (!number || word.size() > digits_of_extended)
    return std::unexpected("expected an identifier of 1 to 8 hexadecimal digits");
  const bool extended = word.size() == digits_of_extended;
  if (*number > (extended ? can::max_extended_identifier : can::max_base_identifier))
    return std::unexpected("expected an identifier up to 7FF, or of 8 digits up to 1FFFFFFF");
  return CanIdentifier{*number, extended};
}

std::expected<can::Duration, Expected> take_interval(std::string_view& words) {
  constexpr std::uint32_t most_seconds = 1'000'000'000;
  const auto seconds = parse_number<std::uint32_t>(next_word(words));
  const auto microseconds = parse_number<std::uint32_t>(next_word(words));
  if (!seconds || !microseconds || *seconds > most_seconds)
    return std::unexpected("expected seconds and microseconds");
  return std::chrono::seconds(*seconds) + std::chrono::microseconds(*microseconds);
}

std::expected<BroadcastManager::Content, Expected> take_content(std::string_view& words, std::size_t bytes) {
  BroadcastManager::Content content = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    const auto value = parse_number<std::uint8_t>(next_word(words), 16);
    if (!value) return std::unexpected("expected as many bytes as the length says, 0 to FF");
    content |= BroadcastManager::Content{*value} << (8 * i);
  }
  return content;
}

std::expected<can::Frame, Expected> read_frame_words(std::string_view words, bool remote) {
  const auto identifier = take_identifier(words);
  if (!identifier) return std::unexpected(identifier.error());
  can::Frame frame{.identifier = identifier->number, .extended = identifier->extended, .remote = remote};
  const auto length = parse_number<std::uint8_t>(next_word(words));
  if (!length || *length > most_data) return std::unexpected("expected a length of 0 to 8");
  frame.dlc = *length;
  const auto content = take_content(words, frame.length());
  if (!content) return std::unexpected(content.error());
  for (std::size_t i = 0; i < frame.length(); ++i)
    frame.data[i] = static_cast<std::uint8_t>(*content >> (8 * i));
  if (!next_word(words).empty()) return std::unexpected("expected no more bytes than the length says");
  return frame;
}

}  // namespace canopus::link
