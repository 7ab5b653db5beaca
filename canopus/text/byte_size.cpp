#include "canopus/text/byte_size.hpp"

#include <array>
#include <limits>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/number.hpp"

namespace canopus::text {
namespace {

struct Unit {
  char letter;
  std::string_view name;
  unsigned shift;
};
constexpr std::array<Unit, 3> units{{{'G', "GiB", 30}, {'M', "MiB", 20}, {'K', "KiB", 10}}};

}  // namespace

std::expected<std::uint64_t, std::string> parse_byte_size(std::string_view text) {
  std::string_view digits = text;
  unsigned shift = 0;
  for (const Unit& unit : units) {
    if (!digits.ends_with(unit.letter)) continue;
    shift = unit.shift;
    digits.remove_suffix(1);
    break;
  }
  const auto number = ascii::parse_number<std::uint64_t>(digits);
  if (!number || *number == 0 || *number > std::numeric_limits<std::uint64_t>::max() >> shift) {
    return std::unexpected(fmt::format(
        "\"{}\" is not a size; expected bytes, or a number with K, M or G, for example \"16M\"", text));
  }
  return *number << shift;
}

std::string describe_byte_size(std::uint64_t bytes) {
  for (const Unit& unit : units) {
    const std::uint64_t size = std::uint64_t{1} << unit.shift;
    if (bytes >= size && bytes % size == 0) return fmt::format("{} {}", bytes / size, unit.name);
  }
  return ascii::counted(bytes, "byte");
}

}  // namespace canopus::text
