#pragma once
// What happens in a plant by the clock alone.

#include <chrono>
#include <memory>
#include <vector>

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

/// Reports the load of every bus once a second.
class LoadReport final : public can::Ticker {
 public:
  LoadReport(std::vector<std::unique_ptr<can::Bus>>& buses, PlantObserver& observer)
      : buses_(buses), observer_(observer) {}
  void tick(can::Time now) override {
    for (const auto& bus : buses_) observer_.load(bus->name(), bus->load(now), now);
    next_ += std::chrono::seconds(1);
  }
  can::Time deadline() const noexcept override { return next_; }

 private:
  std::vector<std::unique_ptr<can::Bus>>& buses_;
  PlantObserver& observer_;
  can::Time next_ = can::Time{} + std::chrono::seconds(1);
};

}  // namespace canopus::plant
