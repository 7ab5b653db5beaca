#pragma once
// A condition on what a PLC holds: "X1", "D100 >= 5", "U0\G601 == 5".

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "canopus/plc/melsec/target.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::serve {

class PlcCondition {
 public:
  /// An address as `canopus plc` takes it, one of == != < <= > >=, and a constant; a bit alone means == 1. A
  /// constant with a minus sign compares the word as -32768 to 32767. The error names what was expected; the
  /// rack must have the address.
  [[nodiscard]] static std::expected<PlcCondition, std::string> parse(std::string_view text,
                                                                      const plc::Rack& rack);

  /// Evaluates the values that a program would read at this moment; false when there is no supply.
  [[nodiscard]] bool holds(plc::Rack& rack, can::Time now) const;

 private:
  enum class Comparison : std::uint8_t { equal, not_equal, less_or_equal, greater_or_equal, less, greater };

  plc::melsec::Target target_;
  bool is_bit_ = false;
  bool is_signed_ = false;
  Comparison comparison_ = Comparison::equal;
  std::int32_t constant_ = 1;
};

}  // namespace canopus::serve
