#pragma once
// Fields of a configuration tool: defaults, ranges, values as people write them. Files, checks and transfers go by the tools'
// tables (module/interface/configuration_tool.hpp), so that they cannot disagree.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "canopus/module/interface/configuration_tool.hpp"

namespace canopus::module_settings {

using Place = module::SettingPlace;
using Field = module::SettingField;
using Window = module::SettingWindow;

/// COB-ID entries: the PDO or consumer is not there [CiA 301 7.5.2.37].
inline constexpr std::uint32_t not_valid = 0x8000'0000;

/// The tools that a file or a command may name.
using Tools = std::span<const module::ConfigurationTool* const>;
/// The tool of the model, in upper or lower case; nullptr: there is none.
[[nodiscard]] const module::ConfigurationTool* find_tool(Tools tools, std::string_view model) noexcept;
/// "FX3U-CAN, RJ71CN91"
[[nodiscard]] std::string models_of(Tools tools);

/// The field's default for this row of a module with this node-ID. Key 0: not a row.
[[nodiscard]] std::uint32_t factory_value(const Window& window, const Field& field, std::uint32_t key,
                                          std::uint32_t node_id) noexcept;

/// The range of a field: "1 to 127", "10, 20, 50 kbps", "High, Mid, Low".
[[nodiscard]] std::string shown_range(const Field& field);
/// The mistake of a value, with the printed range ("Node ID = 128: expected 1 to 127"); empty: nothing.
[[nodiscard]] std::string why_not(const Field& field, std::uint32_t value);
/// A number, decimal or as 0x1F, or a word of the field ("Selected"); else what was expected.
[[nodiscard]] std::optional<std::uint32_t> parse_value(const Field& field, std::string_view text) noexcept;
/// The value as shown in the window: "0x40000181", "250", "Selected".
[[nodiscard]] std::string shown_value(const Field& field, std::uint32_t value);

}  // namespace canopus::module_settings
