#pragma once
// Names of nodes and objects out of device files, for the decoder.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/eds/device_file.hpp"
#include "canopus/text/output.hpp"
#include "canopus/trace/decode/names.hpp"

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

}  // namespace canopus::trace
