#pragma once
// Bytes as text of 64 characters [RFC 4648, 4].

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace canopus::text {

inline constexpr std::string_view base64_digits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// With padding, in one line.
[[nodiscard]] std::string to_base64(std::span<const std::uint8_t> bytes);
/// The bytes, or nothing if the text is no base64. Padding at the end may be missing.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

}  // namespace canopus::text
