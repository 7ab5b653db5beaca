#include "canopus/link/socketcan/netlink.hpp"

#include <array>
#include <cerrno>
#include <utility>

#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace canopus::link {

Netlink::Netlink(bool with_events) {
  socket_ = ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | (with_events ? SOCK_NONBLOCK : 0), NETLINK_ROUTE);
  if (socket_ < 0) return;
  sockaddr_nl place{};
  place.nl_family = AF_NETLINK;
  place.nl_groups = with_events ? RTMGRP_LINK : 0;
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) < 0) {
    ::close(socket_);
    socket_ = -1;
    return;
  }
  // The kernel answers within the call; nothing shall hang if it does not.
  const timeval patience{.tv_sec = 1, .tv_usec = 0};
  (void)::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
}

Netlink::~Netlink() {
  if (socket_ >= 0) ::close(socket_);
}

int Netlink::release() noexcept { return std::exchange(socket_, -1); }

std::expected<LinkMessage, int> Netlink::exchange(const NetlinkRequest& request) {
  if (socket_ < 0) return std::unexpected(EOPNOTSUPP);
  if (::send(socket_, request.data(), request.size(), 0) < 0) return std::unexpected(errno);
  std::array<std::uint8_t, 16384> input;
  while (true) {
    const ssize_t size = ::recv(socket_, input.data(), input.size(), 0);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return std::unexpected(errno);
    const auto messages = read_link_messages(std::span(input).first(static_cast<std::size_t>(size)));
    if (messages.empty()) continue;
    const LinkMessage& answer = messages.front();
    if (answer.kind == LinkMessage::Kind::answer && answer.error != 0) return std::unexpected(answer.error);
    return answer;
  }
}

std::expected<void, int> Netlink::command(const NetlinkRequest& request) {
  const auto answer = exchange(request);
  if (!answer) return std::unexpected(answer.error());
  return {};
}

std::expected<LinkMessage, int> Netlink::request(const std::string& name) {
  return exchange(link_request(name, ++sequence_));
}

std::expected<void, int> Netlink::set_up(int index, bool up) {
  return command(set_link_up(index, up, ++sequence_));
}

std::expected<void, int> Netlink::set_bit_rate(int index, std::uint32_t bit_rate) {
  return command(set_link_bit_rate(index, bit_rate, ++sequence_));
}

}  // namespace canopus::link
