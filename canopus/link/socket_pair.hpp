#pragma once
// A bus of two ends in this process, for threads that talk as two programs would.

#include <expected>
#include <memory>
#include <string>
#include <utility>

#include <boost/asio/io_context.hpp>

#include "canopus/link/bus_client.hpp"

namespace canopus::link {

/// Frames that one end sends the other receives, through the kernel. Each end runs on the thread of its own
/// io_context.
[[nodiscard]] std::expected<std::pair<std::unique_ptr<BusClient>, std::unique_ptr<BusClient>>, std::string>
open_socket_pair(boost::asio::io_context& one, boost::asio::io_context& other);

}  // namespace canopus::link
