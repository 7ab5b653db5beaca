#pragma once
// Nodes, objects and signals by the names that people have for them, out of device files.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/eds/device_file.hpp"
#include "canopus/text/output.hpp"
#include "canopus/trace/decode/names.hpp"
#include "canopus/trace/report/trace_picture.hpp"

namespace canopus::trace {

/// nullptr after the mistake was printed on `err`.
[[nodiscard]] std::shared_ptr<const eds::DeviceFile> load_device_file(const std::string& path,
                                                                      text::Output& err);
/// The node name of a device file: of the DCF, else of the product.
[[nodiscard]] std::string node_name_of(const eds::DeviceFile& file);
/// "3": 1 to 127.
[[nodiscard]] std::optional<std::uint8_t> parse_node_id(std::string_view text) noexcept;
/// "3=encoder.eds", as the option --node has it. False after the mistake was printed on `err`.
[[nodiscard]] bool add_node_names(const std::string& text, Names& names, text::Output& err);

// Values of PDOs as people name them for a picture.

/// "encoder.6004", "3.6004:00": the node by its name or node-ID. Nothing when it is neither, or no object.
[[nodiscard]] std::optional<PictureSignal> parse_picture_signal(const std::string& text, const Names& names);

}  // namespace canopus::trace
