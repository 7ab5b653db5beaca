#pragma once
// Values of objects as a file writes them, turned into bytes as an SDO carries them.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/eds/ini.hpp"

namespace canopus::eds {

/// The place of a value, for messages.
struct Place {
  Problems& problems;
  const Item& item;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  /// "DefaultValue=0x1FF of 1018:01".
  [[nodiscard]] std::string quoted() const;
  void warning(std::string_view message) const { report(Problem::Severity::warning, message); }
  void loss(std::string_view message) const { report(Problem::Severity::loss, message); }
  void report(Problem::Severity severity, std::string_view message) const;
  /// A note that is reported once for all places of its kind.
  void note(std::string_view kind) const;
};

struct Value {
  std::vector<std::uint8_t> bytes;
  bool adds_node_id = false;
};

/// A DefaultValue or ParameterValue. Nothing, after a loss, when it cannot be read.
[[nodiscard]] std::optional<Value> read_value(canopen::DataType type, const Place& place);

/// A LowLimit or HighLimit in the form of canopen::Limits. Nothing when it cannot be used, which is a loss, and for types
/// that have no order.
[[nodiscard]] std::optional<std::uint64_t> read_limit(canopen::DataType type, const Place& place);

/// A plain unsigned number of a key such as SubNumber; `highest` limits it. Nothing, after a problem of this severity,
/// when it is none or too large.
[[nodiscard]] std::optional<std::uint64_t> read_unsigned(
    const Section& section, const Item& item, std::uint64_t highest, Problems& problems,
    Problem::Severity severity = Problem::Severity::warning);

/// A value as a device file writes it, so that read_value() gives these bytes again: 7, 0x0191, $NODEID+0x180, octets
/// as pairs of hexadecimal digits, text as it is (in quotes where it has blanks at its ends). Nothing: bytes that are
/// no text of this type.
[[nodiscard]] std::optional<std::string> value_text(canopen::DataType type,
                                                    std::span<const std::uint8_t> bytes, bool adds_node_id);
/// A limit (canopen::Limits) as a device file writes it.
[[nodiscard]] std::string limit_text(canopen::DataType type, std::uint64_t limit);

/// Lowest and highest value of an integer type, as 64-bit patterns.
struct Range {
  std::uint64_t low;
  std::uint64_t high;
};
[[nodiscard]] Range range(canopen::DataType type) noexcept;
/// True when a < b as values of this type (64-bit patterns; IEEE doubles for reals).
[[nodiscard]] bool less(canopen::DataType type, std::uint64_t a, std::uint64_t b) noexcept;
/// The 64-bit pattern of a value's bytes: sign-extended, or as an IEEE double.
[[nodiscard]] std::uint64_t pattern(canopen::DataType type, const std::vector<std::uint8_t>& bytes) noexcept;
/// BOOLEAN, the integers and the reals.
[[nodiscard]] bool is_number(canopen::DataType type) noexcept;

}  // namespace canopus::eds
