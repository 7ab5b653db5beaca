// A CAN interface of this machine: a raw socket of Linux SocketCAN.

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
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

#include "canopus/link/bus_client.hpp"
#include "canopus/link/can_error.hpp"

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

class Interface final : public std::enable_shared_from_this<Interface> {
 public:
  Interface(asio::io_context& io, int socket) : io_(io), socket_(io, socket), pause_(io) {}

  void set_user(BusClientUser* user) { user_ = user; }
  bool send(const can::Frame& frame) {
    if (ended_ || queue_.size() >= 4096) return false;
    queue_.push_back(raw_of(frame));
    write();
    return !ended_;
  }
  [[nodiscard]] bool all_sent() const { return queue_.empty() || ended_; }
  void read() {
    socket_.async_wait(asio::posix::stream_descriptor::wait_read,
                       [self = shared_from_this()](const error_code& failure) {
                         if (!failure) self->on_readable();
                       });
  }
  void close() {
    user_ = nullptr;
    ended_ = true;
    error_code ignored;
    pause_.cancel();
    socket_.close(ignored);
  }
  asio::io_context& io() { return io_; }

 private:
  void on_readable() {
    for (int count = 0; !ended_ && count < 256; ++count) {
      can_frame raw{};
      const ssize_t size = ::read(socket_.native_handle(), &raw, sizeof raw);
      if (size < 0 && errno == EINTR) continue;
      if (size < 0 && errno == EAGAIN) break;
      if (size < 0) return end(std::strerror(errno));
      if (size != sizeof raw) continue;
      if ((raw.can_id & CAN_ERR_FLAG) != 0) {
        error_frame(raw);
        continue;
      }
      reported_error_ = {};
      if (user_ != nullptr) user_->frame_received(frame_of(raw));
    }
    if (!ended_) read();
  }
  /// Said once, until a frame comes.
  void error_frame(const can_frame& raw) {
    const std::string_view sentence =
        describe_error_frame(raw.can_id & CAN_ERR_MASK, {raw.data, std::min<std::size_t>(raw.can_dlc, 8)});
    if (sentence.empty() || sentence == reported_error_) return;
    reported_error_ = sentence;
    if (user_ != nullptr) user_->bus_complains(sentence);
  }
  void write() {
    if (waiting_) return;
    while (!queue_.empty() && !ended_) {
      const ssize_t size = ::write(socket_.native_handle(), &queue_.front(), sizeof queue_.front());
      if (size == sizeof queue_.front()) {
        queue_.pop_front();
        continue;
      }
      if (errno == EINTR) continue;
      // ENOBUFS: the interface's queue is full, which poll() does not show; so it is tried again a little
      // later.
      if (errno != EAGAIN && errno != ENOBUFS) return end(std::strerror(errno));
      waiting_ = true;
      pause_.expires_after(std::chrono::milliseconds(1));
      pause_.async_wait([self = shared_from_this()](const error_code& failure) {
        self->waiting_ = false;
        if (!failure) self->write();
      });
      return;
    }
  }
  void end(const std::string& reason) {
    ended_ = true;
    if (user_ != nullptr) user_->bus_lost(reason);
  }

  asio::io_context& io_;
  asio::posix::stream_descriptor socket_;
  asio::steady_timer pause_;
  BusClientUser* user_ = nullptr;
  std::deque<can_frame> queue_;
  std::string_view reported_error_;
  bool waiting_ = false;
  bool ended_ = false;
};

class SocketcanClient final : public BusClient {
 public:
  explicit SocketcanClient(std::shared_ptr<Interface> interface) : interface_(std::move(interface)) {}
  ~SocketcanClient() override { interface_->close(); }
  SocketcanClient(const SocketcanClient&) = delete;
  SocketcanClient& operator=(const SocketcanClient&) = delete;

  bool send(const can::Frame& frame) override { return interface_->send(frame); }
  void set_user(BusClientUser* user) override { interface_->set_user(user); }
  bool close(std::chrono::milliseconds time_out) override {
    interface_->set_user(nullptr);
    const auto end = std::chrono::steady_clock::now() + time_out;
    asio::io_context& io = interface_->io();
    while (!interface_->all_sent() && std::chrono::steady_clock::now() < end) {
      if (io.stopped()) io.restart();
      io.run_one_until(end);
    }
    const bool done = interface_->all_sent();
    interface_->close();
    return done;
  }

 private:
  std::shared_ptr<Interface> interface_;
};

}  // namespace

std::expected<std::unique_ptr<BusClient>, std::string> open_socketcan(asio::io_context& io,
                                                                      const BusAddress& address) {
  const int socket = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (socket < 0) {
    const int reason = errno;
    if (reason == EAFNOSUPPORT || reason == EPROTONOSUPPORT || reason == ESOCKTNOSUPPORT) {
      return std::unexpected("this machine's kernel has no SocketCAN (modules can and can_raw)");
    }
    return std::unexpected(std::string("no CAN socket: ") + std::strerror(reason));
  }
  ifreq request{};
  std::ranges::copy(address.bus, request.ifr_name);
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
    return std::unexpected("the interface is down; ip link set " + address.bus + " up");
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
  auto interface = std::make_shared<Interface>(io, socket);
  interface->read();
  return std::make_unique<SocketcanClient>(std::move(interface));
}

}  // namespace canopus::link
