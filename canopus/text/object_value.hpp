#pragma once
// Values of objects as people write them into plant and network files.

#include <cstdint>
#include <expected>
#include <string>
#include <variant>
#include <vector>

#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::text {

using Scalar = std::variant<bool, std::int64_t, double, std::string>;

/// An entry of a device's or module's object dictionary and the value it gets before power-on.
struct ObjectSetting {
  Place place{};
  ObjectName object{};
  Scalar value;
};

/// The bytes of a plant file's value as an object of this type holds it, or what is wrong with it: "300 does
/// not fit UNSIGNED8".
[[nodiscard]] std::expected<std::vector<std::uint8_t>, std::string> encode(const Scalar& value,
                                                                           canopen::DataType type);

}  // namespace canopus::text
