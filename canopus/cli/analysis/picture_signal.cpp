#include "canopus/cli/analysis/picture_signal.hpp"

#include <string_view>

#include "canopus/cli/options/option_checks.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

std::optional<trace::PictureSignal> parse_picture_signal(const std::string& text, const trace::Names& names) {
  const std::size_t dot = text.rfind('.');
  if (dot == std::string::npos) return std::nullopt;
  const auto object = text::parse_object(std::string_view(text).substr(dot + 1));
  if (!object) return std::nullopt;
  const std::string node = text.substr(0, dot);
  std::uint8_t node_id = 0;
  for (const trace::NodeDescription& known : names.nodes()) {
    if (known.name == node) node_id = known.node_id;
  }
  if (node_id == 0 && number_from(1, 127)(node).empty()) node_id = static_cast<std::uint8_t>(std::stoi(node));
  if (node_id == 0) return std::nullopt;
  return trace::PictureSignal{node_id, object->index, object->sub};
}

}  // namespace canopus::cli
