#include "canopus/text/bit_rate.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "canopus/ascii/number.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::text {
namespace {

constexpr std::uint32_t thousand = 1'000;
constexpr std::uint32_t million = 1'000'000;
constexpr std::array<std::pair<std::string_view, std::uint32_t>, 7> units_of_bit_rates{{{"", 1},
                                                                                        {"bit/s", 1},
                                                                                        {"k", thousand},
                                                                                        {"K", thousand},
                                                                                        {"kbit/s", thousand},
                                                                                        {"M", million},
                                                                                        {"Mbit/s", million}}};

std::string bit_rate_text(std::uint32_t bit_rate) {
  return bit_rate >= million ? std::to_string(bit_rate / million) + "M"
                             : std::to_string(bit_rate / thousand) + "k";
}

}  // namespace

std::expected<std::uint32_t, std::string> parse_bit_rate(std::string_view text,
                                                         std::span<const std::uint32_t> known) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string_view unit = text.substr(digits);
  if (unit.starts_with(' ')) unit.remove_prefix(1);
  const auto value = ascii::parse_number<std::uint32_t>(text.substr(0, digits));
  const auto* const factor =
      std::ranges::find(units_of_bit_rates, unit, &std::pair<std::string_view, std::uint32_t>::first);
  if (value && *value != 0 && *value <= million && factor != units_of_bit_rates.end()) {
    const auto found = std::ranges::find(known, std::uint64_t{*value} * factor->second);
    if (found != known.end()) return *found;
  }
  std::vector<std::string> words;
  for (const std::uint32_t bit_rate : known) {
    if (bit_rate != 0) words.push_back(bit_rate_text(bit_rate));
  }
  const std::vector<std::string_view> views(words.begin(), words.end());
  return std::unexpected("expected " + one_of(views));
}

}  // namespace canopus::text
