#pragma once
// Values of PDOs as people name them for a picture.

#include <optional>
#include <string>

#include "canopus/trace/decode/names.hpp"
#include "canopus/trace/report/trace_picture.hpp"

namespace canopus::trace {

/// "encoder.6004", "3.6004:00": the node by its name or node-ID. Nothing when it is neither, or no object.
[[nodiscard]] std::optional<PictureSignal> parse_picture_signal(const std::string& text, const Names& names);

}  // namespace canopus::trace
