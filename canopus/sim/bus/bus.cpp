#include "canopus/sim/bus/bus.hpp"

#include <algorithm>
#include <utility>

#include "canopus/sim/bus/bus_core.hpp"
#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {

struct Bus::Inside {
  Inside(std::string name, std::uint32_t bit_rate, can::Timeline& timeline)
      : core(std::move(name), bit_rate, timeline), near(core, true), far(core, false) {}

  void run_spells(can::Time now);
  void begin(FaultPlan::Spell& spell, can::Time now);
  void end(FaultPlan::Spell& spell, can::Time now);
  void babble(FaultPlan::Spell& spell, can::Time now);
  void set_babble(BusPort& port, const FaultPlan::Spell& spell);
  [[nodiscard]] const FaultPlan::Spell* other_spell(FaultKind kind, const BusPort& port);
  void move(BusPort& port, Segment& to);
  void release_delayed(can::Time now);

  BusCore core;
  Segment near;  // the wire, or the near side of a cut
  Segment far;   // has ports only while the wire is cut
};

Bus::Bus(std::string name, std::uint32_t bit_rate, can::Timeline& timeline)
    : inside_(std::make_unique<Inside>(std::move(name), bit_rate, timeline)) {
  inside_->core.handle = timeline.add(*this, "bus " + inside_->core.name, can::Timeline::Rank::bus);
}

Bus::~Bus() { inside_->core.timeline.remove(inside_->core.handle); }

const std::string& Bus::name() const noexcept { return inside_->core.name; }
std::uint32_t Bus::bit_rate() const noexcept { return inside_->core.bit_rate; }

Port& Bus::add_port(std::string name) {
  BusCore& core = inside_->core;
  Segment& segment = inside_->near;
  const std::size_t index = core.ports.size();
  core.acceptance.resize(index + 1);
  core.ports.push_back(std::make_unique<BusPort>(core, segment, index, std::move(name)));
  inside_->near.resize();
  inside_->far.resize();
  if (core.timeline.now() == core.created && !segment.busy()) {
    segment.reconsider();  // there from the beginning
  } else {
    segment.before_change();
    segment.restart(*core.ports.back());
    segment.after_change();
  }
  return *core.ports.back();
}

std::vector<const Port*> Bus::ports() const {
  std::vector<const Port*> all;
  for (const auto& port : inside_->core.ports) all.push_back(port.get());
  return all;
}

void Bus::set_observer(BusObserver* observer) {
  inside_->core.observers.clear();
  if (observer != nullptr) add_observer(*observer);
}

void Bus::add_observer(BusObserver& observer) { inside_->core.observers.push_back(&observer); }
void Bus::remove_observer(BusObserver& observer) { std::erase(inside_->core.observers, &observer); }

void Bus::add_observer(WireObserver& observer) {
  inside_->near.before_change();
  inside_->core.wire_observers.push_back(&observer);
  inside_->near.after_change();
}
void Bus::remove_observer(WireObserver& observer) { std::erase(inside_->core.wire_observers, &observer); }

BusLoad Bus::load(can::Time now) const { return inside_->core.statistics.load(now); }
std::uint64_t Bus::frames_of(std::uint32_t identifier, bool extended) const {
  return inside_->core.statistics.frames_of(identifier, extended);
}

std::expected<void, std::string> Bus::set_faults(const std::vector<Fault>& faults, std::uint64_t seed) {
  BusCore& core = inside_->core;
  auto plan = FaultPlan::make(faults, seed, core);
  if (!plan) return std::unexpected(plan.error());
  const can::Time now = core.timeline.now();
  for (FaultPlan::Spell& spell : core.plan.spells()) {
    if (spell.active) inside_->end(spell, now);
  }
  core.plan = std::move(*plan);
  inside_->near.clear_faults();
  inside_->far.clear_faults();
  core.refresh();
  return {};
}

void Bus::tick(can::Time now) {
  inside_->core.ticking = true;
  if (!inside_->core.delayed.empty()) inside_->release_delayed(now);
  if (inside_->core.plan.next() <= now) inside_->run_spells(now);
  inside_->near.tick(now);
  inside_->far.tick(now);
  inside_->core.ticking = false;
  inside_->core.ticked = now;
}

can::Time Bus::deadline() const noexcept {
  can::Time next = std::min(inside_->near.deadline(), inside_->far.deadline());
  next = std::min(next, inside_->core.plan.next());
  for (const BusCore::Delayed& delayed : inside_->core.delayed) next = std::min(next, delayed.until);
  return next;
}

void Bus::Inside::release_delayed(can::Time now) {
  for (std::size_t number = 0; number < core.delayed.size();) {
    const BusCore::Delayed delayed = core.delayed[number];
    if (delayed.until > now) {
      ++number;
      continue;
    }
    core.delayed.erase(core.delayed.begin() + static_cast<std::ptrdiff_t>(number));
    delayed.port->enqueue(delayed.frame);
  }
}

void Bus::Inside::run_spells(can::Time now) {
  for (FaultPlan::Spell& spell : core.plan.spells()) {
    if (!spell.active && spell.fault.from <= now) begin(spell, now);
    if (spell.active && spell.fault.until <= now) end(spell, now);
    if (spell.active && spell.next_babble <= now) babble(spell, now);
  }
}

void Bus::Inside::begin(FaultPlan::Spell& spell, can::Time now) {
  spell.active = true;
  switch (spell.fault.kind) {
    case FaultKind::babble:
      for (BusPort* port : spell.ports) set_babble(*port, spell);
      babble(spell, now);
      break;
    case FaultKind::jam:
      for (BusPort* port : spell.ports) {
        port->jammed = true;
        port->held_capacity = spell.fault.capacity;
        port->held.reserve(spell.fault.capacity);
      }
      break;
    case FaultKind::stuck_dominant:
      for (BusPort* port : spell.ports) {
        port->segment->before_change();
        port->stuck = true;
        port->segment->after_change();
      }
      break;
    case FaultKind::cut:
      for (BusPort* port : spell.ports) move(*port, far);
      break;
    default: break;  // about frames
  }
}

void Bus::Inside::set_babble(BusPort& port, const FaultPlan::Spell& spell) {
  port.segment->keep_offer(port);
  port.babbling = true;
  port.babble_always = spell.fault.interval == can::Duration{};
  port.babble = spell.fault.frame;
}

/// A fault of this kind that the port has at this time.
const FaultPlan::Spell* Bus::Inside::other_spell(FaultKind kind, const BusPort& port) {
  for (const FaultPlan::Spell& spell : core.plan.spells()) {
    const bool has_port = std::find(spell.ports.begin(), spell.ports.end(), &port) != spell.ports.end();
    if (spell.active && spell.fault.kind == kind && has_port) return &spell;
  }
  return nullptr;
}

void Bus::Inside::end(FaultPlan::Spell& spell, can::Time now) {
  spell.active = false;
  spell.fault.from = can::never;
  for (BusPort* port : spell.ports) {
    if (const FaultPlan::Spell* other = other_spell(spell.fault.kind, *port)) {
      if (spell.fault.kind == FaultKind::babble) set_babble(*port, *other);
      continue;
    }
    switch (spell.fault.kind) {
      case FaultKind::babble:
        port->segment->keep_offer(*port);
        port->babbling = port->babble_due = false;
        port->segment->offer_changed(*port);
        break;
      case FaultKind::jam: {
        port->jammed = false;
        std::vector<can::Frame> held;
        held.swap(port->held);
        for (const can::Frame& frame : held) port->hear(frame, now);
        break;
      }
      case FaultKind::stuck_dominant:
        port->segment->before_change();
        port->stuck = false;
        port->segment->after_change();
        break;
      case FaultKind::cut: move(*port, near); break;
      default: break;  // about frames
    }
  }
}

void Bus::Inside::babble(FaultPlan::Spell& spell, can::Time now) {
  for (BusPort* port : spell.ports) {
    set_babble(*port, spell);
    port->babble_due = true;
    port->segment->offer_changed(*port);
  }
  const can::Duration interval = spell.fault.interval;
  spell.next_babble = interval > can::Duration{} ? can::later(now, interval) : can::never;
}

/// The port keeps what its controller is doing and finds itself on another wire.
void Bus::Inside::move(BusPort& port, Segment& to) {
  Segment& from = *port.segment;
  if (&from == &to) return;
  from.before_change();
  to.before_change();
  port.segment = &to;
  to.arrive(port, from);
  from.after_change();
  to.after_change();
}

}  // namespace canopus::sim
