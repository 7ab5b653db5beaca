#include "canopus/text/shortened.hpp"

#include <cstdint>

#include <fmt/format.h>

namespace canopus::text {

std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  constexpr std::size_t longest_character = 4;
  const auto continues = [&](std::size_t at) {
    return (static_cast<std::uint8_t>(text[at]) & 0xC0U) == 0x80;
  };
  std::size_t end = most;
  while (end > 0 && most - end < longest_character && continues(end)) --end;
  return fmt::format("{}... (cut, {} bytes in all)", text.substr(0, end), text.size());
}

}  // namespace canopus::text
