#pragma once
// What a waveform says, read from its text, and the same as a bus reports it bit by bit; and whether they agree.

#include <algorithm>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "canopus/sim/bus/bus.hpp"

namespace canopus::sim::waveform_reading {

/// By the name of the signal: its value, what comes to it at which time of the dump.
using Values = std::map<std::string, int>;
using Moments = std::map<std::int64_t, Values>;

struct Read {
  can::Duration unit{};
  Moments moments;
};

/// Of a Value Change Dump with scalars and real numbers. Fields of ports as they are meant: not -1.
inline Read read(const std::string& text) {
  Read all;
  std::map<std::string, std::string> names;
  std::istringstream in(text);
  std::int64_t now = 0;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string first, second, third, code, name;
    words >> first >> second;
    if (first == "$timescale") {
      words >> third;
      all.unit = can::Duration(std::stoi(second) * (third == "us" ? 1000 : 1));
    } else if (first == "$var") {
      words >> third >> code >> name;
      names[code] = name;
    } else if (first.starts_with("#")) {
      now = std::stoll(first.substr(1));
    } else if (first.starts_with("r")) {
      all.moments[now][names.at(second)] = std::stoi(first.substr(1));
    } else if (first.starts_with("0") || first.starts_with("1")) {
      all.moments[now][names.at(first.substr(1))] = first[0] - '0';
    }
  }
  return all;
}

/// Writes down what a bus reports bit by bit.
class Report final : public WireObserver {
 public:
  explicit Report(const Bus& bus, can::Duration unit, can::Time now) : ports_(bus.ports()), unit_(unit) {
    Values& first = at(now);
    first["can"] = 1;
    first["can_far"] = 1;
    for (const Port* port : ports_) {
      first[port->name() + "_tx"] = 1;
      first[port->name() + "_flag"] = first[port->name() + "_arb"] = first[port->name() + "_field"] = 0;
      write_counters(*port, now);
    }
  }
  void level_changed(bool dominant, can::Time now) override { at(now)["can"] = dominant ? 0 : 1; }
  void far_level_changed(bool dominant, can::Time now) override { at(now)["can_far"] = dominant ? 0 : 1; }
  void transmit_changed(const Port& port, bool dominant, can::Time now) override {
    if (knows(port)) at(now)[port.name() + "_tx"] = dominant ? 0 : 1;
  }
  void activity_changed(const Port& port, bool flagging, bool arbitrating, can::Time now) override {
    if (!knows(port)) return;
    at(now)[port.name() + "_flag"] = flagging ? 1 : 0;
    at(now)[port.name() + "_arb"] = arbitrating ? 1 : 0;
  }
  void field_changed(const Port& port, can::FrameField field, can::Time now) override {
    if (knows(port)) at(now)[port.name() + "_field"] = static_cast<int>(field);
  }
  void counters_changed(const Port& port, can::Time now) override {
    if (knows(port)) write_counters(port, now);
  }
  [[nodiscard]] const Moments& moments() const { return moments_; }

 private:
  [[nodiscard]] bool knows(const Port& port) const {
    return std::find(ports_.begin(), ports_.end(), &port) != ports_.end();
  }
  Values& at(can::Time now) { return moments_[now.time_since_epoch() / unit_]; }
  void write_counters(const Port& port, can::Time now) {
    at(now)[port.name() + "_tec"] = port.transmit_error_counter();
    at(now)[port.name() + "_rec"] = port.receive_error_counter();
  }

  std::vector<const Port*> ports_;
  can::Duration unit_;
  Moments moments_;
};

/// The first time at which what was read is not what was reported; empty: never.
inline std::string difference(const Moments& read, const Moments& reported) {
  Values have;
  Values want;
  std::map<std::int64_t, bool> times;
  for (const auto& [time, values] : read) times[time] = true;
  for (const auto& [time, values] : reported) times[time] = true;
  for (const auto& [time, unused] : times) {
    std::map<std::string, bool> changed;
    const auto collect = [&](const Moments& from, Values& into) {
      const auto found = from.find(time);
      if (found == from.end()) return;
      for (const auto& [name, value] : found->second) {
        if (into.contains(name) && into[name] == value) continue;
        into[name] = value;
        changed[name] = true;
      }
    };
    collect(read, have);
    collect(reported, want);
    if (changed.contains("field")) {
      for (const auto& [name, value] : want) {
        if (name.ends_with("_field")) changed[name] = true;
      }
    }
    for (const auto& [name, unused_too] : changed) {
      if (name == "field" || (name == "can_far" && !have.contains(name))) continue;
      const bool is_field = name.ends_with("_field");
      int found = have.at(name);
      if (is_field && found == -1) found = have.at("field");
      // A receiver that is idle yet stays with the bus, whose frame begins.
      if (is_field && have.at(name) == -1 && found == 1 && want.at(name) == 0) continue;
      if (found == want.at(name)) continue;
      return "at " + std::to_string(time) + " " + name + " is " + std::to_string(found) + ", reported " +
             std::to_string(want.at(name));
    }
  }
  return {};
}

}  // namespace canopus::sim::waveform_reading
