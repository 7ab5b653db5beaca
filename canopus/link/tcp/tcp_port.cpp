#include "canopus/link/tcp/tcp_port.hpp"

#include <chrono>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fcntl.h>
#include <unistd.h>

namespace canopus::link {
namespace {

/// A file descriptor kept in reserve. When the process has none left, a connection can still be taken, to send its
/// client so, instead of leaving it to wait without an answer.
class SpareDescriptor {
 public:
  SpareDescriptor() { reserve(); }
  ~SpareDescriptor() { release(); }
  SpareDescriptor(const SpareDescriptor&) = delete;
  SpareDescriptor& operator=(const SpareDescriptor&) = delete;

  /// Takes the next connection that waits, with the reserve, and hands its socket to `refuse`, which does not keep
  /// it. False when none could be taken; the acceptor must not block.
  template <typename Refuse>
  bool refuse_next(boost::asio::ip::tcp::acceptor& acceptor, Refuse refuse) {
    if (file_ < 0) reserve();
    if (file_ < 0) return false;
    release();
    boost::system::error_code error;
    {
      boost::asio::ip::tcp::socket socket(acceptor.get_executor());
      acceptor.accept(socket, error);
      if (!error) refuse(socket);
    }
    reserve();
    return !error;
  }

 private:
  void reserve() { file_ = ::open("/dev/null", O_RDONLY | O_CLOEXEC); }
  void release() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }
  int file_ = -1;
};

}  // namespace

namespace asio = boost::asio;
using boost::system::error_code;

struct TcpPort::State : std::enable_shared_from_this<State> {
  explicit State(asio::io_context& context) : acceptor(context), pause(context) {}

  void accept();
  /// False: none could be taken.
  bool refuse_next() {
    return spare.refuse_next(acceptor, [refuse = users.refuse](Socket& socket) { refuse(socket); });
  }

  Acceptor acceptor;
  asio::steady_timer pause;
  SpareDescriptor spare;
  Users users{};
};

void TcpPort::State::accept() {
  acceptor.async_accept([self = shared_from_this()](error_code failure, Socket socket) {
    if (!self->acceptor.is_open()) return;
    // The system reports this even without a pending connection; by now there may be descriptors again.
    if (failure == asio::error::no_descriptors) self->acceptor.accept(socket, failure);
    if (!failure) {
      // A connection that the peer has reset meanwhile has no address any more and is dropped.
      error_code gone;
      (void)socket.remote_endpoint(gone);
      const auto admit = self->users.admit;  // it may close the port
      if (!gone) admit(std::move(socket));
      if (self->acceptor.is_open()) self->accept();
      return;
    }
    if (failure == asio::error::no_descriptors && self->refuse_next()) return self->accept();
    // Trying again at once would only burn the processor; the port stays open for later.
    self->pause.expires_after(std::chrono::milliseconds(100));
    self->pause.async_wait([self](const error_code&) {
      if (self->acceptor.is_open()) self->accept();
    });
  });
}

TcpPort::TcpPort(asio::io_context& context) : state_(std::make_shared<State>(context)) {}

TcpPort::~TcpPort() { close(); }

error_code TcpPort::listen(const Endpoint& endpoint, Users users, void (*prepare)(Acceptor& acceptor)) {
  Acceptor& acceptor = state_->acceptor;
  error_code failure;
  acceptor.open(endpoint.protocol(), failure);
  if (!failure) acceptor.set_option(Acceptor::reuse_address(true), failure);
  if (!failure && prepare != nullptr) prepare(acceptor);
  if (!failure) acceptor.bind(endpoint, failure);
  if (!failure) acceptor.listen(asio::socket_base::max_listen_connections, failure);
  if (!failure) acceptor.non_blocking(true, failure);
  if (failure) {
    close();
    return failure;
  }
  state_->users = std::move(users);
  state_->accept();
  return {};
}

std::expected<void, std::string> TcpPort::listen(const std::string& host, std::uint16_t port, Users users) {
  using asio::ip::tcp;
  error_code error;
  tcp::resolver resolver(state_->acceptor.get_executor());
  const auto found = resolver.resolve(host, std::to_string(port),
                                      tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (!error) error = listen(found.begin()->endpoint(), std::move(users));
  if (error) return std::unexpected(host + ":" + std::to_string(port) + ": " + error.message());
  return {};
}

std::uint16_t TcpPort::port() const noexcept {
  error_code failure;
  const Endpoint local = state_->acceptor.local_endpoint(failure);
  return failure ? std::uint16_t{0} : local.port();
}

void TcpPort::close() noexcept {
  error_code ignored;
  state_->acceptor.close(ignored);
  state_->pause.cancel(ignored);
  state_->users = {};
}

}  // namespace canopus::link
