#pragma once
// The notation of durations, objects and buffer-memory addresses, in plant files and on the command line.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "canopus/can/time.hpp"

namespace canopus::text {

/// "10ms", "1.5s", "2min", "1h", "250us": a number and a unit, not negative. The error names what was
/// expected.
[[nodiscard]] std::expected<can::Duration, std::string> parse_duration(std::string_view text);

/// An entry of an object dictionary.
struct ObjectName {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  friend bool operator==(const ObjectName&, const ObjectName&) = default;
};
/// "6000:01", "6000" (sub-index 00H), "0x6000:1", "6000:01": always hexadecimal, as CiA documents write
/// them.
[[nodiscard]] std::expected<ObjectName, std::string> parse_object(std::string_view text);

/// "G13000": a buffer memory address, decimal.
[[nodiscard]] std::expected<std::uint32_t, std::string> parse_buffer_address(std::string_view text);

/// "127.0.0.1:5007", "[::1]:5007", ":5007" (127.0.0.1) or "5007".
struct HostAndPort {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
};
[[nodiscard]] std::expected<HostAndPort, std::string> parse_host_and_port(std::string_view text);

/// "12.345 s", "250 ms", "40 us": for people.
[[nodiscard]] std::string describe_duration(can::Duration duration);

}  // namespace canopus::text
