#pragma once
// Values of objects as text.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "canopus/canopen/dictionary/data_type.hpp"

namespace canopus::trace {

/// "00 11 AA"; of more than `most` bytes the first, and dots.
[[nodiscard]] std::string hexadecimal(std::span<const std::uint8_t> bytes, std::size_t most = 32);

/// The value of a type: "1234", "-5", "1.5", "true", "\"drive\"", "12:00:00.000, day 15000". Nothing when the bytes do
/// not fit the type, or no type is known.
[[nodiscard]] std::optional<std::string> typed_value(std::span<const std::uint8_t> bytes,
                                                     canopen::DataType type);
/// The same, or without a type: "00000195H" up to 8 bytes, else the bytes.
[[nodiscard]] std::string value_text(std::span<const std::uint8_t> bytes, canopen::DataType type);

/// The number that `bits` (1..64) of a frame are as this type; nothing for types that are no numbers. Without
/// a type, an unsigned number.
[[nodiscard]] std::optional<double> number_of(std::uint64_t raw, unsigned bits, canopen::DataType type);

/// Milliseconds for people: "0.6 ms", "12.4 ms", "1.2 s".
[[nodiscard]] std::string duration_text(std::int64_t nanoseconds);

}  // namespace canopus::trace
