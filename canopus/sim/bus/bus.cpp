#include "canopus/sim/bus/bus.hpp"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>

#include "canopus/sim/bus/fault_actions.hpp"
#include "canopus/sim/bus/line/line_clocks.hpp"
#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {

struct Bus::Impl final : can::Ticker, BusSchedule {
  Impl(std::string name, std::uint32_t bit_rate, can::Timeline& timeline)
      : core(std::move(name), bit_rate, timeline, *this), near(core, true), far(core, false) {}

  void tick(can::Time now) override;
  void deadline_changed() noexcept override { alarm() = next(); }
  [[nodiscard]] can::Time next() const noexcept {
    return core.had_faults ? next_with_faults() : near.deadline;
  }
  [[nodiscard]] can::Time next_with_faults() const noexcept;

  BusCore core;
  Segment near;  // the wire, or the near side of a cut
  Segment far;   // has ports only while the wire is cut
  FaultActions faults{core, near, far};
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
  if (core.timeline.now() == core.created && !segment.is_busy()) {
    segment.update_members();  // there from the beginning
  } else {
    segment.before_change();
    core.ports.back()->start_controller();
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
    for (const auto& port : impl_->core.ports) port->reported_dominant = false;
  }
  impl_->core.wire_observers.push_back(&observer);
  impl_->near.after_change();
  impl_->far.after_change();
}
void Bus::remove_observer(WireObserver& observer) { std::erase(impl_->core.wire_observers, &observer); }

void Bus::report_wire() { impl_->near.report_wire(); }  // while the far side has ports, all goes bit by bit

bool Bus::can_be_cut() const noexcept {
  const auto& faults = impl_->core.plan.timed_faults();
  return std::any_of(faults.begin(), faults.end(),
                     [](const FaultPlan::TimedFault& timed) { return timed.fault.kind == FaultKind::cut; });
}

bool Bus::is_cut_off(const Port& port) const noexcept {
  return std::ranges::any_of(impl_->core.ports, [&](const auto& one) {
    return one.get() == &port && (!one->plugged() || impl_->far.has(*one));
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
    if (!port->bits.idle()) port->start_controller();
  }
  impl_->near.after_change();
  impl_->far.after_change();
}

BusLoad Bus::load(can::Time now) const {
  return impl_->core.statistics.load(now, {impl_->near.busy_since(), impl_->far.busy_since()});
}

std::vector<BusSide> Bus::sides(can::Time now) const {
  BusCore& core = impl_->core;
  const bool is_cut = std::ranges::any_of(core.plan.timed_faults(), [](const FaultPlan::TimedFault& timed) {
    return timed.active && timed.fault.kind == FaultKind::cut;
  });
  if (!is_cut) return {};
  const BusLoad all = load(now);
  const BusLoad far = core.far_statistics.load(now, {impl_->far.busy_since()});
  std::vector<BusSide> sides{{.now = std::max(all.now - far.now, 0.0),
                              .frames = all.frames - far.frames,
                              .error_frames = all.error_frames - far.error_frames},
                             {.now = far.now, .frames = far.frames, .error_frames = far.error_frames}};
  for (const auto& port : core.ports) {
    if (port->plugged()) sides[impl_->far.has(*port) ? 1 : 0].ports.push_back(port->name());
  }
  return sides;
}

std::uint64_t Bus::frames_of(std::uint32_t identifier, bool extended) const {
  return impl_->core.statistics.frames_of(identifier, extended);
}

std::expected<void, std::string> Bus::set_faults(const std::vector<Fault>& faults, std::uint64_t seed) {
  BusCore& core = impl_->core;
  const auto port_named = [&core](std::string_view wanted) -> BusPort* {
    for (const auto& port : core.ports) {
      if (port->name() == wanted) return port.get();
    }
    return nullptr;
  };
  auto plan = FaultPlan::make(
      faults, seed,
      {.bus_name = core.name, .bit = can::bit_time(1, core.bit_rate), .port_named = port_named});
  if (!plan) return std::unexpected(plan.error());
  impl_->faults.end_all(core.timeline.now());
  core.plan = std::move(*plan);
  if (!core.had_faults && !faults.empty()) {
    core.had_faults = true;
    if (impl_->far.deadline < core.timeline.now()) {  // without faults the far side has no ticks
      impl_->far.before_change();
      impl_->far.after_change();
    }
  }
  impl_->near.cancel_faults();
  impl_->far.cancel_faults();
  core.deadline_changed();
  return {};
}

bool Bus::end_fault(std::size_t number) {
  BusCore& core = impl_->core;
  const bool is_ended = impl_->faults.end(number, core.timeline.now());
  core.deadline_changed();
  return is_ended;
}

std::vector<FaultState> Bus::fault_states() const { return impl_->core.plan.states(); }

void Bus::Impl::tick(can::Time now) {
  core.ticking = true;
  if (core.had_faults) [[unlikely]] {
    faults.run(now);
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
  return std::min({near.deadline, far.deadline, faults.next()});
}

}  // namespace canopus::sim
