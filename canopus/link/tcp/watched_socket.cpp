#include "canopus/link/tcp/watched_socket.hpp"

#include <cerrno>
#include <utility>

#include <boost/asio/detail/config.hpp>
#include <boost/asio/version.hpp>
#include <sys/socket.h>
#include <unistd.h>

// What asio's own sockets are made of is no public interface: it is used as it is in one version, that of Debian 12.
#if BOOST_ASIO_VERSION == 102600 && defined(BOOST_ASIO_HAS_EPOLL)
#define CANOPUS_WAITS_WITHOUT_ASKING 1
#include <boost/asio/detail/reactor.hpp>
#include <boost/asio/detail/reactor_op.hpp>
#else
#define CANOPUS_WAITS_WITHOUT_ASKING 0
#endif

namespace canopus::link {

namespace asio = boost::asio;
using asio::ip::tcp;

#if CANOPUS_WAITS_WITHOUT_ASKING

namespace {

/// One wait. The reactor takes it that all has been read or written when it ends, so the next one asks for nothing.
class Wait final : public asio::detail::reactor_op {
 public:
  using User = WatchedSocket::User;
  using Tell = void (User::*)();

  Wait(User& user, Tell tell)
      : reactor_op(
            {}, [](reactor_op*) { return done_and_exhausted; }, &complete),
        user_(user),
        tell_(tell) {}

  /// Until it is told of or given up.
  void keep(std::shared_ptr<void> keeper) noexcept { keeper_ = std::move(keeper); }
  void give_up() noexcept { is_over_ = true; }

  bool is_ready = false;  // nobody will tell of what is there

 private:
  static void complete(void* loop, asio::detail::operation* base, const boost::system::error_code&,
                       std::size_t) {
    auto* const wait = static_cast<Wait*>(base);
    const std::shared_ptr<void> keeper = std::move(wait->keeper_);  // this wait may be gone after it
    wait->is_ready = true;
    if (loop != nullptr && !wait->is_over_) (wait->user_.*wait->tell_)();
  }

  User& user_;
  Tell tell_;
  std::shared_ptr<void> keeper_;
  bool is_over_ = false;
};

}  // namespace

struct WatchedSocket::Parts {
  using Reactor = asio::detail::reactor;

  Parts(asio::io_context& context, tcp::socket socket, User& user)
      : reactor(asio::use_service<Reactor>(context)),
        reading(user, &User::can_read),
        writing(user, &User::can_write) {
    boost::system::error_code failure;
    socket.non_blocking(true, failure);
    descriptor = socket.release(failure);
    reactor.init_task();
    // The kernel may have no memory to watch it.
    if (reactor.register_descriptor(descriptor, registration) != 0) close();
  }

  void has_read(bool may_have_more) noexcept { reading.is_ready = may_have_more; }
  void has_written(bool all) noexcept { writing.is_ready = all; }

  void wait(Reactor::op_types kind, Wait& wait, std::shared_ptr<void> keeper) {
    if (descriptor < 0) return;
    wait.keep(std::move(keeper));
    if (wait.is_ready)
      reactor.post_immediate_completion(&wait, false);
    else
      reactor.start_op(kind, descriptor, registration, &wait, false, true);
  }

  void close() noexcept {
    if (descriptor < 0) return;
    reading.give_up();
    writing.give_up();
    ::shutdown(descriptor, SHUT_RDWR);
    reactor.deregister_descriptor(descriptor, registration, true);
    ::close(std::exchange(descriptor, -1));
    reactor.cleanup_descriptor_data(registration);
  }

  Reactor& reactor;
  Reactor::per_descriptor_data registration = nullptr;
  int descriptor = -1;
  Wait reading;
  Wait writing;
};

void WatchedSocket::wait_to_read(std::shared_ptr<void> keeper) {
  parts_->wait(Parts::Reactor::read_op, parts_->reading, std::move(keeper));
}

void WatchedSocket::wait_to_write(std::shared_ptr<void> keeper) {
  parts_->wait(Parts::Reactor::write_op, parts_->writing, std::move(keeper));
}

int WatchedSocket::native_handle() const noexcept { return parts_->descriptor; }

#else

struct WatchedSocket::Parts {
  Parts(asio::io_context&, tcp::socket the_socket, User& the_user)
      : socket(std::move(the_socket)), user(the_user) {
    boost::system::error_code failure;
    socket.non_blocking(true, failure);
  }

  void has_read(bool) noexcept {}
  void has_written(bool) noexcept {}

  void wait(tcp::socket::wait_type kind, void (User::*tell)(), std::shared_ptr<void> keeper) {
    socket.async_wait(kind, [this, tell, keeper = std::move(keeper)](const boost::system::error_code& error) {
      if (error != asio::error::operation_aborted && socket.is_open()) (user.*tell)();
    });
  }

  void close() noexcept {
    boost::system::error_code ignored;
    socket.shutdown(tcp::socket::shutdown_both, ignored);
    socket.close(ignored);
  }

  tcp::socket socket;
  User& user;
};

void WatchedSocket::wait_to_read(std::shared_ptr<void> keeper) {
  parts_->wait(tcp::socket::wait_read, &User::can_read, std::move(keeper));
}

void WatchedSocket::wait_to_write(std::shared_ptr<void> keeper) {
  parts_->wait(tcp::socket::wait_write, &User::can_write, std::move(keeper));
}

int WatchedSocket::native_handle() const noexcept {
  return parts_->socket.is_open() ? parts_->socket.native_handle() : -1;
}

#endif

namespace {

WatchedSocket::Transfer transfer_of(ssize_t count) noexcept {
  if (count < 0) return {.error = errno};
  return {.count = static_cast<std::size_t>(count)};
}

}  // namespace

bool WatchedSocket::Transfer::has_to_wait() const noexcept { return error == EAGAIN || error == EWOULDBLOCK; }

WatchedSocket::WatchedSocket(asio::io_context& context, tcp::socket socket, User& user)
    : parts_(std::make_unique<Parts>(context, std::move(socket), user)) {}

WatchedSocket::~WatchedSocket() { close(); }

WatchedSocket::Transfer WatchedSocket::read(std::span<std::uint8_t> space) noexcept {
  ssize_t count = 0;
  do {
    count = ::recv(native_handle(), space.data(), space.size(), 0);
  } while (count < 0 && errno == EINTR);
  const Transfer result = transfer_of(count);
  has_read(result, space.size());
  return result;
}

void WatchedSocket::has_read(const Transfer& result, std::size_t space) noexcept {
  parts_->has_read(result.count == space);
  is_doubtful_ = result.count != 0;
}

WatchedSocket::Transfer WatchedSocket::write(std::span<const std::uint8_t> data) noexcept {
  ssize_t count = 0;
  do {
    count = ::send(native_handle(), data.data(), data.size(), MSG_NOSIGNAL);
  } while (count < 0 && errno == EINTR);
  const Transfer result = transfer_of(count);
  has_written(result, data.size());
  return result;
}

void WatchedSocket::has_written(const Transfer& result, std::size_t size) noexcept {
  parts_->has_written(result.count == size);
}

void WatchedSocket::close() noexcept { parts_->close(); }

}  // namespace canopus::link
