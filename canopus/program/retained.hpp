#pragma once
// RETAIN variables as bytes, for a memory that outlives the program: each with its name and its type, so that another version of the
// program finds its own.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "canopus/program/machine.hpp"

namespace canopus::program {

/// A line for each: name, type, and its slots in hexadecimal, separated by tabs. Empty: the program has none.
[[nodiscard]] std::vector<std::uint8_t> retained_bytes(const Machine& machine);

/// Gives the machine what such bytes hold. What the program has no more, or with another type, is left out and named in the result:
/// "Main.n was INT, and is DINT now". Bytes of anybody: a value that is none of its type is left out, too.
[[nodiscard]] std::vector<std::string> restore_retained(Machine& machine,
                                                        std::span<const std::uint8_t> bytes);

}  // namespace canopus::program
