#include "canopus/sim/bus/line/line_clocks.hpp"

#include <algorithm>
#include <cmath>

namespace canopus::sim {
namespace {

constexpr double golden = 0.6180339887498949;
constexpr double rounding = 1e-3;  // ns

}  // namespace

void LineClocks::add(const std::string& name, std::uint32_t bit_rate, can::Time now) {
  const std::size_t number = stations_.size();
  Station station{.place = number % 2 == 0 ? 0 : line_.length,
                  .stub = line_.stub,
                  .ppm = (number + 1) / 2 % 2 == 0 ? line_.clock_ppm : -line_.clock_ppm,
                  .clock = BitClock(line_.timing),
                  .bit_rate = bit_rate,
                  .origin = now,
                  .monitored = now};
  const auto own = std::ranges::find(line_.nodes, name, &Line::Node::port);
  if (own != line_.nodes.end()) {
    station.place = own->place.value_or(station.place);
    station.stub = own->stub.value_or(station.stub);
    station.ppm = own->clock_ppm.value_or(station.ppm);
  }
  set_rate(station, bit_rate);
  // Quanta of different nodes begin at different moments, here spread evenly.
  station.phase = std::fmod(golden * static_cast<double>(number), 1.0) * station.quantum;
  stations_.push_back(std::move(station));
  measure();
}

void LineClocks::measure() {
  delays_.clear();
  for (const Station& to : stations_) {
    std::vector<can::Duration>& row = delays_.emplace_back();
    for (const Station& from : stations_) {
      const double metres = &to == &from ? 0 : std::abs(to.place - from.place) + to.stub + from.stub;
      row.push_back(line_.transceiver_delay +
                    can::Duration(std::llround(metres * line_.nanoseconds_per_metre)));
      longest_ = std::max(longest_, row.back());
    }
  }
}

void LineClocks::set_rate(Station& station, std::uint32_t bit_rate) noexcept {
  station.bit_rate = bit_rate;
  station.quantum = 1e9 / bit_rate / line_.timing.quanta() / (1 + station.ppm / 1e6);
}

can::Time LineClocks::quantum_begin(const Station& station, std::uint64_t number) noexcept {
  const double after = station.phase + static_cast<double>(number) * station.quantum;
  const auto below = static_cast<std::int64_t>(after - rounding);  // quicker than std::ceil()
  return station.origin + can::Duration(static_cast<double>(below) < after - rounding ? below + 1 : below);
}

std::uint64_t LineClocks::quantum_from(const Station& station, can::Time time) noexcept {
  const double after = static_cast<double>((time - station.origin).count()) - 1 - station.phase;
  auto number = static_cast<std::uint64_t>(std::max(after / station.quantum, 0.0));
  while (quantum_begin(station, number) < time) ++number;
  return number;
}

void LineClocks::restart(std::size_t port, std::uint32_t bit_rate, can::Time now) {
  Station& station = stations_[port];
  station.clock = BitClock(line_.timing);
  station.origin = now;
  station.phase = 0;
  station.quanta = 0;
  if (station.bit_rate != bit_rate) set_rate(station, bit_rate);
}

bool LineClocks::begins_bit(std::size_t port, std::uint32_t bit_rate, can::Time now) const noexcept {
  const Station& station = stations_[port];
  if (station.bit_rate != bit_rate || station.quanta == 0) return false;
  return station.monitored == now ? station.clock.quantum() == 0 : end_of_bit(port) == now;
}

bool LineClocks::advance(std::size_t port, can::Time now) noexcept {
  Station& station = stations_[port];
  const std::uint64_t number = quantum_from(station, now);
  if (number < station.quanta || quantum_begin(station, number) != now) return false;
  if (number > station.quanta) station.clock.skip(static_cast<unsigned>(number - station.quanta));
  station.clock.begin_quantum();
  station.quanta = number + 1;
  station.monitored = now;
  return true;
}

bool LineClocks::advance_asleep(std::size_t port, can::Time now) noexcept {
  Station& station = stations_[port];
  const std::uint64_t number = quantum_from(station, now);
  if (number < station.quanta || quantum_begin(station, number) != now) return false;
  station.quanta = number + 1;
  station.monitored = now;
  return true;
}

void LineClocks::wake(std::size_t port) noexcept {
  BitClock& clock = stations_[port].clock;
  clock = BitClock(line_.timing);
  clock.begin_quantum();
  clock.monitor(true, true, false);
}

can::Time LineClocks::sample_point(std::size_t port) const noexcept {
  return quanta_later(stations_[port], stations_[port].clock.to_sample_point());
}

can::Time LineClocks::end_of_bit(std::size_t port) const noexcept {
  return quanta_later(stations_[port], stations_[port].clock.to_end());
}

can::Time LineClocks::next_sample_point(std::size_t port) const noexcept {
  return quanta_later(stations_[port], stations_[port].clock.to_next_sample_point());
}

void LineClocks::pass_end_of_bit(std::size_t port) noexcept {
  Station& station = stations_[port];
  station.monitored = end_of_bit(port);
  station.quanta += station.clock.to_end();
  station.clock.skip_to_next_bit();
}

can::Time LineClocks::next_quantum(std::size_t port, can::Time now, can::Time then) const noexcept {
  if (!monitors(port)) return then;
  const Station& station = stations_[port];
  const std::uint64_t number = std::max(quantum_from(station, now), station.quanta);
  return std::min(quantum_begin(station, number), then);
}

void LineClocks::drive(std::size_t port, bool dominant, can::Time now) {
  std::vector<Change>& driven = stations_[port].driven;
  if (dominant == (!driven.empty() && driven.back().dominant)) return;
  if (driven.empty()) driving_.push_back(port);
  driven.push_back({now, dominant});
  changed_ = now;
  forgetting_ = std::min(forgetting_, is_old_at(stations_[port]));
}

bool LineClocks::sees(std::size_t to, std::size_t from, can::Time now) const noexcept {
  const std::vector<Change>& driven = stations_[from].driven;
  const can::Time sent = now - delays_[to][from];
  for (auto change = driven.rbegin(); change != driven.rend(); ++change) {
    if (change->time <= sent) return change->dominant;
  }
  return false;
}

/// When what the port has driven first is not seen any more.
can::Time LineClocks::is_old_at(const Station& station) const noexcept {
  const std::vector<Change>& driven = station.driven;
  if (driven.size() == 1 && driven.front().dominant) return can::never;
  return (driven.size() == 1 ? driven.front() : driven[1]).time + longest_ + can::Duration(1);
}

void LineClocks::forget(can::Time now) noexcept {
  if (now < forgetting_) return;
  forgetting_ = can::never;
  std::erase_if(driving_, [&](std::size_t port) {
    std::vector<Change>& driven = stations_[port].driven;
    std::size_t old = 0;
    while (old + 1 < driven.size() && driven[old + 1].time + longest_ < now) ++old;
    driven.erase(driven.begin(), driven.begin() + static_cast<std::ptrdiff_t>(old));
    const bool is_seen =
        driven.size() > 1 || driven.front().dominant || driven.front().time + longest_ >= now;
    if (is_seen) {
      forgetting_ = std::min(forgetting_, is_old_at(stations_[port]));
    } else {
      driven.clear();
    }
    return !is_seen;
  });
}

}  // namespace canopus::sim
