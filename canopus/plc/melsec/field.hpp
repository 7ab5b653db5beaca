#pragma once
// The fields of a message, in either data code: binary sends a number low byte first, ASCII as upper-case
// hexadecimal text with the high digit first. Everything above this file is written once for both.
//
// A reader never reads beyond its bytes: the first field that is missing or not a number sets its fault, and
// every field from then on reads as 0. So a command can be read to its end and judged once.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "canopus/ascii/hex.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/plc/melsec/data_code.hpp"

namespace canopus::plc::melsec {

class FieldReader {
 public:
  enum class Fault : std::uint8_t { none, too_short, not_a_number };

  FieldReader(std::span<const std::uint8_t> bytes, DataCode code) noexcept : bytes_(bytes), code_(code) {}

  [[nodiscard]] DataCode code() const noexcept { return code_; }
  [[nodiscard]] Fault fault() const noexcept { return fault_; }
  [[nodiscard]] bool at_end() const noexcept { return position_ == bytes_.size(); }

  std::uint8_t u8() noexcept { return static_cast<std::uint8_t>(number<1>()); }
  std::uint16_t u16() noexcept { return static_cast<std::uint16_t>(number<2>()); }
  std::uint32_t u24() noexcept { return number<3>(); }
  std::uint32_t u32() noexcept { return number<4>(); }
  /// A u16() for each; all 0 in binary when one is missing.
  void words(std::span<std::uint16_t> into) noexcept {
    if (code_ == DataCode::ascii) {
      for (std::uint16_t& word : into) word = u16();
      return;
    }
    const auto taken = raw(into.size_bytes());
    if (taken.empty()) {
      std::ranges::fill(into, std::uint16_t{0});
    } else {
      std::memcpy(into.data(), taken.data(), taken.size());
    }
  }

  /// Bytes as they are, e.g. the characters of ASCII; empty after a fault.
  std::span<const std::uint8_t> raw(std::size_t count) noexcept {
    if (fault_ != Fault::none || bytes_.size() - position_ < count) {
      if (fault_ == Fault::none) fault_ = Fault::too_short;
      return {};
    }
    const auto taken = bytes_.subspan(position_, count);
    position_ += count;
    return taken;
  }

  /// ASCII only: a number of `digits` characters in base 10 or 16, its leading zeros may be blanks. Saturates
  /// at FFFFFFFFH.
  std::uint32_t digits(std::size_t digits, unsigned base) noexcept {
    std::uint64_t value = 0;
    bool leading = true;
    for (const std::uint8_t character : raw(digits)) {
      if (leading && character == ' ') continue;
      leading = false;
      const unsigned digit = digit_of(character);
      if (digit >= base) {
        fault_ = Fault::not_a_number;
        return 0;
      }
      value = value * base + digit;
    }
    return static_cast<std::uint32_t>(value > 0xFFFFFFFFU ? 0xFFFFFFFFU : value);
  }

  /// Single bits: a character each, or half a byte each with the first one in the high half. Anything but 0
  /// and 1 is false.
  bool bits(std::span<std::uint8_t> into) noexcept {
    const bool ascii = code_ == DataCode::ascii;
    const auto taken = raw(ascii ? into.size() : (into.size() + 1) / 2);
    if (taken.empty()) return true;
    for (std::size_t i = 0; i < into.size(); ++i) {
      const unsigned value = ascii        ? static_cast<unsigned>(taken[i]) - '0'
                             : i % 2 == 0 ? static_cast<unsigned>(taken[i / 2]) >> 4U
                                          : taken[i / 2] & 0x0FU;
      if (value > 1) return false;
      into[i] = static_cast<std::uint8_t>(value);
    }
    return true;
  }

 private:
  /// 255: none. Small letters are none.
  static unsigned digit_of(std::uint8_t character) noexcept {
    return character > 'F' ? 255 : ascii::hex_value(static_cast<char>(character)).value_or(255);
  }

  template <std::size_t size>
  std::uint32_t number() noexcept {
    if (code_ == DataCode::ascii) return digits(2 * size, 16);
    const auto bytes = raw(size);
    return bytes.empty() ? 0 : static_cast<std::uint32_t>(can::load_value(bytes.data(), size));
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
  DataCode code_;
  Fault fault_ = Fault::none;
};

/// Writes into memory. The caller makes sure that it is large enough.
class FieldWriter {
 public:
  FieldWriter(std::span<std::uint8_t> memory, DataCode code) noexcept : memory_(memory), code_(code) {}

  [[nodiscard]] DataCode code() const noexcept { return code_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Back to an earlier size(), to put something else there.
  void rewind(std::size_t size) noexcept { size_ = size; }

  void u8(std::uint8_t value) noexcept { number(value, 1); }
  void u16(std::uint16_t value) noexcept { number(value, 2); }
  void u32(std::uint32_t value) noexcept { number(value, 4); }
  /// A u16() for each.
  void words(std::span<const std::uint16_t> values) noexcept {
    if (code_ == DataCode::ascii) {
      for (const std::uint16_t value : values) number(value, 2);
    } else {  // as they lie in memory, see can/little_endian.hpp
      copy(values.data(), values.size_bytes());
    }
  }
  void text(std::string_view characters) noexcept { copy(characters.data(), characters.size()); }
  void raw(std::span<const std::uint8_t> bytes) noexcept { copy(bytes.data(), bytes.size()); }
  void bits(std::span<const std::uint8_t> values) noexcept {
    if (code_ == DataCode::ascii) {
      for (const std::uint8_t value : values) put(value != 0 ? '1' : '0');
      return;
    }
    for (std::size_t i = 0; i < values.size(); i += 2) {
      const unsigned second = i + 1 < values.size() ? unsigned{values[i + 1]} : 0U;
      put(static_cast<std::uint8_t>(unsigned{values[i]} << 4U | second));
    }
  }

 private:
  void put(std::uint8_t byte) noexcept { memory_[size_++] = byte; }
  void copy(const void* from, std::size_t size) noexcept {
    if (size == 0) return;
    std::memcpy(memory_.subspan(size_, size).data(), from, size);
    size_ += size;
  }
  void number(std::uint32_t value, std::size_t size) noexcept {
    if (code_ == DataCode::binary) {
      can::store_value(&memory_[size_], value, static_cast<unsigned>(size));
      size_ += size;
      return;
    }
    for (std::size_t i = 2 * size; i-- > 0;)
      put(static_cast<std::uint8_t>(ascii::hex_digit(value >> (4 * i))));
  }

  std::span<std::uint8_t> memory_;
  std::size_t size_ = 0;
  DataCode code_;
};

}  // namespace canopus::plc::melsec
