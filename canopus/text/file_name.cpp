#include "canopus/text/file_name.hpp"

#include <cstdint>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"

namespace canopus::text {

namespace {

/// FNV-1a, 64 bits.
std::uint64_t checksum(std::string_view text) {
  std::uint64_t sum = 0xCBF2'9CE4'8422'2325;
  for (const char c : text) sum = (sum ^ static_cast<unsigned char>(c)) * 0x0000'0100'0000'01B3;
  return sum;
}

}  // namespace

std::string file_name_of(std::string_view name) {
  constexpr std::size_t longest = 80;
  constexpr std::size_t longest_beginning = 60;
  std::string file;
  for (const char c : name) {
    const bool stays = ascii::is_letter(c) || ascii::is_digit(c) || c == '-' || c == '_';
    file += stays ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    if (file.size() > longest) {
      return fmt::format("{}-{:016x}", file.substr(0, longest_beginning), checksum(name));
    }
  }
  return file;
}

}  // namespace canopus::text
