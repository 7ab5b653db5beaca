#include "canopus/link/bus_address.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace canopus::link {
namespace {

constexpr std::string_view default_host = "127.0.0.1";
constexpr std::uint16_t default_port = 29536;
/// IFNAMSIZ - 1.
constexpr std::size_t longest_interface = 15;
/// What fits into `< open NAME >` and is taken by servers of other makes.
constexpr std::size_t longest_bus_name = 64;

/// What can stand as one word inside an element of the protocol.
bool is_word(std::string_view name) {
  return std::ranges::all_of(name, [](char c) { return c > ' ' && c < '\x7f' && c != '<' && c != '>'; });
}

std::string refuse(std::string_view text, std::string_view expected) {
  return fmt::format("\"{}\" is not a bus; expected {}", text, expected);
}

}  // namespace

std::expected<BusAddress, std::string> parse_bus_address(std::string_view text) {
  constexpr std::string_view socketcand = "socketcand:";
  constexpr std::string_view socketcan = "socketcan:";
  if (text.starts_with(socketcan)) {
    const std::string_view name = text.substr(socketcan.size());
    if (name.empty() || name.size() > longest_interface || name.contains('/') || !is_word(name)) {
      return std::unexpected(refuse(text, "socketcan:INTERFACE, for example socketcan:can0"));
    }
    return BusAddress{.kind = BusAddress::Kind::socketcan, .bus = std::string(name)};
  }
  constexpr std::string_view form = "socketcand:HOST:PORT/BUS or socketcan:INTERFACE";
  if (!text.starts_with(socketcand)) return std::unexpected(refuse(text, form));

  std::string_view rest = text.substr(socketcand.size());
  BusAddress address{.host = std::string(default_host), .port = default_port};
  if (const std::size_t slash = rest.find('/'); slash != std::string_view::npos) {
    address.bus = rest.substr(slash + 1);
    rest = rest.substr(0, slash);
    if (address.bus.empty() || address.bus.size() > longest_bus_name || !is_word(address.bus)) {
      return std::unexpected(refuse(text, "the bus's name, one word, after the slash"));
    }
  }
  std::string_view host = rest;
  std::string_view port;
  bool has_port = false;
  if (rest.starts_with('[')) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos || (end + 1 != rest.size() && rest[end + 1] != ':')) {
      return std::unexpected(refuse(text, "an IPv6 address in brackets, for example socketcand:[::1]:29536"));
    }
    host = rest.substr(1, end - 1);
    has_port = end + 1 != rest.size();
    if (has_port) port = rest.substr(end + 2);
  } else if (const std::size_t colon = rest.find(':'); colon != std::string_view::npos) {
    host = rest.substr(0, colon);
    has_port = true;
    port = rest.substr(colon + 1);
  }
  if (!host.empty()) address.host = host;
  if (!is_word(host)) return std::unexpected(refuse(text, form));
  if (has_port) {
    const auto [end, failure] = std::from_chars(port.data(), port.data() + port.size(), address.port);
    if (failure != std::errc{} || end != port.data() + port.size() || address.port == 0) {
      return std::unexpected(refuse(text, "a port of 1 to 65535 after the host"));
    }
  }
  return address;
}

std::string describe(const BusAddress& address) {
  if (address.kind == BusAddress::Kind::socketcan) return "socketcan:" + address.bus;
  const bool brackets = address.host.contains(':');
  return fmt::format("socketcand:{}{}{}:{}{}{}", brackets ? "[" : "", address.host, brackets ? "]" : "",
                     address.port, address.bus.empty() ? "" : "/", address.bus);
}

}  // namespace canopus::link
