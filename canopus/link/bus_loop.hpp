#pragma once
// Participants in real time, over a bus client. Added protocol objects receive every frame; run() runs the
// event loop until a request is answered.

#include <chrono>
#include <cstdint>
#include <expected>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include "canopus/can/controller.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/link/bus_client.hpp"
#include "canopus/link/suspend_aware_clock.hpp"

namespace canopus::link {

class BusLoop final : public can::Sink, private BusClientListener {
 public:
  enum class Signals : std::uint8_t {
    end_run,     ///< Ctrl-C and SIGTERM
    left_alone,  ///< another component of this process handles them
  };
  /// Joins the bus. The error is a sentence.
  [[nodiscard]] static std::expected<std::unique_ptr<BusLoop>, std::string> open(
      const BusAddress& address, can::Duration time_out, Signals signals = Signals::end_run);
  /// Leaves the bus, after at most one second for pending transmissions.
  ~BusLoop();
  BusLoop(const BusLoop&) = delete;
  BusLoop& operator=(const BusLoop&) = delete;

  bool send(const can::Frame& frame) override;
  /// Only these identifiers are needed from now on (BusClient::set_filter); others may still be received.
  void need(std::initializer_list<IdentifierFilter> filters) {
    bus_->set_filter({filters.begin(), filters.size()});
  }
  /// BusClient::restart().
  std::expected<void, std::string> restart(std::uint32_t bit_rate) { return bus_->restart(bit_rate); }
  /// BusClient::restarted().
  [[nodiscard]] std::optional<std::expected<void, std::string>> restarted() const {
    return bus_->restarted();
  }
  /// BusClient::status().
  [[nodiscard]] ControllerStatus status() const { return bus_->status(); }
  /// Frames that were sent and are not on the bus yet, as far as the transport confirms them.
  [[nodiscard]] std::size_t under_way() const noexcept { return under_way_; }
  /// BusClient::is_flushed().
  [[nodiscard]] bool is_flushed() { return bus_->is_flushed(); }
  /// From now on the participant receives frames and ticks. It must outlive the loop or be removed.
  void add(can::Participant& participant);
  void remove(can::Participant& participant);
  /// The same for a receive-only listener.
  void add_listener(can::Listener& listener);
  void remove_listener(can::Listener& listener);
  /// Since the bus was joined.
  [[nodiscard]] can::Time now() const;
  /// From now on time in which this process stood still does not count (SuspendAwareClock): for request
  /// timeouts, which take silence for an answer. Other timers need real time.
  void extend_timeouts();

  /// For servers that share the loop; they live while it runs.
  [[nodiscard]] boost::asio::io_context& io() noexcept { return io_; }
  /// Called when the controller's state or counters changed, where the transport reports them.
  void set_status_listener(std::function<void(const ControllerStatus&)> listener) {
    status_listener_ = std::move(listener);
  }

  enum class End : std::uint8_t {
    done,
    time_over,
    interrupted,  ///< Ctrl-C or SIGTERM
    lost,         ///< the bus; failure() has the reason
  };
  /// Runs until `done()`, which is asked after everything that happened, or until `end`.
  End run(const std::function<bool()>& done, can::Time end = can::never);
  /// Why the bus was lost.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  /// Called with an error text of the bus's server; it may have unprintable characters.
  void set_complaint(std::function<void(std::string_view)> complaint) { complaint_ = std::move(complaint); }

 private:
  explicit BusLoop(Signals signals);
  void frame_received(const can::Frame& frame) override;
  void frame_sent(const can::Frame& /*frame*/) override {
    if (under_way_ > 0) --under_way_;
  }
  void bus_lost(const std::string& reason) override;
  void bus_complains(std::string_view text) override;
  void controller_changed(const ControllerStatus& status) override {
    if (status_listener_) status_listener_(status);
  }
  [[nodiscard]] can::Duration elapsed() const;

  struct Entry {
    can::Listener* listener;
    std::optional<can::Timeline::Handle> handle;  // none: it has no deadlines
  };

  boost::asio::io_context io_;
  boost::asio::signal_set signals_;
  std::unique_ptr<BusClient> bus_;
  can::Timeline timeline_;
  std::vector<Entry> entries_;
  std::chrono::steady_clock::time_point started_;
  std::optional<SuspendAwareClock> patient_;
  bool interrupted_ = false;
  bool lost_ = false;
  std::size_t under_way_ = 0;
  std::string failure_;
  std::function<void(std::string_view)> complaint_;
  std::function<void(const ControllerStatus&)> status_listener_;
};

}  // namespace canopus::link
