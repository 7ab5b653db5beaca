#pragma once
// Standard functions and function blocks of IEC 61131-3 that are no single instruction: what they do, whatever the language.

#include <span>
#include <string_view>

#include "canopus/program/program.hpp"

namespace canopus::program {

/// Of a name with what it works on: "SQRT_LREAL", "CONCAT_STRING", "CONCAT_WSTRING"; nullptr for none. Arguments are slots: numbers
/// by value, strings by their place in the memory; the result of a string function goes to the string that slot 0 points to, and is
/// cut off where that one ends.
[[nodiscard]] Native native_named(std::string_view name) noexcept;

struct StandardBlock {
  struct Variable {
    std::string_view name;
    Elementary type;
    MemberKind kind;
  };
  std::string_view name;
  std::span<const Variable> variables;  ///< in the order of their slots
  Native run;
};
[[nodiscard]] std::span<const StandardBlock> standard_blocks() noexcept;

}  // namespace canopus::program
