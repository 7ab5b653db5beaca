#pragma once
// One script of frames and errors, carried out by the simulated bus and by the reference (slow_bus.hpp).

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>
#include <ostream>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"
#include "sim/slow_bus.hpp"

namespace canopus::sim::repeat {

using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;
using can::Time;

/// A script for both.
struct Script {
  struct Sending {
    unsigned station;
    unsigned slot;
    Frame frame;
  };
  struct Corruption {
    unsigned attempt;  // from 1
    unsigned bit;
    std::optional<unsigned> station;  // none: on the wire
  };
  unsigned stations = 3;
  std::optional<unsigned> listen_only{};
  std::vector<Sending> sendings{};
  std::vector<Corruption> corruptions{};
  unsigned slots = 3'000;

  friend std::ostream& operator<<(std::ostream& out, const Script& script) {
    out << script.stations << " stations, ";
    if (script.listen_only) out << *script.listen_only << " listens, ";
    out << script.slots << " slots\n";
    for (const Sending& sending : script.sendings) {
      out << "  " << sending.slot << ": " << sending.station << " sends " << std::hex
          << sending.frame.identifier << std::dec << (sending.frame.extended ? " extended" : "")
          << (sending.frame.remote ? " remote" : "") << " dlc " << int{sending.frame.dlc} << "\n";
    }
    for (const Corruption& corruption : script.corruptions) {
      out << "  attempt " << corruption.attempt << " bit " << corruption.bit << " at ";
      if (corruption.station) {
        out << *corruption.station << "\n";
      } else {
        out << "all\n";
      }
    }
    return out;
  }
};

struct Outcome {
  std::string wire;
  std::vector<std::string> frames;
  std::vector<std::string> errors;
  std::vector<std::string> stations;
};

inline std::string show(const std::string& name, int tec, int rec, const std::vector<Frame>& heard,
                        const std::vector<Frame>& sent) {
  std::ostringstream text;
  text << name << ": TEC " << tec << ", REC " << rec << ", heard";
  for (const Frame& frame : heard) text << " " << frame.identifier;
  text << ", sent";
  for (const Frame& frame : sent) text << " " << frame.identifier;
  return text.str();
}

inline std::string name_of(unsigned station) { return std::string(1, static_cast<char>('a' + station)); }

inline Outcome expected(const Script& script) {
  slow::Bus bus;
  for (unsigned number = 0; number < script.stations; ++number) bus.add(name_of(number));
  if (script.listen_only) bus.nodes[*script.listen_only].listen_only = true;
  for (const Script::Sending& sending : script.sendings)
    bus.send(sending.station, sending.slot, sending.frame);
  for (const Script::Corruption& corruption : script.corruptions) {
    bus.corrupt(corruption.attempt, corruption.bit, corruption.station);
  }
  bus.run(script.slots);
  Outcome outcome{.wire = bus.wire, .frames = bus.frames, .errors = bus.errors, .stations = {}};
  for (const slow::Bus::Node& node : bus.nodes) {
    outcome.stations.push_back(show(node.name, node.tec, node.rec, node.heard, node.sent));
  }
  return outcome;
}

struct Recorder final : BusObserver, WireObserver {
  static constexpr can::Duration bit = 1us;
  static long slot_of(Time time) { return time.time_since_epoch() / bit; }
  void frame_completed(const Frame& frame, Time start, Time end) override {
    frames.push_back(std::to_string(frame.identifier) + " " + std::to_string(slot_of(start)) + " " +
                     std::to_string(slot_of(end)));
  }
  void error_detected(const Port& port, BusError error, Time now) override {
    constexpr const char* names[] = {"none", "bit", "stuff", "crc", "form", "ack"};
    errors.push_back(port.name() + " " + names[static_cast<int>(error)] + " " + std::to_string(slot_of(now)));
  }
  void level_changed(bool dominant, Time now) override {
    const auto slot = static_cast<std::size_t>(slot_of(now));
    wire.resize(slot, wire.empty() ? '1' : level);
    level = dominant ? '0' : '1';
  }
  void transmit_changed(const Port&, bool, Time) override {}
  void activity_changed(const Port&, bool, bool, Time) override {}
  [[nodiscard]] std::string wire_until(unsigned slots) const {
    std::string all = wire;
    all.resize(slots, level);
    return all;
  }
  std::string wire;
  char level = '1';
  std::vector<std::string> frames;
  std::vector<std::string> errors;
};

struct Simulated {
  explicit Simulated(const Script& script, bool shows_wire) {
    bus.add_observer(static_cast<BusObserver&>(recorder));
    for (unsigned number = 0; number < script.stations; ++number) {
      stations.push_back(std::make_unique<Station>(bus, timeline, name_of(number)));
      stations.back()->port.set_automatic_recovery(false);
    }
    if (script.listen_only) stations[*script.listen_only]->port.set_listen_only(true);
    timeline.run_until(Time(20us));  // it has integrated: slot 0 is here
    if (shows_wire) bus.add_observer(static_cast<WireObserver&>(recorder));
  }
  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Recorder recorder;
  std::vector<std::unique_ptr<Station>> stations;
};

inline constexpr unsigned first_slot = 20;

inline Outcome simulated(const Script& script, bool shows_wire) {
  Simulated it(script, shows_wire);
  std::vector<Fault> faults;
  for (const Script::Corruption& corruption : script.corruptions) {
    faults.push_back({.kind = FaultKind::corrupt,
                      .first = corruption.attempt,
                      .count = 1,
                      .receiver = corruption.station ? name_of(*corruption.station) : "",
                      .bit = corruption.bit});
  }
  EXPECT_TRUE(it.bus.set_faults(faults, 1).has_value());
  std::vector<Script::Sending> sendings = script.sendings;
  std::stable_sort(sendings.begin(), sendings.end(),
                   [](const auto& one, const auto& other) { return one.slot < other.slot; });
  for (const Script::Sending& sending : sendings) {
    it.stations[sending.station]->send_at(Time(1us * sending.slot), sending.frame);
  }
  it.timeline.run_until(Time(1us * script.slots));
  Outcome outcome{.wire = it.recorder.wire_until(script.slots),
                  .frames = it.recorder.frames,
                  .errors = it.recorder.errors,
                  .stations = {}};
  for (const auto& station : it.stations) {
    std::vector<Frame> sent;
    for (const Heard& one : station->sent) sent.push_back(one.frame);
    outcome.stations.push_back(show(station->port.name(), station->port.transmit_error_counter(),
                                    station->port.receive_error_counter(), station->frames(), sent));
  }
  return outcome;
}

/// The errors of one bit in no order.
inline std::vector<std::string> sorted(std::vector<std::string> lines) {
  std::stable_sort(lines.begin(), lines.end());
  return lines;
}

inline std::string difference(const Outcome& wanted, const Outcome& found, bool shows_wire) {
  std::ostringstream text;
  if (shows_wire && wanted.wire != found.wire) {
    const auto at = static_cast<std::size_t>(
        std::mismatch(wanted.wire.begin(), wanted.wire.end(), found.wire.begin(), found.wire.end()).first -
        wanted.wire.begin());
    const std::size_t from = at < 60 ? 0 : at - 60;
    text << "the wire differs in slot " << at << ":\n  expected " << wanted.wire.substr(from, 120)
         << "\n  found    " << found.wire.substr(from, 120) << "\n";
  }
  const auto compare = [&](const char* what, const std::vector<std::string>& one,
                           const std::vector<std::string>& other) {
    const auto [left, right] = std::mismatch(one.begin(), one.end(), other.begin(), other.end());
    if (left == one.end() && right == other.end()) return;
    text << what << ": expected " << (left == one.end() ? "none" : *left) << ", found "
         << (right == other.end() ? "none" : *right) << "\n";
  };
  compare("frame", wanted.frames, found.frames);
  compare("error", sorted(wanted.errors), sorted(found.errors));
  // Frame by frame a counter takes success at the end of the frame, not at its ACK slot.
  if (shows_wire) compare("station", wanted.stations, found.stations);
  return text.str();
}

inline std::string verdict(const Script& script) {
  const Outcome wanted = expected(script);
  return difference(wanted, simulated(script, true), true) +
         difference(wanted, simulated(script, false), false);
}

inline rc::Gen<Script> script() {
  return rc::gen::exec([] {
    Script script;
    script.stations = *rc::gen::inRange(1U, 6U);
    if (*rc::gen::inRange(0, 4) == 0) script.listen_only = *rc::gen::inRange(0U, script.stations);
    const auto any_sending = rc::gen::exec([&script] {
      Script::Sending sending{};
      sending.station = *rc::gen::inRange(0U, script.stations);
      sending.slot = first_slot + *rc::gen::weightedOneOf<unsigned>({{2, rc::gen::inRange(0U, 60U)},
                                                                     {2, rc::gen::inRange(0U, 600U)},
                                                                     {3, rc::gen::inRange(0U, 4'000U)}});
      const auto value = *rc::gen::inRange(0U, 1U << 16);
      sending.frame.extended = value % 9 == 1;
      sending.frame.remote = value % 13 == 1;
      // Nobody else has this identifier.
      sending.frame.identifier = value % 0x7F8 / 8 * 8 + sending.station;
      if (value % 3 == 0) sending.frame.identifier &= 0x187;  // rows of dominant bits
      sending.frame.dlc = static_cast<std::uint8_t>(value % 4);
      for (std::size_t byte = 0; byte < sending.frame.length(); ++byte)
        sending.frame.data[byte] = static_cast<std::uint8_t>(value >> (4 * byte));
      return sending;
    });
    script.sendings = *rc::gen::container<std::vector<Script::Sending>>(any_sending);
    // Equal identifiers of one station: which goes first is the queue's business, not the wire's.
    std::set<std::tuple<std::uint32_t, bool, bool>> known;
    std::erase_if(script.sendings, [&](const Script::Sending& sending) {
      const Frame& frame = sending.frame;
      return !known.emplace(frame.identifier, frame.extended, frame.remote).second;
    });
    const auto bit = rc::gen::weightedOneOf<unsigned>(
        {{4, rc::gen::inRange(0U, 60U)}, {1, rc::gen::inRange(0U, 90U)}, {2, rc::gen::inRange(40U, 60U)}});
    const unsigned timed_faults = *rc::gen::inRange(0U, 5U);  // at most four meet in one frame
    for (unsigned timed = 0; timed < timed_faults; ++timed) {
      // Often enough in a row to make somebody passive.
      const unsigned first = *rc::gen::inRange(1U, 40U);
      const unsigned count = *rc::gen::element(1U, 1U, 2U, 5U, 17U, 20U);
      const unsigned every = *rc::gen::inRange(1U, 3U);
      const unsigned where = *bit;
      const unsigned victim = *rc::gen::inRange(0U, script.stations + 2);
      for (unsigned number = 0; number < count; ++number) {
        script.corruptions.push_back(
            {first + number * every, where, victim < script.stations ? std::optional(victim) : std::nullopt});
      }
    }
    return script;
  });
}

}  // namespace canopus::sim::repeat
