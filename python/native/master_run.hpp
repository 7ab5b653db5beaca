#pragma once
// An NMT master without a PLC, as the Python module drives it. Nothing here knows Python.

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "canopus/master/network_master.hpp"

#include "master_place.hpp"
#include "plant_run.hpp"

namespace canopus::python {

/// The network file at `path` has this text; a problem: every mistake. Without a text: a master of this node-ID, without slaves.
master::NetworkFile network_of(const std::optional<std::string>& text, const std::string& path,
                               unsigned node);

class MasterRun final : private can::Participant, private master::NetworkObserver {
 public:
  /// Frames of one identifier that are kept at most, the latest ones.
  static constexpr std::size_t most_frames = 100'000;

  /// It is switched on at once: its start-up happens while time passes. A problem: every mistake of what the network file
  /// names, a line each.
  MasterRun(const std::function<std::unique_ptr<MasterPlace>()>& join, const master::NetworkFile& file);
  ~MasterRun() override;
  MasterRun(const MasterRun&) = delete;
  MasterRun& operator=(const MasterRun&) = delete;

  void set_signal_check(std::function<void()> check_signals) { check_signals_ = std::move(check_signals); }
  /// Leaves the bus; again: nothing. Everything but now() and events is a problem afterwards.
  void close();
  [[nodiscard]] can::Time now() const;

  void run_for(can::Duration duration);
  /// Lets time pass until the start-up is over. False: the time was over before.
  bool boot(can::Duration time_out);
  /// A line of JSON for each slave.
  [[nodiscard]] std::string results() const;
  [[nodiscard]] std::string drain_events();
  /// As 1F82H shows it: "operational", "pre-operational", "stopped", "missing", "unknown".
  [[nodiscard]] std::string state(unsigned node) const;
  /// Request NMT [CiA 302-2]: 04H 05H 06H 07H 7FH; node 0: all.
  void command(unsigned node, std::uint8_t value);

  SdoResult sdo(unsigned node, unsigned index, unsigned sub, const std::optional<std::string>& value,
                can::Duration time_out, bool block);

  void send(const can::Frame& frame);
  /// From now on frames of this identifier are kept for receive(). A token.
  std::size_t subscribe(std::uint32_t identifier, bool extended);
  /// Again: nothing.
  void unsubscribe(std::size_t token);
  /// The next one of them; time passes until there is one, `time_out` at most.
  std::optional<TimedFrame> receive_next(std::size_t token, can::Duration time_out);

 private:
  void check() const;
  /// A problem: time passes just now, maybe in another thread.
  void check_still() const;
  void event(const char* name, const master::NetworkSlave& slave, can::Time now, std::string more = {});

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override { network_->transmitted(frame, now); }
  void tick(can::Time now) override { network_->tick(now); }

  // master::NetworkObserver
  void slave_booted(const master::NetworkSlave& slave, can::Time now) override;
  void slave_failed(const master::NetworkSlave& slave, const manager::BootRecord& record,
                    can::Time now) override;
  void state_changed(const master::NetworkSlave& slave, std::uint8_t state, can::Time now) override;
  void error_control_event(const master::NetworkSlave& slave, manager::ErrorControlEvent what,
                           can::Time now) override;
  void error_control_resolved(const master::NetworkSlave& slave, can::Time now) override;

  std::string events_;
  struct Subscription {
    std::uint32_t identifier = 0;
    bool extended = false;
    std::deque<TimedFrame> frames{};
  };
  std::map<std::size_t, Subscription> subscriptions_;
  std::size_t last_token_ = 0;
  std::function<void()> check_signals_ = [] {};
  can::Time last_{};
  std::unique_ptr<MasterPlace> place_;
  std::unique_ptr<master::NetworkMaster> network_;
};

}  // namespace canopus::python
