#include "canopus/trace/decode/value_text.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/can/little_endian.hpp"

namespace canopus::trace {
namespace {

using canopen::DataType;

/// A string of a device between quotes, without the zeros that fill it up.
std::string quoted(std::span<const std::uint8_t> bytes) {
  std::size_t length = bytes.size();
  while (length > 0 && bytes[length - 1] == 0) --length;
  constexpr std::size_t most = 120;
  std::string text = "\"";
  text.append(reinterpret_cast<const char*>(bytes.data()), std::min(length, most));
  return text + (length > most ? "\"..." : "\"");
}

std::string time_of_day_text(std::span<const std::uint8_t> bytes) {
  const std::uint32_t ms = can::load_u32(bytes) & 0x0FFF'FFFF;
  const std::uint64_t days = can::load_value(bytes.subspan(4));
  return fmt::format("{:02}:{:02}:{:02}.{:03}, day {}", ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60,
                     ms % 1000, days);
}

std::int64_t sign_extended(std::uint64_t raw, unsigned bits) noexcept {
  const unsigned unused = 64 - bits;
  return static_cast<std::int64_t>(raw << unused) >> unused;
}

}  // namespace

std::string hexadecimal(std::span<const std::uint8_t> bytes, std::size_t most) {
  std::string text = ascii::hex_bytes(bytes.first(std::min(bytes.size(), most)), " ");
  if (bytes.size() > most) text += " ...";
  return text;
}

std::optional<std::string> typed_value(std::span<const std::uint8_t> bytes, DataType type) {
  if (type == DataType::none) return std::nullopt;
  if (type == DataType::visible_string) return quoted(bytes);
  if (canopen::is_variable_length(type)) return hexadecimal(bytes);
  const unsigned length = canopen::byte_length(type);
  if (bytes.size() != length) return std::nullopt;
  const std::uint64_t raw = can::load_value(bytes);
  switch (type) {
    case DataType::boolean: return raw == 0 ? "false" : "true";
    case DataType::real32: return fmt::format("{}", std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
    case DataType::real64: return fmt::format("{}", std::bit_cast<double>(raw));
    case DataType::time_of_day:
    case DataType::time_difference: return time_of_day_text(bytes);
    default: break;
  }
  if (canopen::is_signed(type)) return fmt::format("{}", sign_extended(raw, length * 8));
  return fmt::format("{}", raw);
}

std::string value_text(std::span<const std::uint8_t> bytes, DataType type) {
  if (auto text = typed_value(bytes, type)) return *text;
  if (bytes.empty()) return "nothing";
  if (bytes.size() <= 8) return fmt::format("{:0{}X}H", can::load_value(bytes), bytes.size() * 2);
  return hexadecimal(bytes);
}

std::optional<double> number_of(std::uint64_t raw, unsigned bits, DataType type) {
  if (bits == 0 || bits > 64) return std::nullopt;
  if (bits < 64) raw &= (std::uint64_t{1} << bits) - 1;
  if (type == DataType::real32)
    return bits == 32 ? std::optional(double{std::bit_cast<float>(static_cast<std::uint32_t>(raw))})
                      : std::nullopt;
  if (type == DataType::real64) return bits == 64 ? std::optional(std::bit_cast<double>(raw)) : std::nullopt;
  if (type == DataType::time_of_day || type == DataType::time_difference ||
      (type != DataType::none && canopen::is_variable_length(type))) {
    return std::nullopt;
  }
  if (canopen::is_signed(type)) return static_cast<double>(sign_extended(raw, bits));
  return static_cast<double>(raw);
}

std::string duration_text(std::int64_t nanoseconds) {
  const double ms = static_cast<double>(nanoseconds) / 1e6;
  if (std::abs(ms) >= 10'000) return fmt::format("{:.1f} s", ms / 1000);
  if (std::abs(ms) >= 100) return fmt::format("{:.0f} ms", ms);
  return fmt::format("{:.{}f} ms", ms, std::abs(ms) >= 0.1 || ms == 0 ? 1 : 3);
}

}  // namespace canopus::trace
