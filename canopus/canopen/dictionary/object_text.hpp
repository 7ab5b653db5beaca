#pragma once
// How an entry of an object dictionary is called.

#include <string>

#include "canopus/ascii/hex.hpp"

namespace canopus::canopen {

/// "6000:01": a sub-index, in commands, files, messages and JSON. What text::parse_object() reads.
[[nodiscard]] inline std::string object_text(unsigned index, unsigned sub) {
  return ascii::hex(index, 4) + ':' + ascii::hex(sub, 2);
}

/// "6000H": an object as a whole, in sentences.
[[nodiscard]] inline std::string object_name(unsigned index) { return ascii::hex(index, 4) + 'H'; }

}  // namespace canopus::canopen
