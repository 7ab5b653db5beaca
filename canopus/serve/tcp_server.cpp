#include "canopus/serve/tcp_server.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "canopus/link/tcp_clients.hpp"

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
      : clients(io,
                {.allowed = the_options.allowed,
                 .most = the_options.maximum_clients,
                 .gives_way_after = the_options.gives_way_after},
                std::move(the_report)),
        rack(the_rack),
        clock(the_clock),
        protocol(std::move(the_protocol)),
        make(std::move(the_make)),
        options(std::move(the_options)) {}

  void admit(tcp::socket socket);

  link::TcpClients<Connection> clients;
  plc::Rack& rack;
  link::LoopClock& clock;
  std::string protocol;
  MakeConversation make;
  TcpServerOptions options;
  std::uint64_t requests = 0;
  std::uint64_t heard = 0;  // messages from clients and connections, so far
};

class TcpServer::Connection : public link::TcpClient<Connection>, private plc::EndProcessing::Requests {
 public:
  Connection(Parts& parts, tcp::socket socket, std::string name)
      : TcpClient(parts.clients, std::move(name)),
        parts_(parts),
        socket_(std::move(socket)),
        heard_number_(++parts.heard),
        session_(parts.make(link::address_of_peer(socket_))) {}

  void start() {
    error_code ignored;
    socket_.non_blocking(true, ignored);
    set(IPPROTO_TCP, TCP_NODELAY, 1);
    check_alive();
    receive();
  }

  [[nodiscard]] link::HeldPlace place() const noexcept {
    return {.hold = link::Hold::while_used, .used = received_at_, .number = heard_number_};
  }

  void close() noexcept {
    if (!is_closed()) parts_.rack.end_processing().leave(*this);
    close_socket(socket_);
  }

 private:
  /// space() is read when bytes have arrived: until then the END of a scan may move those before them.
  void receive() {
    if (is_receiving_ || is_sending_ || input_ended_ || session_->space().empty()) return;
    is_receiving_ = true;
    socket_.async_wait(tcp::socket::wait_read, [self = shared_from_this()](const error_code& error) {
      self->is_receiving_ = false;
      if (self->is_closed()) return;
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
    received_at_ = CoarseClock::now();
    heard_number_ = ++parts_.heard;
    session_->received(count);
    work();
  }

  void end_input(const error_code& error) {
    input_ended_ = true;
    // Its pending requests are still executed and answered.
    if (is_waiting_ || !session_->output().empty()) return;
    end(error == asio::error::timed_out ? "does not answer the alive check any more" : nullptr);
  }

  void set(int level, int name, int value) noexcept {
    ::setsockopt(socket_.native_handle(), level, name, &value, sizeof value);
  }

  void check_alive() {
    const TcpServerOptions& options = parts_.options;
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
      if (session_->over()) return end(reason_of_end().c_str());
    } while (answer_complete(progress));
    if (is_closed()) return;  // the run ended on the way there
    watch_request(progress);
    if (input_ended_ && !is_waiting_) return end();
    receive();
  }

  [[nodiscard]] std::string reason_of_end() const {
    const std::string_view refusal = session_->refusal();
    return refusal.empty() ? "sent what is no request of the " + parts_.protocol : std::string(refusal);
  }

  /// Answers what is complete, unless that has to wait for the END of the scan. Whether there may be more to do.
  bool answer_complete(bool& progress) {
    if (!session_->has_request()) return false;
    if (parts_.rack.answers_at_end()) {
      is_waiting_ = true;
      parts_.rack.end_processing().wait(*this);
      return false;
    }
    const can::Time now = parts_.clock.now();
    if (is_closed()) return false;
    if (answer(now)) {
      progress = true;
      parts_.clock.accessed();
    }
    return !is_closed();
  }

  /// Whether something was answered.
  bool answer(can::Time now) {
    const std::size_t answered = session_->process(now);
    parts_.requests += answered;
    return answered != 0;
  }

  // plc::EndProcessing::Requests: inside the timeline, so what is answered is sent afterwards.
  void answer_requests(can::Time now) override {
    is_waiting_ = false;
    const bool progress = answer(now);
    asio::post(parts_.clients.context(), [self = shared_from_this(), progress] {
      if (self->is_closed()) return;
      self->parts_.clock.touched();
      if (!self->is_closed() && !self->is_sending_) self->work(progress);
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
    set_timer(parts_.options.send_timeout, "does not take its replies");
    socket_.async_wait(tcp::socket::wait_write, [self = shared_from_this()](const error_code& error) {
      if (self->is_closed()) return;
      if (error) return self->end();
      self->stop_timer();
      self->is_sending_ = false;
      self->work();
    });
  }

  /// A request that has begun has its time; one that is answered gives the next its own.
  void watch_request(bool progress) {
    if (is_waiting_ || !session_->half_request()) return stop_timer();
    if (progress || !is_timer_set())
      set_timer(parts_.options.half_request_timeout, "left a request incomplete");
  }

  Parts& parts_;
  tcp::socket socket_;
  std::uint64_t heard_number_;  // later is higher, and no two are equal
  CoarseClock::time_point received_at_ = CoarseClock::now();
  bool is_receiving_ = false;  // waits for bytes
  bool is_sending_ = false;    // waits for room to send
  bool is_waiting_ = false;    // for the END of the scan
  bool input_ended_ = false;   // nothing more comes
  std::unique_ptr<Conversation> session_;
};

void TcpServer::Parts::admit(tcp::socket socket) {
  if (!clients.may_connect(socket)) return;
  std::string name = link::name_of_peer(socket);
  if (!clients.make_room(name, CoarseClock::now())) return;
  clients.add(std::make_shared<Connection>(*this, std::move(socket), std::move(name)))->start();
}

TcpServer::TcpServer(asio::io_context& context, plc::Rack& rack, link::LoopClock& clock, std::string protocol,
                     MakeConversation make, TcpServerOptions options, link::ClientReport report)
    : parts_(std::make_shared<Parts>(context, rack, clock, std::move(protocol), std::move(make),
                                     std::move(options), std::move(report))) {}

TcpServer::~TcpServer() { stop(); }

std::expected<void, std::string> TcpServer::listen(const std::string& host, std::uint16_t port) {
  return parts_->clients.listen(host, port,
                                [parts = parts_](tcp::socket socket) { parts->admit(std::move(socket)); });
}

std::uint16_t TcpServer::port() const noexcept { return parts_->clients.port(); }

std::size_t TcpServer::clients() const noexcept { return parts_->clients.size(); }

std::uint64_t TcpServer::requests() const noexcept { return parts_->requests; }

void TcpServer::stop() noexcept { parts_->clients.close(); }

}  // namespace canopus::serve
