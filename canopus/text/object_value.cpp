#include "canopus/text/object_value.hpp"

#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/eds/value.hpp"

namespace canopus::text {

namespace {

template <typename Number>
std::expected<std::vector<std::uint8_t>, std::string> whole_number(Number number, canopen::DataType type) {
  const unsigned bits = canopen::bit_length(type);
  const auto low = canopen::is_signed(type) ? -std::exp2(bits - 1) : 0.0;
  const auto high = canopen::is_signed(type) ? std::exp2(bits - 1) : std::exp2(bits);
  const auto value = static_cast<double>(number);
  // A negative number may stand for the bit pattern of an unsigned one (-1 = FFFFH), as GX Works allows.
  const bool fits = value < high && value >= (low == 0.0 ? -std::exp2(bits - 1) : low);
  if (!fits) return std::unexpected(fmt::format("{} does not fit {}", number, eds::name(type)));
  return canopen::little_endian(static_cast<std::uint64_t>(static_cast<std::int64_t>(number)),
                                canopen::byte_length(type));
}

}  // namespace

std::expected<std::vector<std::uint8_t>, std::string> encode(const Scalar& value, canopen::DataType type) {
  if (canopen::is_variable_length(type)) {
    if (const auto* words = std::get_if<std::string>(&value)) return canopen::text(*words);
    return std::unexpected(fmt::format("expected a string for {}", eds::name(type)));
  }
  if (const auto* flag = std::get_if<bool>(&value)) {
    return canopen::little_endian(*flag ? 1 : 0, canopen::byte_length(type));
  }
  if (std::holds_alternative<std::string>(value)) {
    return std::unexpected(fmt::format("\"{}\" is a string, expected a number for {}",
                                       std::get<std::string>(value), eds::name(type)));
  }
  const auto* whole = std::get_if<std::int64_t>(&value);
  const double number = whole != nullptr ? static_cast<double>(*whole) : std::get<double>(value);
  if (type == canopen::DataType::real32) {
    return canopen::little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(number)), 4);
  }
  if (type == canopen::DataType::real64)
    return canopen::little_endian(std::bit_cast<std::uint64_t>(number), 8);
  if (whole != nullptr) return whole_number(*whole, type);
  if (number != std::floor(number)) {
    return std::unexpected(fmt::format("{} is not a whole number, as {} needs", number, eds::name(type)));
  }
  return whole_number(number, type);
}

}  // namespace canopus::text
