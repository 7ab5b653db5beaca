#pragma once
// The notation of numbers of bytes, on the command line and in messages.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

namespace canopus::text {

/// "4096", "64K", "16M", "2G": a number of bytes, or of units of 1024, 1024², 1024³ bytes; at least 1. The
/// error names what was expected.
[[nodiscard]] std::expected<std::uint64_t, std::string> parse_byte_size(std::string_view text);

/// "16 MiB", "64 KiB", "1000 bytes": in the largest unit of which it is a whole number.
[[nodiscard]] std::string describe_byte_size(std::uint64_t bytes);

}  // namespace canopus::text
