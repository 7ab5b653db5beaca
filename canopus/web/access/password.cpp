#include "canopus/web/access/password.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <system_error>

#include <crypt.h>
#include <fmt/format.h>

#include "canopus/web/access/secret.hpp"

namespace canopus::web {
namespace {

/// "$y$j9T$salt$" or "$7$CU..../....salt$": what crypt_gensalt() writes for each cost. The letter is log2 of N, in the alphabet of
/// crypt(), yescrypt's one less.
bool has_usual_cost(std::string_view text) {
  if (text.starts_with("$y$j") && text.size() > 7) {
    return std::string_view("9ABCDEF").contains(text[4]) && text.substr(5, 2) == "T$";
  }
  if (text.starts_with("$7$") && text.size() > 14) {
    return std::string_view("BCDEFG").contains(text[3]) && text.substr(4, 10) == "U..../....";
  }
  return false;
}

bool is_letter_of_crypt(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '.' && letter <= '9');
}

/// crypt_rn() with its memory; empty when it fails.
std::string crypt_of(const std::string& password, const std::string& setting) {
  const auto memory = std::make_unique<crypt_data>();
  const char* hash = ::crypt_rn(password.c_str(), setting.c_str(), memory.get(), sizeof(crypt_data));
  return hash == nullptr ? std::string() : std::string(hash);
}

}  // namespace

bool is_password_hash(std::string_view text) noexcept {
  constexpr std::size_t digest = 43;  // 256 bits, six a letter
  if (!has_usual_cost(text)) return false;
  const std::size_t last = text.rfind('$');
  const std::size_t salt = text.starts_with("$y$") ? 7 : 14;
  if (last < salt || last - salt > 86 || text.size() - last - 1 != digest) return false;
  const auto is_plain = [](std::string_view part) { return std::ranges::all_of(part, is_letter_of_crypt); };
  return is_plain(text.substr(salt, last - salt)) && is_plain(text.substr(last + 1));
}

bool fits_hash(const std::string& password, const std::string& hash) {
  if (password.size() > longest_password || password.contains('\0') || !is_password_hash(hash)) return false;
  return is_same_secret(crypt_of(password, hash), hash);
}

std::expected<std::string, std::string> hash_of(const std::string& password) {
  if (password.size() < shortest_password || password.size() > longest_password) {
    return std::unexpected(fmt::format("expected a password of {} to {} bytes, found {}", shortest_password,
                                       longest_password, password.size()));
  }
  if (std::ranges::any_of(password, [](unsigned char letter) { return letter < 0x20 || letter == 0x7F; })) {
    return std::unexpected(std::string("a password has no control characters"));
  }
  std::array<char, CRYPT_GENSALT_OUTPUT_SIZE> setting{};
  const char* made =
      ::crypt_gensalt_rn("$y$", 0, nullptr, 0, setting.data(), static_cast<int>(setting.size()));
  std::string hash = made == nullptr ? std::string() : crypt_of(password, made);
  if (!is_password_hash(hash)) {
    return std::unexpected("crypt() makes no yescrypt hash: " + std::generic_category().message(errno));
  }
  return hash;
}

}  // namespace canopus::web
