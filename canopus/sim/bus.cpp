#include "canopus/sim/bus.hpp"

#include <algorithm>
#include <utility>

#include "canopus/sim/bus_core.hpp"
#include "canopus/sim/segment.hpp"

namespace canopus::sim {

struct Bus::Wire {
  Wire(std::string name, std::uint32_t bit_rate, can::Timeline& timeline)
      : core(std::move(name), bit_rate, timeline), segment(core) {}
  BusCore core;
  Segment segment;
};

Bus::Bus(std::string name, std::uint32_t bit_rate, can::Timeline& timeline)
    : wire_(std::make_unique<Wire>(std::move(name), bit_rate, timeline)) {
  wire_->core.handle = timeline.add(*this, can::Timeline::Rank::bus);
}

Bus::~Bus() { wire_->core.timeline.remove(wire_->core.handle); }

const std::string& Bus::name() const noexcept { return wire_->core.name; }
std::uint32_t Bus::bit_rate() const noexcept { return wire_->core.bit_rate; }

Port& Bus::add_port(std::string name) {
  BusCore& core = wire_->core;
  const std::size_t index = core.ports.size();
  core.acceptance.resize(index + 1);
  core.ports.push_back(std::make_unique<BusPort>(core, wire_->segment, index, std::move(name)));
  Segment& segment = wire_->segment;
  segment.resize();
  if (core.timeline.now() == core.created && !segment.busy()) {
    segment.reconsider();  // there from the beginning
  } else {
    segment.before_change();
    segment.restart(*core.ports.back());
    segment.after_change();
  }
  return *core.ports.back();
}

void Bus::set_observer(BusObserver* observer) {
  wire_->core.observers.clear();
  if (observer != nullptr) add_observer(*observer);
}

void Bus::add_observer(BusObserver& observer) { wire_->core.observers.push_back(&observer); }
void Bus::remove_observer(BusObserver& observer) { std::erase(wire_->core.observers, &observer); }

void Bus::add_observer(WireObserver& observer) {
  wire_->segment.before_change();
  wire_->core.wire_observers.push_back(&observer);
  wire_->segment.after_change();
}
void Bus::remove_observer(WireObserver& observer) { std::erase(wire_->core.wire_observers, &observer); }

BusLoad Bus::load(can::Time now) const { return wire_->core.statistics.load(now); }
std::uint64_t Bus::frames_of(std::uint32_t identifier, bool extended) const {
  return wire_->core.statistics.frames_of(identifier, extended);
}

void Bus::tick(can::Time now) {
  wire_->core.ticking = true;
  wire_->segment.tick(now);
  wire_->core.ticking = false;
}

can::Time Bus::deadline() const noexcept { return wire_->segment.deadline(); }

}  // namespace canopus::sim
