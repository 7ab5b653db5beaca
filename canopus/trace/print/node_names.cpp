#include "canopus/trace/print/node_names.hpp"

#include <string_view>

#include "canopus/ascii/number.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::trace {

std::shared_ptr<const eds::DeviceFile> load_device_file(const std::string& path, text::Output& err) {
  const auto text = text::read_file(path);
  if (!text) {
    err.line("canopus: {}", text.error());
    return nullptr;
  }
  const eds::ReadResult result = eds::read_device_file(*text);
  if (!result.file) {
    const eds::Problem& problem = result.problems.front();
    err.line("{}:{}:{}: {}", path, problem.line, problem.column, problem.message);
  }
  return result.file;
}

std::string node_name_of(const eds::DeviceFile& file) {
  if (file.commissioning && !file.commissioning->node_name.empty()) return file.commissioning->node_name;
  return file.device.product_name;
}

std::optional<std::uint8_t> parse_node_id(std::string_view text) noexcept {
  const auto node = ascii::parse_number<std::uint8_t>(text);
  return node && *node >= 1 && *node <= 127 ? node : std::nullopt;
}

bool add_node_names(const std::string& text, Names& names, text::Output& err) {
  const std::size_t sign = text.find('=');
  const auto node_id = parse_node_id(std::string_view(text).substr(0, sign));
  if (sign == std::string::npos || !node_id) {
    err.line("canopus: --eds {}: expected a node-ID 1 to 127, = and a device file, as 3=encoder.eds", text);
    return false;
  }
  const auto file = load_device_file(text.substr(sign + 1), err);
  if (!file) return false;
  names.add(describe_node("", *node_id, node_name_of(*file), file->dictionary));
  return true;
}

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
