#pragma once
// One client's conversation in the socketcand protocol, without the socket. Both sides send elements, text
// between '<' and '>', words separated by blanks, with nothing between the elements:
//
//   server            client                                  server
//   < hi >            < open line1 >                          < ok >    the bus's name; if it is another:
//                                                                       an error, and the connection ends
//                     < rawmode >                             < ok >    from now on every frame of the bus:
//   < frame 581 12.000345 4318100101000000 >                            identifier as %03X, extended %08X
//                     < send 601 8 40 18 10 1 0 0 0 0 >                 8 digits: an extended identifier
//                     < sendrtr 705 1 >                                 a remote frame
//                     < echo >                                < echo >
//                     < bcmmode >                             < ok >    frames stop; so it is after `open`
//                     < subscribe 0 0 123 >                             in this mode: frames of one identifier;
//   < frame 123 12.000345 11 22 33 >                                    their bytes have blanks between them
//                     < filter 1 500000 123 1 FF >                      those whose first byte changes, at
//                                                                       least 1.5 s from one to the next
//                     < muxfilter 0 0 123 2 FF 0 0 0 0 0 0 0 33 FF FF FF FF FF FF FF >
//                     < unsubscribe 123 >
//                     < add 0 20000 123 2 11 22 >                       a frame every 20 ms,
//                     < update 123 2 11 33 >                            with another content,
//                     < delete 123 >                                    and no longer
//                     < line1 B 250000 >                      < ok >    its controller restarts at another bit rate,
//                                                                       where the bus is a simulated one; what it has
//                                                                       sent and is not on the bus is gone
//   < error 288 12.000345 >                                             the class of an error frame: what its
//                                                                       controller found, or its new state
//   < error 020 12.000345 >                                             no acknowledge for this client's
//                                                                       frames: once for as long as it lasts
//
// `< open >` without a name opens the bus as well: a server has only one. Other servers refuse that. Likewise
// `< B 250000 >`.
//
// What is not understood gets `< error ... >`; after garbage outside of elements, or an element without end,
// the connection is closed. As in socketcand's raw mode a client does not receive the frames it sent itself,
// and remote frames are not passed on to it, in both modes. Jobs and filters end with bcmmode (broadcast_manager.hpp).
// The modes of ISO-TP and of statistics (controlmode) are refused. [socketcand doc/protocol.md]

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "canopus/can/controller.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/link/broadcast_manager.hpp"

namespace canopus::link {

/// Longest message a session or write_socketcand_frame() produces, in characters.
inline constexpr std::size_t socketcand_max_message = 96;
/// Longest element a client may send, brackets included.
inline constexpr std::size_t socketcand_max_element = 128;
/// The same of `< muxfilter ... >`: 257 times 8 bytes.
inline constexpr std::size_t socketcand_max_muxfilter = 6400;

/// How the data bytes of a frame are written: raw mode and bcmmode differ.
enum class SocketcandData : std::uint8_t {
  together,  ///< 112233
  apart      ///< 11 22 33
};

/// Writes `< frame ... >` and returns its length. Time is written in seconds with six decimals, cut.
std::size_t write_socketcand_frame(std::span<char, socketcand_max_message> out, const can::Frame& frame,
                                   can::Time time, SocketcandData data = SocketcandData::together) noexcept;

/// Writes `< error 020 12.000345 >`, as socketcand passes on the error frames of a CAN interface (can_error.hpp),
/// and returns its length.
std::size_t write_socketcand_error(std::span<char, socketcand_max_message> out, std::uint32_t error_class,
                                   can::Time time) noexcept;

class SocketcandSession : private BroadcastManager::Receiver {
 public:
  /// The session's interface to its connection.
  class Peer {
   public:
    /// Sends a message of at most socketcand_max_message characters. Some clients compare the answer of one
    /// recv() with the whole message: each goes out as a segment of its own.
    virtual void message(std::string_view text) = 0;
    /// A frame for a client in bcmmode, which has passed a filter.
    virtual void filtered_frame(const can::Frame& frame, can::Time time) = 0;
    /// The present time of the bus.
    [[nodiscard]] virtual can::Time now() const = 0;
    /// The client's controller restarts at this bit rate (can::bit_rates). False: the client cannot set it.
    virtual bool restart(std::uint32_t /*bit_rate*/) { return false; }

   protected:
    ~Peer() = default;
  };

  enum class State : std::uint8_t {
    no_bus,   ///< greeted, waits for `open`
    quiet,    ///< bus open (bcmmode): frames that pass a filter are forwarded to the client
    raw,      ///< every frame of the bus is forwarded to the client
    closed,   ///< the caller closes the connection once the messages so far are sent
    dropped,  ///< its client is gone, and what it left behind is only counted
  };

  /// `bus_name` is the only name that `open` accepts, besides none at all. `bus` takes the client's frames.
  SocketcandSession(std::string bus_name, can::Sink& bus, Peer& peer);

  /// The connection is established: sends `< hi >`.
  void start();
  /// Bytes came from the client, cut anywhere.
  void receive(std::string_view bytes);
  /// A frame of the bus, for the filters of bcmmode.
  void filter(const can::Frame& frame, can::Time now);
  /// The send jobs and filters of bcmmode; tick() when it is due.
  [[nodiscard]] can::Alarm& alarm() noexcept { return manager_.alarm(); }
  void tick(can::Time now);
  /// Its client is gone: no frame of a job is sent any more, those that it has sent itself are.
  void end_jobs() { manager_.clear(); }
  /// The bus may have room again: goes on where a frame was refused.
  void resume();
  /// The bus refused a frame. The caller reads no bytes from the client until resume() ended this, so that
  /// TCP slows down a client that sends faster than the bus, without loss.
  [[nodiscard]] bool waiting() const noexcept { return refused_.has_value(); }
  /// The bus takes nothing any more: drops the frame it refused and those behind it, as far as they have been
  /// read.
  void drop_waiting();
  /// The client is gone: what it left behind does not go on the bus any more. From now on its frames are only
  /// counted, those that receive() still brings included.
  void drop();
  /// Frames of the client that did not go on the bus.
  [[nodiscard]] std::uint64_t frames_dropped() const noexcept { return frames_dropped_; }
  [[nodiscard]] State state() const noexcept { return state_; }

 private:
  void read_input();
  void element(std::string_view text);
  void set_bit_rate(std::string_view arguments);
  void send(std::string_view arguments, bool remote);
  /// Whether it was a command of bcmmode.
  bool manage(std::string_view command, std::string_view arguments);
  using Done = std::expected<void, std::string_view>;
  Done manage_jobs(std::string_view command, std::string_view arguments);
  Done manage_filters(std::string_view command, std::string_view arguments);
  Done set_multiplex_filter(CanIdentifier identifier, can::Duration interval, std::string_view arguments);
  /// Whether it was a command of the protocol that there is not here.
  bool refuse(std::string_view command);
  void error(std::string_view text);
  void error(std::string_view command, std::string_view text);
  // BroadcastManager::Receiver
  void filtered_frame(const can::Frame& frame, can::Time time) override;
  void close_with(std::string_view text);

  std::string bus_name_;
  can::Sink& bus_;
  Peer& peer_;
  State state_ = State::no_bus;
  std::string input_;                  // not yet understood
  std::optional<can::Frame> refused_;  // waits for the bus
  std::uint64_t frames_dropped_ = 0;
  BroadcastManager manager_{bus_, *this};
};

}  // namespace canopus::link
