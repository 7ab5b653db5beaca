#include "canopus/link/socketcan/can_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace canopus::link {
namespace {

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

ReceivedFrame received(const can_frame& raw, int flags) {
  if ((raw.can_id & CAN_ERR_FLAG) == 0) {
    const auto kind = (flags & MSG_CONFIRM) != 0 ? ReceivedFrame::Kind::own : ReceivedFrame::Kind::frame;
    return {.kind = kind, .frame = frame_of(raw)};
  }
  ReceivedFrame frame{.kind = ReceivedFrame::Kind::error, .error_class = raw.can_id & CAN_ERR_MASK};
  frame.frame.dlc = std::min<std::uint8_t>(raw.can_dlc, 8);
  std::copy_n(raw.data, frame.frame.dlc, frame.frame.data.begin());
  return frame;
}

std::chrono::nanoseconds time_of(const timespec& time) {
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

/// The hardware's time, where its clock goes with the system's; else the kernel's.
std::optional<std::chrono::nanoseconds> time_of(const scm_timestamping& times) {
  const auto software = time_of(times.ts[0]);
  const auto hardware = time_of(times.ts[2]);
  if (hardware.count() != 0 && std::chrono::abs(hardware - software) < std::chrono::seconds(1))
    return hardware;
  if (software.count() != 0) return software;
  return std::nullopt;
}

void enable_time_stamps(int socket) {
  const int sources = SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE |
                      SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE;
  if (::setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPING, &sources, sizeof sources) == 0) return;
  const int yes = 1;
  (void)::setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes);
}

std::unexpected<std::string> refuse(int socket, std::string reason) {
  ::close(socket);
  return std::unexpected(std::move(reason));
}

}  // namespace

std::expected<CanSocket, std::string> open_can_socket(const std::string& interface) {
  const int socket = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (socket < 0) {
    const int reason = errno;
    if (reason == EAFNOSUPPORT || reason == EPROTONOSUPPORT || reason == ESOCKTNOSUPPORT) {
      return std::unexpected("this machine's kernel has no SocketCAN (modules can and can_raw)");
    }
    return std::unexpected(std::string("no CAN socket: ") + std::strerror(reason));
  }
  ifreq request{};
  std::ranges::copy(interface, request.ifr_name);
  if (::ioctl(socket, SIOCGIFINDEX, &request) < 0) {
    const int reason = errno;
    return refuse(socket,
                  reason == ENODEV ? "there is no such interface (see `ip link`)" : std::strerror(reason));
  }
  const int number = request.ifr_ifindex;
  const bool is_up = ::ioctl(socket, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
  if (!is_up) return refuse(socket, "the interface is down; ip link set " + interface + " up");
  constexpr unsigned error_counters = 0x200;  // CAN_ERR_CNT, which older headers do not have
  const can_err_mask_t errors =
      CAN_ERR_ACK | CAN_ERR_PROT | CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | error_counters;
  (void)::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors);
  const int yes = 1;
  (void)::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &yes, sizeof yes);
  (void)::setsockopt(socket, SOL_SOCKET, SO_RXQ_OVFL, &yes, sizeof yes);
  const int room = 1 << 20;
  (void)::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
  enable_time_stamps(socket);
  sockaddr_can place{};
  place.can_family = AF_CAN;
  place.can_ifindex = number;
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&place), sizeof place) < 0) {
    const int reason = errno;
    return refuse(socket, reason == ENODEV ? "this is not a CAN interface" : std::strerror(reason));
  }
  return CanSocket{.descriptor = socket, .interface = number};
}

std::expected<void, int> receive_can_frames(int descriptor, ReceivedBatch& batch) {
  std::array<can_frame, can_batch> raw{};
  std::array<iovec, can_batch> places{};
  std::array<mmsghdr, can_batch> heads{};
  alignas(cmsghdr) std::array<std::array<char, 256>, can_batch> controls;
  for (std::size_t i = 0; i < can_batch; ++i) {
    places[i] = {.iov_base = &raw[i], .iov_len = sizeof raw[i]};
    heads[i].msg_hdr.msg_iov = &places[i];
    heads[i].msg_hdr.msg_iovlen = 1;
    heads[i].msg_hdr.msg_control = controls[i].data();
    heads[i].msg_hdr.msg_controllen = controls[i].size();
  }
  int count = -1;
  do {
    count = ::recvmmsg(descriptor, heads.data(), can_batch, MSG_DONTWAIT, nullptr);
  } while (count < 0 && errno == EINTR);
  if (count < 0) return std::unexpected(errno);
  batch.count = 0;
  batch.dropped.reset();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    if (heads[i].msg_len != sizeof(can_frame)) continue;
    ReceivedFrame frame = received(raw[i], static_cast<int>(heads[i].msg_hdr.msg_flags));
    for (cmsghdr* part = CMSG_FIRSTHDR(&heads[i].msg_hdr); part != nullptr;
         part = CMSG_NXTHDR(&heads[i].msg_hdr, part)) {
      if (part->cmsg_level != SOL_SOCKET) continue;
      if (part->cmsg_type == SCM_TIMESTAMPING) {
        scm_timestamping times{};
        std::memcpy(&times, CMSG_DATA(part), sizeof times);
        frame.received_at = time_of(times);
      } else if (part->cmsg_type == SO_TIMESTAMPNS) {
        timespec time{};
        std::memcpy(&time, CMSG_DATA(part), sizeof time);
        frame.received_at = time_of(time);
      } else if (part->cmsg_type == SO_RXQ_OVFL) {
        std::uint32_t dropped = 0;
        std::memcpy(&dropped, CMSG_DATA(part), sizeof dropped);
        batch.dropped = dropped;
      }
    }
    batch.places[batch.count++] = frame;
  }
  return {};
}

std::expected<std::size_t, int> send_can_frames(int descriptor, std::span<const can::Frame> frames) {
  std::array<can_frame, can_batch> raw{};
  std::array<iovec, can_batch> places{};
  std::array<mmsghdr, can_batch> heads{};
  const std::size_t count = std::min(frames.size(), can_batch);
  for (std::size_t i = 0; i < count; ++i) {
    raw[i] = raw_of(frames[i]);
    places[i] = {.iov_base = &raw[i], .iov_len = sizeof raw[i]};
    heads[i].msg_hdr.msg_iov = &places[i];
    heads[i].msg_hdr.msg_iovlen = 1;
  }
  int taken = -1;
  do {
    taken = ::sendmmsg(descriptor, heads.data(), static_cast<unsigned>(count), MSG_DONTWAIT);
  } while (taken < 0 && errno == EINTR);
  if (taken < 0) return std::unexpected(errno);
  return static_cast<std::size_t>(taken);
}

void set_can_filter(int descriptor, std::span<const IdentifierFilter> filters) {
  std::vector<can_filter> raw;
  for (const IdentifierFilter& filter : filters) {
    // The filter always compares the identifier format; remote frames pass as well.
    raw.push_back({.can_id = filter.identifier | (filter.extended ? CAN_EFF_FLAG : 0U),
                   .can_mask = (filter.mask & CAN_EFF_MASK) | CAN_EFF_FLAG});
  }
  if (raw.empty() || raw.size() > CAN_RAW_FILTER_MAX) raw = {{.can_id = 0, .can_mask = 0}};
  (void)::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, raw.data(),
                     static_cast<socklen_t>(raw.size() * sizeof(can_filter)));
}

int clear_socket_error(int descriptor) {
  int error = 0;
  socklen_t size = sizeof error;
  (void)::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

}  // namespace canopus::link
