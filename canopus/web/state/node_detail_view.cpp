#include "canopus/web/state/node_detail_view.hpp"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/client/domain_words.hpp"
#include "canopus/plant/catalogue/error_history.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/serve/device_control.hpp"
#include "canopus/web/state/objects.hpp"
#include "canopus/web/state/view_fields.hpp"

namespace canopus::web {
namespace {

/// The dictionary of the node that a concise DCF is for: names and types. nullptr: it is not of this plant.
const canopen::DictionaryDescription* configured_device(plant::Plant& plant, std::string_view bus,
                                                        std::uint8_t node_id) {
  const auto nodes = plant.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].label.bus != bus || nodes[i].label.node_id != node_id) continue;
    const canopen::Node* const node = node_at(plant, i);
    return node == nullptr ? nullptr : &node->dictionary().description();
  }
  return nullptr;
}

text::Json words_of_domain(plant::Plant& plant, std::string_view bus, ViewedObject object,
                           std::span<const std::uint8_t> bytes) {
  const bool is_concise = object.index == client::concise_dcf_object;
  const auto* const device = is_concise ? configured_device(plant, bus, object.sub) : nullptr;
  return client::json_of(client::domain_words(object.index, bytes, device));
}

text::Json json_of(const module::ResetRequest& request) {
  return {{"offered", request.kind != module::ResetRequest::Kind::none}, {"how", request.text}};
}

}  // namespace

std::expected<text::Json, std::string> domain_in_words(plant::Plant& plant, const text::Json& wish) {
  const auto object = object_of_view(view_text(wish, "object"));
  if (!object) return std::unexpected("object: expected INDEX:SUB, as 1F22:03");
  const auto bytes = ascii::bytes_of_hex(view_text(wish, "bytes"));
  if (!bytes) return std::unexpected("bytes: expected pairs of hexadecimal digits");
  const auto bus = wish.find("bus");
  const bool has_bus = bus != wish.end() && bus->is_string();
  return words_of_domain(plant, has_bus ? bus->get<std::string>() : std::string(), *object, *bytes);
}

std::string errors_event(plant::Plant& plant, const text::Json& wish) {
  const std::size_t number = view_number(wish, "errors", SIZE_MAX);
  const auto modules = plant.modules();
  if (number >= modules.size()) return {};
  const plant::CatalogueEntry* const entry = plant::find_module(plant.module_section(number).model);
  if (entry == nullptr) return {};
  const can::Time now = plant.timeline().now();
  text::Json event = plant::event_line(now, "errors");
  event["number"] = number;
  event["module"] = modules[number].label.name;
  event["groups"] = modules[number].is_on
                        ? serve::error_groups(plant::error_history(*entry, plant.module(number), now))
                        : text::Json::array();
  event["clear"] = json_of(entry->reset_procedure->clear_errors);
  event["reset"] = json_of(entry->reset_procedure->restart);
  return view_event(event);
}

std::string domain_event(plant::Plant& plant, const text::Json& wish) {
  const std::size_t number = view_number(wish, "domain", SIZE_MAX);
  const canopen::Node* const node = node_at(plant, number);
  const auto object = object_of_view(view_text(wish, "object"));
  if (node == nullptr || !object) return {};
  const canopen::ObjectDictionary& objects = node->dictionary();
  const canopen::Entry entry = objects.description().find(object->index, object->sub);
  if (!entry || !canopen::is_variable_length(entry.description->type)) return {};
  const auto bytes = bytes_of_object(plant, number, objects, entry);
  const plant::NodeStatus status = plant.nodes()[number];
  text::Json event = plant::event_line(plant.timeline().now(), "domain");
  event["number"] = number;
  event["bus"] = status.label.bus;
  event["node"] = status.label.node_id;
  event["object"] = canopen::object_text(object->index, object->sub);
  event["size"] = bytes.size();
  if (wish.contains("part")) {
    const std::size_t from = std::min(view_number(wish, "part", SIZE_MAX), bytes.size());
    event["part"] = from;
    event["hex"] = ascii::hex_bytes(bytes.subspan(from, std::min(domain_part, bytes.size() - from)));
  } else {
    event["words"] = words_of_domain(plant, status.label.bus, *object, bytes);
  }
  return view_event(event);
}

}  // namespace canopus::web
