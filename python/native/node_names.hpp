#pragma once

#include <string>
#include <vector>

#include "canopus/text/output.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::python {

/// Throws PlantProblem with these lines.
[[noreturn]] void refuse(const text::TextOutput& errors);

/// Names for the decoder: of a plant file, of a network file (each may be empty), and of device files, as "3=encoder.eds". Throws
/// PlantProblem with what is wrong with one of them.
trace::Names node_names(const std::string& plant, const std::string& network,
                        const std::vector<std::string>& nodes);

}  // namespace canopus::python
