#include "canopus/module_settings/module_windows.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::module_settings {

const module::ConfigurationTool* find_tool(Tools tools, std::string_view model) noexcept {
  const auto found = std::ranges::find_if(
      tools, [&](const auto* tool) { return ascii::equal_ignoring_case(model, tool->model); });
  return found == tools.end() ? nullptr : *found;
}

std::string models_of(Tools tools) {
  std::string models;
  for (const auto* tool : tools) models.append(models.empty() ? "" : ", ").append(tool->model);
  return models;
}

std::uint32_t factory_value(const Window& window, const Field& field, std::uint32_t key,
                            std::uint32_t node_id) noexcept {
  if (field.name == "COB-ID") {
    const bool transmits = window.mapping == 0x1A00;
    const std::uint32_t no_rtr = transmits ? 0x4000'0000 : 0;
    if (key >= 1 && key <= 4) return no_rtr + (transmits ? 0x80U : 0x100U) + 0x100 * key + node_id;
    return 0x8000'0000 | no_rtr;
  }
  if (field.name == "Multiple NMT master detect cycle time") return field.factory + 10 * node_id;
  return field.factory;
}

std::string shown_range(const Field& field) {
  const auto unit = field.unit.empty() ? std::string() : fmt::format(" {}", field.unit);
  if (!field.choices.empty()) return fmt::format("{}{}", fmt::join(field.choices, ", "), unit);
  if (!field.words.empty()) return fmt::format("{}", fmt::join(field.words, ", "));
  return fmt::format("{} to {}{}", shown_value(field, field.lowest), shown_value(field, field.highest), unit);
}

std::string why_not(const Field& field, std::uint32_t value) {
  const bool is_in = field.choices.empty() ? value >= field.lowest && value <= field.highest
                                           : std::ranges::find(field.choices, value) != field.choices.end();
  if (!is_in)
    return fmt::format("{} = {}: expected {}", field.name, shown_value(field, value), shown_range(field));
  if (value % field.step != 0) {
    return fmt::format("{} = {}: expected steps of {}{}{}", field.name, shown_value(field, value),
                       shown_value(field, field.step), field.unit.empty() ? "" : " ", field.unit);
  }
  return {};
}

std::optional<std::uint32_t> parse_value(const Field& field, std::string_view text) noexcept {
  for (std::size_t i = 0; i < field.words.size(); ++i) {
    if (ascii::equal_ignoring_case(text, field.words[i])) return static_cast<std::uint32_t>(i);
  }
  return ascii::parse_number_with_prefix<std::uint32_t>(text);
}

std::string shown_value(const Field& field, std::uint32_t value) {
  if (value < field.words.size()) return std::string(field.words[value]);
  if (!field.hexadecimal) return fmt::format("{}", value);
  if (field.highest <= 0xFF) return fmt::format("0x{:02X}", value);
  return field.highest <= 0xFFFF ? fmt::format("0x{:X}", value) : fmt::format("0x{:08X}", value);
}

}  // namespace canopus::module_settings
