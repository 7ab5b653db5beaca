#pragma once
// The other end of a connection, for servers.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include <boost/asio/ip/tcp.hpp>

#include "canopus/link/allow_list.hpp"

namespace canopus::link {

/// Called with a message about a client for the user: a sentence that begins with the client's address.
using ClientReport = std::function<void(std::string_view sentence)>;

[[nodiscard]] inline InternetAddress internet_address(const boost::asio::ip::address& address) {
  const auto bytes = address.is_v4()
                         ? boost::asio::ip::make_address_v6(boost::asio::ip::v4_mapped, address.to_v4())
                         : address.to_v6();
  InternetAddress result;
  std::ranges::copy(bytes.to_bytes(), result.begin());
  return result;
}

/// "192.168.1.7:50123", "[::1]:50123".
[[nodiscard]] inline std::string name_of(const boost::asio::ip::address& address, std::uint16_t port) {
  const std::string text = address.to_string();
  return (address.is_v6() ? "[" + text + "]" : text) + ":" + std::to_string(port);
}

/// "192.168.1.7:50123"; "a client" when it is gone already.
[[nodiscard]] inline std::string name_of_peer(const boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code failure;
  const auto peer = socket.remote_endpoint(failure);
  if (failure) return "a client";
  return name_of(peer.address(), peer.port());
}

/// All zeros when it is gone already.
[[nodiscard]] inline InternetAddress address_of_peer(const boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code failure;
  const auto peer = socket.remote_endpoint(failure);
  return failure ? InternetAddress{} : internet_address(peer.address());
}

/// Whether the list allows the other end; not when it is gone already.
[[nodiscard]] inline bool is_allowed(const boost::asio::ip::tcp::socket& socket, const AllowList& allowed) {
  boost::system::error_code failure;
  const auto peer = socket.remote_endpoint(failure);
  return !failure && allowed.allows(internet_address(peer.address()));
}

}  // namespace canopus::link
