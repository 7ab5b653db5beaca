#pragma once
// The components of a plant, and its construction from its file.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/module/interface/non_volatile_memory.hpp"
#include "canopus/plant/bus_bridge.hpp"
#include "canopus/plant/deferred_events.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/lift_on_bus.hpp"
#include "canopus/plant/module_in_rack.hpp"
#include "canopus/plant/node_registry.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plant/plant_partitioning.hpp"
#include "canopus/plant/plant_stores.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/plc/rack/module_refresh.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/sim/bus/bus.hpp"

namespace canopus::plant {

/// Stops a PLC's CPU with an error, once.
class CpuErrorTimer final : public can::Ticker {
 public:
  CpuErrorTimer(plc::Rack& rack, can::Duration after) : rack_(rack), after_(after) {}

  /// The rack has been switched on.
  void powered(can::Time now) { alarm() = can::later(now, after_); }
  void tick(can::Time now) override {
    alarm().cancel();
    rack_.fail_cpu(now);
  }

 private:
  plc::Rack& rack_;
  can::Duration after_;
};

/// Reports the load of a bus once a second.
class LoadReport final : public can::Ticker {
 public:
  LoadReport(const can::Bus& bus, PlantObserver& observer) : bus_(bus), observer_(observer) {
    alarm() = can::Time{} + period;
  }
  void tick(can::Time now) override {
    observer_.on({now, LoadMeasured{bus_.name(), bus_.load(now)}});
    alarm() = deadline() + period;
  }

 private:
  const can::Bus& bus_;
  static constexpr can::Duration period = std::chrono::seconds(1);
  PlantObserver& observer_;
};

struct Plant::Parts {
  PlantFile file;
  can::Timeline timeline;
  PlantPartitioning division;
  std::vector<std::unique_ptr<DeferredEvents>> events;  // of each part; of a plant without buses: one
  std::vector<std::unique_ptr<can::Bus>> buses;
  std::vector<sim::Bus*> simulated;  // of each bus; null: it is another one
  std::vector<std::unique_ptr<BusBridge>> bridges;
  std::vector<std::unique_ptr<NodeRegistry>> watches;
  std::vector<std::unique_ptr<LiftOnBus>> lifts;
  std::vector<std::unique_ptr<DeviceOnBus>> devices;
  std::vector<const can::Port*> device_ports;  // of each device
  std::vector<std::unique_ptr<ModuleInRack>> modules;
  std::vector<const can::Port*> module_ports;  // of each module
  std::vector<std::unique_ptr<plc::Rack>> racks;
  std::vector<std::unique_ptr<module::NonVolatileMemory>> program_memories;
  std::vector<std::unique_ptr<plc::ProgramExecution>>
      executions;  // of each rack; null: it has no program of the user
  std::vector<std::unique_ptr<plc::ModuleRefresh>> refreshes;
  std::vector<std::unique_ptr<CpuErrorTimer>> cpu_errors;
  std::vector<std::unique_ptr<LoadReport>> load_reports;
  std::vector<std::string> connections;
  std::vector<text::FileWarning> warnings;
  std::optional<PlantStores> stores;
  std::atomic<bool> has_stalled = false;

  /// The timeline of a partition. A plant with one partition uses the timeline of the whole.
  can::Timeline& timeline_of(std::size_t part) {
    return timeline.partition_count() == 0 ? timeline : timeline.partition(part);
  }

  can::Bus& bus(std::string_view name) {
    return **std::ranges::find_if(buses, [&](const auto& bus) { return bus->name() == name; });
  }
};

/// Opens the device files and fills `parts` from parts.file. All errors are found at once.
[[nodiscard]] std::vector<text::FileError> assemble(Plant::Parts& parts, PlantObserver& observer,
                                                    std::uint64_t seed, BusOpener* opener);

}  // namespace canopus::plant
