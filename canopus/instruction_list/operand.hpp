#pragma once
// An operand of an instruction as text: K10, HFF, E1.5, "text", D0, D0.5, K4M0Z1, U0\G25, T0, P10, N0.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "canopus/instruction_list/instructions.hpp"
#include "canopus/program/data_type.hpp"

namespace canopus::instruction_list {

struct Operand {
  enum class Kind : std::uint8_t {
    integer,
    real,
    text,
    device,
    timer,            ///< T0: contact, coil and value
    retentive_timer,  ///< ST0
    counter,          ///< C0
    index_register,   ///< of an FX3, which has them beside the devices: number 0 to 7 of Z, 8 to 15 of V
    pointer,          ///< P10
    nesting,          ///< N0
    variable          ///< of the program: a label without a device
  };
  Kind kind = Kind::device;
  std::string written{};
  std::string name{};  ///< of a device, without digits, bit and index
  std::int64_t value = 0;
  bool is_hexadecimal = false;
  double real = 0;
  std::string text{};
  std::uint32_t number = 0;  ///< of a timer, counter, index register, pointer
  unsigned digits = 0;       ///< K4M0: 4
  int bit = -1;              ///< D0.5: 5
  std::string index{};       ///< D0Z1: "Z1"
  // Of a variable; `number` is its place in the memory, of a local one its slot in the frame.
  program::Elementary type = program::Elementary::int_;
  bool is_local = false;
  bool is_constant_variable = false;

  [[nodiscard]] bool is_constant() const noexcept { return kind == Kind::integer || kind == Kind::real; }
};

/// The error says what was expected. Whether the CPU has such a device is not checked.
[[nodiscard]] std::expected<Operand, std::string> parse_operand(std::string_view text, Family family);

}  // namespace canopus::instruction_list
