#pragma once
// `canopus eds show FILE`: a device description file as a person reads a data sheet: identity, objects, PDOs.

#include <string>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

/// Prints the file to `out`, as one JSON object or in lines of at most 80 columns (longer names are cut); why
/// it cannot, to `err`. Returns the exit code: 0 shown, 1 no device can be made of the file, 2 it could not be
/// read.
int eds_show(const std::string& file, bool json, Output& out, Output& err);

}  // namespace canopus::cli
