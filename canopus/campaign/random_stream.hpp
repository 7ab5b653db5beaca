#pragma once
// Random numbers of a campaign: the same on every machine and with every standard library, whose distributions are not.

#include <cstdint>
#include <string_view>

namespace canopus::campaign {

/// FNV-1a: a checksum that does not depend on the machine.
class Checksum {
 public:
  constexpr void add(std::string_view bytes) noexcept {
    for (const char byte : bytes) add_octet(static_cast<std::uint8_t>(byte));
  }
  constexpr void add_number(std::uint64_t number) noexcept {
    for (unsigned shift = 0; shift < 64; shift += 8) add_octet(static_cast<std::uint8_t>(number >> shift));
  }
  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return value_; }

 private:
  constexpr void add_octet(std::uint8_t octet) noexcept { value_ = (value_ ^ octet) * 0x0000'0100'0000'01B3; }
  std::uint64_t value_ = 0xCBF2'9CE4'8422'2325;
};

/// SplitMix64 (Steele, Lea, Flood 2014).
class RandomStream {
 public:
  /// A stream of its own for each name, so that what one rule draws does not depend on the others.
  constexpr RandomStream(std::uint64_t seed, std::string_view name) noexcept {
    Checksum checksum;
    checksum.add_number(seed);
    checksum.add(name);
    state_ = checksum.value();
  }
  constexpr std::uint64_t next() noexcept {
    state_ += 0x9E37'79B9'7F4A'7C15;
    std::uint64_t mixed = state_;
    mixed = (mixed ^ mixed >> 30U) * 0xBF58'476D'1CE4'E5B9;
    mixed = (mixed ^ mixed >> 27U) * 0x94D0'49BB'1331'11EB;
    return mixed ^ mixed >> 31U;
  }
  /// 0 to `count` - 1, each as likely; `count` is not 0.
  constexpr std::uint64_t below(std::uint64_t count) noexcept {
    const std::uint64_t rest = (~std::uint64_t{0} % count + 1) % count;  // of 2^64 by count
    std::uint64_t number = next();
    while (number > ~std::uint64_t{0} - rest) number = next();
    return number % count;
  }
  /// `low` to `high`, both included.
  constexpr std::int64_t between(std::int64_t low, std::int64_t high) noexcept {
    const std::uint64_t count = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
    const std::uint64_t offset = count == 0 ? next() : below(count);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + offset);
  }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace canopus::campaign
