#pragma once
// Common to the transports of bus clients: the transmit queue, the callbacks to the user, the states of
// opening, interruption and end, and reconnection. A transport implements connect, write and disconnect.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/can/ring.hpp"
#include "canopus/link/bus_client.hpp"
#include "canopus/link/complaint_limiter.hpp"

namespace canopus::link {

/// Handlers that are under way keep it alive after its client is gone.
class Transport : public std::enable_shared_from_this<Transport> {
 public:
  enum class State : std::uint8_t { opening, open, interrupted, ended };
  static constexpr std::size_t most_waiting = 4096;  ///< frames

  Transport(boost::asio::io_context& io, BusClientOptions options);
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// Reports that came before there was a user are delivered soon after.
  void set_user(BusClientListener* user);
  bool send(const can::Frame& frame);
  [[nodiscard]] State state() const noexcept { return state_; }
  /// Why it ended.
  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }
  [[nodiscard]] const ControllerStatus& status() const noexcept { return status_; }

  void open() { connect(); }
  void close();
  /// Runs the io_context until `done`, or until `end`: false.
  template <typename Done>
  bool run_until(Done done, std::chrono::steady_clock::time_point end) {
    while (!done()) {
      if (io_.stopped()) io_.restart();
      // An io_context that always has something to do must not keep the end from coming.
      (void)io_.run_one_until(end);
      if (std::chrono::steady_clock::now() >= end) return done();
    }
    return true;
  }

  /// No more frames come: get those out that wait.
  virtual void finish() {}
  /// Everything is on its way to the bus.
  [[nodiscard]] virtual bool finished() const { return queue_.empty(); }
  /// BusClient::is_flushed().
  virtual bool is_flushed() { return true; }
  /// A hint for the error when opening takes too long: "is it a socketcand server?".
  [[nodiscard]] virtual std::string_view silence() const { return {}; }
  virtual std::expected<void, std::string> restart(std::uint32_t bit_rate);
  /// BusClient::restarted().
  [[nodiscard]] virtual std::optional<std::expected<void, std::string>> restarted() const {
    return std::expected<void, std::string>{};
  }
  virtual void set_filter(std::span<const IdentifierFilter> /*filters*/) {}
  virtual void abort_transmissions() { queue_.clear(); }

 protected:
  /// Starts to connect; opened() or failed() follows, maybe from inside.
  virtual void connect() = 0;
  virtual void disconnect() = 0;
  /// Frames wait in queue(). Must not call the user.
  virtual void write() = 0;
  /// Frames that left queue() and still count as waiting.
  [[nodiscard]] virtual std::size_t under_way() const { return 0; }

  void opened();
  /// The connection is gone. Tries again, or ends.
  void failed(std::string reason);
  /// The same from inside of send().
  void fail_later(std::string reason);
  void received(const can::Frame& frame, std::optional<std::chrono::nanoseconds> received_at = std::nullopt);
  void sent(const can::Frame& frame, std::optional<std::chrono::nanoseconds> sent_at = std::nullopt);
  /// The same from inside of send().
  void sent_later(const can::Frame& frame);
  /// Reports a fault to the user, at most one a second (ComplaintLimiter).
  void complain(std::string_view text);
  /// Reports a change of state, without a limit of rate.
  void announce(std::string_view text);
  void set_status(const ControllerStatus& status);

  [[nodiscard]] boost::asio::io_context& io() noexcept { return io_; }
  [[nodiscard]] const BusClientOptions& options() const noexcept { return options_; }
  [[nodiscard]] can::Ring<can::Frame>& queue() noexcept { return queue_; }
  [[nodiscard]] const can::Ring<can::Frame>& queue() const noexcept { return queue_; }
  [[nodiscard]] bool is_open() const noexcept { return state_ == State::open; }
  [[nodiscard]] bool is_closing() const noexcept { return closing_; }
  void set_closing() noexcept { closing_ = true; }
  template <typename Derived>
  std::shared_ptr<Derived> self(Derived* /*this*/) {
    return std::static_pointer_cast<Derived>(shared_from_this());
  }

 private:
  void report_later();
  void deliver_complaint(std::string_view text);
  void await_complaints();

  boost::asio::io_context& io_;
  BusClientOptions options_;
  boost::asio::steady_timer pause_;
  BusClientListener* user_ = nullptr;
  State state_ = State::opening;
  bool closing_ = false;
  bool reporting_ = false;
  std::string reason_;
  can::Ring<can::Frame> queue_;
  can::Ring<can::Frame> handed_over_;  // to report as sent
  ControllerStatus status_{};
  ComplaintLimiter complaints_;
  boost::asio::steady_timer complaint_pause_;
  std::string undelivered_;  // the first report before there was a user
};

/// Opens it; the error is a sentence without the address.
[[nodiscard]] std::expected<std::unique_ptr<BusClient>, std::string> open_transport(
    std::shared_ptr<Transport> transport, std::chrono::milliseconds time_out);

// The transports, for open_bus().
[[nodiscard]] std::shared_ptr<Transport> make_socketcand(boost::asio::io_context& io,
                                                         const BusAddress& address,
                                                         const BusClientOptions& options);
[[nodiscard]] std::shared_ptr<Transport> make_socketcan(boost::asio::io_context& io,
                                                        const BusAddress& address,
                                                        const BusClientOptions& options);
[[nodiscard]] std::shared_ptr<Transport> make_slcan(boost::asio::io_context& io, const BusAddress& address,
                                                    const BusClientOptions& options);
[[nodiscard]] std::shared_ptr<Transport> make_multicast(boost::asio::io_context& io,
                                                        const BusAddress& address,
                                                        const BusClientOptions& options);
[[nodiscard]] std::shared_ptr<Transport> make_cannelloni(boost::asio::io_context& io,
                                                         const BusAddress& address,
                                                         const BusClientOptions& options);

}  // namespace canopus::link
