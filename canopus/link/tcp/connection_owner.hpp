#pragma once
// Which user of this machine is at the other end of a connection over the loopback interface.

#include <cstdint>
#include <optional>
#include <string_view>

#include <boost/asio/ip/tcp.hpp>

namespace canopus::link {

/// The user-ID that the process has which opened the socket `local` that is connected with `remote`, as a
/// table in the form of /proc/net/tcp has it. Nothing: no line has both, or they are not of IPv4.
[[nodiscard]] std::optional<std::uint32_t> owner_in_table(std::string_view table,
                                                          const boost::asio::ip::tcp::endpoint& local,
                                                          const boost::asio::ip::tcp::endpoint& remote);

/// Whether the other end of this connection is a process of the same user (effective user-ID). False, too,
/// when the other end is gone, on another machine, or of IPv6.
[[nodiscard]] bool is_of_own_user(const boost::asio::ip::tcp::socket& socket);

}  // namespace canopus::link
