#include "canopus/sim/bus/bus.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "canopus/sim/bus/bus_core.hpp"
#include "canopus/sim/bus/line/line_clocks.hpp"
#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {

BusCore::BusCore(std::string bus_name, std::uint32_t bus_bit_rate, can::Timeline& bus_timeline,
                 BusSchedule& bus_schedule)
    : name(std::move(bus_name)),
      bit_rate(bus_bit_rate),
      created(bus_timeline.now()),
      timeline(bus_timeline),
      schedule(bus_schedule) {}
BusCore::~BusCore() = default;

struct Bus::Impl final : can::Ticker, BusSchedule {
  Impl(std::string name, std::uint32_t bit_rate, can::Timeline& timeline)
      : core(std::move(name), bit_rate, timeline, *this), near(core, true), far(core, false) {}

  void tick(can::Time now) override;
  void run_faults(can::Time now);
  void deadline_changed() noexcept override { alarm() = next(); }
  [[nodiscard]] can::Time next() const noexcept {
    return core.had_faults ? next_with_faults() : near.deadline();
  }
  [[nodiscard]] can::Time next_with_faults() const noexcept;
  [[nodiscard]] can::Time next_of_faults() const noexcept;
  void run_timed_faults(can::Time now);
  void act(FaultPlan::TimedFault& timed, can::Time now);
  void begin(FaultPlan::TimedFault& timed, can::Time now);
  void end(FaultPlan::TimedFault& timed, can::Time now);
  void babble(FaultPlan::TimedFault& timed, can::Time now);
  void set_babble(BusPort& port, const FaultPlan::TimedFault& timed);
  void make_noise(FaultPlan::TimedFault& timed, can::Time now);
  void invert(FaultPlan::TimedFault& timed);
  [[nodiscard]] can::Time after_bits(can::Time now, std::uint64_t bits) const;
  static void set_port_fault(BusPort& port, const Fault& fault, bool begins);
  void set_termination(const Termination& termination);
  [[nodiscard]] const FaultPlan::TimedFault* other_timed_fault(FaultKind kind, const BusPort& port);
  void move(BusPort& port, Segment& to);
  void release_delayed(can::Time now);
  void run_driver(can::Time now);

  BusCore core;
  Segment near;  // the wire, or the near side of a cut
  Segment far;   // has ports only while the wire is cut
};

Bus::Bus(std::string name, std::uint32_t bit_rate, can::Timeline& timeline)
    : impl_(std::make_unique<Impl>(std::move(name), bit_rate, timeline)) {
  impl_->deadline_changed();
  timeline.add(*impl_, "bus " + impl_->core.name, can::Timeline::Rank::bus);
}

Bus::~Bus() = default;

const std::string& Bus::name() const noexcept { return impl_->core.name; }
std::uint32_t Bus::bit_rate() const noexcept { return impl_->core.bit_rate; }

Port& Bus::add_port(std::string name) {
  BusCore& core = impl_->core;
  Segment& segment = impl_->near;
  const auto index = static_cast<std::uint32_t>(core.ports.size());
  core.acceptance.resize(index + 1);
  core.ports.push_back(std::make_unique<BusPort>(core, segment, index, std::move(name)));
  if (core.clocks != nullptr) core.clocks->add(core.ports.back()->name(), core.bit_rate, core.timeline.now());
  impl_->near.resize();
  impl_->far.resize();
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
  for (const auto& port : impl_->core.ports) all.push_back(port.get());
  return all;
}

void Bus::set_observer(BusObserver* observer) {
  impl_->core.observers.clear();
  if (observer != nullptr) add_observer(*observer);
}

void Bus::add_observer(BusObserver& observer) { impl_->core.observers.push_back(&observer); }
void Bus::remove_observer(BusObserver& observer) { std::erase(impl_->core.observers, &observer); }

void Bus::add_observer(WireObserver& observer) {
  impl_->near.before_change();
  impl_->far.before_change();
  if (impl_->core.wire_observers.empty()) {
    for (const auto& port : impl_->core.ports) port->shown_dominant = false;
  }
  impl_->core.wire_observers.push_back(&observer);
  impl_->near.after_change();
  impl_->far.after_change();
}
void Bus::remove_observer(WireObserver& observer) { std::erase(impl_->core.wire_observers, &observer); }

void Bus::report_wire() { impl_->near.report_wire(); }  // while the far side has anybody, all goes bit by bit

bool Bus::can_be_cut() const noexcept {
  const auto& faults = impl_->core.plan.timed_faults();
  return std::any_of(faults.begin(), faults.end(),
                     [](const FaultPlan::TimedFault& timed) { return timed.fault.kind == FaultKind::cut; });
}

bool Bus::is_cut_off(const Port& port) const noexcept {
  return std::ranges::any_of(impl_->core.ports, [&](const auto& one) {
    return one.get() == &port && (!one->plugged() || one->segment == &impl_->far);
  });
}

can::Duration Bus::time_grid() const noexcept {
  const BusCore& core = impl_->core;
  if (core.clocks != nullptr) return can::Duration(1);
  const auto with_bit = [](can::Duration grid, can::Duration bit) {
    return can::Duration(std::gcd(std::gcd(grid.count(), bit.count()), after_sample_point(bit).count()));
  };
  can::Duration grid = with_bit(core.plan.time_grid(), can::bit_time(1, core.bit_rate));
  for (const auto& port : core.ports) grid = with_bit(grid, port->bit());
  return grid;
}

void Bus::set_line(const Line& line) {
  BusCore& core = impl_->core;
  impl_->near.before_change();
  impl_->far.before_change();
  core.clocks = std::make_unique<LineClocks>(line);
  for (const auto& port : core.ports) {
    core.clocks->add(port->name(), core.bit_rate, core.timeline.now());
    if (!port->bits.idle()) port->segment->restart(*port);
  }
  impl_->near.after_change();
  impl_->far.after_change();
}

BusLoad Bus::load(can::Time now) const {
  return impl_->core.statistics.load(now, {impl_->near.busy_since(), impl_->far.busy_since()});
}
std::uint64_t Bus::frames_of(std::uint32_t identifier, bool extended) const {
  return impl_->core.statistics.frames_of(identifier, extended);
}

std::expected<void, std::string> Bus::set_faults(const std::vector<Fault>& faults, std::uint64_t seed) {
  BusCore& core = impl_->core;
  auto plan = FaultPlan::make(faults, seed, core);
  if (!plan) return std::unexpected(plan.error());
  const can::Time now = core.timeline.now();
  for (FaultPlan::TimedFault& timed : core.plan.timed_faults()) {
    if (timed.active) impl_->end(timed, now);
  }
  impl_->near.drive({});
  core.plan = std::move(*plan);
  core.had_faults = core.had_faults || !faults.empty();
  impl_->near.clear_faults();
  impl_->far.clear_faults();
  core.deadline_changed();
  return {};
}

std::vector<FaultState> Bus::fault_states() const { return impl_->core.plan.states(); }

void Bus::Impl::tick(can::Time now) {
  core.ticking = true;
  if (core.had_faults) [[unlikely]] {
    run_faults(now);
    near.tick(now);
    far.tick(now);
  } else {
    near.tick(now);  // nothing is on the far side of a wire that was never cut
  }
  core.ticking = false;
  core.ticked = now;
  alarm() = next();
}

can::Time Bus::Impl::next_with_faults() const noexcept {
  return std::min({near.deadline(), far.deadline(), next_of_faults()});
}

void Bus::Impl::run_faults(can::Time now) {
  if (!core.delayed.empty()) release_delayed(now);
  if (core.plan.next() <= now) run_timed_faults(now);
  if (core.plan.driver().next() <= now) run_driver(now);
}

can::Time Bus::Impl::next_of_faults() const noexcept {
  can::Time next = std::min(core.plan.next(), core.plan.driver().next());
  for (const BusCore::Delayed& delayed : core.delayed) next = std::min(next, delayed.until);
  return next;
}

void Bus::Impl::release_delayed(can::Time now) {
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

void Bus::Impl::run_driver(can::Time now) {
  BitDriver& driver = core.plan.driver();
  if (driver.run(now)) near.drive({.is_busy = driver.is_busy(), .level = driver.level()});
}

void Bus::Impl::run_timed_faults(can::Time now) {
  for (FaultPlan::TimedFault& timed : core.plan.timed_faults()) {
    if (!timed.active && timed.fault.from <= now) begin(timed, now);
    if (timed.active && timed.fault.until <= now) end(timed, now);
    if (timed.active && timed.next_act <= now) act(timed, now);
  }
}

void Bus::Impl::act(FaultPlan::TimedFault& timed, can::Time now) {
  if (timed.fault.kind == FaultKind::babble) {
    babble(timed, now);
  } else {
    make_noise(timed, now);
  }
}

void Bus::Impl::begin(FaultPlan::TimedFault& timed, can::Time now) {
  timed.active = true;
  switch (timed.fault.kind) {
    case FaultKind::babble:
      for (BusPort* port : timed.ports) set_babble(*port, timed);
      babble(timed, now);
      break;
    case FaultKind::jam:
      for (BusPort* port : timed.ports) {
        port->jammed = true;
        port->held_capacity = timed.fault.capacity;
        port->held.reserve(timed.fault.capacity);
      }
      break;
    case FaultKind::stuck_dominant:
    case FaultKind::stuck_recessive:
    case FaultKind::late:
    case FaultKind::overload:
    case FaultKind::single_shot:
    case FaultKind::early:
      for (BusPort* port : timed.ports) set_port_fault(*port, timed.fault, true);
      break;
    case FaultKind::cut:
      for (BusPort* port : timed.ports) move(*port, far);
      break;
    case FaultKind::noise: timed.next_act = after_bits(now, timed.bits_to_next_hit()); break;
    case FaultKind::termination:
      set_termination(termination(timed.fault.resistors, timed.fault.length, core.ports.size()));
      break;
    default: break;  // about frames
  }
}

void Bus::Impl::set_babble(BusPort& port, const FaultPlan::TimedFault& timed) {
  port.segment->snapshot_pending(port);
  port.babbling = true;
  port.babble_always = timed.fault.interval == can::Duration{};
  port.babble = timed.fault.frame;
}

/// A fault of this kind that the port has at this time.
const FaultPlan::TimedFault* Bus::Impl::other_timed_fault(FaultKind kind, const BusPort& port) {
  for (const FaultPlan::TimedFault& timed : core.plan.timed_faults()) {
    const bool has_port = std::find(timed.ports.begin(), timed.ports.end(), &port) != timed.ports.end();
    if (timed.active && timed.fault.kind == kind && has_port) return &timed;
  }
  return nullptr;
}

void Bus::Impl::end(FaultPlan::TimedFault& timed, can::Time now) {
  timed.active = false;
  timed.fault.from = can::never;
  for (BusPort* port : timed.ports) {
    if (const FaultPlan::TimedFault* other = other_timed_fault(timed.fault.kind, *port)) {
      if (timed.fault.kind == FaultKind::babble) {
        set_babble(*port, *other);
        port->segment->offer_changed(*port);
      } else if (timed.fault.kind != FaultKind::jam && timed.fault.kind != FaultKind::cut) {
        set_port_fault(*port, other->fault, true);
      }
      continue;
    }
    switch (timed.fault.kind) {
      case FaultKind::babble:
        port->segment->snapshot_pending(*port);
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
      case FaultKind::cut: move(*port, near); break;
      default: set_port_fault(*port, timed.fault, false); break;
    }
  }
  if (timed.is_inverting) invert(timed);
  if (timed.fault.kind == FaultKind::termination) set_termination({});
}

void Bus::Impl::set_termination(const Termination& termination) {
  near.set_termination(termination);
  far.set_termination(termination);
}

/// One bit of noise begins or ends.
void Bus::Impl::make_noise(FaultPlan::TimedFault& timed, can::Time now) {
  std::uint64_t good_bits = 0;
  if (timed.is_inverting) good_bits = timed.bits_to_next_hit();
  if (!timed.is_inverting || good_bits > 0) invert(timed);
  timed.next_act = after_bits(now, timed.is_inverting ? 1 : good_bits);
}

void Bus::Impl::invert(FaultPlan::TimedFault& timed) {
  timed.is_inverting = !timed.is_inverting;
  if (timed.ports.empty()) {
    near.invert();
    far.invert();
    return;
  }
  for (BusPort* port : timed.ports) {
    port->segment->before_change();
    port->inverted = !port->inverted;
    port->segment->after_change();
  }
}

can::Time Bus::Impl::after_bits(can::Time now, std::uint64_t bits) const {
  return can::later(now, can::bit_time(1, core.bit_rate) * static_cast<std::int64_t>(bits));
}

/// A fault of a port's controller or driver begins or ends.
void Bus::Impl::set_port_fault(BusPort& port, const Fault& fault, bool begins) {
  port.segment->before_change();
  switch (fault.kind) {
    case FaultKind::stuck_dominant: port.stuck = begins; break;
    case FaultKind::stuck_recessive: port.mute = begins; break;
    case FaultKind::late: port.lateness = begins ? fault.delay : can::Duration{}; break;
    case FaultKind::overload:
      port.overload_frames = begins ? fault.overload_frames : 0;
      port.bits.set_overload_frames(port.overload_frames);
      break;
    case FaultKind::single_shot: port.single_shot = begins; break;
    case FaultKind::early:
      port.early_bits = begins ? fault.early_bits : 0;
      port.bits.set_early_bits(port.early_bits);
      break;
    default: break;
  }
  port.segment->after_change();
}

void Bus::Impl::babble(FaultPlan::TimedFault& timed, can::Time now) {
  for (BusPort* port : timed.ports) {
    set_babble(*port, timed);
    port->babble_due = true;
    port->segment->offer_changed(*port);
  }
  const can::Duration interval = timed.fault.interval;
  timed.next_act = interval > can::Duration{} ? can::later(now, interval) : can::never;
}

/// The port keeps what its controller is doing and finds itself on another wire.
void Bus::Impl::move(BusPort& port, Segment& to) {
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
