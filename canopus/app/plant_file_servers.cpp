// Where the servers of a plant listen, and to whom.

#include "canopus/app/table_reader.hpp"
#include "canopus/link/allow_list.hpp"

namespace canopus::app {

link::AllowList read_allowed(TableReader& table, std::string_view key, std::string_view protocol,
                             const std::optional<HostAndPort>& place) {
  std::vector<link::Network> networks;
  table.elements("allow", [&](const toml::node& element) {
    const auto* text = element.as_string();
    const auto network = text == nullptr
                             ? std::unexpected(fmt::format("{}: expected networks such as \"192.168.1.0/24\"",
                                                           describe_found(element)))
                             : link::parse_network(text->get());
    if (!network) return table.error(place_of(element.source()), fmt::format("allow: {}", network.error()));
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

}  // namespace canopus::app
