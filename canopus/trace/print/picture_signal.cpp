#include "canopus/trace/print/picture_signal.hpp"

#include <string_view>

#include "canopus/text/text_values.hpp"
#include "canopus/trace/print/node_names.hpp"

namespace canopus::trace {

std::optional<PictureSignal> parse_picture_signal(const std::string& text, const Names& names) {
  const std::size_t dot = text.rfind('.');
  if (dot == std::string::npos) return std::nullopt;
  const auto object = text::parse_object(std::string_view(text).substr(dot + 1));
  if (!object) return std::nullopt;
  const std::string node = text.substr(0, dot);
  std::uint8_t node_id = 0;
  for (const NodeDescription& known : names.nodes()) {
    if (known.name == node) node_id = known.node_id;
  }
  if (node_id == 0) node_id = parse_node_id(node).value_or(0);
  if (node_id == 0) return std::nullopt;
  return PictureSignal{node_id, object->index, object->sub};
}

}  // namespace canopus::trace
