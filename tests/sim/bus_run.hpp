#pragma once
// A random script (bus_script.hpp) carried out on a bus, and what there is to say against it.

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <memory>
#include <ostream>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/bus/line/line.hpp"

#include "sim/bus_script.hpp"
#include "sim/bus_station.hpp"

namespace canopus::sim::random_script {

/// What two ways of working have to agree in, and what there is to say against the run.
struct Outcome {
  std::vector<std::string> lines;
  std::vector<std::string> complaints;
};

inline std::string nanoseconds(Time time) { return std::to_string(time.time_since_epoch().count()); }

/// Listens to what the bus reports and compares it with itself.
class Judge final : public BusObserver, public WireObserver {
 public:
  Judge(can::Timeline& timeline, Outcome& outcome) : timeline_(timeline), outcome_(outcome) {}

  void frame_completed(const Frame& frame, Time start, Time end) override {
    outcome_.lines.push_back("frame " + std::to_string(frame.identifier) + " " + nanoseconds(start) + " " +
                             nanoseconds(end));
    check(end == timeline_.now(), "a frame that ends at another moment");
    check(start < end, "a frame without length");
    check(!one_bus || start >= last_end_ - may_overlap, "a frame that begins before the last one ends");
    last_end_ = end;
    ++frames;
  }
  void error_detected(const Port& port, BusError error, Time now) override {
    outcome_.lines.push_back("error " + port.name() + " " + std::to_string(static_cast<int>(error)) + " " +
                             nanoseconds(now));
    check(now == timeline_.now(), "an error at another moment");
  }
  void level_changed(bool dominant, Time now) override {
    check(now == timeline_.now(), "a level at another moment");
    check(dominant != dominant_, "a level that was there already");
    dominant_ = dominant;
  }
  void transmit_changed(const Port& port, bool dominant, Time now) override {
    check(now == timeline_.now(), "a transmitted level at another moment");
    check(dominant ? driving_.insert(&port).second : driving_.erase(&port) == 1,
          "a transmitted level that was there already");
  }
  void activity_changed(const Port& port, bool flagging, bool arbitrating, Time now) override {
    check(now == timeline_.now(), "an activity at another moment");
    check(!(flagging && arbitrating), "a flag in arbitration");
    if (flagging || arbitrating) {
      active_.insert(&port);
    } else {
      active_.erase(&port);
    }
  }
  void check(bool good, const std::string& what) {
    if (!good) outcome_.complaints.push_back(what + " at " + nanoseconds(timeline_.now()));
  }
  /// Nobody sends any more.
  void check_silence() {
    check(!dominant_, "a wire that stays dominant");
    check(driving_.empty(), "a station that stays dominant");
    check(active_.empty(), "a station that stays active");
  }
  std::uint64_t frames = 0;
  bool one_bus = true;  // not cut, and one bit rate: one frame after the other
  // But for this: whoever joins counts 11 recessive bits. A frame that no node acknowledges ends with 10, and up to 5 of
  // its CRC before them: it may begin before that frame ends for a monitor.
  Duration may_overlap{};

 private:
  can::Timeline& timeline_;
  Outcome& outcome_;
  Time last_end_{};
  bool dominant_ = false;
  std::set<const Port*> driving_;
  std::set<const Port*> active_;
};

struct Event final : can::Participant {
  void receive(const Frame&, Time) override {}
  void tick(Time now) override {
    alarm().cancel();
    happens(now);
  }
  std::function<void(Time)> happens;
};

inline constexpr unsigned listener = 0;  // nothing is done to this station

inline Fault fault_of(unsigned number, unsigned stations, Duration bit) {
  const std::string some = std::to_string(1 + number / 16 % std::max(stations - 1, 1U));
  const unsigned where = number / 128 % 140;
  const Time from = Time(bit * (number / 64 % 1'000));
  const Time until = from + bit * (1 + number % 700);
  const double probability = 0.1 + 0.01 * (number % 80);
  switch (number % 17) {
    case 0: return {.kind = FaultKind::corrupt, .probability = probability};
    case 1: return {.kind = FaultKind::corrupt, .probability = probability, .receiver = some, .bit = where};
    case 2: return {.kind = FaultKind::corrupt, .every = 1 + number / 10 % 5, .count = 60, .bit = where};
    case 3: return {.kind = FaultKind::duplicate, .probability = probability / 4};
    case 4: return {.kind = FaultKind::drop, .probability = probability, .receiver = some};
    case 5: return {.kind = FaultKind::delay, .probability = probability, .delay = bit * (1 + where)};
    case 6:
      return {.kind = FaultKind::babble,
              .from = from,
              .until = until,
              .ports = {some},
              .frame = can::data_frame(number % 0x800),
              .interval = bit * (number % 3 * 60)};
    case 7: return {.kind = FaultKind::jam, .from = from, .until = until, .ports = {some}, .capacity = 2};
    case 10: return {.kind = FaultKind::stuck_recessive, .from = from, .until = until, .ports = {some}};
    case 11:
      return {.kind = FaultKind::late,
              .from = from,
              .until = until,
              .delay = bit * (1 + where) / 150,
              .ports = {some}};
    case 12:
      return {.kind = FaultKind::noise,
              .from = from,
              .until = until,
              .ports = number / 16 % 2 == 0 ? std::vector<std::string>{} : std::vector<std::string>{some},
              .bit_error_rate = 0.001 * (1 + where)};
    case 13:
      return {.kind = FaultKind::overload,
              .from = from,
              .until = until,
              .ports = {some},
              .overload_frames = 1 + number / 16 % 2};
    case 14: return {.kind = FaultKind::single_shot, .from = from, .until = until, .ports = {some}};
    case 16:
      return {.kind = FaultKind::early,
              .from = from,
              .until = until,
              .ports = {some},
              .early_bits = 1 + where % max_early_bits};
    case 15:
      return {.kind = FaultKind::termination,
              .from = from,
              .until = until,
              .resistors = number / 16 % 10,
              .length = 10.0 * where};
    case 8: return {.kind = FaultKind::cut, .from = from, .until = until, .ports = {some}};
    default:
      return {.kind = FaultKind::stuck_dominant,
              .from = from,
              .until = from + bit * (number % 50),
              .ports = {some}};
  }
}

class Run {
 public:
  Run(const Script& script, bool bit_by_bit, const Line* line = nullptr)
      : script_(script), bus_("bus", script.bit_rate, timeline_), judge_(timeline_, outcome_) {
    timeline_.set_stall_handler(
        [this](const can::Timeline::Stall& stall) { outcome_.complaints.push_back(stall.text()); });
    judge_.may_overlap = 4 * bit();
    if (line != nullptr) bus_.set_line(*line);
    bus_.add_observer(static_cast<BusObserver&>(judge_));
    for (unsigned number = 0; number < script.stations; ++number) add_station();
    if (bit_by_bit) bus_.add_observer(static_cast<WireObserver&>(judge_));
    timeline_.add(event_);
    stations_[listener]->on_change = [this](Time) {
      listener_passive_ =
          listener_passive_ || stations_[listener]->port.error_state() != can::ErrorState::error_active;
    };
    set_faults(script.faults);
  }

  Outcome operator()() {
    Time moment{};
    for (const Step& step : script_.steps) {
      const Duration gap = bit() * step.gap_in_64th_bits / 64 + Duration(step.nanoseconds);
      moment = std::max(moment + gap, timeline_.now());
      if (step.after_the_bus) {
        run_until(moment);
        act(step);
      } else {
        event_.happens = [&](Time) { act(step); };
        event_.alarm() = moment;
        run_until(moment);
      }
      check_counters();
    }
    heal();
    for (const auto& station : stations_) write_down(*station);
    outcome_.lines.push_back("frames " + std::to_string(bus_.load(timeline_.now()).frames));
    judge_.check(bus_.load(timeline_.now()).frames == judge_.frames, "frames that were not reported");
    return std::move(outcome_);
  }
  [[nodiscard]] Bus& bus() { return bus_; }
  /// Gets every port after each step.
  std::function<void(const Port&)> inspect;
  [[nodiscard]] Time now() const { return timeline_.now(); }

 private:
  struct Account {
    std::size_t accepted = 0;  // by send()
    bool lost_some = false;
    bool was_elsewhere = false;  // at another bit rate: a corrupted ACK slot can be its acknowledgement
  };

  static constexpr unsigned most_stations = 20;
  [[nodiscard]] unsigned count() const { return static_cast<unsigned>(stations_.size()); }
  [[nodiscard]] Duration bit() const { return can::bit_time(1, script_.bit_rate); }

  void add_station() {
    const auto number = static_cast<unsigned>(stations_.size());
    stations_.push_back(std::make_unique<Station>(bus_, timeline_, std::to_string(number)));
    accounts_.emplace_back();
    Station& station = *stations_.back();
    if (!script_.answers) return;
    station.on_receive = [this, number](const Frame& frame, Time) {
      if (frame.extended || frame.identifier % 32 != number || frame.identifier >= 0x400) return;
      send(number, can::data_frame(0x400 + frame.identifier / 32 * 32 + number));
    };
  }
  void send(unsigned number, const Frame& frame) {
    if (stations_[number]->port.send(frame)) ++accounts_[number].accepted;
  }

  /// Nobody else sends this frame.
  Frame frame_of(unsigned station, unsigned value) {
    Frame frame = can::data_frame((value % 32 * 32 + station) % 0x400, {});
    frame.extended = value % 7 == 0;
    frame.remote = value % 11 == 0;
    frame.dlc = static_cast<std::uint8_t>(frame.remote ? 0 : value % 9);
    if (frame.dlc > 0) frame.data[0] = static_cast<std::uint8_t>(serial_);
    if (frame.dlc > 1) frame.data[1] = static_cast<std::uint8_t>(serial_ >> 8);
    for (std::size_t byte = 2; byte < frame.dlc; ++byte)
      frame.data[byte] = static_cast<std::uint8_t>(value >> byte);
    ++serial_;
    return frame;
  }

  void set_faults(const std::vector<unsigned>& numbers) {
    std::vector<Fault> faults;
    for (const unsigned number : numbers) {
      Fault fault = fault_of(number, count(), bit());
      if (about_a_station(fault) && count() < 2) continue;
      const Duration since = timeline_.now() - Time{};
      if (fault.until != can::never) {
        fault.from += since;
        fault.until += since;
      }
      drops_ = drops_ || fault.kind == FaultKind::drop || fault.kind == FaultKind::jam ||
               fault.kind == FaultKind::cut || fault.kind == FaultKind::late ||
               fault.kind == FaultKind::noise || fault.kind == FaultKind::termination;
      if (fault.kind == FaultKind::single_shot) {
        for (Account& account : accounts_) account.lost_some = true;
      }
      judge_.one_bus = judge_.one_bus && fault.kind != FaultKind::cut && fault.kind != FaultKind::early;
      faults.push_back(fault);
    }
    const auto good = bus_.set_faults(faults, 1);
    judge_.check(good.has_value(), "faults are refused");
  }
  static bool about_a_station(const Fault& fault) { return !fault.ports.empty() || !fault.receiver.empty(); }

  void act(const Step& step) {
    const unsigned number = step.station % count();
    const bool may_be_touched = number != listener;
    Station& station = *stations_[number];
    switch (step.act) {
      case Act::send: send(number, frame_of(number, step.value)); return;
      case Act::send_burst:
        for (unsigned count = 0; count < 2 + step.value % 5; ++count) {
          send(number, frame_of(number, step.value / 8 + 17 * count));
        }
        return;
      case Act::new_faults: set_faults({step.value, step.value / 3}); return;
      case Act::add_station:
        if (count() < most_stations) add_station();
        return;
      default: break;
    }
    if (!may_be_touched) return;
    switch (step.act) {
      case Act::plug: station.port.plug(true); break;
      case Act::unplug: station.port.plug(false); break;
      case Act::restart:
        accounts_[number].lost_some = true;
        station.port.restart(script_.bit_rate);
        break;
      case Act::other_bit_rate:
        accounts_[number].was_elsewhere = true;
        judge_.one_bus = false;
        accounts_[number].lost_some = true;
        station.port.restart(script_.bit_rate == 500'000 ? 250'000 : 500'000);
        break;
      case Act::listen_only:
        accounts_[number].lost_some = true;  // a frame that a fault delays comes to be refused
        station.port.set_listen_only(true);
        break;
      case Act::take_part: station.port.set_listen_only(false); break;
      case Act::manual_recovery: station.port.set_automatic_recovery(false); break;
      case Act::automatic_recovery: station.port.set_automatic_recovery(true); break;
      case Act::abort:
        accounts_[number].lost_some = true;
        station.port.abort_transmissions();
        break;
      default: break;
    }
  }

  void run_until(Time end) {
    const Time before = timeline_.now();
    timeline_.run_until(end);
    judge_.check(timeline_.now() >= before && timeline_.now() >= end, "time that does not go forward");
  }

  void check_counters() {
    for (const auto& station : stations_) {
      const Port& port = station->port;
      const unsigned transmit = port.transmit_error_counter();
      const unsigned receive = port.receive_error_counter();
      judge_.check(transmit <= 256 && receive <= 255, "error counters out of range");
      const auto expected = transmit >= 256                     ? can::ErrorState::bus_off
                            : transmit >= 128 || receive >= 128 ? can::ErrorState::error_passive
                                                                : can::ErrorState::error_active;
      judge_.check(port.error_state() == expected, "an error state that is not the counters'");
      if (inspect) inspect(port);
    }
  }

  /// Everybody is as at the beginning: what waits goes out, and then everybody hears everybody.
  void heal() {
    set_faults({});
    for (unsigned number = 0; number < count(); ++number) {
      Port& port = stations_[number]->port;
      if (port.bit_rate() != script_.bit_rate) port.restart(script_.bit_rate);
      port.set_listen_only(false);
      port.set_automatic_recovery(true);
      port.plug(true);
    }
    if (count() < 2) return;
    run_until(timeline_.now() + bit() * 200'000);
    check_counters();
    for (unsigned number = 0; number < count(); ++number) {
      const Station& station = *stations_[number];
      if (!accounts_[number].lost_some) {
        judge_.check(station.sent.size() == accounts_[number].accepted,
                     "station " + std::to_string(number) + " got " + std::to_string(station.sent.size()) +
                         " of " + std::to_string(accounts_[number].accepted) + " frames out");
      }
      if (number == listener || drops_ || listener_passive_ || accounts_[number].was_elsewhere) continue;
      // Whoever never was error passive has heard what others have got out.
      std::vector<Frame> heard = stations_[listener]->frames();
      for (const Heard& sent : station.sent) {
        judge_.check(std::find(heard.begin(), heard.end(), sent.frame) != heard.end(),
                     "frame " + std::to_string(sent.frame.identifier) + " was not heard");
      }
    }
    std::vector<std::size_t> heard_before;
    for (const auto& station : stations_) heard_before.push_back(station->heard.size());
    for (unsigned number = 0; number < count(); ++number) {
      stations_[number]->port.send(can::data_frame(0x700 + number));
    }
    run_until(timeline_.now() + bit() * 2'000);
    for (unsigned number = 0; number < count(); ++number) {
      judge_.check(stations_[number]->heard.size() == heard_before[number] + count() - 1,
                   "station " + std::to_string(number) + " does not hear everybody at last");
    }
    judge_.check_silence();
  }

  void write_down(const Station& station) {
    std::vector<std::string>& lines = outcome_.lines;
    for (const Heard& heard : station.heard) {
      lines.push_back(station.port.name() + " heard " + std::to_string(heard.frame.identifier) + " " +
                      nanoseconds(heard.at));
    }
    for (const Heard& sent : station.sent) {
      lines.push_back(station.port.name() + " sent " + std::to_string(sent.frame.identifier) + " " +
                      nanoseconds(sent.at));
    }
    lines.push_back(station.port.name() + " overflows " + std::to_string(station.port.transmit_overflows()) +
                    ", TEC " + std::to_string(station.port.transmit_error_counter()) + ", REC " +
                    std::to_string(station.port.receive_error_counter()) + ", changes " +
                    std::to_string(station.changes) + ", errors " +
                    std::to_string(station.port.counters().errors) + ", bus-offs " +
                    std::to_string(station.port.counters().bus_offs));
  }

  const Script& script_;
  can::Timeline timeline_;
  Outcome outcome_;
  Bus bus_;
  Judge judge_;
  std::vector<std::unique_ptr<Station>> stations_;
  std::vector<Account> accounts_;
  Event event_;
  unsigned serial_ = 0;
  bool drops_ = false;
  bool listener_passive_ = false;
};

inline std::string first_difference(const Outcome& frames, const Outcome& bits) {
  const auto [one, other] =
      std::mismatch(frames.lines.begin(), frames.lines.end(), bits.lines.begin(), bits.lines.end());
  if (one == frames.lines.end() && other == bits.lines.end()) return {};
  std::string common;
  for (auto line = one - std::min<std::ptrdiff_t>(one - frames.lines.begin(), 5); line != one; ++line)
    common += "... " + *line + "\n";
  return common + "frame by frame: " + (one == frames.lines.end() ? "end" : *one) +
         ", bit by bit: " + (other == bits.lines.end() ? "end" : *other);
}

inline std::string complaints(const Outcome& outcome) {
  std::string all;
  for (const std::string& complaint : outcome.complaints) all += complaint + "\n";
  return all;
}

}  // namespace canopus::sim::random_script
