#include "canopus/serve/tcp_server.hpp"

#include <algorithm>
#include <ctime>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "canopus/link/tcp/connection_places.hpp"
#include "canopus/link/tcp/tcp_port.hpp"
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

struct TcpServer::Parts {
  Parts(asio::io_context& io, plc::Rack& the_rack, link::LoopClock& the_clock, std::string the_protocol,
        MakeConversation the_make, TcpServerOptions the_options, link::ClientReport the_report)
      : context(io),
        rack(the_rack),
        clock(the_clock),
        protocol(std::move(the_protocol)),
        make(std::move(the_make)),
        options(std::move(the_options)),
        report(std::move(the_report)),
        port(io) {}

  void admit(tcp::socket socket);
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
  std::vector<std::shared_ptr<Connection>> connections;
  std::uint64_t requests = 0;
  std::uint64_t heard = 0;  // messages from clients and connections, so far
};

/// One client. Handlers hold it; it forgets the server when the server is gone.
class TcpServer::Connection : public std::enable_shared_from_this<Connection>,
                              private plc::EndProcessing::Requests {
 public:
  Connection(Parts& parts, tcp::socket socket, std::string name)
      : parts_(&parts),
        socket_(std::move(socket)),
        name_(std::move(name)),
        heard_number_(++parts.heard),
        timer_(parts.context),
        session_(parts.make(link::address_of_peer(socket_))) {}

  void start() {
    error_code ignored;
    socket_.non_blocking(true, ignored);
    set(IPPROTO_TCP, TCP_NODELAY, 1);
    check_alive();
    receive();
  }

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] link::HeldPlace place() const noexcept {
    return {.hold = link::Hold::while_used, .used = heard_at_, .number = heard_number_};
  }

  void close() noexcept {
    if (parts_ != nullptr) parts_->rack.end_processing().leave(*this);
    parts_ = nullptr;
    error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_both, ignored);
    socket_.close(ignored);
    timer_.stop();
  }

 private:
  /// Bytes go where the session wants them when they are there: until then the END of a scan may move those before them.
  void receive() {
    if (is_receiving_ || is_sending_ || input_ended_ || session_->space().empty()) return;
    is_receiving_ = true;
    socket_.async_wait(tcp::socket::wait_read, [self = shared_from_this()](const error_code& error) {
      self->is_receiving_ = false;
      if (self->parts_ == nullptr) return;
      if (error) return self->end_input(error);
      if (!self->is_sending_) self->read();
    });
  }

  void read() {
    const auto space = session_->space();
    if (space.empty()) return;  // work() makes some, and goes on
    error_code error;
    const std::size_t count = socket_.read_some(asio::buffer(space.data(), space.size()), error);
    if (error == asio::error::would_block) return receive();
    if (error) return end_input(error);
    heard_at_ = CoarseClock::now();
    heard_number_ = ++parts_->heard;
    session_->received(count);
    work();
  }

  void end_input(const error_code& error) {
    input_ended_ = true;
    // What it has asked is still done and answered.
    if (is_waiting_ || !session_->output().empty()) return;
    end(error == asio::error::timed_out ? "does not answer the alive check any more" : nullptr);
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
    for (auto output = session_->output(); !output.empty(); output = session_->output()) {
      error_code error;
      const std::size_t count = socket_.write_some(asio::buffer(output.data(), output.size()), error);
      if (error) {
        if (error == asio::error::would_block)
          wait_to_send();
        else
          end();
        return false;
      }
      session_->sent(count);
    }
    return true;
  }

  void wait_to_send() {
    is_sending_ = true;
    set_timer(parts_->options.send_timeout, "does not take its replies");
    socket_.async_wait(tcp::socket::wait_write, [self = shared_from_this()](const error_code& error) {
      if (self->parts_ == nullptr) return;
      if (error) return self->end();
      self->timer_.stop();
      self->is_sending_ = false;
      self->work();
    });
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
  tcp::socket socket_;
  std::string name_;
  std::uint64_t heard_number_;  // later is higher, and no two are equal
  CoarseClock::time_point heard_at_ = CoarseClock::now();
  ConnectionTimer timer_;
  bool is_receiving_ = false;  // waits for bytes
  bool is_sending_ = false;    // waits for room to send
  bool is_waiting_ = false;    // for the END of the scan
  bool input_ended_ = false;   // nothing more comes
  std::unique_ptr<Conversation> session_;
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
  for (const auto& connection : parts_->connections) connection->close();
  parts_->connections.clear();
}

}  // namespace canopus::serve
