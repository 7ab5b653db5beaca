#pragma once
// Objects of CiA 301 and CiA 302 that every device may have: their meaning where no device file
// is at hand. A device file's own names and types go before.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::trace {

struct ObjectFacts {
  std::string name{};
  canopen::DataType type = canopen::DataType::none;  ///< none: not known
};

/// Name and type of a sub-index. `dictionary` may be nullptr.
[[nodiscard]] ObjectFacts object_facts(const canopen::DictionaryDescription* dictionary, std::uint16_t index,
                                       std::uint8_t sub);

/// The unit CiA 301 gives the value: "ms", "us", "x 100 us"; empty for others.
[[nodiscard]] std::string_view object_unit(std::uint16_t index, std::uint8_t sub) noexcept;

/// The value of an object for people, with its unit; COB-IDs and mapping entries as their fields.
[[nodiscard]] std::string object_value_text(std::uint16_t index, std::uint8_t sub,
                                            std::span<const std::uint8_t> value, canopen::DataType type);

}  // namespace canopus::trace
