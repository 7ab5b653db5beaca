#pragma once
// A bus of another process or of this machine's hardware, joined as a client: frames go in, frames come out.
// Behind the one interface are the transports that BusAddress names.
//
// Everything runs on the thread of the io_context.

#include <chrono>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>

#include "canopus/can/controller.hpp"
#include "canopus/link/bus_address.hpp"
#include "canopus/link/controller_status.hpp"

namespace canopus::link {

/// Identifiers that are needed: those that agree with `identifier` in the bits of `mask`.
struct IdentifierFilter {
  std::uint32_t identifier = 0;
  std::uint32_t mask = 0;
  bool extended = false;

  /// One base identifier.
  [[nodiscard]] static constexpr IdentifierFilter only(std::uint32_t identifier) noexcept {
    return {.identifier = identifier, .mask = 0x7FF};
  }
  /// The base identifiers of a service: all nodes.
  [[nodiscard]] static constexpr IdentifierFilter function(std::uint32_t function_code) noexcept {
    return {.identifier = function_code, .mask = 0x780};
  }

  friend bool operator==(const IdentifierFilter&, const IdentifierFilter&) = default;
};

/// Callbacks of a bus. They may call send().
class BusClientListener {
 public:
  virtual void frame_received(const can::Frame& frame) = 0;
  /// The same with the time stamp of the kernel or hardware (since 1970, UTC), where there is one. By default
  /// it calls frame_received().
  virtual void frame_received_at(const can::Frame& frame,
                                 std::optional<std::chrono::nanoseconds> /*received_at*/) {
    frame_received(frame);
  }
  /// A frame that this client sent is complete on the bus (the kernel's echo, slcan's `z`), or, where the
  /// transport has no transmit confirmation, was handed to it. In the order of send(), never called inside
  /// send().
  virtual void frame_sent(const can::Frame& /*frame*/) {}
  /// The same with the time stamp of the echo, as frame_received_at() has it.
  virtual void frame_sent_at(const can::Frame& frame, std::optional<std::chrono::nanoseconds> /*sent_at*/) {
    frame_sent(frame);
  }
  /// The controller's state, counters or bit rate changed.
  virtual void controller_changed(const ControllerStatus& /*status*/) {}
  /// The connection ended for good. `reason` is a sentence for the user.
  virtual void bus_lost(const std::string& reason) = 0;
  /// With BusClientOptions::keep_trying, in place of bus_lost(): the bus went away (interface down, adapter
  /// unplugged, connection lost) and is tried again. Frames that waited are dropped. And: it is there again.
  virtual void bus_interrupted(const std::string& /*reason*/) {}
  virtual void bus_resumed() {}
  /// The other side reported a fault, for example lost frames. The bus stays connected.
  virtual void bus_complains(std::string_view /*text*/) {}

 protected:
  ~BusClientListener() = default;
};

class BusClient : public can::Sink {
 public:
  virtual ~BusClient() = default;
  /// The client does not receive its own frames. send() is false when 4096 frames wait already, or the bus is
  /// lost or interrupted.
  virtual void set_user(BusClientListener* user) = 0;
  /// Ends the connection once everything sent so far is on its way to the bus; runs the io_context until
  /// then, or for `time_out`. False when it was not done by then. No callback comes after this.
  virtual bool close(std::chrono::milliseconds time_out) = 0;

  /// Counters are up to 250 ms old (slcan: 1 s); SocketCAN reports changes of the error state at once.
  [[nodiscard]] virtual ControllerStatus status() const { return {}; }
  /// Restarts the controller with this bit rate in bit/s (0: the one it has). The error names a remedy ("ip
  /// link set can0 type can bitrate 250000") where the transport or the system refuses it.
  virtual std::expected<void, std::string> restart(std::uint32_t bit_rate);
  /// The result of the last restart(), where the other side answers it; nothing as long as it has not
  /// answered.
  [[nodiscard]] virtual std::optional<std::expected<void, std::string>> restarted() const {
    return std::expected<void, std::string>{};
  }
  /// Only these identifiers are needed, for transports that can leave the others out early; an empty list
  /// means all. Others may still be received.
  virtual void set_filter(std::span<const IdentifierFilter> /*filters*/) {}
  /// The other side has taken all frames, as far as it can be asked: the first call asks. For those that send no more.
  virtual bool is_flushed() { return true; }
  /// Drops the frames that still wait. They are not reported as sent.
  virtual void abort_transmissions() {}
};

struct BusClientOptions {
  std::chrono::milliseconds time_out{5000};  ///< for the opening
  /// A bus that went away is tried again. It must be there at the opening.
  bool keep_trying = false;
  std::chrono::milliseconds retry{1000};  ///< from a failure to the next try
  /// Requested bit rate in bit/s; 0: the present one, or that of its address.
  std::uint32_t bit_rate = 0;
};

/// Joins a bus; runs the io_context until that is done, or for the time-out. The error is a sentence with the
/// address: "socketcand:127.0.0.1:29536: Connection refused".
[[nodiscard]] std::expected<std::unique_ptr<BusClient>, std::string> open_bus(
    boost::asio::io_context& io, const BusAddress& address, const BusClientOptions& options = {});

}  // namespace canopus::link
