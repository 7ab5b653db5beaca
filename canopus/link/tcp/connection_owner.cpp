#include "canopus/link/tcp/connection_owner.hpp"

#include <bit>
#include <fstream>
#include <iterator>
#include <ranges>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::link {

namespace {

using Endpoint = boost::asio::ip::tcp::endpoint;

/// "0100007F:1F90": the bytes of the address as a number of this machine, the port as a number.
std::string in_table(const Endpoint& endpoint) {
  const auto bytes = std::bit_cast<std::uint32_t>(endpoint.address().to_v4().to_bytes());
  return fmt::format("{:08X}:{:04X}", bytes, endpoint.port());
}

/// The word of this number of a line, from 0.
std::string_view word(std::string_view line, unsigned number) {
  for (;; --number) {
    const std::string_view found = ascii::next_word(line);
    if (number == 0 || found.empty()) return found;
  }
}

}  // namespace

std::optional<std::uint32_t> owner_in_table(std::string_view table, const Endpoint& local,
                                            const Endpoint& remote) {
  if (!local.address().is_v4() || !remote.address().is_v4()) return std::nullopt;
  const std::string from = in_table(local);
  const std::string to = in_table(remote);
  constexpr unsigned local_word = 1;
  constexpr unsigned remote_word = 2;
  constexpr unsigned owner_word = 7;
  for (const auto part : std::views::split(table, '\n')) {
    const std::string_view line(part.begin(), part.end());
    if (word(line, local_word) != from || word(line, remote_word) != to) continue;
    const auto user = ascii::parse_number<std::uint32_t>(word(line, owner_word));
    if (user) return user;
  }
  return std::nullopt;
}

bool is_of_own_user(const boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code failure;
  const Endpoint peer = socket.remote_endpoint(failure);
  if (failure) return false;
  const Endpoint own = socket.local_endpoint(failure);
  if (failure) return false;
  std::ifstream file("/proc/net/tcp");
  const std::string table{std::istreambuf_iterator<char>(file), {}};
  return owner_in_table(table, peer, own) == ::geteuid();
}

}  // namespace canopus::link
