#include "canopus/web/state/values.hpp"

#include <bit>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

#include "canopus/can/little_endian.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/web/state/objects.hpp"
#include "canopus/web/state/view_fields.hpp"

namespace canopus::web {
namespace {

using canopen::DataType;

/// Takes a number off the front of a key, and the character behind it; nothing: there is none.
std::optional<std::uint64_t> parse_prefix(std::string_view& key, int base, char behind) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), number, base);
  if (error != std::errc()) return std::nullopt;
  key.remove_prefix(static_cast<std::size_t>(end - key.data()));
  if (behind == '\0') return key.empty() ? std::optional(number) : std::nullopt;
  if (!key.starts_with(behind)) return std::nullopt;
  key.remove_prefix(1);
  return number;
}

text::Json number_of(DataType type, std::uint64_t raw) {
  if (type == DataType::real32) return std::bit_cast<float>(static_cast<std::uint32_t>(raw));
  if (type == DataType::real64) return std::bit_cast<double>(raw);
  if (!canopen::is_signed(type)) return raw;
  const unsigned unused = 64U - 8U * canopen::byte_length(type);
  return static_cast<std::int64_t>(raw << unused) >> unused;
}

text::Json word(plant::Plant& plant, std::string_view key) {
  const auto module = parse_prefix(key, 10, ' ');
  const auto address = module ? parse_prefix(key, 10, '\0') : std::nullopt;
  if (!address || *module >= plant.modules().size() || *address > 0xFFFF) return nullptr;
  module::BufferMemoryAccess* const memory = plant.module(static_cast<std::size_t>(*module)).buffer_memory();
  if (memory == nullptr) return nullptr;
  return memory->peek(static_cast<std::uint16_t>(*address), plant.timeline().now());
}

text::Json object(plant::Plant& plant, std::string_view key) {
  const auto place = parse_prefix(key, 10, ' ');
  const auto index = place ? parse_prefix(key, 16, ':') : std::nullopt;
  const auto sub = index ? parse_prefix(key, 16, '\0') : std::nullopt;
  if (!sub || *index > 0xFFFF || *sub > 0xFF) return nullptr;
  const canopen::Node* const node = node_at(plant, static_cast<std::size_t>(*place));
  if (node == nullptr) return nullptr;
  const canopen::ObjectDictionary& objects = node->dictionary();
  const canopen::Entry entry =
      objects.description().find(static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*sub));
  if (!entry || canopen::is_variable_length(entry.description->type)) return nullptr;
  const auto bytes = objects.bytes(entry);
  return number_of(entry.description->type,
                   can::load_value(bytes.data(), static_cast<unsigned>(bytes.size())));
}

}  // namespace

std::string values_event(plant::Plant& plant, const text::Json& wish) {
  const auto keys = wish.find("values");
  if (keys == wish.end() || !keys->is_array() || keys->size() > most_values) return {};
  text::Json event = plant::event_line(plant.timeline().now(), "values");
  event["values"] = text::Json::array();
  constexpr std::string_view words = "words ";
  constexpr std::string_view objects = "objects ";
  for (const text::Json& one : *keys) {
    const std::string key = one.is_string() ? one.get<std::string>() : std::string();
    text::Json value;
    if (key.starts_with(words)) value = word(plant, std::string_view(key).substr(words.size()));
    if (key.starts_with(objects)) value = object(plant, std::string_view(key).substr(objects.size()));
    event["values"].push_back({{"key", key}, {"value", std::move(value)}});
  }
  return view_event(event);
}

}  // namespace canopus::web
