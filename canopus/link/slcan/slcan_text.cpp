#include "canopus/link/slcan/slcan_text.hpp"

#include <algorithm>

#include "canopus/ascii/hex.hpp"

namespace canopus::link {
namespace {

constexpr std::uint32_t standard_rates[] = {10'000,  20'000,  50'000,  100'000,  125'000,
                                            250'000, 500'000, 800'000, 1'000'000};

using ascii::write_hex;

/// Takes hexadecimal digits off the front.
std::optional<std::uint32_t> next_hex(std::string_view& text, std::size_t digits) noexcept {
  if (text.size() < digits) return std::nullopt;
  std::uint32_t value = 0;
  for (const char c : text.substr(0, digits)) {
    const auto digit = ascii::hex_value(c);
    if (!digit) return std::nullopt;
    value = value << 4 | *digit;
  }
  text.remove_prefix(digits);
  return value;
}

std::optional<can::Frame> read_frame(std::string_view text) noexcept {
  const char kind = text.front();
  text.remove_prefix(1);
  can::Frame frame{.extended = kind == 'T' || kind == 'R', .remote = kind == 'r' || kind == 'R'};
  const auto identifier = next_hex(text, frame.extended ? 8 : 3);
  const auto length = next_hex(text, 1);
  if (!identifier || !length || *length > 8) return std::nullopt;
  if (*identifier > (frame.extended ? can::max_extended_identifier : can::max_base_identifier))
    return std::nullopt;
  frame.identifier = *identifier;
  frame.dlc = static_cast<std::uint8_t>(*length);
  for (std::uint8_t& byte : std::span(frame.data).first(frame.length())) {
    const auto value = next_hex(text, 2);
    if (!value) return std::nullopt;
    byte = static_cast<std::uint8_t>(*value);
  }
  // Time stamps: milliseconds of a minute, or 8 digits of some makes.
  const bool has_time = (text.size() == 4 || text.size() == 8) && next_hex(text, text.size());
  if (!text.empty() && !has_time) return std::nullopt;
  return frame;
}

}  // namespace

std::size_t write_slcan_frame(std::span<char, slcan_max_line> out, const can::Frame& frame) noexcept {
  char* p = out.data();
  constexpr char kinds[] = "tTrR";
  *p++ = kinds[(frame.remote ? 2 : 0) + (frame.extended ? 1 : 0)];
  p = write_hex(p, frame.identifier, frame.extended ? 8 : 3);
  p = write_hex(p, std::min<std::uint32_t>(frame.dlc, 8), 1);
  for (const std::uint8_t byte : frame.bytes()) p = write_hex(p, byte, 2);
  *p++ = '\r';
  return static_cast<std::size_t>(p - out.data());
}

std::optional<std::string> slcan_bit_rate(std::uint32_t bit_rate) {
  const auto* standard = std::ranges::find(standard_rates, bit_rate);
  if (standard != std::end(standard_rates)) {
    return std::string{'S', static_cast<char>('0' + (standard - standard_rates))};
  }
  // A time quantum is BRP clocks of 8 MHz; a bit is 1 + TSEG1 + TSEG2 quanta [SJA1000 6.5.1].
  constexpr std::uint32_t clock = 8'000'000;
  for (std::uint32_t quanta = 25; bit_rate != 0 && quanta >= 8; --quanta) {
    if (clock % (bit_rate * std::uint64_t{quanta}) != 0) continue;
    const std::uint32_t prescaler = clock / (bit_rate * quanta);
    const std::uint32_t second = std::max<std::uint32_t>(2, quanta / 8);  // behind the sample point
    const std::uint32_t first = quanta - 1 - second;
    if (prescaler > 64 || first > 16 || second > 8) continue;
    std::string text = "s0000";
    char* p = write_hex(text.data() + 1, prescaler - 1, 2);
    write_hex(p, (second - 1) << 4 | (first - 1), 2);
    return text;
  }
  return std::nullopt;
}

SlcanLine SlcanReader::end_of_line(char end) const noexcept {
  using Kind = SlcanLine::Kind;
  const std::string_view text(input_.data(), std::min(size_, input_.size()));
  if (end == '\a') return {.kind = Kind::refused, .text = text};
  if (size_ > input_.size()) return {.kind = Kind::other, .text = text};
  if (text.empty()) return {.kind = Kind::done};
  switch (text.front()) {
    case 'z':
    case 'Z':
      if (text.size() == 1) return {.kind = Kind::taken, .text = text};
      break;
    case 't':
    case 'T':
    case 'r':
    case 'R':
      if (const auto frame = read_frame(text)) return {.kind = Kind::frame, .frame = *frame, .text = text};
      break;
    case 'F': {
      std::string_view digits = text.substr(1);
      const auto flags = next_hex(digits, 2);
      if (flags && digits.empty()) {
        return {.kind = Kind::flags, .flags = static_cast<std::uint8_t>(*flags), .text = text};
      }
      break;
    }
    default: break;
  }
  return {.kind = Kind::other, .text = text};
}

}  // namespace canopus::link
