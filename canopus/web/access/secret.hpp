#pragma once
// What nobody can guess: keys and the names of sessions.

#include <string>
#include <string_view>

namespace canopus::web {

/// 128 bits from the kernel as 32 hexadecimal digits.
[[nodiscard]] std::string new_secret();

/// Takes as long for any two texts of one length: how much of a guess was right cannot be measured.
[[nodiscard]] bool is_same_secret(std::string_view one, std::string_view other) noexcept;

}  // namespace canopus::web
