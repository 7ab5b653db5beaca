#pragma once
// What happens in a plant by the clock alone.

#include <chrono>

#include "canopus/can/bus.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plant {

/// Stops a PLC's CPU with an error, once.
class CpuErrorTimer final : public can::Ticker {
 public:
  CpuErrorTimer(plc::Rack& rack, can::Duration after) : rack_(rack), after_(after) {}

  /// The rack has been switched on.
  void powered(can::Time now) { at_ = can::later(now, after_); }
  void tick(can::Time now) override {
    at_ = can::never;
    rack_.fail_cpu(now);
  }
  can::Time deadline() const noexcept override { return at_; }

 private:
  plc::Rack& rack_;
  can::Duration after_;
  can::Time at_ = can::never;
};

/// Reports the load of a bus once a second.
class LoadReport final : public can::Ticker {
 public:
  LoadReport(const can::Bus& bus, PlantObserver& observer) : bus_(bus), observer_(observer) {}
  void tick(can::Time now) override {
    observer_.load(bus_.name(), bus_.load(now), now);
    next_ += std::chrono::seconds(1);
  }
  can::Time deadline() const noexcept override { return next_; }

 private:
  const can::Bus& bus_;
  PlantObserver& observer_;
  can::Time next_ = can::Time{} + std::chrono::seconds(1);
};

}  // namespace canopus::plant
