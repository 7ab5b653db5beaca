#pragma once
// The inside of the socketcand server: its connections. Only the sources of the server include this.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "canopus/link/socketcand_server.hpp"
#include "canopus/link/socketcand_session.hpp"
#include "canopus/link/tcp_clients.hpp"

namespace canopus::link {

/// State shared by the server and pending handlers.
struct SocketcandServer::Shared : std::enable_shared_from_this<Shared> {
  Shared(boost::asio::io_context& context, boost::asio::ip::tcp::endpoint local, std::string name,
         AttachToBus attach_to_bus, LoopClock& loop, SocketcandLimits given, ClientReport to_report)
      : io(context),
        endpoint(std::move(local)),
        bus_name(std::move(name)),
        attach(std::move(attach_to_bus)),
        clock(loop),
        limits(std::move(given)),
        clients(context, {.allowed = limits.allowed, .most = limits.clients}, std::move(to_report)) {}

  void admit(boost::asio::ip::tcp::socket socket);

  boost::asio::io_context& io;
  boost::asio::ip::tcp::endpoint endpoint;
  std::string bus_name;
  AttachToBus attach;
  LoopClock& clock;
  SocketcandLimits limits;
  TcpClients<Client> clients;
  SocketcandStatistics statistics;
};

/// One connection: a socket on one side, a place on the bus on the other, a session between them.
///
/// Bus callbacks only queue messages and start socket operations; what takes the client off the bus happens
/// in handlers of the io_context, never inside the bus.
class SocketcandServer::Client final : public std::enable_shared_from_this<Client>,
                                       public AttachedClient,
                                       private can::Sink,
                                       private SocketcandSession::Peer {
 public:
  /// Messages that wait for its socket.
  [[nodiscard]] std::size_t waiting_messages() const noexcept { return queued_; }

  Client(Shared& server, boost::asio::ip::tcp::socket socket)
      : server_(&server),
        socket_(std::move(socket)),
        name_(name_of_peer(socket_)),
        session_(server.bus_name, *this, *this),
        queue_(std::max(server.limits.queue, 2 * reserved_for_answers)),
        stall_(server.io) {
    for (can::Alarm* part : {&hold_until_, &close_at_, &check_at_, &session_.alarm()})
      alarm().add_part(*part);
  }

  [[nodiscard]] bool attach() {
    attachment_ = server_->attach(*this);
    return attachment_ != nullptr;
  }

  [[nodiscard]] boost::asio::ip::tcp::socket& socket() { return socket_; }

  void start() {
    session_.start();
    read();
  }

  /// Ends the connection and leaves the bus at once.
  void leave();

  // AttachedClient
  void unacknowledged(can::Time now) override;
  void controller_error(std::uint32_t error_class, can::Time now) override;
  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& /*frame*/, can::Time now) override {
    if (on_the_way_ > 0) --on_the_way_;
    progress_at_ = now;
    gave_up_ = false;
    bus_has_room(now);
  }
  void controller_changed(can::Time now) override { bus_has_room(now); }
  void tick(can::Time now) override;

 private:
  /// Queued text. Frames can be lost to a full queue and be held back; answers cannot.
  struct Message {
    std::array<char, socketcand_max_message> text;
    std::uint8_t length = 0;
    bool frame = false;
  };
  /// Bytes read at a time. An element of 3 characters has an answer, so they make less than
  /// most_answers messages, what the session kept of the last ones included.
  static constexpr std::size_t read_size = 1024;
  static constexpr std::size_t most_answers = (read_size + socketcand_max_element) / 3 + 1;
  /// Slots that frames leave free, so that answers always find one; input is only read while most_answers of
  /// them are free, so TCP slows down a client that sends requests and never reads.
  static constexpr std::size_t reserved_for_answers = 512;
  static_assert(most_answers < reserved_for_answers);
  /// Poll interval of a client that is not read because the bus is full.
  static constexpr can::Duration check_interval = std::chrono::milliseconds(20);
  /// Most bytes of a disconnected client's input that are read to count its frames.
  static constexpr std::size_t most_counted = 256 * 1024;

  // can::Sink, for the session
  bool send(const can::Frame& frame) override;
  // SocketcandSession::Peer
  void message(std::string_view text) override;
  void filtered_frame(const can::Frame& frame, can::Time time) override {
    queue_frame(frame, time, SocketcandData::apart);
  }
  [[nodiscard]] can::Time now() const override { return time_; }
  bool restart(std::uint32_t bit_rate) override;

  void read();
  void on_read(const boost::system::error_code& failure, std::size_t size);
  void on_written(const boost::system::error_code& failure);
  void write_next();
  Message* claim_slot(std::size_t reserve);
  void queue_frame(const can::Frame& frame, can::Time time, SocketcandData data);
  void report_lost();
  void judge_reading();
  void bus_has_room(can::Time now);
  void after_input(SocketcandSession::State before, can::Time now);
  void client_is_gone(can::Time now);
  void check_client(can::Time now);
  [[nodiscard]] std::uint64_t drop_input();
  void end_soon();
  void leave_later();
  /// The client gets no frames any more.
  [[nodiscard]] bool ending() const {
    return gone_ || leaving_ || session_.state() == SocketcandSession::State::closed;
  }

  Shared* server_;  // null once the client has left
  boost::asio::ip::tcp::socket socket_;
  std::string name_;
  SocketcandSession session_;
  std::unique_ptr<BusAttachment> attachment_;
  std::array<char, read_size> input_;
  std::vector<Message> queue_;  // ring
  std::size_t front_ = 0;
  std::size_t queued_ = 0;
  bool writing_ = false;
  bool reading_ = false;
  bool gone_ = false;                // the client has closed; its last frames are still to go out
  bool read_all_ = false;            // to the end of the connection
  bool gave_up_ = false;             // frames are dropped until the bus takes one again
  bool too_slow_ = false;            // read nothing for so long that its connection ends
  bool leaving_ = false;             // leave() is about to come
  std::uint64_t lost_ = 0;           // frames since there was room last
  std::uint64_t written_ = 0;        // messages that its socket took
  boost::asio::steady_timer stall_;  // runs while it is judged whether the client reads at all
  std::uint32_t on_the_way_ = 0;     // frames given to the bus and not yet transmitted
  can::Alarm hold_until_;            // frames wait for this moment when it is not never
  can::Alarm close_at_;              // when to close with unsent output
  can::Alarm check_at_;              // next poll of a client that waits for the bus
  can::Time time_{};                 // of the last call that had one
  can::Time progress_at_{};          // when the bus took a frame last, or waiting began
};

}  // namespace canopus::link
