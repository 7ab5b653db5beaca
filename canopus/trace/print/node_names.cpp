#include "canopus/trace/print/node_names.hpp"

#include <charconv>

#include "canopus/text/file_text.hpp"

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
  unsigned node = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, failure] = std::from_chars(text.data(), end, node);
  if (failure != std::errc{} || stop != end || node == 0 || node > 127) return std::nullopt;
  return static_cast<std::uint8_t>(node);
}

bool add_node_names(const std::string& text, Names& names, text::Output& err) {
  const std::size_t sign = text.find('=');
  const auto node_id = parse_node_id(std::string_view(text).substr(0, sign));
  if (sign == std::string::npos || !node_id) {
    err.line("canopus: --node {}: expected a node-ID 1 to 127, = and a device file, as 3=encoder.eds", text);
    return false;
  }
  const auto file = load_device_file(text.substr(sign + 1), err);
  if (!file) return false;
  names.add(describe_node("", *node_id, node_name_of(*file), file->dictionary));
  return true;
}

}  // namespace canopus::trace
