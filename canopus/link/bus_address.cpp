#include "canopus/link/bus_address.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/link/allow_list.hpp"

namespace canopus::link {
namespace {

constexpr std::string_view default_host = "127.0.0.1";
constexpr std::uint16_t socketcand_port = 29536;
constexpr std::uint16_t cannelloni_port = 20000;
constexpr std::string_view multicast_group = "239.74.163.2";  // python-can's
constexpr std::uint16_t multicast_port = 43113;
constexpr std::uint32_t default_serial_speed = 115200;
/// IFNAMSIZ - 1.
constexpr std::size_t longest_interface = 15;
/// Longest name for `< open NAME >` that other makes of servers accept.
constexpr std::size_t longest_bus_name = 64;
constexpr std::size_t longest_path = 255;

using Kind = BusAddress::Kind;
using Parsed = std::expected<BusAddress, std::string>;

constexpr std::string_view socketcan_form = "socketcan:INTERFACE, for example socketcan:can0";
constexpr std::string_view slcan_form =
    "slcan:DEVICE@BITRATE or slcan:tcp:HOST:PORT@BITRATE, for example slcan:/dev/ttyACM0@250000";
constexpr std::string_view multicast_form =
    "udp-multicast:GROUP:PORT, for example udp-multicast:239.74.163.2:43113";
constexpr std::string_view cannelloni_form =
    "cannelloni:HOST:PORT, cannelloni:HOST:PORT:OUR-PORT or cannelloni:tcp:HOST:PORT";

/// Whether a name can be one word inside an element of the protocol.
bool is_word(std::string_view name) {
  return std::ranges::all_of(name, [](char c) { return c > ' ' && c < '\x7f' && c != '<' && c != '>'; });
}

/// The text comes from a person, its bytes from anywhere.
std::unexpected<std::string> refuse(std::string_view text, std::string_view expected) {
  return std::unexpected(fmt::format("\"{}\" is not a bus; expected {}", text, expected));
}

template <typename Number>
bool read_number(std::string_view digits, Number& number) {
  const auto read = ascii::parse_number<Number>(digits);
  number = read.value_or(0);
  return number != 0;
}

bool skip_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// `HOST`, `HOST:PORT`, `[IPV6]:PORT`, as far as they are there; the rest behind a further colon stays in `rest`.
std::expected<void, std::string> read_host_and_port(std::string_view text, std::string_view form,
                                                    std::string_view& rest, BusAddress& address) {
  std::string_view host = rest;
  std::string_view behind;
  bool has_port = false;
  if (rest.starts_with('[')) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos || (end + 1 != rest.size() && rest[end + 1] != ':')) {
      const std::string_view kind = text.substr(0, text.find('['));
      return refuse(text, fmt::format("an IPv6 address in brackets, for example {}[::1]:{}", kind,
                                      address.port != 0 ? address.port : socketcand_port));
    }
    host = rest.substr(1, end - 1);
    has_port = end + 1 != rest.size();
    if (has_port) behind = rest.substr(end + 2);
  } else if (const std::size_t colon = rest.find(':'); colon != std::string_view::npos) {
    host = rest.substr(0, colon);
    has_port = true;
    behind = rest.substr(colon + 1);
  }
  if (!is_word(host)) return refuse(text, form);
  if (!host.empty()) address.host = host;
  rest = {};
  if (!has_port) return {};
  const std::size_t colon = behind.find(':');
  if (colon != std::string_view::npos) rest = behind.substr(colon + 1);
  if (!read_number(behind.substr(0, colon), address.port)) {
    return refuse(text, "a port of 1 to 65535 after the host");
  }
  if (colon != std::string_view::npos && rest.empty()) return refuse(text, form);
  return {};
}

Parsed parse_socketcan(std::string_view text, std::string_view name) {
  if (name.empty() || name.size() > longest_interface || name.contains('/') || !is_word(name)) {
    return refuse(text, socketcan_form);
  }
  return BusAddress{.kind = Kind::socketcan, .bus = std::string(name)};
}

Parsed parse_socketcand(std::string_view text, std::string_view rest) {
  constexpr std::string_view form = "socketcand:HOST:PORT/BUS";
  BusAddress address{.host = std::string(default_host), .port = socketcand_port};
  if (const std::size_t slash = rest.find('/'); slash != std::string_view::npos) {
    address.bus = rest.substr(slash + 1);
    rest = rest.substr(0, slash);
    if (address.bus.empty() || address.bus.size() > longest_bus_name || !is_word(address.bus)) {
      return refuse(text, "the bus's name, one word, after the slash");
    }
  }
  if (const auto read = read_host_and_port(text, form, rest, address); !read)
    return std::unexpected(read.error());
  if (!rest.empty()) return refuse(text, "a port of 1 to 65535 after the host");
  return address;
}

Parsed parse_slcan(std::string_view text, std::string_view rest) {
  BusAddress address{.kind = Kind::slcan};
  if (const std::size_t at = rest.rfind('@'); at != std::string_view::npos) {
    if (!read_number(rest.substr(at + 1), address.bit_rate) || address.bit_rate > 1'000'000) {
      return refuse(text, "a bit rate of 1 to 1000000 bit/s behind the @");
    }
    rest = rest.substr(0, at);
  }
  address.tcp = skip_prefix(rest, "tcp:");
  if (address.tcp) {
    if (const auto read = read_host_and_port(text, slcan_form, rest, address); !read) {
      return std::unexpected(read.error());
    }
    if (address.host.empty() || address.port == 0 || !rest.empty()) return refuse(text, slcan_form);
    return address;
  }
  address.serial_speed = default_serial_speed;
  if (const std::size_t comma = rest.rfind(','); comma != std::string_view::npos) {
    if (!read_number(rest.substr(comma + 1), address.serial_speed)) {
      return refuse(text, "the speed of the serial line in bit/s behind the comma, for example 115200");
    }
    rest = rest.substr(0, comma);
  }
  address.bus = rest;
  const bool printable =
      std::ranges::none_of(rest, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
  if (!rest.starts_with('/') || rest.size() > longest_path || !printable) return refuse(text, slcan_form);
  return address;
}

Parsed parse_multicast(std::string_view text, std::string_view rest) {
  BusAddress address{
      .kind = Kind::udp_multicast, .host = std::string(multicast_group), .port = multicast_port};
  if (const auto read = read_host_and_port(text, multicast_form, rest, address); !read) {
    return std::unexpected(read.error());
  }
  const auto group = parse_internet_address(address.host);
  const bool is_multicast =
      group && (address.host.contains(':') ? (*group)[0] == 0xFF : (*group)[12] >> 4 == 0xE);
  if (!is_multicast)
    return refuse(text, "a multicast group: 224.0.0.0 to 239.255.255.255, or ff00::/8 in brackets");
  if (!rest.empty()) return refuse(text, multicast_form);
  return address;
}

Parsed parse_cannelloni(std::string_view text, std::string_view rest) {
  BusAddress address{.kind = Kind::cannelloni, .port = cannelloni_port};
  address.tcp = skip_prefix(rest, "tcp:");
  if (const auto read = read_host_and_port(text, cannelloni_form, rest, address); !read) {
    return std::unexpected(read.error());
  }
  if (address.host.empty() || (address.tcp && !rest.empty())) return refuse(text, cannelloni_form);
  if (!address.tcp) address.local_port = cannelloni_port;
  if (!rest.empty() && !read_number(rest, address.local_port)) {
    return refuse(text, "our port, 1 to 65535, behind the other side's");
  }
  return address;
}

/// Host and port as read_host_and_port() takes them.
std::string endpoint(const BusAddress& address) {
  const bool brackets = address.host.contains(':');
  return fmt::format("{}{}{}:{}", brackets ? "[" : "", address.host, brackets ? "]" : "", address.port);
}

}  // namespace

std::expected<BusAddress, std::string> parse_bus_address(std::string_view text) {
  std::string_view rest = text;
  if (skip_prefix(rest, "socketcan:")) return parse_socketcan(text, rest);
  if (skip_prefix(rest, "socketcand:")) return parse_socketcand(text, rest);
  if (skip_prefix(rest, "slcan:")) return parse_slcan(text, rest);
  if (skip_prefix(rest, "udp-multicast:")) return parse_multicast(text, rest);
  if (skip_prefix(rest, "cannelloni:")) return parse_cannelloni(text, rest);
  return refuse(
      text,
      "socketcand:HOST:PORT/BUS, socketcan:INTERFACE, slcan:DEVICE@BITRATE, udp-multicast:GROUP:PORT or "
      "cannelloni:HOST:PORT");
}

std::string describe(const BusAddress& address) {
  switch (address.kind) {
    case Kind::socketcan: return "socketcan:" + address.bus;
    case Kind::slcan: {
      std::string text = "slcan:" + (address.tcp ? "tcp:" + endpoint(address) : address.bus);
      if (!address.tcp && address.serial_speed != default_serial_speed)
        text += fmt::format(",{}", address.serial_speed);
      if (address.bit_rate != 0) text += fmt::format("@{}", address.bit_rate);
      return text;
    }
    case Kind::udp_multicast: return "udp-multicast:" + endpoint(address);
    case Kind::cannelloni:
      if (address.tcp) return "cannelloni:tcp:" + endpoint(address);
      return "cannelloni:" + endpoint(address) +
             (address.local_port != cannelloni_port ? fmt::format(":{}", address.local_port) : "");
    case Kind::socketcand: break;
  }
  return "socketcand:" + endpoint(address) + (address.bus.empty() ? "" : "/" + address.bus);
}

}  // namespace canopus::link
