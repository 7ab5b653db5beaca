#include "canopus/text/base64.hpp"

namespace canopus::text {

std::string to_base64(std::span<const std::uint8_t> bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j) bits = bits << 8 | (i + j < bytes.size() ? bytes[i + j] : 0U);
    for (unsigned j = 0; j < 4; ++j) {
      const bool is_there = i + j <= bytes.size();
      text += is_there ? base64_digits[bits >> (18 - 6 * j) & 0x3FU] : '=';
    }
  }
  return text;
}

}  // namespace canopus::text
