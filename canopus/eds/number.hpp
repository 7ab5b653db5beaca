#pragma once
// Numbers as EDS files write them, and as people do.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace canopus::eds {

struct Number {
  bool negative = false;
  std::uint64_t magnitude = 0;
  bool hexadecimal = false;   ///< a bit pattern rather than a quantity
  bool adds_node_id = false;  ///< $NODEID + number
  /// Tolerated mistakes, for a note: "octal", "a comment behind it" ... Empty: nothing.
  std::string_view overlooked{};

  /// As a two's complement pattern.
  [[nodiscard]] std::uint64_t bits() const noexcept { return negative ? ~magnitude + 1 : magnitude; }
};

/// Reads decimal, 0x hexadecimal and 0 octal numbers and $NODEID formulas [CiA 306]; overlooks blanks,
/// quotes, a comment behind, 1AH and 1A for 0x1A, 8U, 5.0. A formula may be any sum, difference or product of numbers
/// to which the node-ID is added once, with parentheses: 0x80000000+($NODEID+0x200). Nothing when it is no number, has
/// more than 64 bits, or depends on the node-ID otherwise ($NODEID*2).
[[nodiscard]] std::optional<Number> read_number(std::string_view text);

/// Reads a decimal fraction: 1.5, 1,5, -3e-4. Nothing when it is none or goes on behind.
[[nodiscard]] std::optional<double> read_real(std::string_view text);

/// Without a comment behind: up to the first semicolon.
[[nodiscard]] std::string_view without_comment(std::string_view text) noexcept;

}  // namespace canopus::eds
