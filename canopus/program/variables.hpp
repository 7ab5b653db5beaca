#pragma once
// The single variables of a program: the members of its structures, blocks and arrays, each with the name that Machine::find() takes.

#include <cstdint>
#include <functional>
#include <string>

#include "canopus/program/program.hpp"

namespace canopus::program {

/// A variable that has one value, or a string.
struct SingleVariable {
  const std::string& name;  ///< "MAIN.list[3].x"
  const DataType& type;
  std::uint32_t place = 0;
  bool is_constant = false;
  bool is_retained = false;
  const std::string& comment;  ///< of the variable that it is in, if it has none of its own
};

/// Calls `each` for all of them, in the order of their declaration, as long as it returns true. Without variables of the caller
/// (VAR_IN_OUT) and those that have no value between two scans.
void for_each_variable(const Program& program, const std::function<bool(const SingleVariable&)>& each);

}  // namespace canopus::program
