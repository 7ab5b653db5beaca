#pragma once
// Which machines a server takes connections from. Its own machine may always connect.

#include <array>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace canopus::link {

/// An address of either kind, an IPv4 one as IPv6 has it (::ffff:192.168.1.7).
using InternetAddress = std::array<std::uint8_t, 16>;

/// "192.168.1.7", "fd00::7" or "localhost" (127.0.0.1); the error names what was expected.
[[nodiscard]] std::expected<InternetAddress, std::string> parse_internet_address(std::string_view text);
/// 127.0.0.0/8 or ::1: reachable from this machine only.
[[nodiscard]] bool is_loopback(const InternetAddress& address) noexcept;

/// The addresses that begin with the same bits.
struct Network {
  InternetAddress address{};
  unsigned prefix = 128;  ///< bits 0..128, those of the IPv4 form included

  [[nodiscard]] bool contains(const InternetAddress& other) const noexcept;
};
/// "192.168.1.0/24", "fd00::/8", or an address alone for one machine. Bits behind the prefix are a mistake.
[[nodiscard]] std::expected<Network, std::string> parse_network(std::string_view text);

class AllowList {
 public:
  /// This machine alone.
  AllowList() = default;
  explicit AllowList(std::vector<Network> networks) : networks_(std::move(networks)) {}

  [[nodiscard]] bool allows(const InternetAddress& address) const noexcept;

 private:
  std::vector<Network> networks_;
};

}  // namespace canopus::link
