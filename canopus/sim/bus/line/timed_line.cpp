#include "canopus/sim/bus/line/timed_line.hpp"

#include <algorithm>
#include <cmath>

namespace canopus::sim {
namespace {

constexpr double femtoseconds_per_second = 1e15;
constexpr double femtoseconds_per_nanosecond = 1e6;

TimedLine::Time rounded(double femtoseconds) { return TimedLine::Time(std::llround(femtoseconds)); }

}  // namespace

std::size_t TimedLine::add(const Node& node) {
  auto station = std::make_unique<Station>(node);
  const double nominal = femtoseconds_per_second / bit_rate_ / node.timing.quanta();
  station->quantum = rounded(nominal / (1 + node.clock_ppm / 1e6));
  station->next = node.start;
  station->controller.restart(true);
  stations_.push_back(std::move(station));
  measure();
  return stations_.size() - 1;
}

void TimedLine::measure() {
  for (const auto& to : stations_) {
    to->delay.clear();
    for (const auto& from : stations_) {
      Time delay = from->node.driver_delay + to->node.receiver_delay;
      if (from != to) {
        const double metres =
            std::abs(from->node.metres - to->node.metres) + from->node.stub_metres + to->node.stub_metres;
        delay += rounded(metres * nanoseconds_per_metre_ * femtoseconds_per_nanosecond);
      }
      to->delay.push_back(delay);
      longest_ = std::max(longest_, delay);
    }
  }
}

void TimedLine::run(std::chrono::nanoseconds duration) {
  const Time end = now_ + duration;
  while (true) {
    Time next = end;
    for (const auto& station : stations_) next = std::min(next, station->next);
    now_ = next;
    if (now_ >= end) return;
    // All bits that begin now begin before any node monitors the wire: without delay they are seen at once.
    for (const auto& station : stations_) {
      if (station->next == now_ && station->clock.begin_quantum()) begin_bit(*station);
    }
    for (const auto& station : stations_) {
      if (station->next == now_) begin_quantum(*station);
    }
  }
}

void TimedLine::begin_bit(Station& station) {
  if (station.controller.idle() && !station.pending.empty()) {
    station.controller.transmit(station.pending.front());
  }
  drive(station);
}

void TimedLine::drive(Station& station) {
  const bool dominant = station.controller.drives_dominant();
  if (dominant == station.driving) return;
  station.driving = dominant;
  station.driven.push_back({now_, dominant});
  // The change before the oldest that all have seen says nothing any more.
  while (station.driven.size() > 1 && station.driven[1].time + longest_ < now_) station.driven.pop_front();
}

bool TimedLine::dominant_at(const Station& station) const {
  for (std::size_t number = 0; number < stations_.size(); ++number) {
    const std::deque<Change>& driven = stations_[number]->driven;
    const Time sent = now_ - station.delay[number];
    const auto change =
        std::find_if(driven.rbegin(), driven.rend(), [sent](const Change& it) { return it.time <= sent; });
    if (change != driven.rend() && change->dominant) return true;
  }
  return false;
}

void TimedLine::begin_quantum(Station& station) {
  const BitClock::Quantum quantum =
      station.clock.monitor(dominant_at(station), station.controller.synchronises_hard(), station.driving);
  if (quantum.samples) sample(station, quantum.dominant);
  // A SOF of its own is not due: the bit began with the edge of another node's.
  if (quantum.begins) drive(station);
  station.next += station.quantum;
}

void TimedLine::sample(Station& station, bool dominant) {
  const BitController::Events events = station.controller.sample(dominant);
  if (events.error != can::BusError::none) ++station.errors[static_cast<unsigned>(events.error)];
  if (events.received) station.received.push_back(station.controller.frame());
  if (events.transmitted) {
    ++station.transmitted;
    station.pending.pop_front();
  }
  if (events.early_start && !station.pending.empty()) station.controller.join(station.pending.front());
}

unsigned TimedLine::errors() const noexcept {
  unsigned sum = 0;
  for (const auto& station : stations_) {
    for (const unsigned count : station->errors) sum += count;
  }
  return sum;
}

}  // namespace canopus::sim
