#include "canopus/serve/control_server.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include "canopus/link/tcp_clients.hpp"

namespace canopus::serve {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using WallClock = std::chrono::steady_clock;

struct ControlServer::Parts {
  Parts(asio::io_context& io, link::LoopClock& the_clock, Answer the_answer, ControlServerOptions the_options,
        link::ClientReport the_report)
      : clients(io,
                {.allowed = the_options.allowed,
                 .most = the_options.maximum_clients,
                 .gives_way_after = the_options.gives_way_after},
                std::move(the_report)),
        clock(the_clock),
        answer(std::move(the_answer)),
        options(std::move(the_options)) {}

  void admit(tcp::socket socket);

  link::TcpClients<Connection> clients;
  link::LoopClock& clock;
  Answer answer;
  ControlServerOptions options;
};

/// One client: reads a line, waits for its answer and sends it, and goes on with the next line.
class ControlServer::Connection : public link::TcpClient<Connection> {
 public:
  Connection(Parts& parts, tcp::socket socket, std::string name)
      : TcpClient(parts.clients, std::move(name)), parts_(parts), socket_(std::move(socket)) {}

  void start() {
    error_code ignored;
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.set_option(asio::socket_base::keep_alive(true), ignored);
    receive();
  }

  /// While it waits for its answer it has a reason to be silent.
  [[nodiscard]] link::HeldPlace place() const noexcept {
    return {.hold = state_ == State::waits ? link::Hold::firm : link::Hold::while_used, .used = received_at_};
  }

  void close() noexcept {
    close_socket(socket_);
    call_off();
  }

 private:
  enum class State : std::uint8_t {
    reads,  // up to the end of a line
    waits,  // for the answer; it continues reading to detect the client's disconnect
    sends,
    ends,  // with the answer that is being sent
  };

  void receive() {
    if (receiving_ || input_.size() > parts_.options.most_waiting) return;
    receiving_ = true;
    socket_.async_read_some(asio::buffer(buffer_),
                            [self = shared_from_this()](error_code error, std::size_t count) {
                              self->receiving_ = false;
                              if (!self->is_closed()) self->received(error, count);
                            });
  }

  void received(const error_code& error, std::size_t count) {
    if (error) {
      if (state_ != State::sends) return end();
      state_ = State::ends;  // a client that has closed its side may still read
      return;
    }
    received_at_ = WallClock::now();
    input_.append(buffer_.data(), count);
    if (state_ == State::reads) return work();
    if (state_ == State::waits) receive();
  }

  /// Answers the first line that is complete.
  void work() {
    const std::size_t end = input_.find('\n');
    const std::size_t length = std::min(end, input_.size());
    if (length > parts_.options.longest_line) {
      const std::string limit = std::to_string(parts_.options.longest_line);
      report("sent a line of more than " + limit + " bytes: its connection is closed");
      send(R"({"ok":false,"error":"a request has at most )" + limit + " bytes\"}\n", State::ends);
      return;
    }
    if (end == std::string::npos) {
      if (input_.empty()) {
        stop_timer();
      } else if (!is_timer_set()) {
        set_timer(parts_.options.half_line_timeout, "left a request incomplete");
      }
      return receive();
    }
    stop_timer();
    (void)parts_.clock.now();
    if (is_closed()) return;  // the run ended on the way there
    const std::string line = input_.substr(0, end);
    input_.erase(0, end + 1);
    state_ = State::waits;
    const auto reply = [weak = weak_from_this()](std::string answer) {
      if (const auto self = weak.lock()) self->answered(std::move(answer));
    };
    CallOff call_off = parts_.answer(line, reply);
    if (is_closed() || state_ != State::waits) return;
    call_off_ = std::move(call_off);
    parts_.clock.touched();
    if (!is_closed()) receive();
  }

  void answered(std::string answer) {
    if (is_closed() || state_ != State::waits) return;
    call_off_ = nullptr;
    parts_.clock.touched();
    if (!is_closed()) send(std::move(answer), State::sends);
  }

  void send(std::string answer, State state) {
    state_ = state;
    output_ = std::move(answer);
    set_timer(parts_.options.send_timeout, "does not take its answers");
    asio::async_write(socket_, asio::buffer(output_),
                      [self = shared_from_this()](error_code error, std::size_t) {
                        if (self->is_closed()) return;
                        if (error || self->state_ == State::ends) return self->end();
                        self->stop_timer();
                        self->state_ = State::reads;
                        self->work();
                      });
  }

  void call_off() noexcept {
    if (const CallOff wanted = std::exchange(call_off_, nullptr)) wanted();
  }

  Parts& parts_;
  tcp::socket socket_;
  WallClock::time_point received_at_ = WallClock::now();
  std::array<char, 1024> buffer_{};
  std::string input_;
  std::string output_;
  State state_ = State::reads;
  bool receiving_ = false;
  CallOff call_off_;
};

void ControlServer::Parts::admit(tcp::socket socket) {
  if (!clients.may_connect(socket)) return;
  std::string name = link::name_of_peer(socket);
  if (!clients.make_room(name, WallClock::now())) return;
  clients.add(std::make_shared<Connection>(*this, std::move(socket), std::move(name)))->start();
}

ControlServer::ControlServer(asio::io_context& context, link::LoopClock& clock, Answer answer,
                             ControlServerOptions options, link::ClientReport report)
    : parts_(std::make_shared<Parts>(context, clock, std::move(answer), std::move(options),
                                     std::move(report))) {}

ControlServer::~ControlServer() { stop(); }

std::expected<void, std::string> ControlServer::listen(const std::string& host, std::uint16_t port) {
  return parts_->clients.listen(host, port,
                                [parts = parts_](tcp::socket socket) { parts->admit(std::move(socket)); });
}

std::uint16_t ControlServer::port() const noexcept { return parts_->clients.port(); }

std::size_t ControlServer::clients() const noexcept { return parts_->clients.size(); }

void ControlServer::stop() noexcept { parts_->clients.close(); }

}  // namespace canopus::serve
