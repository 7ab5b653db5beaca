#include "canopus/link/allow_list.hpp"

#include <algorithm>

#include <arpa/inet.h>

#include "canopus/ascii/number.hpp"

namespace canopus::link {

namespace {

constexpr unsigned ipv4_offset = 96;  // bits in front of an IPv4 address
constexpr InternetAddress ipv4_form = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0, 0, 0, 0};

bool is_ipv4(const InternetAddress& address) {
  return std::equal(ipv4_form.begin(), ipv4_form.begin() + 12, address.begin());
}

/// The address with the bits behind the prefix off.
InternetAddress masked(InternetAddress address, unsigned prefix) {
  for (unsigned byte = 0; byte < address.size(); ++byte) {
    const unsigned kept = std::min(8U, prefix - std::min(prefix, 8 * byte));
    address[byte] = static_cast<std::uint8_t>(address[byte] & 0xFF00U >> kept);
  }
  return address;
}

std::string text_of(const InternetAddress& address) {
  char text[INET6_ADDRSTRLEN];
  if (is_ipv4(address)) {
    ::inet_ntop(AF_INET, address.data() + 12, text, sizeof text);
  } else {
    ::inet_ntop(AF_INET6, address.data(), text, sizeof text);
  }
  return text;
}

}  // namespace

std::expected<InternetAddress, std::string> parse_internet_address(std::string_view text) {
  const std::string terminated(text == "localhost" ? "127.0.0.1" : text);
  InternetAddress address = ipv4_form;
  const bool is_cut = terminated.find('\0') != std::string::npos;
  if (!is_cut && ::inet_pton(AF_INET, terminated.c_str(), address.data() + 12) == 1) return address;
  if (!is_cut && ::inet_pton(AF_INET6, terminated.c_str(), address.data()) == 1) return address;
  return std::unexpected("\"" + std::string(text) +
                         "\" is not an address; expected numbers such as 192.168.1.7 or fd00::7");
}

bool is_loopback(const InternetAddress& address) noexcept {
  if (is_ipv4(address)) return address[12] == 127;
  constexpr InternetAddress ipv6_loopback = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
  return address == ipv6_loopback;
}

bool Network::contains(const InternetAddress& other) const noexcept {
  return masked(other, prefix) == masked(address, prefix);
}

std::expected<Network, std::string> parse_network(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto address = parse_internet_address(text.substr(0, slash));
  if (!address) return std::unexpected(address.error() + ", or a network such as 192.168.1.0/24");
  Network network{*address};
  if (slash == std::string_view::npos) return network;
  const unsigned most = is_ipv4(*address) ? 32 : 128;
  const std::string_view digits = text.substr(slash + 1);
  const auto prefix = ascii::parse_number<unsigned>(digits);
  if (!prefix || *prefix > most) {
    return std::unexpected("\"" + std::string(text) + "\": a network's prefix is 0 to " +
                           std::to_string(most));
  }
  network.prefix = *prefix + (most == 32 ? ipv4_offset : 0);
  const InternetAddress first = masked(*address, network.prefix);
  if (first != *address) {
    return std::unexpected("\"" + std::string(text) + "\" has bits behind its prefix; expected " +
                           text_of(first) + "/" + std::string(digits) + ", or " + text_of(*address) +
                           " for one machine");
  }
  return network;
}

bool AllowList::allows(const InternetAddress& address) const noexcept {
  return is_loopback(address) ||
         std::ranges::any_of(networks_, [&](const Network& network) { return network.contains(address); });
}

}  // namespace canopus::link
