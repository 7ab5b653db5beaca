#include "canopus/serve/control_server.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include "canopus/link/tcp/connection_places.hpp"
#include "canopus/link/tcp/tcp_port.hpp"
#include "canopus/serve/connection_timer.hpp"

namespace canopus::serve {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using WallClock = std::chrono::steady_clock;

struct ControlServer::Parts {
  Parts(asio::io_context& io, link::LoopClock& the_clock, Answer the_answer, ControlServerOptions the_options,
        link::ClientReport the_report)
      : context(io),
        clock(the_clock),
        answer(std::move(the_answer)),
        options(std::move(the_options)),
        report(std::move(the_report)),
        port(io) {}

  void admit(tcp::socket socket);
  void remove(const Connection& connection);
  void say(const std::string& client, const std::string& what) const {
    if (report) report(client + ' ' + what);
  }

  asio::io_context& context;
  link::LoopClock& clock;
  Answer answer;
  ControlServerOptions options;
  link::ClientReport report;
  link::TcpPort port;
  std::vector<std::shared_ptr<Connection>> connections;
};

/// One client: reads a line, waits for its answer and sends it, and goes on with the next line. Handlers hold it;
/// it forgets the server when the server is gone.
class ControlServer::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Parts& parts, tcp::socket socket)
      : parts_(&parts),
        socket_(std::move(socket)),
        name_(link::name_of_peer(socket_)),
        timer_(parts.context) {}

  void start() {
    error_code ignored;
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.set_option(asio::socket_base::keep_alive(true), ignored);
    receive();
  }

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// While it waits for its answer it has a reason to be silent.
  [[nodiscard]] link::HeldPlace place() const noexcept {
    return {.hold = state_ == State::waits ? link::Hold::firm : link::Hold::while_used, .used = heard_at_};
  }

  void close() noexcept {
    parts_ = nullptr;
    call_off();
    error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_both, ignored);
    socket_.close(ignored);
    timer_.stop();
  }

 private:
  enum class State : std::uint8_t {
    reads,  // up to the end of a line
    waits,  // for the answer; it reads on, to see its client leave
    sends,
    ends,  // with the answer that is being sent
  };

  void receive() {
    if (receiving_ || input_.size() > parts_->options.most_waiting) return;
    receiving_ = true;
    socket_.async_read_some(asio::buffer(buffer_),
                            [self = shared_from_this()](error_code error, std::size_t count) {
                              self->receiving_ = false;
                              if (self->parts_ != nullptr) self->received(error, count);
                            });
  }

  void received(const error_code& error, std::size_t count) {
    if (error) {
      if (state_ != State::sends) return end();
      state_ = State::ends;  // who has closed its side may still read
      return;
    }
    heard_at_ = WallClock::now();
    input_.append(buffer_.data(), count);
    if (state_ == State::reads) return work();
    if (state_ == State::waits) receive();
  }

  /// Answers the first line that is complete.
  void work() {
    const std::size_t end = input_.find('\n');
    const std::size_t length = std::min(end, input_.size());
    if (length > parts_->options.longest_line) {
      const std::string limit = std::to_string(parts_->options.longest_line);
      parts_->say(name_, "sent a line of more than " + limit + " bytes: its connection is closed");
      send(R"({"ok":false,"error":"a request has at most )" + limit + " bytes\"}\n", State::ends);
      return;
    }
    if (end == std::string::npos) {
      if (input_.empty()) {
        timer_.stop();
      } else if (!timer_.is_set()) {
        set_timer(parts_->options.half_line_timeout, "left a request incomplete");
      }
      return receive();
    }
    timer_.stop();
    (void)parts_->clock.now();
    if (parts_ == nullptr) return;  // the run ended on the way there
    const std::string line = input_.substr(0, end);
    input_.erase(0, end + 1);
    state_ = State::waits;
    const auto reply = [weak = weak_from_this()](std::string answer) {
      if (const auto self = weak.lock()) self->answered(std::move(answer));
    };
    CallOff call_off = parts_->answer(line, reply);
    if (parts_ == nullptr || state_ != State::waits) return;
    call_off_ = std::move(call_off);
    parts_->clock.touched();
    if (parts_ != nullptr) receive();
  }

  void answered(std::string answer) {
    if (parts_ == nullptr || state_ != State::waits) return;
    call_off_ = nullptr;
    parts_->clock.touched();
    if (parts_ != nullptr) send(std::move(answer), State::sends);
  }

  void send(std::string answer, State state) {
    state_ = state;
    output_ = std::move(answer);
    set_timer(parts_->options.send_timeout, "does not take its answers");
    asio::async_write(socket_, asio::buffer(output_),
                      [self = shared_from_this()](error_code error, std::size_t) {
                        if (self->parts_ == nullptr) return;
                        if (error || self->state_ == State::ends) return self->end();
                        self->timer_.stop();
                        self->state_ = State::reads;
                        self->work();
                      });
  }

  void call_off() noexcept {
    if (const CallOff wanted = std::exchange(call_off_, nullptr)) wanted();
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
  WallClock::time_point heard_at_ = WallClock::now();
  ConnectionTimer timer_;
  std::array<char, 1024> buffer_{};
  std::string input_;
  std::string output_;
  State state_ = State::reads;
  bool receiving_ = false;
  CallOff call_off_;
};

void ControlServer::Parts::admit(tcp::socket socket) {
  const std::string name = link::name_of_peer(socket);
  if (!link::is_allowed(socket, options.allowed)) return say(name, "is not allowed to connect");
  const link::ConnectionPlaces places(options.maximum_clients, options.gives_way_after);
  const auto report_of = [this](const std::string& client, const std::string& what) { say(client, what); };
  if (!places.make_room(connections, name, WallClock::now(), report_of)) return;
  connections.push_back(std::make_shared<Connection>(*this, std::move(socket)));
  connections.back()->start();
}

void ControlServer::Parts::remove(const Connection& connection) {
  std::erase_if(connections, [&](const auto& other) { return other.get() == &connection; });
}

ControlServer::ControlServer(asio::io_context& context, link::LoopClock& clock, Answer answer,
                             ControlServerOptions options, link::ClientReport report)
    : parts_(std::make_shared<Parts>(context, clock, std::move(answer), std::move(options),
                                     std::move(report))) {}

ControlServer::~ControlServer() { stop(); }

std::expected<void, std::string> ControlServer::listen(const std::string& host, std::uint16_t port) {
  return parts_->port.listen(
      host, port,
      {.admit = [parts = parts_](tcp::socket socket) { parts->admit(std::move(socket)); },
       .refuse =
           [parts = parts_](tcp::socket& socket) {
             parts->say(link::name_of_peer(socket), link::TcpPort::no_descriptor_left);
           }});
}

std::uint16_t ControlServer::port() const noexcept { return parts_->port.port(); }

std::size_t ControlServer::clients() const noexcept { return parts_->connections.size(); }

void ControlServer::stop() noexcept {
  parts_->port.close();
  for (const auto& connection : parts_->connections) connection->close();
  parts_->connections.clear();
}

}  // namespace canopus::serve
