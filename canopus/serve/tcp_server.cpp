#include "canopus/serve/tcp_server.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "canopus/link/tcp/connection_places.hpp"
#include "canopus/link/tcp/socket_round.hpp"
#include "canopus/link/tcp/tcp_port.hpp"
#include "canopus/link/tcp/watched_socket.hpp"
#include "canopus/serve/connection_timer.hpp"

namespace canopus::serve {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// Seconds of the machine's clock, cheaply: to a few milliseconds.
struct CoarseClock {
  using time_point = std::chrono::steady_clock::time_point;
  [[nodiscard]] static time_point now() noexcept {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC_COARSE, &time);
    return time_point(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
  }
};

/// Where the end of a stream came together with its last bytes, it is found so late.
constexpr auto look_again_after = std::chrono::milliseconds(10);

struct TcpServer::Parts : std::enable_shared_from_this<Parts> {
  Parts(asio::io_context& io, plc::Rack& the_rack, link::LoopClock& the_clock, std::string the_protocol,
        MakeConversation the_make, TcpServerOptions the_options, link::ClientReport the_report)
      : context(io),
        rack(the_rack),
        clock(the_clock),
        protocol(std::move(the_protocol)),
        make(std::move(the_make)),
        options(std::move(the_options)),
        report(std::move(the_report)),
        port(io),
        look_timer(io) {}

  void admit(tcp::socket socket);
  void look_again_soon();
  void look_again();
  void remove(const Connection& connection);
  void say(const std::string& client, const std::string& what) const {
    if (report) report(client + ' ' + what);
  }

  asio::io_context& context;
  plc::Rack& rack;
  link::LoopClock& clock;
  std::string protocol;
  MakeConversation make;
  TcpServerOptions options;
  link::ClientReport report;
  link::TcpPort port;
  asio::steady_timer look_timer;  // of connections that may have more to read than anybody tells of
  bool looks_again = false;
  std::shared_ptr<link::SocketRound> round = std::make_shared<link::SocketRound>(context);
  std::vector<std::shared_ptr<Connection>> connections;
  std::uint64_t requests = 0;
  std::uint64_t heard = 0;  // messages from clients and connections, so far
};

/// One client. Handlers hold it; it forgets the server when the server is gone.
class TcpServer::Connection : public std::enable_shared_from_this<Connection>,
                              private plc::EndProcessing::Requests,
                              private link::WatchedSocket::User,
                              private link::SocketRound::User {
 public:
  Connection(Parts& parts, tcp::socket socket, std::string name)
      : parts_(&parts),
        name_(std::move(name)),
        heard_number_(++parts.heard),
        timer_(parts.context),
        session_(parts.make(link::address_of_peer(socket))),
        socket_(parts.context, std::move(socket), *this) {}

  void start() {
    if (socket_.native_handle() < 0) return end("cannot be listened to, as the system is out of memory");
    set(IPPROTO_TCP, TCP_NODELAY, 1);
    check_alive();
    receive();
  }

  /// Reads what nobody would tell of.
  void look_again() {
    if (parts_ != nullptr && socket_.is_doubtful() && is_receiving_ && !is_sending_) read();
  }

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] link::HeldPlace place() const noexcept {
    return {.hold = link::Hold::while_used, .used = heard_at_, .number = heard_number_};
  }

  void close() noexcept {
    if (parts_ != nullptr) parts_->rack.end_processing().leave(*this);
    parts_ = nullptr;
    socket_.close();
    timer_.stop();
  }

 private:
  void receive() {
    if (is_receiving_ || is_ready_ || is_sending_ || input_ended_ || session_->space().empty()) return;
    wait_to_read();
  }

  void wait_to_read() {
    if (std::exchange(is_receiving_, true)) return;
    socket_.wait_to_read(shared_from_this());
  }

  void can_read() override {
    is_receiving_ = false;
    if (is_sending_) return;
    if (parts_->round->goes_alone(*this, parts_->connections.size() == 1)) return read();
    is_ready_ = true;
    parts_->round->join({shared_from_this(), this});
  }

  void read() {
    const auto space = session_->space();
    if (space.empty()) return;  // work() makes some, and goes on
    if (hear(socket_.read(space))) work();
  }

  /// Bytes go where the session wants them, when they are there: the END of a scan may move those before them.
  link::BatchedRead begin() override {
    is_ready_ = false;
    if (parts_ == nullptr || is_sending_) return {};
    return {.socket = &socket_,
            .bytes = session_->space()};  // if there is none, work() makes some, and goes on
  }

  link::BatchedWrite reply() override {
    if (parts_ == nullptr) return {};
    progress_ = false;
    // What an END has left may still be there.
    if (session_->output().empty() && !session_->over()) answer_complete(progress_);
    if (parts_ == nullptr) return {};
    return {.socket = &socket_, .bytes = session_->output()};
  }

  void go_on(const link::WatchedSocket::Transfer& sent) override {
    if (parts_ != nullptr && take(sent)) work(progress_);
  }

  /// Whether something came.
  bool hear(const link::WatchedSocket::Transfer& came) override {
    if (parts_ == nullptr) return false;
    if (came.has_to_wait()) {
      wait_to_read();
      return false;
    }
    if (came.count == 0) {
      end_input(came.error);
      return false;
    }
    parts_->look_again_soon();
    heard_at_ = CoarseClock::now();
    heard_number_ = ++parts_->heard;
    session_->received(came.count);
    return true;
  }

  void end_input(int error) {
    input_ended_ = true;
    // What it has asked is still done and answered.
    if (is_waiting_ || !session_->output().empty()) return;
    end(error == ETIMEDOUT ? "does not answer the alive check any more" : nullptr);
  }

  void set(int level, int name, int value) noexcept {
    ::setsockopt(socket_.native_handle(), level, name, &value, sizeof value);
  }

  void check_alive() {
    const TcpServerOptions& options = parts_->options;
    set(SOL_SOCKET, SO_KEEPALIVE, 1);
    set(IPPROTO_TCP, TCP_KEEPIDLE, static_cast<int>(options.alive_check_start.count()));
    set(IPPROTO_TCP, TCP_KEEPINTVL, static_cast<int>(options.alive_check_interval.count()));
    set(IPPROTO_TCP, TCP_KEEPCNT, options.alive_checks);
  }

  /// Sends what is answered, and answers what is complete, until there is nothing more, the client does not take
  /// more, or the rest has to wait for the END of the scan. `progress`: something has just been answered.
  void work(bool progress = false) {
    do {
      if (!send()) return;
      if (session_->over()) return end(("sent what is no request of the " + parts_->protocol).c_str());
    } while (answer_complete(progress));
    if (parts_ == nullptr) return;  // the run ended on the way there
    watch_request(progress);
    if (input_ended_ && !is_waiting_) return end();
    receive();
  }

  /// Answers what is complete, unless that has to wait for the END of the scan. Whether there may be more to do.
  bool answer_complete(bool& progress) {
    if (!session_->has_request()) return false;
    if (parts_->rack.answers_at_end()) {
      is_waiting_ = true;
      parts_->rack.end_processing().wait(*this);
      return false;
    }
    const can::Time now = parts_->clock.now();
    if (parts_ == nullptr) return false;
    if (answer(now)) {
      progress = true;
      parts_->clock.accessed();
    }
    return parts_ != nullptr;
  }

  /// Whether something was answered.
  bool answer(can::Time now) {
    const std::size_t answered = session_->process(now);
    parts_->requests += answered;
    return answered != 0;
  }

  // plc::EndProcessing::Requests: inside the timeline, so what is answered is sent afterwards.
  void answer_requests(can::Time now) override {
    is_waiting_ = false;
    const bool progress = answer(now);
    asio::post(parts_->context, [self = shared_from_this(), progress] {
      if (self->parts_ == nullptr) return;
      self->parts_->clock.touched();
      if (self->parts_ != nullptr && !self->is_sending_) self->work(progress);
    });
  }

  /// False when the rest has to wait, or the connection is at its end.
  bool send() {
    for (auto output = session_->output(); !output.empty(); output = session_->output())
      if (!take(socket_.write(output))) return false;
    return true;
  }

  /// So much was sent. False as for send().
  bool take(const link::WatchedSocket::Transfer& written) {
    if (written.has_to_wait()) {
      wait_to_send();
      return false;
    }
    if (written.error != 0) {
      end();
      return false;
    }
    session_->sent(written.count);
    return true;
  }

  void wait_to_send() {
    is_sending_ = true;
    set_timer(parts_->options.send_timeout, "does not take its replies");
    socket_.wait_to_write(shared_from_this());
  }

  void can_write() override {
    timer_.stop();
    is_sending_ = false;
    work();
  }

  /// A request that has begun has its time; one that is answered gives the next its own.
  void watch_request(bool progress) {
    if (is_waiting_ || !session_->half_request()) return timer_.stop();
    if (progress || !timer_.is_set())
      set_timer(parts_->options.half_request_timeout, "left a request incomplete");
  }

  void set_timer(std::chrono::milliseconds timeout, const char* reason) {
    timer_.set(timeout, [self = shared_from_this(), reason] {
      if (self->parts_ != nullptr) self->end(reason);
    });
  }

  /// `reason`: what the client did, when it was not its client that ended the connection.
  void end(const char* reason = nullptr) {
    Parts& parts = *parts_;
    if (reason != nullptr) parts.say(name_, std::string(reason) + ": its connection is closed");
    close();
    parts.remove(*this);
  }

  Parts* parts_;
  std::string name_;
  std::uint64_t heard_number_;  // later is higher, and no two are equal
  CoarseClock::time_point heard_at_ = CoarseClock::now();
  ConnectionTimer timer_;
  bool is_receiving_ = false;  // waits for bytes
  bool is_ready_ = false;      // has some, and waits to be served
  bool is_sending_ = false;    // waits for room to send
  bool is_waiting_ = false;    // for the END of the scan
  bool input_ended_ = false;   // nothing more comes
  bool progress_ = false;      // something was answered since it is served
  std::unique_ptr<Conversation> session_;
  link::WatchedSocket socket_;
};

void TcpServer::Parts::admit(tcp::socket socket) {
  const std::string name = link::name_of_peer(socket);
  if (!link::is_allowed(socket, options.allowed)) return say(name, "is not allowed to connect");
  const link::ConnectionPlaces places(options.maximum_clients, options.gives_way_after);
  const auto report_of = [this](const std::string& client, const std::string& what) { say(client, what); };
  if (!places.make_room(connections, name, CoarseClock::now(), report_of)) return;
  const auto connection = std::make_shared<Connection>(*this, std::move(socket), name);
  connections.push_back(connection);
  connection->start();
}

void TcpServer::Parts::look_again_soon() {
  if (std::exchange(looks_again, true)) return;
  look_timer.expires_after(look_again_after);
  look_timer.async_wait([self = shared_from_this()](const error_code& error) {
    if (!error) self->look_again();
  });
}

void TcpServer::Parts::look_again() {
  looks_again = false;
  const auto all = connections;  // one that is at its end leaves them
  for (const auto& connection : all) connection->look_again();
}

void TcpServer::Parts::remove(const Connection& connection) {
  std::erase_if(connections, [&](const auto& other) { return other.get() == &connection; });
}

TcpServer::TcpServer(asio::io_context& context, plc::Rack& rack, link::LoopClock& clock, std::string protocol,
                     MakeConversation make, TcpServerOptions options, link::ClientReport report)
    : parts_(std::make_shared<Parts>(context, rack, clock, std::move(protocol), std::move(make),
                                     std::move(options), std::move(report))) {}

TcpServer::~TcpServer() { stop(); }

std::expected<void, std::string> TcpServer::listen(const std::string& host, std::uint16_t port) {
  return parts_->port.listen(
      host, port,
      {.admit = [parts = parts_](tcp::socket socket) { parts->admit(std::move(socket)); },
       .refuse =
           [parts = parts_](tcp::socket& socket) {
             parts->say(link::name_of_peer(socket), link::TcpPort::no_descriptor_left);
           }});
}

std::uint16_t TcpServer::port() const noexcept { return parts_->port.port(); }

std::size_t TcpServer::clients() const noexcept { return parts_->connections.size(); }

std::uint64_t TcpServer::requests() const noexcept { return parts_->requests; }

void TcpServer::stop() noexcept {
  parts_->port.close();
  parts_->look_timer.cancel();
  for (const auto& connection : parts_->connections) connection->close();
  parts_->connections.clear();
}

}  // namespace canopus::serve
