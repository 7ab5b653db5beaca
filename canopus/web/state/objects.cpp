#include "canopus/web/state/objects.hpp"

#include <algorithm>
#include <bit>
#include <span>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/manager/nmt/flying_master.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/text/json.hpp"
#include "canopus/trace/decode/object_meaning.hpp"
#include "canopus/web/state/view_fields.hpp"

namespace canopus::web {
namespace {

using canopen::DataType;
constexpr std::size_t most_shown_bytes = 64;

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  return ascii::hex_bytes(bytes.first(std::min(bytes.size(), most_shown_bytes)));
}

/// As text, so that 64 bits stay whole in JavaScript.
std::string decimal(DataType type, std::uint64_t raw) {
  if (type == DataType::real32)
    return fmt::format("{}", std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
  if (type == DataType::real64) return fmt::format("{}", std::bit_cast<double>(raw));
  if (!canopen::is_signed(type)) return fmt::format("{}", raw);
  const unsigned unused = 64U - 8U * canopen::byte_length(type);
  return fmt::format("{}", static_cast<std::int64_t>(raw << unused) >> unused);
}

std::string hexadecimal(DataType type, std::uint64_t raw) {
  return fmt::format("{:0{}X}", raw, 2 * canopen::byte_length(type));
}

bool is_ascii(std::span<const std::uint8_t> bytes) {
  return std::ranges::all_of(bytes, [](std::uint8_t byte) { return byte >= 0x20 && byte < 0x7F; });
}

/// 1F90:02 to 05 together are a time.
void add_negotiation(text::Json& row, const canopen::ObjectDictionary& objects, const canopen::Entry& entry,
                     std::uint8_t node_id) {
  constexpr std::uint16_t flying_master = 0x1F90, start_up = 0x1F80;
  constexpr std::uint8_t first = 2, last = 5;
  if (entry.index != flying_master || entry.sub < first || entry.sub > last) return;
  const manager::FlyingMasterTiming timing = manager::flying_timing(objects, node_id);
  std::string words = manager::negotiation_words(timing, node_id);
  if ((objects.get<std::uint32_t>(start_up, 0, 0) & manager::start_up_bit::flying_master) == 0)
    words += "; it takes no part (1F80H bit 5)";
  row["words"] = std::move(words);
  if (const std::string wrong = manager::overlapping_slots(timing); !wrong.empty()) row["warning"] = wrong;
}

void add_value(text::Json& row, const canopen::ObjectDictionary& objects, const canopen::Entry& entry,
               std::uint8_t node_id, const BytesOfEntry& bytes_of) {
  const DataType type = entry.description->type;
  const bool has_bytes = bytes_of && canopen::is_variable_length(type);
  const auto bytes = has_bytes ? bytes_of(entry) : objects.bytes(entry);
  if (canopen::is_variable_length(type)) {
    row["bytes"] = bytes.size();
    row["hex"] = hexadecimal(bytes);
    const auto shown = bytes.first(std::min(bytes.size(), most_shown_bytes));
    if (type == DataType::visible_string && is_ascii(shown))
      row["text"] = std::string(shown.begin(), shown.end());
    return;
  }
  const std::uint64_t raw = can::load_value(bytes.data(), static_cast<unsigned>(bytes.size()));
  const std::uint64_t usual = objects.description().default_value(entry, node_id);
  row["hex"] = hexadecimal(type, raw);
  row["decimal"] = decimal(type, raw);
  row["default_hex"] = hexadecimal(type, usual);
  row["default_decimal"] = decimal(type, usual);
  const canopen::Limits limits = objects.description().limits(entry);
  if (limits.low) row["low"] = decimal(type, *limits.low);
  if (limits.high) row["high"] = decimal(type, *limits.high);
  add_negotiation(row, objects, entry, node_id);
}

}  // namespace

const canopen::Node* node_at(plant::Plant& plant, std::size_t place) {
  const std::size_t modules = plant.modules().size();
  if (place < modules) return &plant.module(place).node();
  return place - modules < plant.device_count() ? &plant.device(place - modules).device().node() : nullptr;
}

std::span<const std::uint8_t> bytes_of_object(plant::Plant& plant, std::size_t place,
                                              const canopen::ObjectDictionary& objects,
                                              const canopen::Entry& entry) {
  constexpr std::uint16_t concise_dcfs = 0x1F22;  // a module does not keep them in its dictionary
  if (entry.index == concise_dcfs && entry.sub != 0 && place < plant.modules().size()) {
    const auto file = plant.module(place).concise_dcf(entry.sub);
    if (!file.empty()) return file;
  }
  return objects.bytes(entry);
}

std::optional<ViewedObject> object_of_view(std::string_view text) {
  if (text.size() != 7 || text[4] != ':') return std::nullopt;
  const auto index = ascii::parse_number<std::uint16_t>(text.substr(0, 4), 16);
  const auto sub = ascii::parse_number<std::uint8_t>(text.substr(5), 16);
  if (!index || !sub) return std::nullopt;
  return ViewedObject{*index, *sub};
}

void add_objects(text::Json& event, const canopen::ObjectDictionary& objects, std::uint8_t node_id,
                 std::string_view lower_find, std::size_t from, std::size_t count,
                 const BytesOfEntry& bytes) {
  const canopen::DictionaryDescription& description = objects.description();
  std::size_t all = 0;
  event["rows"] = text::Json::array();
  for (const canopen::ObjectDescription& object : description.objects()) {
    const std::string_view of = description.name(object);
    const bool is_meant =
        has_words(of, lower_find) || has_words(fmt::format("{:04X}", object.index), lower_find);
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const canopen::Entry entry = description.find(object, static_cast<std::uint8_t>(sub));
      if (!entry) continue;
      const std::string_view own = description.name(entry);
      if (!is_meant && !has_words(own, lower_find)) continue;
      const std::size_t place = all++;
      if (place < from || place - from >= count) continue;
      text::Json row{{"object", canopen::object_text(object.index, sub)},
                     {"name", own.empty() ? of : own},
                     {"of", of},
                     {"type", eds::name(entry.description->type)},
                     {"access", eds::name(entry.description->access)}};
      if (entry.description->tpdo_mappable) row["tpdo"] = true;
      if (entry.description->rpdo_mappable) row["rpdo"] = true;
      const std::string_view unit = trace::object_meaning(object.index, static_cast<std::uint8_t>(sub)).unit;
      if (!unit.empty()) row["unit"] = unit;
      add_value(row, objects, entry, node_id, bytes);
      event["rows"].push_back(std::move(row));
    }
  }
  event["of"] = all;
}

std::string objects_event(plant::Plant& plant, const text::Json& wish) {
  const std::size_t number = view_number(wish, "objects", SIZE_MAX);
  const canopen::Node* const node = node_at(plant, number);
  if (node == nullptr) return {};
  const plant::NodeStatus status = plant.nodes()[number];
  text::Json event = plant::event_line(plant.timeline().now(), "objects");
  event["number"] = number;
  event["bus"] = status.label.bus;
  event["node"] = status.label.node_id;
  event["name"] = status.label.name;
  event["from"] = view_number(wish, "from", SIZE_MAX);
  add_objects(
      event, node->dictionary(), node->node_id(), view_text(wish, "find"), event["from"].get<std::size_t>(),
      view_number(wish, "count", most_objects),
      [&](const canopen::Entry& entry) { return bytes_of_object(plant, number, node->dictionary(), entry); });
  return view_event(event);
}

std::string meaning_event(plant::Plant& plant, const text::Json& wish) {
  const auto object = object_of_view(view_text(wish, "meaning"));
  if (!object) return {};
  const trace::ObjectMeaning meaning = trace::object_meaning(object->index, object->sub);
  text::Json event = plant::event_line(plant.timeline().now(), "meaning");
  event["object"] = canopen::object_text(object->index, object->sub);
  event["meaning"] = meaning.text;
  event["unit"] = meaning.unit;
  event["source"] = meaning.source;
  return view_event(event);
}

}  // namespace canopus::web
