#include "canopus/client/sdo_request.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/sdo/uploaded_value.hpp"
#include "canopus/client/node_id.hpp"
#include "canopus/client/sdo_value.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/trace/decode/value_words.hpp"

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
  if (auto good = target.set_type(type); !good) return std::unexpected(std::move(good.error()));
  return target;
}

std::expected<void, std::string> SdoTarget::set_type(const std::string& text) {
  if (text.empty()) return {};
  type = parse_type(text);
  type_name = text;
  if (type) return {};
  return std::unexpected(
      fmt::format("--type: \"{}\" is not a type{}", text, text::suggestion(text, type_names())));
}

void SdoTarget::use(std::shared_ptr<const canopen::DictionaryDescription> file, const canopen::Entry& entry,
                    std::string name) {
  dictionary = std::move(file);
  object = {entry.index, entry.sub};
  title = std::move(name);
  const std::string_view own = client::type_name(entry.description->type);
  if (type || own.empty()) return;
  type = entry.description->type;
  type_name = own;
}

std::string SdoTarget::object_text() const { return canopen::object_text(object.index, object.sub); }

std::string SdoTarget::object_title() const {
  return title.empty() ? object_text() : object_text() + " " + title;
}

namespace {

trace::ValueWords value_words(const SdoTarget& target, std::span<const std::uint8_t> bytes) {
  if (target.dictionary == nullptr || bytes.size() > 8) return {};
  return trace::value_words(target.dictionary.get(), target.object.index, target.object.sub,
                            can::load_value(bytes));
}

std::string_view unit_of(const SdoTarget& target) {
  if (target.dictionary == nullptr) return {};
  return trace::value_unit(target.dictionary.get(), target.object.index, target.object.sub);
}

/// A limit of a device file: an IEEE double for reals, else sign-extended.
std::string limit_text(std::uint64_t limit, canopen::DataType type) {
  if (type == canopen::DataType::real32 || type == canopen::DataType::real64)
    return fmt::format("{}", std::bit_cast<double>(limit));
  return canopen::is_signed(type) ? fmt::format("{}", static_cast<std::int64_t>(limit))
                                  : fmt::format("{}", limit);
}

/// Whether a value is within the range of the device file, if it is of the file's type.
std::expected<void, std::string> check_range(const SdoTarget& target, std::span<const std::uint8_t> bytes,
                                             const std::string& value) {
  using canopen::AbortCode;
  if (target.dictionary == nullptr) return {};
  const canopen::Entry entry = target.dictionary->find(target.object.index, target.object.sub);
  if (!entry || target.type != entry.description->type) return {};
  const AbortCode code = target.dictionary->check_write(entry, bytes);
  if (code != AbortCode::value_too_high && code != AbortCode::value_too_low) return {};
  const auto [low, high] = target.dictionary->limits(entry);
  const canopen::DataType type = entry.description->type;
  const std::string range = low && high ? limit_text(*low, type) + " to " + limit_text(*high, type)
                            : high      ? "at most " + limit_text(*high, type)
                            : low       ? "at least " + limit_text(*low, type)
                                        : std::string("0 or 1");
  return std::unexpected(
      fmt::format("{} is out of the range of {}: expected {}", value, target.object_title(), range));
}

}  // namespace

std::expected<std::string, std::string> show_value(const SdoTarget& target,
                                                   std::span<const std::uint8_t> bytes) {
  auto text = show_value(bytes, *target.type);
  if (!text) return text;
  if (const std::string_view unit = unit_of(target); !unit.empty())
    text->insert(std::min(text->find("  "), text->size()), fmt::format(" {}", unit));
  if (const trace::ValueWords words = value_words(target, bytes); !words.empty())
    *text += "  " + words.text();
  return text;
}

std::expected<std::vector<std::uint8_t>, std::string> bytes_of_value(const SdoTarget& target,
                                                                     const std::string& value, bool raw) {
  if (value.empty() && target.type != canopen::DataType::visible_string)
    return std::unexpected("what is to be written? Give a VALUE, or --file");
  if (target.type) {
    auto bytes = encode_value(value, *target.type);
    if (!bytes) return bytes;
    if (auto good = check_range(target, *bytes, value); !good)
      return std::unexpected(std::move(good.error()));
    return bytes;
  }
  if (raw) return encode_value(value, canopen::DataType::octet_string);
  return std::unexpected(
      fmt::format("type missing: use --type u16 (or another of {}), or --raw for bytes in hexadecimal",
                  text::one_of(type_names())));
}

ReadValue value_of(std::span<const std::uint8_t> bytes, const SdoSpeed& speed,
                   std::optional<canopen::DataType> type) {
  using Remark = canopen::UploadedValue::Remark;
  const unsigned length = type ? canopen::byte_length(*type) : 0;
  const auto value = canopen::uploaded_value(bytes, speed.size_indicated, length);
  if (value.remark == Remark::longer_than_type) {
    return {value.bytes, fmt::format("{} came, {} has {}: the others are 0",
                                     ascii::counted(bytes.size(), "byte"), type_name(*type), length)};
  }
  if (value.remark == Remark::size_not_indicated && length == 0)
    return {value.bytes, "the node did not indicate how many of the 4 bytes are the value"};
  return {value.bytes, {}};
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

text::Json row_of(const SdoTarget& target, std::span<const std::uint8_t> came, const SdoSpeed& speed) {
  const auto [bytes, remark] = value_of(came, speed, target.type);
  text::Json line;
  line["node"] = target.node;
  line["object"] = target.object_text();
  line["bytes"] = hexadecimal(bytes, "");
  if (target.type) {
    line["type"] = target.type_name;
    line["value"] = json_value(bytes, *target.type);
  }
  if (!target.title.empty()) line["name"] = target.title;
  if (const std::string_view unit = unit_of(target); !unit.empty()) line["unit"] = unit;
  const trace::ValueWords words = value_words(target, bytes);
  if (!words.state.empty()) line["state"] = words.state;
  if (!words.bits.empty()) {
    text::Json& list = line["bits"] = text::Json::array();
    for (const std::string_view bit : words.bits) list.push_back(bit);
  }
  if (is_domain(target, bytes)) {
    line["domain"] = json_of(words_of(target, bytes));
    line["transfer"] = {{"bytes", speed.bytes},
                        {"seconds", can::seconds(can::Time{speed.time})},
                        {"form", name(speed.form)},
                        {"text", describe(speed)}};
  }
  if (!remark.empty()) line["remark"] = remark;
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
