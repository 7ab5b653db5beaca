#include "canopus/web/state/views.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/module/canopen/network_variables.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/web/state/node_detail_view.hpp"
#include "canopus/web/state/objects.hpp"
#include "canopus/web/state/program_views.hpp"
#include "canopus/web/state/values.hpp"
#include "canopus/web/state/view_fields.hpp"

namespace canopus::web {
namespace {

std::string_view access_name(module::WordAccess access) {
  switch (access) {
    case module::WordAccess::read: return "read";
    case module::WordAccess::write: return "write";
    case module::WordAccess::read_write: return "read/write";
    case module::WordAccess::none: break;
  }
  return "";
}

/// `low` and `high`, or `values`; of a word that takes anything, nothing.
void add_range(text::Json& line, const module::ValueRange& range) {
  using enum module::ValueRange::Kind;
  if (range.kind == one_of) {
    line["values"] = range.values;
  } else if (range.kind != any) {
    line["low"] = range.low;
    line["high"] = range.high;
  }
}

std::string_view start_up_name(module::StartUp start_up) {
  switch (start_up) {
    case module::StartUp::none: break;
    case module::StartUp::booting: return "booting";
    case module::StartUp::waits_for_own_start: return "waits for own start";
    case module::StartUp::ended: return "ended";
    case module::StartUp::halted: return "halted";
  }
  return "none";
}

}  // namespace

void WebViews::Tap::frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) {
  if (is_looked_at_ && !frame.extended) last[frame.identifier & can::max_base_identifier] = end;
}

WebViews::WebViews(plant::Plant& plant, const WebBoots& boots)
    : plant_(plant), boots_(boots), traffic_(plant) {
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    taps_.push_back(std::make_unique<Tap>(is_looked_at_));
    plant.bus(i).add_observer(*taps_.back());
  }
}

WebViews::~WebViews() {
  for (std::size_t i = 0; i < taps_.size(); ++i) plant_.bus(i).remove_observer(*taps_[i]);
}

void WebViews::list_modules() {
  const std::size_t count = plant_.modules().size();
  for (std::size_t i = 0; i < count; ++i) {
    const plant::ModuleSection& section = plant_.module_section(i);
    Module one{.name = shown_name(section),
               .bus = section.bus,
               .entry = plant::find_module(section.model),
               .module = &plant_.module(i)};
    const auto rows = one.entry->buffer_rows;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (rows[row].name.empty() || rows[row].access == module::WordAccess::none) continue;
      for (std::uint32_t address = rows[row].first; address <= rows[row].last; address += rows[row].stride) {
        one.words.push_back({static_cast<std::uint16_t>(address), static_cast<std::uint16_t>(row)});
      }
    }
    // Of rows for one address (of other modes, or of FROM and TO) the first.
    std::ranges::stable_sort(one.words, {}, &Module::Word::address);
    const auto rest = std::ranges::unique(one.words, {}, &Module::Word::address);
    one.words.erase(rest.begin(), rest.end());
    modules_.push_back(std::move(one));
  }
}

std::string WebViews::event_of(std::string_view view) {
  if (view.empty()) {
    is_looked_at_ = false;
    traffic_.forget();
    return {};
  }
  const auto wish = text::parse_json(view).value_or(Json());
  if (!wish.is_object()) return {};
  if (wish.contains("words")) return words_event(wish);
  if (wish.contains("boots")) return boots_event();
  if (wish.contains("objects")) return objects_event(plant_, wish);
  if (wish.contains("traffic")) return traffic_.event_of(wish);
  if (wish.contains("values")) return values_event(plant_, wish);
  if (wish.contains("meaning")) return meaning_event(plant_, wish);
  if (wish.contains("errors")) return errors_event(plant_, wish);
  if (wish.contains("domain")) return domain_event(plant_, wish);
  if (wish.contains("program")) return program_event(plant_, wish);
  if (wish.contains("variables")) return variables_event(plant_, wish);
  return {};
}

std::string WebViews::words_event(const text::Json& view) {
  if (modules_.empty()) list_modules();
  is_looked_at_ = true;
  const std::size_t position = view_number(view, "words", SIZE_MAX);
  if (position >= modules_.size()) return {};
  const Module& module = modules_[position];
  module::BufferMemoryAccess* const memory = module.module->buffer_memory();
  if (memory == nullptr) return {};
  const can::Time now = plant_.timeline().now();
  const std::string find = view_text(view, "find");
  const std::size_t from = view_number(view, "from", SIZE_MAX);
  const std::size_t count = view_number(view, "count", most_words);
  const Tap* tap = nullptr;
  for (std::size_t i = 0; i < taps_.size(); ++i) {
    if (plant_.bus(i).name() == module.bus) tap = taps_[i].get();
  }
  const auto process = process_words(module);
  const auto senders = process.empty() ? Senders() : senders_on(module.bus);
  Json event = plant::event_line(now, "words");
  event["number"] = position;
  event["module"] = module.name;
  event["from"] = from;
  event["rows"] = Json::array();
  std::size_t matching = 0;
  for (const Module::Word& word : module.words) {
    const module::BufferRow& row = module.entry->buffer_rows[word.row];
    const auto pdo = process.find(word.address);
    const Source source = pdo == process.end() ? Source() : source_of(pdo->second, senders);
    const auto has = [&](std::string_view text) { return has_words(text, find); };
    if (!has(row.name) && !has(fmt::format("g{}", word.address)) && !has(source.pdo) && !has(source.can_id) &&
        !has(source.sender))
      continue;
    const std::size_t place = matching++;
    if (place < from || place - from >= count) continue;
    Json line{{"address", word.address},
              {"name", row.name},
              {"access", access_name(row.access)},
              {"value", memory->peek(word.address, now)},
              {"initial", row.initial},
              {"section", row.section}};
    add_range(line, row.range);
    if (pdo != process.end()) {
      line["pdo"] = source.pdo;
      line["can_id"] = source.can_id;
      if (pdo->second.received) line["from"] = source.sender;
      const can::Time last = tap == nullptr ? can::never : tap->last[pdo->second.identifier];
      if (last != can::never) line["age"] = can::seconds(can::Time(now - last));
    }
    event["rows"].push_back(std::move(line));
  }
  event["of"] = matching;
  return view_event(event);
}

std::map<std::uint16_t, WebViews::ProcessWord> WebViews::process_words(const Module& module) const {
  std::map<std::uint16_t, ProcessWord> words;
  const module::DataExchangeLayout& layout = module.module->program_interface().process_data;
  const canopen::ObjectDictionary& objects = module.module->node().dictionary();
  for (const bool received : {true, false}) {
    for (unsigned pdo = 0; pdo < layout.pdos; ++pdo) {
      const auto index = static_cast<std::uint16_t>((received ? 0x1400U : 0x1800U) + pdo);
      const canopen::CobId cob_id =
          canopen::usable(canopen::CobId{objects.get<std::uint32_t>(index, 1, canopen::CobId::invalid_bit)});
      if (!cob_id.is_valid() || cob_id.is_extended()) continue;
      const auto mapping = static_cast<std::uint16_t>(index + 0x200U);
      const auto mapped = std::min<unsigned>(objects.get<std::uint8_t>(mapping, 0), 8);
      for (unsigned sub = 1; sub <= mapped; ++sub) {
        const auto object = objects.get<std::uint32_t>(mapping, static_cast<std::uint8_t>(sub));
        const auto place = module::variable_place(static_cast<std::uint16_t>(object >> 16),
                                                  static_cast<std::uint8_t>(object >> 8), layout.words * 2,
                                                  layout.variables);
        if (!place) continue;
        const bool is_receive = place->direction == module::VariableDirection::output;
        if (is_receive != received) continue;
        for (unsigned byte = 0; byte < std::max<unsigned>(place->size, 1); byte += 2) {
          const std::size_t word = (place->offset + byte) / 2U;
          const auto first = received ? layout.receive_first : layout.transmit_first;
          words.try_emplace(static_cast<std::uint16_t>(layout.address(first, word)),
                            ProcessWord{received, pdo + 1, cob_id.identifier()});
        }
      }
    }
  }
  return words;
}

WebViews::Source WebViews::source_of(const ProcessWord& word, const Senders& senders) {
  Source source{.pdo = fmt::format("{}PDO{}", word.received ? 'R' : 'T', word.pdo),
                .can_id = fmt::format("{:03X}", word.identifier)};
  if (const auto sender = senders.find(word.identifier); word.received && sender != senders.end())
    source.sender = sender->second;
  return source;
}

WebViews::Senders WebViews::senders_on(std::string_view bus) const {
  Senders senders;
  for (std::size_t i = 0; i < plant_.device_count(); ++i) {
    plant::DeviceOnBus& seat = plant_.device(i);
    const plant::NodeStatus status = seat.status();
    if (status.label.bus != bus) continue;
    const canopen::ObjectDictionary& objects = seat.device().node().dictionary();
    for (const canopen::ObjectDescription& object : objects.description().objects()) {
      if (object.index < 0x1800 || object.index >= 0x1A00) continue;
      const canopen::CobId cob_id = canopen::usable(
          canopen::CobId{objects.get<std::uint32_t>(object.index, 1, canopen::CobId::invalid_bit)});
      if (!cob_id.is_valid() || cob_id.is_extended()) continue;
      senders.try_emplace(cob_id.identifier(), fmt::format("node {} ({}) TPDO{}", status.label.node_id,
                                                           status.label.name, object.index - 0x1800 + 1));
    }
  }
  return senders;
}

std::string WebViews::boots_event() const {
  const can::Time now = plant_.timeline().now();
  Json event = plant::event_line(now, "boots");
  event["masters"] = Json::array();
  for (const plant::ModuleStatus& module : plant_.modules()) {
    if (module.start_up == module::StartUp::none) continue;
    event["masters"].push_back({{"bus", module.label.bus},
                                {"node", module.label.node_id},
                                {"name", module.label.name},
                                {"start_up", start_up_name(module.start_up)}});
  }
  event["slaves"] = Json::array();
  for (const auto& [key, slave] : boots_.slaves()) {
    Json one{{"bus", slave.bus}, {"node", slave.node_id}, {"name", slave.name}, {"master", slave.master}};
    one["steps"] = Json::array();
    for (const WebBoots::Step& step : slave.steps) {
      Json line{{"t", can::seconds(step.at)}};
      plant::add_boot(line, step.record, now);
      one["steps"].push_back(std::move(line));
    }
    event["slaves"].push_back(std::move(one));
  }
  return view_event(event);
}

}  // namespace canopus::web
