#include "canopus/client/sdo_value.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/text/json.hpp"

namespace canopus::client {
namespace {

using canopen::DataType;

struct TypeName {
  std::string_view name;
  DataType type;
};
constexpr std::array<TypeName, 23> names{{
    {"bool", DataType::boolean},
    {"u8", DataType::unsigned8},
    {"u16", DataType::unsigned16},
    {"u24", DataType::unsigned24},
    {"u32", DataType::unsigned32},
    {"u40", DataType::unsigned40},
    {"u48", DataType::unsigned48},
    {"u56", DataType::unsigned56},
    {"u64", DataType::unsigned64},
    {"i8", DataType::integer8},
    {"i16", DataType::integer16},
    {"i24", DataType::integer24},
    {"i32", DataType::integer32},
    {"i40", DataType::integer40},
    {"i48", DataType::integer48},
    {"i56", DataType::integer56},
    {"i64", DataType::integer64},
    {"f32", DataType::real32},
    {"f64", DataType::real64},
    {"text", DataType::visible_string},
    {"unicode", DataType::unicode_string},
    {"bytes", DataType::octet_string},
    {"domain", DataType::domain},
}};

bool is_number(DataType type) {
  return !canopen::is_variable_length(type) && type != DataType::boolean && type != DataType::real32 &&
         type != DataType::real64;
}

std::int64_t signed_number_of(std::span<const std::uint8_t> bytes) {
  const unsigned unused = 64U - 8U * static_cast<unsigned>(bytes.size());
  return std::bit_cast<std::int64_t>(can::load_value(bytes) << unused) >> unused;
}

double real_of(std::span<const std::uint8_t> bytes) {
  if (bytes.size() == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(can::load_value(bytes)));
  return std::bit_cast<double>(can::load_value(bytes));
}

std::expected<std::vector<std::uint8_t>, std::string> encode_number(std::string_view text, DataType type) {
  const unsigned bits = canopen::bit_length(type);
  const bool is_signed = canopen::is_signed(type);
  const std::uint64_t highest = ~std::uint64_t{0} >> (64U - bits + (is_signed ? 1U : 0U));
  const std::uint64_t lowest = is_signed ? highest + 1 : 0;  // without its sign
  std::string_view digits = text;
  const bool negative = digits.starts_with('-');
  if (negative) digits.remove_prefix(1);
  int base = 10;
  if (ascii::has_hex_prefix(digits)) {
    digits.remove_prefix(2);
    base = 16;
  } else if (digits.ends_with('H') || digits.ends_with('h')) {
    digits.remove_suffix(1);
    base = 16;
  }
  const auto size = ascii::parse_number_or_error<std::uint64_t>(digits, base);
  if (!size && size.error() == ascii::NumberError::no_number) {
    return std::unexpected(fmt::format(
        "\"{}\" is not a number for {}; expected for example 1234, 0x4D2 or 4D2H", text, type_name(type)));
  }
  // A hexadecimal number may be the bit pattern of a negative one: FFH as i8 is -1.
  const std::uint64_t limit = negative ? lowest : base == 16 ? ~std::uint64_t{0} >> (64U - bits) : highest;
  if (!size || *size > limit) {
    return std::unexpected(fmt::format("{} does not fit {}: expected {}{} to {}", text, type_name(type),
                                       is_signed ? "-" : "", lowest, highest));
  }
  return canopen::little_endian(negative ? ~*size + 1 : *size, canopen::byte_length(type));
}

std::expected<std::vector<std::uint8_t>, std::string> encode_real(std::string_view text, DataType type) {
  const auto value = ascii::parse_number<double>(text);
  if (!value) {
    return std::unexpected(fmt::format("\"{}\" is not a number for {}; expected for example 1.5 or -2e3",
                                       text, type_name(type)));
  }
  if (type == DataType::real64) return canopen::little_endian(std::bit_cast<std::uint64_t>(*value), 8);
  return canopen::little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(*value)), 4);
}

std::expected<std::vector<std::uint8_t>, std::string> encode_bytes(std::string_view text) {
  std::string digits;
  std::ranges::copy_if(text, std::back_inserter(digits), [](char c) { return c != ' '; });
  if (auto bytes = ascii::bytes_of_hex(digits)) return std::move(*bytes);
  return std::unexpected(fmt::format(
      "\"{}\" are not bytes; expected pairs of hexadecimal digits, for example \"01 A0 FF\"", text));
}

/// UTF-8 to UCS-2; what is no UTF-8, or beyond FFFFH, becomes FFFDH.
std::vector<std::uint8_t> encode_unicode(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t at) {
      return at < text.size() ? static_cast<unsigned>(static_cast<unsigned char>(text[at])) : 0U;
    };
    const unsigned first = byte(i);
    const std::size_t length = first < 0x80       ? 1
                               : first >> 5 == 6  ? 2
                               : first >> 4 == 14 ? 3
                               : first >> 3 == 30 ? 4
                                                  : 0;
    unsigned code = length == 1 ? first : first & (0x7FU >> std::min<std::size_t>(length, 6));
    bool good = length != 0;
    for (std::size_t k = 1; good && k < length; ++k) {
      good = (byte(i + k) & 0xC0U) == 0x80U;
      code = code << 6 | (byte(i + k) & 0x3FU);
    }
    if (!good || code > 0xFFFF) code = 0xFFFD;
    can::append_value(bytes, code, 2);
    i += good ? length : 1;
  }
  return bytes;
}

std::string decode_unicode(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const unsigned code = can::load_as<std::uint16_t>(&bytes[i]);
    if (code == 0) break;
    if (code < 0x80) {
      text += static_cast<char>(code);
    } else if (code < 0x800) {
      text += static_cast<char>(0xC0U | code >> 6);
      text += static_cast<char>(0x80U | (code & 0x3FU));
    } else {
      text += static_cast<char>(0xE0U | code >> 12);
      text += static_cast<char>(0x80U | (code >> 6 & 0x3FU));
      text += static_cast<char>(0x80U | (code & 0x3FU));
    }
  }
  return text;
}

/// Text as far as its first NUL, which some devices send with it.
std::string decode_text(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), std::ranges::find(bytes, 0)};
}

/// In quotation marks; what a terminal would take for a command is escaped.
std::string in_quotes(std::string_view text) {
  std::string shown = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      shown += '\\';
      shown += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      shown += fmt::format("\\x{:02X}", static_cast<unsigned char>(c));
    } else {
      shown += c;
    }
  }
  return shown + '"';
}

bool fits(std::span<const std::uint8_t> bytes, DataType type) {
  return canopen::is_variable_length(type) || bytes.size() == canopen::byte_length(type);
}

}  // namespace

std::optional<DataType> parse_type(std::string_view name) {
  const auto found = std::ranges::find(names, name, &TypeName::name);
  return found == names.end() ? std::nullopt : std::optional(found->type);
}

std::vector<std::string_view> type_names() {
  std::vector<std::string_view> list;
  for (const TypeName& name : names) list.push_back(name.name);
  return list;
}

std::string_view type_name(DataType type) {
  const auto found = std::ranges::find(names, type, &TypeName::type);
  return found == names.end() ? std::string_view{} : found->name;
}

std::expected<std::vector<std::uint8_t>, std::string> encode_value(std::string_view text, DataType type) {
  switch (type) {
    case DataType::boolean:
      if (text == "true" || text == "1") return std::vector<std::uint8_t>{1};
      if (text == "false" || text == "0") return std::vector<std::uint8_t>{0};
      return std::unexpected(fmt::format("\"{}\" is not a bool; expected true, false, 1 or 0", text));
    case DataType::real32:
    case DataType::real64: return encode_real(text, type);
    case DataType::visible_string: return canopen::text(text);
    case DataType::unicode_string: return encode_unicode(text);
    case DataType::octet_string:
    case DataType::domain: return encode_bytes(text);
    default: return encode_number(text, type);
  }
}

std::expected<std::string, std::string> show_value(std::span<const std::uint8_t> bytes, DataType type) {
  if (!fits(bytes, type)) {
    return std::unexpected(fmt::format("{} came ({}), {} has {}", ascii::counted(bytes.size(), "byte"),
                                       hexadecimal(bytes), type_name(type), canopen::byte_length(type)));
  }
  switch (type) {
    case DataType::boolean: return bytes[0] != 0 ? "true" : "false";
    case DataType::real32: return fmt::format("{}", static_cast<float>(real_of(bytes)));
    case DataType::real64: return fmt::format("{}", real_of(bytes));
    case DataType::visible_string: return in_quotes(decode_text(bytes));
    case DataType::unicode_string: return in_quotes(decode_unicode(bytes));
    case DataType::octet_string:
    case DataType::domain: return hexadecimal(bytes);
    default: break;
  }
  const std::string pattern = fmt::format("{:0{}X}H", can::load_value(bytes), 2 * bytes.size());
  if (canopen::is_signed(type)) return fmt::format("{}  {}", signed_number_of(bytes), pattern);
  return fmt::format("{}  {}", can::load_value(bytes), pattern);
}

std::string show_bytes(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return "no bytes";
  std::string shown = hexadecimal(bytes);
  const bool is_text = bytes.size() >= 2 && std::ranges::all_of(bytes, [](std::uint8_t byte) {
                         return byte >= 0x20 && byte < 0x7F;
                       });
  if (is_text) shown += "  " + in_quotes(decode_text(bytes));
  if (bytes.size() == 1 || bytes.size() == 2 || bytes.size() == 4 || bytes.size() == 8) {
    const DataType type = bytes.size() == 1   ? DataType::unsigned8
                          : bytes.size() == 2 ? DataType::unsigned16
                          : bytes.size() == 4 ? DataType::unsigned32
                                              : DataType::unsigned64;
    shown += "  " + show_value(bytes, type).value_or("");
  }
  return shown;
}

text::Json json_value(std::span<const std::uint8_t> bytes, DataType type) {
  if (!fits(bytes, type)) return nullptr;
  if (type == DataType::boolean) return bytes[0] != 0;
  if (type == DataType::real32 || type == DataType::real64) return real_of(bytes);
  if (type == DataType::visible_string) return decode_text(bytes);
  if (type == DataType::unicode_string) return decode_unicode(bytes);
  if (!is_number(type)) return hexadecimal(bytes, "");
  if (canopen::is_signed(type)) return signed_number_of(bytes);
  return can::load_value(bytes);
}

std::string hexadecimal(std::span<const std::uint8_t> bytes, std::string_view between) {
  return ascii::hex_bytes(bytes, between);
}

}  // namespace canopus::client
