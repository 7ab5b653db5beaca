#include "canopus/cli/module_settings/shown_data.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

#include <fmt/format.h>

#include "canopus/client/domain_words.hpp"
#include "canopus/client/sdo_value.hpp"

namespace canopus::cli {

std::vector<std::pair<std::string_view, std::string>> shown_data(std::span<const std::uint8_t> bytes) {
  std::vector<std::pair<std::string_view, std::string>> forms;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 8); ++i)
    value |= std::uint64_t{bytes[i]} << 8 * i;
  if (bytes.size() <= 8) {
    forms.emplace_back("hexadecimal", fmt::format("0x{:0{}X}", value, 2 * bytes.size()));
    forms.emplace_back("decimal", fmt::format("{}", value));
    if (bytes.size() == 4) {
      forms.emplace_back("floating point",
                         fmt::format("{}", std::bit_cast<float>(static_cast<std::uint32_t>(value))));
    }
    if (bytes.size() == 8)
      forms.emplace_back("floating point", fmt::format("{}", std::bit_cast<double>(value)));
  } else {
    forms.emplace_back("hexadecimal", client::hexadecimal(bytes));
  }
  forms.emplace_back("ASCII", client::ascii_of(bytes));
  return forms;
}

}  // namespace canopus::cli
