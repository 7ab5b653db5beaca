#include "canopus/cli/run/live_table.hpp"

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

void LiveTable::note(can::Time now, std::string_view text) {
  events_.push_back(fmt::format("{:>10.3f}  {}", can::seconds(now), text));
  if (events_.size() > kept_events) events_.pop_front();
}

void LiveTable::keep(RunMessage message) {
  if (error_output_ != nullptr) {
    RunMessages::print(message, *error_output_);
    message.is_printed = true;
  }
  messages_.add(std::move(message));
}

void LiveTable::lss_configured(const plant::NodeLabel& node, std::uint32_t bit_rate, can::Time now) {
  note(now, describe_lss(node, bit_rate));
}

void LiveTable::emergency(const plant::NodeLabel& node, const canopen::Emergency& message, can::Time now) {
  note(now, fmt::format("{}: EMCY {:04X}H, error register {:02X}H", describe(node), message.code,
                        message.error_register));
}

void LiveTable::unacknowledged(const plant::NodeLabel& node, can::Time now) {
  keep({now, describe_unacknowledged(node), false});
}

void LiveTable::bus_error(const plant::BusErrorEvent& error, can::Time now) {
  std::string text = fmt::format("{:.3f} s: {}", can::seconds(now), describe(error));
  bus_errors_.insert_or_assign(std::string(error.bus), std::move(text));
}

void LiveTable::controller_changed(const plant::NodeLabel& node, const can::ControllerReport& report,
                                   can::Time now) {
  note(now, describe_controller(node, report));
}

void LiveTable::nmt_state_changed(const plant::NodeLabel& node, canopen::NmtState state, can::Time now) {
  note(now, fmt::format("{}: {}", describe(node), canopen::name(state)));
}

void LiveTable::slave_boot_went_on(const plant::NodeLabel& slave, const plant::NodeLabel&,
                                   const manager::BootRecord& record, can::Time now) {
  if (record.step == manager::BootStep::booted) {
    note(now, fmt::format("{}: {}", describe(slave), manager::describe(record)));
  } else if (record.step == manager::BootStep::failed) {
    error(describe(slave), manager::explain(record, now), now);
  }
}

/// A warning of the plant file: the run has printed it before there was a table.
void LiveTable::warning(std::string_view source, std::string_view message, can::Time now) {
  messages_.add({now, fmt::format("{}: warning: {}", source, message), false, true});
}

void LiveTable::module_error(std::string_view, std::string_view source,
                             const module::ModuleErrorRecord& record) {
  keep({record.at, fmt::format("{}: {}", source, plant::describe(record)), true});
}

void LiveTable::error(std::string_view source, std::string_view message, can::Time now) {
  keep({now, fmt::format("{}: {}", source, message), true});
}

TableState LiveTable::look(can::Time now, can::Duration lag) {
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
  state.events.assign(events_.begin(), events_.end());
  state.servers = servers_;
  return state;
}

}  // namespace canopus::cli
