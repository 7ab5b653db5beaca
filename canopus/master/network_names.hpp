#pragma once

#include <string>

#include "canopus/text/output.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::master {

/// Adds the names of the nodes and objects of this network file, for the decoder. False after its mistakes were printed on `err`.
[[nodiscard]] bool add_network_names(const std::string& path, trace::Names& names, text::Output& err);

}  // namespace canopus::master
