#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace canopus::ascii {

/// "1 byte", "2 bytes"; a noun in "s", "x" or "ch" gets "es": "2 buses".
[[nodiscard]] inline std::string counted(std::uint64_t count, std::string_view noun) {
  std::string text = std::to_string(count) + ' ';
  text += noun;
  if (count == 1) return text;
  const bool takes_es = noun.ends_with('s') || noun.ends_with('x') || noun.ends_with("ch");
  return text += takes_es ? "es" : "s";
}

}  // namespace canopus::ascii
