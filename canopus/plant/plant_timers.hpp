#pragma once
// Events of a plant at fixed times.

#include <chrono>

#include "canopus/can/bus.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/rack/rack.hpp"

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

}  // namespace canopus::plant
