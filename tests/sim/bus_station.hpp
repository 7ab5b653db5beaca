#pragma once
// A participant on a bus that writes down what it hears.

#include <algorithm>
#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/sim/bus/bus.hpp"

namespace canopus::sim {

struct Heard {
  can::Frame frame;
  can::Time at;
  friend bool operator==(const Heard&, const Heard&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Heard& heard) {
    return out << std::hex << heard.frame.identifier << std::dec << '@'
               << heard.at.time_since_epoch().count();
  }
};

class Station final : public can::Participant {
 public:
  Station(Bus& bus, can::Timeline& the_timeline, std::string name) : port(bus.add_port(std::move(name))) {
    can::Ticker::alarm().add_part(alarm);
    can::Ticker::alarm().add_part(next_sending_);
    the_timeline.add(*this);
    port.connect(*this);
  }
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;
  ~Station() override { port.disconnect(); }

  /// Moments in ascending order.
  void send_at(can::Time moment, const can::Frame& frame) {
    plan_.emplace_back(moment, frame);
    set_next_sending();
  }
  [[nodiscard]] std::vector<can::Frame> frames() const {
    std::vector<can::Frame> all;
    for (const Heard& one : heard) all.push_back(one.frame);
    return all;
  }

  void receive(const can::Frame& frame, can::Time now) override {
    heard.push_back({frame, now});
    if (on_receive) on_receive(frame, now);
  }
  void transmitted(const can::Frame& frame, can::Time now) override {
    sent.push_back({frame, now});
    if (on_transmitted) on_transmitted(frame, now);
  }
  void controller_changed(can::Time now) override {
    ++changes;
    if (on_change) on_change(now);
  }
  void tick(can::Time now) override {
    if (now >= alarm) {
      alarm = can::never;
      ticks.push_back(now);
    }
    while (next_ < plan_.size() && plan_[next_].first <= now) port.send(plan_[next_++].second);
    set_next_sending();
  }

  Port& port;
  std::vector<Heard> heard;
  std::vector<Heard> sent;
  std::vector<can::Time> ticks;
  int changes = 0;
  can::Alarm alarm;
  std::function<void(const can::Frame&, can::Time)> on_receive;
  std::function<void(const can::Frame&, can::Time)> on_transmitted;
  std::function<void(can::Time)> on_change;

 private:
  void set_next_sending() { next_sending_ = next_ < plan_.size() ? plan_[next_].first : can::never; }

  can::Alarm next_sending_;
  std::vector<std::pair<can::Time, can::Frame>> plan_;
  std::size_t next_ = 0;
};

}  // namespace canopus::sim
