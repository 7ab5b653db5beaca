#include "canopus/client/sdo_request.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/client/node_id.hpp"
#include "canopus/client/sdo_value.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::client {

std::expected<SdoTarget, std::string> SdoTarget::parse(std::string_view node, const std::string& object,
                                                       const std::string& type) {
  SdoTarget target;
  target.node = static_cast<std::uint8_t>(parse_node(node));
  if (target.node == 0)
    return std::unexpected(fmt::format("\"{}\" is not a node; expected a node-ID 1 to 127", node));
  const auto name = text::parse_object(object);
  if (!name) return std::unexpected(name.error());
  target.object = *name;
  if (type.empty()) return target;
  target.type = parse_type(type);
  target.type_name = type;
  if (target.type) return target;
  return std::unexpected(
      fmt::format("--type: \"{}\" is not a type{}", type, text::suggestion(type, type_names())));
}

std::string SdoTarget::object_text() const { return canopen::object_text(object.index, object.sub); }

std::expected<std::vector<std::uint8_t>, std::string> bytes_of_value(const SdoTarget& target,
                                                                     const std::string& value, bool raw) {
  if (value.empty() && target.type != canopen::DataType::visible_string)
    return std::unexpected("what is to be written? Give a VALUE, or --file");
  if (target.type) return encode_value(value, *target.type);
  if (raw) return encode_value(value, canopen::DataType::octet_string);
  return std::unexpected(
      fmt::format("which type has the value? Give --type {}, or --raw for bytes in hexadecimal",
                  text::one_of(type_names())));
}

bool is_domain(const SdoTarget& target, std::span<const std::uint8_t> bytes) {
  constexpr std::size_t many = 32;
  if (target.type) return *target.type == canopen::DataType::domain;
  if (target.object.index == client::concise_dcf_object) return target.object.sub != 0;
  return bytes.size() > many && std::ranges::any_of(bytes, [](std::uint8_t byte) {
           return byte < 0x20 || byte >= 0x7F;  // else it is a text
         });
}

client::DomainWords words_of(const SdoTarget& target, std::span<const std::uint8_t> bytes) {
  return client::domain_words(target.object.index, bytes, target.names.get());
}

text::Json row_of(const SdoTarget& target, std::span<const std::uint8_t> bytes, const SdoSpeed& speed) {
  text::Json line;
  line["node"] = target.node;
  line["object"] = target.object_text();
  line["bytes"] = hexadecimal(bytes, "");
  if (target.type) {
    line["type"] = target.type_name;
    line["value"] = json_value(bytes, *target.type);
  }
  if (is_domain(target, bytes)) {
    line["domain"] = json_of(words_of(target, bytes));
    line["transfer"] = {{"bytes", speed.bytes},
                        {"seconds", can::seconds(can::Time{speed.time})},
                        {"form", name(speed.form)},
                        {"text", describe(speed)}};
  }
  return line;
}

text::Json row_of(const SdoTarget& target, const SdoFailure& failure) {
  text::Json line;
  line["node"] = target.node;
  line["object"] = target.object_text();
  if (failure.code != canopen::AbortCode::none)
    line["abort"] = fmt::format("{:08X}", static_cast<std::uint32_t>(abort_on_bus(failure.code)));
  line["reason"] = failure.reason;
  return line;
}

}  // namespace canopus::client
