#pragma once
// The purpose of objects of CiA 301, CiA 302 and CiA 402, in a sentence each: the description beside a value.

#include <cstdint>
#include <string>
#include <string_view>

namespace canopus::trace {

struct ObjectMeaning {
  std::string_view text{};    ///< empty: an object of a manufacturer, or one that is not known here
  std::string_view unit{};    ///< "ms", "us", "x 100 us"; empty: none, or that of the device
  std::string_view source{};  ///< "CiA 301 7.5.2.20"
};

/// The meaning of a sub-index; of equal ones (1016:03) their common meaning.
[[nodiscard]] ObjectMeaning object_meaning(std::uint16_t index, std::uint8_t sub) noexcept;

}  // namespace canopus::trace
