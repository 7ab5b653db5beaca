#pragma once
// The client's side of a socketcand conversation (socketcand_session.hpp shows both), without the socket:
// waits for `< hi >`, opens the bus, enters raw mode, and from then on reads frames. Frames to send are
// elements of their own, write_socketcand_send().

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "canopus/can/frame.hpp"

namespace canopus::link {

/// Longest element write_socketcand_send() makes.
inline constexpr std::size_t socketcand_max_send = 64;

/// Writes `< send 601 8 40 18 10 1 0 0 0 0 >` or `< sendrtr 705 1 >` and returns its length. Lengths above 8
/// are sent as 8.
std::size_t write_socketcand_send(std::span<char, socketcand_max_send> out, const can::Frame& frame) noexcept;

class SocketcandDialogue {
 public:
  class Peer {
   public:
    /// Sends this text to the server unchanged.
    virtual void message(std::string_view text) = 0;
    virtual void frame_received(const can::Frame& frame) = 0;
    /// The server reported an error (frames were lost, a frame was refused); the connection stays.
    virtual void complaint(std::string_view text) = 0;
    /// An error frame of the server's CAN interface, of which its class is known (can_error.hpp).
    virtual void controller_error(std::uint32_t /*error_class*/) {}
    /// The answer to `< echo >`: what was sent before it has been read.
    virtual void echoed() {}
    /// The answer to `< line1 B 250000 >`: done, or why not.
    virtual void bit_rate_changed() {}
    virtual void bit_rate_refused(std::string_view /*text*/) {}

   protected:
    ~Peer() = default;
  };

  enum class State : std::uint8_t {
    greeting,      ///< waits for `< hi >`
    opening,       ///< asked for the bus
    entering_raw,  ///< asked for its frames
    raw,           ///< frames come and go
    failed,        ///< error() has the reason; the caller closes the connection
  };

  /// An empty name opens the only bus of the server, which servers of other makes refuse.
  SocketcandDialogue(std::string bus_name, Peer& peer);

  /// Requests another bit rate of our controller, bit/s, in raw mode; the answer comes to the peer. The
  /// protocol has it, servers of other makes mostly do not [socketcand doc/protocol.md, "to be implemented"].
  void request_bit_rate(std::uint32_t bit_rate);

  /// Bytes came from the server, cut anywhere.
  void receive(std::string_view bytes);
  [[nodiscard]] State state() const noexcept { return state_; }
  /// A sentence, when failed.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 private:
  void element(std::string_view text);
  void frame(std::string_view arguments);
  void error_element(std::string_view arguments);
  void fail(std::string text);

  std::string bus_name_;
  Peer& peer_;
  State state_ = State::greeting;
  std::string input_;  // not yet understood
  std::string error_;
  bool bit_rate_asked_ = false;
  std::string_view reported_error_;  // of an error frame; not again until a frame comes
};

}  // namespace canopus::link
