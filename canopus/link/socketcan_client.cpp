// A CAN interface of this machine: a raw socket of Linux SocketCAN.

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <string>
#include <utility>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "canopus/link/can_error.hpp"
#include "canopus/link/transport.hpp"

namespace canopus::link {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

can_frame raw_of(const can::Frame& frame) {
  can_frame raw{};
  raw.can_id = frame.identifier | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
  raw.can_dlc = std::min<std::uint8_t>(frame.dlc, 8);
  std::ranges::copy(frame.bytes(), raw.data);
  return raw;
}

can::Frame frame_of(const can_frame& raw) {
  can::Frame frame{.extended = (raw.can_id & CAN_EFF_FLAG) != 0, .remote = (raw.can_id & CAN_RTR_FLAG) != 0};
  frame.identifier = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.dlc = std::min<std::uint8_t>(raw.can_dlc, 8);
  std::copy_n(raw.data, frame.length(), frame.data.begin());
  return frame;
}

std::expected<int, std::string> open_socket(const std::string& name) {
  const int socket = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (socket < 0) {
    const int reason = errno;
    if (reason == EAFNOSUPPORT || reason == EPROTONOSUPPORT || reason == ESOCKTNOSUPPORT) {
      return std::unexpected("this machine's kernel has no SocketCAN (modules can and can_raw)");
    }
    return std::unexpected(std::string("no CAN socket: ") + std::strerror(reason));
  }
  ifreq request{};
  std::ranges::copy(name, request.ifr_name);
  if (::ioctl(socket, SIOCGIFINDEX, &request) < 0) {
    const int reason = errno;
    ::close(socket);
    if (reason == ENODEV) return std::unexpected("there is no such interface (see `ip link`)");
    return std::unexpected(std::strerror(reason));
  }
  const int number = request.ifr_ifindex;
  const bool is_up = ::ioctl(socket, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
  if (!is_up) {
    ::close(socket);
    return std::unexpected("the interface is down; ip link set " + name + " up");
  }
  const can_err_mask_t errors = CAN_ERR_ACK | CAN_ERR_PROT | CAN_ERR_CRTL | CAN_ERR_BUSOFF;
  (void)::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors);
  sockaddr_can place{};
  place.can_family = AF_CAN;
  place.can_ifindex = number;
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&place), sizeof place) < 0) {
    const int reason = errno;
    ::close(socket);
    if (reason == ENODEV) return std::unexpected("this is not a CAN interface");
    return std::unexpected(std::strerror(reason));
  }
  return socket;
}

class SocketcanTransport final : public Transport {
 public:
  SocketcanTransport(asio::io_context& io, std::string interface, BusClientOptions options)
      : Transport(io, options), interface_(std::move(interface)), socket_(io), pause_(io) {}

 private:
  void connect() override {
    auto socket = open_socket(interface_);
    if (!socket) return failed(socket.error());
    socket_.assign(*socket);
    read();
    opened();
  }
  void disconnect() override {
    ++generation_;
    error_code ignored;
    pause_.cancel();
    waiting_ = false;
    socket_.close(ignored);
  }
  void read() {
    socket_.async_wait(asio::posix::stream_descriptor::wait_read,
                       [self = self(this), generation = generation_](const error_code& failure) {
                         if (!failure && generation == self->generation_) self->on_readable();
                       });
  }
  void on_readable() {
    const std::uint32_t generation = generation_;
    for (int count = 0; generation == generation_ && count < 256; ++count) {
      can_frame raw{};
      const ssize_t size = ::read(socket_.native_handle(), &raw, sizeof raw);
      if (size < 0 && errno == EINTR) continue;
      if (size < 0 && errno == EAGAIN) break;
      if (size < 0) return failed(std::strerror(errno));
      if (size != sizeof raw) continue;
      if ((raw.can_id & CAN_ERR_FLAG) != 0) {
        error_frame(raw);
        continue;
      }
      reported_error_ = {};
      received(frame_of(raw));
    }
    if (generation == generation_) read();
  }
  /// Said once, until a frame comes.
  void error_frame(const can_frame& raw) {
    const std::span bytes(raw.data, std::min<std::size_t>(raw.can_dlc, 8));
    ControllerStatus now = status();
    update_status(now, raw.can_id & CAN_ERR_MASK, bytes);
    set_status(now);
    const std::string_view sentence = describe_error_frame(raw.can_id & CAN_ERR_MASK, bytes);
    if (sentence.empty() || sentence == reported_error_) return;
    reported_error_ = sentence;
    complain(sentence);
  }
  void write() override {
    if (waiting_) return;
    while (!queue().empty()) {
      const can_frame raw = raw_of(queue().front());
      const ssize_t size = ::write(socket_.native_handle(), &raw, sizeof raw);
      if (size == sizeof raw) {
        sent_later(queue().front());
        queue().pop_front();
        continue;
      }
      if (errno == EINTR) continue;
      // ENOBUFS: the interface's queue is full, which poll() does not show; so it is tried again a little
      // later.
      if (errno != EAGAIN && errno != ENOBUFS) return fail_later(std::strerror(errno));
      waiting_ = true;
      pause_.expires_after(std::chrono::milliseconds(1));
      pause_.async_wait([self = self(this), generation = generation_](const error_code& failure) {
        if (failure || generation != self->generation_) return;
        self->waiting_ = false;
        self->write();
      });
      return;
    }
  }

  std::string interface_;
  asio::posix::stream_descriptor socket_;
  asio::steady_timer pause_;
  std::uint32_t generation_ = 0;
  std::string_view reported_error_;
  bool waiting_ = false;
};

}  // namespace

std::shared_ptr<Transport> make_socketcan(asio::io_context& io, const BusAddress& address,
                                          const BusClientOptions& options) {
  return std::make_shared<SocketcanTransport>(io, address.bus, options);
}

}  // namespace canopus::link
