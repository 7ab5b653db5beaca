#include "canopus/web/access/secret.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <system_error>

#include <sys/random.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::web {

std::string new_secret() {
  std::array<std::uint8_t, 16> bits{};
  // Up to 256 bytes come whole once the kernel has its first randomness; only the wait for that can be interrupted.
  while (::getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size())) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "getrandom");
  }
  return ascii::lower(ascii::hex_bytes(bits));
}

bool is_same_secret(std::string_view one, std::string_view other) noexcept {
  if (one.size() != other.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    difference |=
        static_cast<unsigned char>(one[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(other[i]));
  }
  return difference == 0;
}

}  // namespace canopus::web
