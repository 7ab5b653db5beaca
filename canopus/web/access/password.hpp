#pragma once
// Passwords of the page's users, as yescrypt ($y$) or scrypt ($7$) hashes of libxcrypt's crypt(): the library that keeps the
// system's own passwords, there on every Debian, and `mkpasswd` makes the same. Both need much memory for each guess. Older
// hashes (DES, MD5, SHA) do not, and are not taken.

#include <cstddef>
#include <expected>
#include <string>
#include <string_view>

namespace canopus::web {

inline constexpr std::size_t shortest_password = 8;   ///< bytes, of new ones
inline constexpr std::size_t longest_password = 256;  ///< bytes; crypt() takes 511

/// A whole hash that crypt() could have made with its usual cost (16 MiB for each guess) or more, up to 1 GiB.
[[nodiscard]] bool is_password_hash(std::string_view text) noexcept;
/// Takes its time: tens of milliseconds with the usual cost. Any thread may ask. Not when the password is too long, holds a
/// NUL, or there is not enough memory.
[[nodiscard]] bool fits_hash(const std::string& password, const std::string& hash);
/// A yescrypt hash with a salt of the kernel's randomness. The error is a sentence: what a password has to be.
[[nodiscard]] std::expected<std::string, std::string> hash_of(const std::string& password);

}  // namespace canopus::web
