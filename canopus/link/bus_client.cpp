#include "canopus/link/bus_client.hpp"

namespace canopus::link {

std::expected<std::unique_ptr<BusClient>, std::string> open_bus(boost::asio::io_context& io,
                                                                const BusAddress& address,
                                                                std::chrono::milliseconds time_out) {
  auto bus = address.kind == BusAddress::Kind::socketcan ? open_socketcan(io, address)
                                                         : open_socketcand(io, address, time_out);
  if (!bus) return std::unexpected(describe(address) + ": " + bus.error());
  return bus;
}

}  // namespace canopus::link
