// Where the servers of a plant listen, and to whom.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/link/allow_list.hpp"
#include "canopus/plant/plant_references.hpp"
#include "canopus/plant/plant_sections.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

namespace {

/// Two servers cannot have one port of one address.
class Ports {
 public:
  Ports(const PlantFile& plant, std::vector<text::FileError>& errors) : plant_(plant), errors_(errors) {}

  void check() {
    for (const PlcSection& plc : plant_.plcs) {
      if (!plc.listen) continue;
      take_port(*plc.listen, plc.listen_place, "listen",
                plc.name.empty() ? "a PLC without a name" : fmt::format("PLC \"{}\"", plc.name));
    }
    for (const BusSection& bus : plant_.buses) {
      if (!bus.socketcand) continue;
      take_port(*bus.socketcand, bus.serve_place, "serve", fmt::format("bus \"{}\"", bus.name));
    }
  }

 private:
  struct Server {
    std::string who;
    std::uint32_t line = 0;
  };
  using Addresses = std::map<link::InternetAddress, Server>;

  void take_port(const text::HostAndPort& where, text::Place place, std::string_view key, std::string who) {
    const auto address = link::parse_internet_address(where.host);
    if (!address || where.port == 0) return;  // no address: reported already; port 0: a free one
    Addresses& servers = ports_[where.port];
    if (const auto other = same_address(servers, *address); other != servers.end()) {
      errors_.push_back(
          {place, fmt::format("{}: port {} is taken already, by {} in line {}; give each server its own", key,
                              where.port, other->second.who, other->second.line)});
      return;
    }
    servers.emplace(*address, Server{std::move(who), place.line});
  }

  /// A server that would get the same connections: 0.0.0.0 is every IPv4 address, :: every address of both kinds.
  static Addresses::const_iterator same_address(const Addresses& servers,
                                                const link::InternetAddress& address) {
    static const link::InternetAddress any_ipv4 = *link::parse_internet_address("0.0.0.0");
    static const link::InternetAddress last_ipv4 = *link::parse_internet_address("255.255.255.255");
    static constexpr link::InternetAddress any{};
    if (address == any) return servers.begin();
    if (const auto everywhere = servers.find(any); everywhere != servers.end()) return everywhere;
    const bool is_ipv4 = address >= any_ipv4 && address <= last_ipv4;
    if (!is_ipv4) return servers.find(address);
    const auto first = servers.lower_bound(any_ipv4);
    if (first == servers.end() || first->first > last_ipv4) return servers.end();
    return address == any_ipv4 || first->first == any_ipv4 ? first : servers.find(address);
  }

  const PlantFile& plant_;
  std::vector<text::FileError>& errors_;
  std::map<std::uint16_t, Addresses> ports_;
};

}  // namespace

link::AllowList read_allowed(text::TableReader& table, std::string_view key, std::string_view protocol,
                             const std::optional<text::HostAndPort>& place) {
  std::vector<link::Network> networks;
  table.elements("allow", [&](const toml::node& element) {
    const auto* text = element.as_string();
    const auto network = text == nullptr
                             ? std::unexpected(fmt::format("{}: expected networks such as \"192.168.1.0/24\"",
                                                           text::describe_found(element)))
                             : link::parse_network(text->get());
    if (!network)
      return table.error(text::place_of(element.source()), fmt::format("allow: {}", network.error()));
    networks.push_back(*network);
  });
  const bool has_list = table.find("allow") != nullptr;
  if (!place) {
    if (has_list) table.error("allow", fmt::format("nobody can connect; {} says where it listens", key));
    return {};
  }
  const auto address = link::parse_internet_address(place->host);
  if (!address) {
    table.error(table.place(key), fmt::format("{}: {}, or localhost", key, address.error()));
  } else if (!has_list && !link::is_loopback(*address)) {
    table.error(table.place(key),
                fmt::format("{}: other machines can reach {}, and the {} has no password here; say which may "
                            "connect, for example allow = [\"192.168.1.0/24\"], or listen on 127.0.0.1",
                            key, place->host, protocol));
  }
  return link::AllowList(std::move(networks));
}

void check_servers(const PlantFile& plant, std::vector<text::FileError>& errors) {
  Ports(plant, errors).check();
}

}  // namespace canopus::plant
