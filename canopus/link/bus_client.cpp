#include "canopus/link/bus_client.hpp"

#include "canopus/link/transport.hpp"

namespace canopus::link {
namespace {

std::shared_ptr<Transport> make(boost::asio::io_context& io, const BusAddress& address,
                                const BusClientOptions& options) {
  switch (address.kind) {
    case BusAddress::Kind::socketcan: return make_socketcan(io, address, options);
    case BusAddress::Kind::slcan: return make_slcan(io, address, options);
    case BusAddress::Kind::udp_multicast: return make_multicast(io, address, options);
    case BusAddress::Kind::cannelloni: return make_cannelloni(io, address, options);
    case BusAddress::Kind::socketcand: break;
  }
  return make_socketcand(io, address, options);
}

}  // namespace

std::expected<void, std::string> BusClient::restart(std::uint32_t /*bit_rate*/) {
  return std::unexpected("the bit rate of this bus is not set from here");
}

std::expected<std::unique_ptr<BusClient>, std::string> open_bus(boost::asio::io_context& io,
                                                                const BusAddress& address,
                                                                const BusClientOptions& options) {
  auto bus = open_transport(make(io, address, options), options.time_out);
  if (!bus) return std::unexpected(describe(address) + ": " + bus.error());
  return bus;
}

}  // namespace canopus::link
