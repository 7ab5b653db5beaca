#pragma once
// The LSS master of a gateway [CiA 309-1; CiA 305]: requests of its clients, one after the other, because LSS
// answers name no request. A request is a sequence of services that other clients' requests do not interrupt.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "canopus/can/controller.hpp"
#include "canopus/lss/lss_master.hpp"

namespace canopus::client {

class GatewayLss final : public can::Participant, private lss::LssMasterListener {
 public:
  static constexpr std::chrono::milliseconds default_time_out{100};  ///< for an answer

  using Ticket = std::uint64_t;
  /// Begins a service; without one, waits for `pause`.
  struct Step {
    std::function<bool(lss::LssMaster& master, can::Time now)> begin{};
    can::Duration pause{};
  };
  struct Request {
    Step first{};
    /// After each step: a further one, or none. May be empty.
    std::function<std::optional<Step>(lss::LssResult result, const lss::LssMaster& master, can::Time now)>
        next{};
    std::function<void(lss::LssResult result, const lss::LssMaster& master, can::Time now)> done{};
    can::Duration time_out = default_time_out;
    bool goes_on = false;  ///< to its end, though its client is gone
  };

  explicit GatewayLss(can::Sink& bus) : master_(bus, *this) {
    alarm().add_part(master_.alarm());
    alarm().add_part(pause_);
  }

  void request(Ticket ticket, Request request, can::Time now);
  /// `done` is not called.
  void call_off(Ticket ticket, can::Time now);
  /// Ends all as refused, with error 0.
  void clear(can::Time now);

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override { master_.receive(frame, now); }
  void tick(can::Time now) override;

 private:
  struct Job {
    Ticket ticket;
    Request request;
  };
  void lss_finished(lss::LssMaster& master, lss::LssResult result, can::Time now) override;
  void begin(const Step& step, can::Time now);
  void start(can::Time now);
  void step_over(lss::LssResult result, can::Time now);

  lss::LssMaster master_;
  std::deque<Job> jobs_;  // the first one is running
  bool running_ = false;
  can::Alarm pause_;
};

}  // namespace canopus::client
