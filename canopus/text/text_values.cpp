#include "canopus/text/text_values.hpp"

#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"

namespace canopus::text {
namespace {

using ascii::parse_hexadecimal;
using ascii::parse_number;

}  // namespace

std::expected<can::Duration, std::string> parse_duration(std::string_view text) {
  const auto refuse = [&] {
    return std::unexpected(
        fmt::format("\"{}\" is not a duration; expected a number and a unit (ns, us, ms, s, min, h), for "
                    "example \"10ms\"",
                    text));
  };
  double number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || !std::isfinite(number) || number < 0) return refuse();
  std::string_view unit(rest, static_cast<std::size_t>(text.data() + text.size() - rest));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  double nanoseconds = 0;
  if (unit == "ns") {
    nanoseconds = 1;
  } else if (unit == "us") {
    nanoseconds = 1e3;
  } else if (unit == "ms") {
    nanoseconds = 1e6;
  } else if (unit == "s") {
    nanoseconds = 1e9;
  } else if (unit == "min") {
    nanoseconds = 60e9;
  } else if (unit == "h") {
    nanoseconds = 3600e9;
  } else {
    return refuse();
  }
  if (number * nanoseconds > 9e18) return refuse();
  return can::Duration(std::llround(number * nanoseconds));
}

std::expected<ObjectName, std::string> parse_object(std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto index = parse_hexadecimal<std::uint16_t>(text.substr(0, colon));
  const auto sub = colon == std::string_view::npos ? std::optional<std::uint8_t>(0)
                                                   : parse_hexadecimal<std::uint8_t>(text.substr(colon + 1));
  if (!index || !sub) {
    return std::unexpected(fmt::format(
        "\"{}\" is not an object; expected index:sub-index in hexadecimal, for example \"6000:01\"", text));
  }
  return ObjectName{*index, *sub};
}

std::expected<std::uint32_t, std::string> parse_buffer_address(std::string_view text) {
  std::optional<std::uint32_t> address;
  if (text.starts_with('G') || text.starts_with('g')) address = parse_number<std::uint32_t>(text.substr(1));
  if (!address || *address > 0xFFFF) {
    return std::unexpected(fmt::format("\"{}\" is not a buffer memory address; expected G0 to G65535", text));
  }
  return *address;
}

std::expected<HostAndPort, std::string> parse_host_and_port(std::string_view text) {
  const auto refuse = [text](std::string_view why) {
    return std::unexpected(fmt::format("\"{}\" {}; expected for example \"127.0.0.1:5007\"", text, why));
  };
  HostAndPort place;
  const std::size_t colon = text.rfind(':');
  std::string_view host = colon == std::string_view::npos ? std::string_view{} : text.substr(0, colon);
  const std::string_view number = colon == std::string_view::npos ? text : text.substr(colon + 1);
  const auto port = parse_number<std::uint32_t>(number);
  if (!port) return refuse("is not host:port");
  if (*port > 65535) return refuse(fmt::format("has port {}, and the highest port is 65535", *port));
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  if (!host.empty()) place.host = host;
  place.port = static_cast<std::uint16_t>(*port);
  return place;
}

std::string describe_duration(can::Duration duration) {
  const double ns = static_cast<double>(duration.count());
  if (std::abs(ns) >= 1e9) return fmt::format("{:.3f} s", ns / 1e9);
  if (std::abs(ns) >= 1e6) return fmt::format("{:.1f} ms", ns / 1e6);
  return fmt::format("{:.0f} us", ns / 1e3);
}

}  // namespace canopus::text
