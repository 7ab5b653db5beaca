#include "canopus/link/socket_pair.hpp"

#include <array>
#include <cerrno>
#include <cstring>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <sys/socket.h>

#include "canopus/link/transport.hpp"

namespace canopus::link {
namespace {

using boost::system::error_code;

class PairTransport final : public Transport {
 public:
  PairTransport(boost::asio::io_context& io, int socket) : Transport(io, {}), socket_(io, socket) {}

 private:
  void connect() override {
    read();
    opened();
  }
  void disconnect() override {
    error_code ignored;
    socket_.close(ignored);
  }
  void read() {
    socket_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                       [self = self(this)](const error_code& failure) {
                         if (!failure) self->on_readable();
                       });
  }
  void on_readable() {
    while (socket_.is_open()) {
      can::Frame frame;
      const ssize_t size = ::recv(socket_.native_handle(), &frame, sizeof frame, MSG_DONTWAIT);
      if (size == sizeof frame) {
        received(frame);
      } else if (size < 0 && errno == EAGAIN) {
        return read();
      } else if (size >= 0 || errno != EINTR) {
        return failed("the other end is gone");
      }
    }
  }
  void write() override {
    while (!queue().empty()) {
      const can::Frame frame = queue().front();
      if (::send(socket_.native_handle(), &frame, sizeof frame, MSG_DONTWAIT | MSG_NOSIGNAL) !=
          sizeof frame) {
        if (errno == EAGAIN) return;  // the peer does not read; the next frame tries again
        return fail_later(std::strerror(errno));
      }
      queue().pop_front();
      sent_later(frame);
    }
  }

  boost::asio::posix::stream_descriptor socket_;
};

}  // namespace

std::expected<std::pair<std::unique_ptr<BusClient>, std::unique_ptr<BusClient>>, std::string>
open_socket_pair(boost::asio::io_context& one, boost::asio::io_context& other) {
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, sockets.data()) != 0) {
    return std::unexpected(std::string("no pair of sockets: ") + std::strerror(errno));
  }
  auto first = open_transport(std::make_shared<PairTransport>(one, sockets[0]), std::chrono::seconds(1));
  auto second = open_transport(std::make_shared<PairTransport>(other, sockets[1]), std::chrono::seconds(1));
  if (!first) return std::unexpected(first.error());
  if (!second) return std::unexpected(second.error());
  return std::pair(std::move(*first), std::move(*second));
}

}  // namespace canopus::link
