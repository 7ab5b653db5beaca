// A bus behind a socketcand server.

#include <array>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include "canopus/link/bus_client.hpp"
#include "canopus/link/socketcand_dialogue.hpp"

namespace canopus::link {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// The connection; handlers under way keep it alive after its client is gone.
class Connection final : public std::enable_shared_from_this<Connection>, private SocketcandDialogue::Peer {
 public:
  Connection(asio::io_context& io, const BusAddress& address)
      : io_(io), resolver_(io), socket_(io), dialogue_(address.bus, *this) {}

  void connect(const BusAddress& address) {
    const auto connected = [self = shared_from_this()](const error_code& failure, const tcp::endpoint&) {
      if (failure) return self->end(describe(failure));
      error_code ignored;
      self->socket_.set_option(tcp::no_delay(true), ignored);
      self->read();
    };
    resolver_.async_resolve(address.host, std::to_string(address.port),
                            [self = shared_from_this(), connected](const error_code& failure,
                                                                   const tcp::resolver::results_type& found) {
                              if (failure) return self->end(failure.message());
                              asio::async_connect(self->socket_, found, connected);
                            });
  }

  [[nodiscard]] bool joined() const { return dialogue_.state() == SocketcandDialogue::State::raw; }
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }
  void set_user(BusClientUser* user) { user_ = user; }

  bool send(const can::Frame& frame) {
    if (ended_ || closing_ || waiting_.size() >= most_waiting) return false;
    std::array<char, socketcand_max_send> text;
    waiting_.append(text.data(), write_socketcand_send(text, frame));
    write();
    return true;
  }

  /// What is queued is still sent, then the server ends the connection.
  void close_softly() {
    closing_ = true;
    write();
  }
  void close() {
    user_ = nullptr;
    ended_ = true;
    error_code ignored;
    resolver_.cancel();
    socket_.close(ignored);
  }
  /// Runs the io_context until `done`.
  template <typename Done>
  bool run_until(Done done, Clock::time_point end) {
    while (!done()) {
      if (io_.stopped()) io_.restart();
      if (io_.run_one_until(end) == 0 && Clock::now() >= end) return done();
    }
    return true;
  }

 private:
  // SocketcandDialogue::Peer
  void message(std::string_view text) override {
    waiting_.append(text);
    write();
  }
  void frame_received(const can::Frame& frame) override {
    if (user_ != nullptr) user_->frame_received(frame);
  }
  void complaint(std::string_view text) override {
    if (user_ != nullptr) user_->bus_complains(text);
  }

  static std::string describe(const error_code& failure) {
    if (failure != asio::error::connection_refused) return failure.message();
    return failure.message() +
           ". Is `canopus run` running, without --virtual? Its plant file opens a bus with serve = "
           "\"socketcand:127.0.0.1:29536\"";
  }

  void read() {
    socket_.async_read_some(asio::buffer(input_),
                            [self = shared_from_this()](const error_code& failure, std::size_t size) {
                              self->on_read(failure, size);
                            });
  }
  void on_read(const error_code& failure, std::size_t size) {
    if (ended_) return;
    if (size > 0) dialogue_.receive({input_.data(), size});
    if (dialogue_.state() == SocketcandDialogue::State::failed) return end(dialogue_.error());
    if (failure == asio::error::eof) return end("the server ended the connection");
    if (failure) return end(failure.message());
    read();
  }
  void write() {
    if (writing_ || ended_ || !socket_.is_open()) return;
    if (waiting_.empty()) {
      error_code ignored;
      if (closing_) socket_.shutdown(tcp::socket::shutdown_send, ignored);
      return;
    }
    writing_ = true;
    std::swap(waiting_, output_);
    waiting_.clear();
    asio::async_write(socket_, asio::buffer(output_),
                      [self = shared_from_this()](const error_code& failure, std::size_t) {
                        self->writing_ = false;
                        if (self->ended_) return;
                        // The server's last words, which the reader still takes, say more than this error
                        // does.
                        if (!failure) self->write();
                      });
  }
  void end(std::string reason) {
    if (ended_) return;
    ended_ = true;
    reason_ = std::move(reason);
    error_code ignored;
    socket_.close(ignored);
    if (user_ != nullptr && !closing_) user_->bus_lost(reason_);
  }

  static constexpr std::size_t most_waiting =
      4096 * 40;  // characters: about as many frames as an element is long

  asio::io_context& io_;
  tcp::resolver resolver_;
  tcp::socket socket_;
  SocketcandDialogue dialogue_;
  BusClientUser* user_ = nullptr;
  std::array<char, 16384> input_;
  std::string waiting_;  // to be written next
  std::string output_;   // being written
  bool writing_ = false;
  bool closing_ = false;
  bool ended_ = false;
  std::string reason_;
};

class SocketcandClient final : public BusClient {
 public:
  explicit SocketcandClient(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}
  ~SocketcandClient() override { connection_->close(); }
  SocketcandClient(const SocketcandClient&) = delete;
  SocketcandClient& operator=(const SocketcandClient&) = delete;

  bool send(const can::Frame& frame) override { return connection_->send(frame); }
  void set_user(BusClientUser* user) override { connection_->set_user(user); }
  bool close(std::chrono::milliseconds time_out) override {
    connection_->set_user(nullptr);
    connection_->close_softly();
    const bool done =
        connection_->run_until([this] { return connection_->ended(); }, Clock::now() + time_out);
    connection_->close();
    return done;
  }

 private:
  std::shared_ptr<Connection> connection_;
};

}  // namespace

std::expected<std::unique_ptr<BusClient>, std::string> open_socketcand(asio::io_context& io,
                                                                       const BusAddress& address,
                                                                       std::chrono::milliseconds time_out) {
  auto connection = std::make_shared<Connection>(io, address);
  connection->connect(address);
  const bool answered = connection->run_until([&] { return connection->joined() || connection->ended(); },
                                              Clock::now() + time_out);
  if (!answered || connection->ended()) {
    const std::string reason =
        answered ? connection->reason()
                 : "no answer within " + std::to_string(time_out.count()) + " ms; is it a socketcand server?";
    connection->close();
    return std::unexpected(reason);
  }
  return std::make_unique<SocketcandClient>(std::move(connection));
}

}  // namespace canopus::link
