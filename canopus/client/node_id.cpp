#include "canopus/client/node_id.hpp"

#include <charconv>

namespace canopus::client {

unsigned parse_node(std::string_view text) noexcept {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  unsigned node = 0;
  const auto [end, failure] =
      std::from_chars(text.data(), text.data() + text.size(), node, hexadecimal ? 16 : 10);
  return failure == std::errc{} && end == text.data() + text.size() && node <= 127 ? node : 0;
}

}  // namespace canopus::client
