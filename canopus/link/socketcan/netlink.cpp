#include "canopus/link/socketcan/netlink.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace canopus::link {
namespace {

using Bytes = std::span<const std::uint8_t>;

template <typename T>
std::optional<T> read(Bytes bytes) {
  if (bytes.size() < sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::size_t aligned(std::size_t size) { return (size + 3) & ~std::size_t{3}; }

/// Calls `attribute(type, content)` for each one.
template <typename Attribute>
void for_each_attribute(Bytes bytes, Attribute attribute) {
  while (const auto head = read<rtattr>(bytes)) {
    if (head->rta_len < sizeof(rtattr) || head->rta_len > bytes.size()) return;
    attribute(head->rta_type & NLA_TYPE_MASK, bytes.subspan(sizeof(rtattr), head->rta_len - sizeof(rtattr)));
    bytes = bytes.subspan(std::min(aligned(head->rta_len), bytes.size()));
  }
}

std::string text(Bytes bytes) {
  const auto end = std::ranges::find(bytes, 0);
  return {bytes.begin(), end};
}

can::ErrorState state_of(std::uint32_t state) {
  switch (state) {
    case CAN_STATE_ERROR_PASSIVE: return can::ErrorState::error_passive;
    case CAN_STATE_BUS_OFF: return can::ErrorState::bus_off;
    default: return can::ErrorState::error_active;
  }
}

void read_controller(Bytes bytes, LinkMessage& message) {
  for_each_attribute(bytes, [&message](int type, Bytes content) {
    const auto status = [&message]() -> ControllerStatus& {
      if (!message.controller) message.controller.emplace();
      return *message.controller;
    };
    switch (type) {
      case IFLA_CAN_STATE:
        if (const auto state = read<std::uint32_t>(content)) status().state = state_of(*state);
        return;
      case IFLA_CAN_BERR_COUNTER:
        if (const auto counters = read<can_berr_counter>(content)) {
          status().transmit_errors = counters->txerr;
          status().receive_errors = counters->rxerr;
          status().counters_known = true;
        }
        return;
      case IFLA_CAN_BITTIMING:
        if (const auto timing = read<can_bittiming>(content)) {
          status().bit_rate = timing->bitrate;
          status().sample_point = static_cast<std::uint16_t>(std::min(timing->sample_point, 1000U));
        }
        return;
      case IFLA_CAN_RESTART_MS:
        if (const auto time = read<std::uint32_t>(content)) message.restart_ms = *time;
        return;
      default: return;
    }
  });
}

LinkMessage read_link(Bytes bytes) {
  LinkMessage message;
  const auto head = read<ifinfomsg>(bytes);
  if (!head) return message;
  message.index = head->ifi_index;
  message.up = (head->ifi_flags & IFF_UP) != 0;
  for_each_attribute(bytes.subspan(sizeof(ifinfomsg)), [&message](int type, Bytes content) {
    if (type == IFLA_IFNAME) message.name = text(content);
    if (type != IFLA_LINKINFO) return;
    for_each_attribute(content, [&message](int part, Bytes inner) {
      if (part == IFLA_INFO_KIND) message.type = text(inner);
      if (part == IFLA_INFO_DATA && message.type == "can") read_controller(inner, message);
    });
  });
  return message;
}

/// A message under construction; attributes go to its end, and lengths are known when they are closed.
class Request {
 public:
  Request(std::uint16_t type, std::uint16_t flags, std::uint32_t sequence, const ifinfomsg& link) {
    const nlmsghdr head{.nlmsg_len = 0,
                        .nlmsg_type = type,
                        .nlmsg_flags = static_cast<std::uint16_t>(flags | NLM_F_REQUEST),
                        .nlmsg_seq = sequence,
                        .nlmsg_pid = 0};
    append(&head, sizeof head);
    append(&link, sizeof link);
  }
  std::size_t open(int type) {
    const std::size_t place = bytes_.size();
    const rtattr head{.rta_len = 0, .rta_type = static_cast<std::uint16_t>(type)};
    append(&head, sizeof head);
    return place;
  }
  void close(std::size_t place) {
    const auto length = static_cast<std::uint16_t>(bytes_.size() - place);
    std::memcpy(bytes_.data() + place, &length, sizeof length);
    bytes_.resize(aligned(bytes_.size()));
  }
  void attribute(int type, const void* content, std::size_t size) {
    const std::size_t place = open(type);
    append(content, size);
    close(place);
  }
  NetlinkRequest done() {
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);
    return std::move(bytes_);
  }

 private:
  void append(const void* content, std::size_t size) {
    const auto* start = static_cast<const std::uint8_t*>(content);
    bytes_.insert(bytes_.end(), start, start + size);
  }
  NetlinkRequest bytes_;
};

}  // namespace

std::vector<LinkMessage> read_link_messages(Bytes bytes) {
  std::vector<LinkMessage> messages;
  while (const auto head = read<nlmsghdr>(bytes)) {
    if (head->nlmsg_len < sizeof(nlmsghdr) || head->nlmsg_len > bytes.size()) break;
    const Bytes content = bytes.subspan(sizeof(nlmsghdr), head->nlmsg_len - sizeof(nlmsghdr));
    bytes = bytes.subspan(std::min(aligned(head->nlmsg_len), bytes.size()));
    if (head->nlmsg_type == NLMSG_ERROR) {
      const auto error = read<int>(content);
      if (error && *error <= 0 && *error > -4096) {
        messages.push_back({.kind = LinkMessage::Kind::answer, .error = -*error});
      }
    } else if (head->nlmsg_type == RTM_NEWLINK || head->nlmsg_type == RTM_DELLINK) {
      messages.push_back(read_link(content));
      if (head->nlmsg_type == RTM_DELLINK) messages.back().kind = LinkMessage::Kind::gone;
    }
  }
  return messages;
}

NetlinkRequest link_request(std::string_view name, std::uint32_t sequence) {
  Request request(RTM_GETLINK, 0, sequence, {});
  const std::string terminated(name);
  request.attribute(IFLA_IFNAME, terminated.c_str(), terminated.size() + 1);
  return request.done();
}

NetlinkRequest set_link_up(int index, bool up, std::uint32_t sequence) {
  ifinfomsg link{};
  link.ifi_index = index;
  link.ifi_flags = up ? IFF_UP : 0;
  link.ifi_change = IFF_UP;
  return Request(RTM_NEWLINK, NLM_F_ACK, sequence, link).done();
}

NetlinkRequest set_link_bit_rate(int index, std::uint32_t bit_rate, std::uint32_t sequence) {
  ifinfomsg link{};
  link.ifi_index = index;
  Request request(RTM_NEWLINK, NLM_F_ACK, sequence, link);
  const std::size_t information = request.open(IFLA_LINKINFO);
  request.attribute(IFLA_INFO_KIND, "can", 3);
  const std::size_t data = request.open(IFLA_INFO_DATA);
  can_bittiming timing{};
  timing.bitrate = bit_rate;  // the kernel finds the rest
  request.attribute(IFLA_CAN_BITTIMING, &timing, sizeof timing);
  request.close(data);
  request.close(information);
  return request.done();
}

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
