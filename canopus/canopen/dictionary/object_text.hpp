#pragma once
// How an entry of an object dictionary is called.

#include <string>

#include "canopus/ascii/hex.hpp"

namespace canopus::canopen {

/// "6000:01": in commands, tables and JSON. What text::parse_object() reads.
[[nodiscard]] inline std::string object_text(unsigned index, unsigned sub) {
  return ascii::hex(index, 4) + ':' + ascii::hex(sub, 2);
}

/// "6000H": in sentences, where numbers are decimal if nothing else is said.
[[nodiscard]] inline std::string object_name(unsigned index) { return ascii::hex(index, 4) + 'H'; }
/// "6000H:01".
[[nodiscard]] inline std::string object_name(unsigned index, unsigned sub) {
  return object_name(index) + ':' + ascii::hex(sub, 2);
}

}  // namespace canopus::canopen
