#include "canopus/cli/run/live_table.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/interface/event_records.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::cli {
namespace {

constexpr std::size_t kept_events = 8;
constexpr std::size_t shown_messages = 12;

}  // namespace

void LiveTable::on(const plant::Event& event) {
  std::visit([&](const auto& what) { add(what, event.time); }, event.what);
}

void LiveTable::note(can::Time now, std::string_view text) {
  Note note{.last = now, .text = std::string(text)};
  if (const auto same = std::ranges::find(events_, text, &Note::text); same != events_.end()) {
    note.count += same->count;
    events_.erase(same);
  }
  events_.push_back(std::move(note));
  if (events_.size() > kept_events) events_.pop_front();
}

void LiveTable::add_message(RunMessage message) {
  if (error_output_ != nullptr) {
    RunMessages::print(message, *error_output_);
    message.is_printed = true;
  }
  messages_.add(std::move(message));
}

void LiveTable::add(const plant::LssSetting& event, can::Time now) {
  note(now, describe_lss(event.node, event.bit_rate));
}

void LiveTable::add(const plant::EmergencySent& event, can::Time now) {
  note(now, fmt::format("{}: EMCY {:04X}H, error register {:02X}H", describe(event.node), event.message.code,
                        event.message.error_register));
}

void LiveTable::add(const plant::MissingAck& event, can::Time now) {
  add_message({now, describe_unacknowledged(event.node), false});
}

void LiveTable::add(const plant::BusErrorEvent& event, can::Time now) {
  std::string text = fmt::format("{:.3f} s: {}", can::seconds(now), describe(event));
  bus_errors_.insert_or_assign(std::string(event.bus), std::move(text));
}

void LiveTable::add(const plant::ControllerChange& event, can::Time now) {
  note(now, describe_controller(event.node, event.report));
}

void LiveTable::add(const plant::NmtStateChange& event, can::Time now) {
  note(now, fmt::format("{}: {}", describe(event.node), canopen::name(event.state)));
}

void LiveTable::add(const plant::SlaveBootStep& event, can::Time now) {
  if (event.record.step == manager::BootStep::booted) {
    note(now, fmt::format("{}: {}", describe(event.slave), manager::describe(event.record)));
  } else if (event.record.step == manager::BootStep::failed) {
    add(plant::Failure{describe(event.slave), manager::explain(event.record, now)}, now);
  }
}

/// The run has printed a warning of the plant file before there was a table.
void LiveTable::add(const plant::Warning& event, can::Time now) {
  if (now != can::Time{})
    return add_message({now, fmt::format("{}: warning: {}", event.source, event.message), false});
  messages_.add({now, fmt::format("{}: warning: {}", event.source, event.message), false, true});
}

void LiveTable::add(const plant::ModuleError& event, can::Time) {
  add_message({event.record.at, fmt::format("{}: {}", event.module, plant::describe(event.record)), true});
}

void LiveTable::add(const plant::Failure& event, can::Time now) {
  add_message({now, fmt::format("{}: {}", event.source, event.message), true});
}

TableState LiveTable::state(can::Time now, can::Duration lag) {
  TableState state{.plant = plant_->name(), .now = now, .lag = lag};
  if (state.plant.empty()) state.plant = std::filesystem::path(plant_->file().path).filename().string();
  for (std::size_t i = 0; i < plant_->bus_count(); ++i) {
    const can::Bus& bus = plant_->bus(i);
    const auto error = bus_errors_.find(bus.name());
    state.buses.push_back({.name = bus.name(),
                           .bit_rate = bus.bit_rate(),
                           .load = bus.load(now),
                           .last_error = error == bus_errors_.end() ? "" : error->second});
  }
  for (const plant::NodeStatus& status : plant_->nodes()) state.nodes.push_back({status});
  counts_.resize(state.nodes.size());
  const double span = can::seconds(can::Time{} + (now - counted_at_));
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (span >= 1) {
      counts_[i].rate = static_cast<double>(state.nodes[i].status.pdos - counts_[i].pdos) / span;
      counts_[i].pdos = state.nodes[i].status.pdos;
    }
    state.nodes[i].pdo_rate = counts_[i].rate;
  }
  if (span >= 1) counted_at_ = now;
  state.boots = plant_->boots();
  state.troubles = plant_->troubles();
  state.forced = plant_->forced();
  state.modules = plant_->modules();
  state.messages = messages_.latest(shown_messages);
  state.errors = messages_.errors();
  state.warnings = messages_.warnings();
  for (const auto& [last, text, count] : events_) {
    state.events.push_back(fmt::format("{:>10.3f}  {}{}", can::seconds(last), text,
                                       count == 1 ? "" : fmt::format(" ×{}", count)));
  }
  state.servers = servers_;
  return state;
}

}  // namespace canopus::cli
