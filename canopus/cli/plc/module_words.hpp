#pragma once
// The words of a module's buffer memory by the names of its manual: "Communication status" is
// communication_status.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/plant/catalogue/module_catalogue.hpp"

namespace canopus::cli {

/// Words of one name.
struct NamedWords {
  std::string name;  ///< small letters, digits and _
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  std::uint16_t stride = 1;  ///< from one word of this name to the next

  [[nodiscard]] std::uint32_t count() const noexcept { return (last - first) / stride + 1; }
};

/// Those of a module, in the order of its table; of a name that several function modes have, the first one.
[[nodiscard]] std::vector<NamedWords> named_words(const plant::CatalogueEntry& entry);

/// "communication_status", or "nmt_state[4]" for the word four behind the first of that name, counted in
/// words of this name. `model` may be left out when every module that has the name has it at the same
/// address. The error names what was expected.
[[nodiscard]] std::expected<std::uint32_t, std::string> find_word(std::string_view name,
                                                                  std::string_view model = {});

}  // namespace canopus::cli
