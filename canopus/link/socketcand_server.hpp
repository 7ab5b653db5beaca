#pragma once
// Opens a bus to other processes: a TCP server for the socketcand protocol (see socketcand_session.hpp) to
// several clients. Each client is a node of its own on the bus, so its frames go through arbitration, and it
// receives the other clients' frames but not its own.
//
// A client that does not read cannot hold up the bus: its messages wait in a queue of fixed size, frames that
// find it full are lost and counted, the client gets their number when there is room again, and too many cost
// it the connection. A client that sends faster than the bus is not read until the bus has room; the socket
// buffers are small, so that TCP flow control slows it down early. What a client leaves behind when its
// connection ends is still sent for `linger`; then it is dropped, and the number of frames is reported.
// Frames are dropped as well while the bus takes none at all for `patience`, and the client gets a message.
//
// Everything runs on the thread of the io_context, which is the thread of the bus.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "canopus/can/controller.hpp"
#include "canopus/link/allow_list.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/link/peer.hpp"

namespace canopus::link {

/// One client's place on the bus: takes its frames. Destroying it takes the client off the bus: its
/// Participant is not called any more, and frames it has queued are not sent.
class BusAttachment : public can::Sink {
 public:
  virtual ~BusAttachment() = default;
  /// The client's controller restarts at this bit rate, bit/s; its queued frames are discarded. False: a bus
  /// where clients cannot do that.
  virtual bool restart(std::uint32_t /*bit_rate*/) { return false; }
};

/// A client as the bus has it.
class AttachedClient : public can::Participant {
 public:
  /// No acknowledge for the client's frames: no other node is on the bus. Called once while this lasts.
  virtual void unacknowledged(can::Time now) = 0;
  /// The client's controller found an error, or came to another state: class of the SocketCAN error frame.
  virtual void controller_error(std::uint32_t error_class, can::Time now) = 0;
};

/// Puts a client on the bus. It lives until its attachment is destroyed. Null: the bus takes no more.
using AttachToBus = std::function<std::unique_ptr<BusAttachment>(AttachedClient& client)>;

struct SocketcandLimits {
  AllowList allowed{};  ///< clients that may connect
  /// From this machine only processes of the same user; IPv4 only.
  bool own_user_alone = false;
  std::size_t clients = 32;  ///< connections at a time; one more gets a message and is closed
  std::size_t queue = 2048;  ///< messages that wait for one client's socket, at least 1024
  /// Frames in a row lost to a full queue from which on a client is closed that takes nothing for `stall`.
  std::uint64_t lost_frames = 8192;
  std::chrono::milliseconds stall{2000};  ///< real time
  /// Run time between the answer to `rawmode` and the first frame: the python-can client takes all that one
  /// recv() returns for the answer, so nothing may follow it closely.
  can::Duration settle = std::chrono::milliseconds(20);
  /// Run time that a closed connection may take to get its last messages and frames out. The frames that are
  /// left then are dropped.
  can::Duration linger = std::chrono::seconds(1);
  /// Run time without any of its frames sent after which a client that is faster than the bus waits no more:
  /// no acknowledge, or others leave no gap. Its frames are dropped then, as by a real CAN interface.
  can::Duration patience = std::chrono::seconds(1);
};

struct SocketcandStatistics {
  std::size_t clients = 0;                ///< connected now
  std::uint64_t connections = 0;          ///< accepted so far, those over the limit included
  std::uint64_t frames_to_clients = 0;    ///< queued for a client
  std::uint64_t frames_from_clients = 0;  ///< taken by the bus
  std::uint64_t frames_lost = 0;          ///< not queued because the client was too slow
  std::uint64_t frames_dropped = 0;       ///< sent by clients, and not taken by the bus in time
  std::uint64_t clients_too_slow = 0;     ///< closed for it
};

class SocketcandServer {
 public:
  /// Nothing happens before listen(). `clock` and the io_context outlive the server; `attach` is called for
  /// each client that connects. The bus is at clock.now() when a client joins or leaves it.
  SocketcandServer(boost::asio::io_context& io, const boost::asio::ip::tcp::endpoint& endpoint,
                   std::string bus_name, AttachToBus attach, LoopClock& clock, SocketcandLimits limits = {},
                   ClientReport report = {});
  /// close()
  ~SocketcandServer();
  SocketcandServer(const SocketcandServer&) = delete;
  SocketcandServer& operator=(const SocketcandServer&) = delete;

  /// Starts to accept. Error: `cannot listen on 127.0.0.1:29536: Address already in use`.
  [[nodiscard]] std::expected<void, std::string> listen();
  /// The port it listens on (the one the system chose when the endpoint's is 0); 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  [[nodiscard]] SocketcandStatistics statistics() const noexcept;
  /// Messages that wait for the slowest client's socket. When its queue is full (SocketcandLimits::queue), frames are
  /// lost: a plant in virtual time can wait for its clients instead.
  [[nodiscard]] std::size_t waiting_messages() const noexcept;
  /// Ends all connections and takes the clients off the bus. Must not be called from a bus callback.
  void close();

 private:
  class Client;
  struct Shared;
  std::shared_ptr<Shared> shared_;  // handlers may outlive the server by one round of the loop
};

}  // namespace canopus::link
