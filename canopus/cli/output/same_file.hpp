#pragma once
// A command must not write over what it reads.

#include <string>

namespace canopus::cli {

/// Whether `in` (- is the standard input) and `out` are one regular file, even by different names. An `out`
/// of - is never one.
[[nodiscard]] bool is_same_file(const std::string& in, const std::string& out);

}  // namespace canopus::cli
