#pragma once

#include <string>

#include "canopus/text/output.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::plant {

/// Adds the names of the nodes and objects of the plant in this file, for the decoder. False after its mistakes were printed on `err`.
[[nodiscard]] bool add_plant_names(const std::string& path, trace::Names& names, text::Output& err);

}  // namespace canopus::plant
