// Any bytes as a file that is to be changed: the first three name a section, a key and a value. Unchanged it is
// the same bytes; what was set is read again; what was refused changed nothing.

#include "canopus/eds/ini_text.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using canopus::eds::IniText;
  if (size < 3) return 0;
  const std::string_view file(reinterpret_cast<const char*>(data) + 3, size - 3);  // NOLINT
  constexpr std::array<std::string_view, 5> values = {"5", "", "x=y", "\xC3\xBC", "\xE7\x94\xB5\xE6\x9C\xBA"};
  IniText text(file);
  if (text.text() != file) std::abort();
  std::string section = "New";
  std::string key = "Added";
  if (!text.sections().empty() && data[0] != 0) section = text.sections()[data[0] % text.sections().size()];
  if (const auto keys = text.keys(section); !keys.empty() && data[1] != 0) key = keys[data[1] % keys.size()];
  const std::string_view value = values[data[2] % values.size()];
  if (!text.set(section, key, value)) {
    if (text.text() != file) std::abort();
    return 0;
  }
  const auto again = IniText(text.text()).value(section, key);
  if (!again || !again->starts_with(value) || again != text.value(section, key)) std::abort();
  const std::string before = text.text();
  const bool is_removed = text.remove(section, key).has_value();
  // Refused where the rest would be read in another encoding.
  if (is_removed ? text.value(section, key).has_value() : text.text() != before) std::abort();
  return 0;
}
