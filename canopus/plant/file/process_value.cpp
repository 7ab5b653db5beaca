#include "canopus/plant/file/process_value.hpp"

#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::plant {

using canopen::DataType;
using canopen::Entry;

namespace {

bool is_real(DataType type) { return type == DataType::real32 || type == DataType::real64; }

std::int64_t extended(DataType type, std::uint64_t bits) {
  const unsigned unused = 64U - canopen::bit_length(type);
  return static_cast<std::int64_t>(bits << unused) >> unused;
}

double real(DataType type, std::uint64_t bits) {
  return type == DataType::real64
             ? std::bit_cast<double>(bits)
             : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
}

/// A limit or a bound of an integer type, a 64-bit pattern.
std::string bound_text(DataType type, std::uint64_t pattern) {
  if (is_real(type)) return fmt::format("{}", std::bit_cast<double>(pattern));
  return canopen::is_signed(type) ? fmt::format("{}", static_cast<std::int64_t>(pattern))
                                  : fmt::format("{}", pattern);
}

/// A whole number as a 64-bit two's complement pattern. Nothing: it is none, or has more than 64 bits.
struct Whole {
  bool negative = false;
  std::uint64_t magnitude = 0;
};
std::optional<Whole> parse_whole(std::string_view text) {
  Whole number;
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) {
    number.negative = text[0] == '-';
    text.remove_prefix(1);
  }
  const auto magnitude = ascii::parse_number_with_prefix<std::uint64_t>(text);
  if (!magnitude) return std::nullopt;
  number.magnitude = *magnitude;
  return number;
}

std::optional<double> parse_real(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = ascii::parse_number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// The 64-bit pattern of a text as eds::less compares it.
std::expected<std::uint64_t, std::string> pattern_of(std::string_view text, DataType type) {
  const std::string_view type_name = eds::name(type);
  if (is_real(type)) {
    const auto whole = parse_whole(text);
    const auto value = whole ? (whole->negative ? -1.0 : 1.0) * static_cast<double>(whole->magnitude)
                             : parse_real(text).value_or(NAN);
    if (std::isnan(value))
      return std::unexpected(fmt::format("\"{}\" is no number, as {} needs", text, type_name));
    if (type == DataType::real32 && std::abs(value) > 3.4028234663852886e38) {
      return std::unexpected(fmt::format("{} does not fit {}", text, type_name));
    }
    return std::bit_cast<std::uint64_t>(value);
  }
  if (type == DataType::boolean) {
    if (text == "true" || text == "1") return 1U;
    if (text == "false" || text == "0") return 0U;
    return std::unexpected(fmt::format("\"{}\" is no BOOLEAN; expected true, false, 1 or 0", text));
  }
  const auto number = parse_whole(text);
  if (!number) {
    return std::unexpected(fmt::format(
        "\"{}\" is no whole number, as {} needs; expected for example 17 or 0x11", text, type_name));
  }
  const eds::Range range = eds::range(type);
  const std::uint64_t lowest_magnitude = canopen::is_signed(type) ? ~range.low + 1 : 0;
  const bool fits =
      number->negative ? number->magnitude <= lowest_magnitude : number->magnitude <= range.high;
  if (!fits) {
    return std::unexpected(fmt::format("{} does not fit {}; expected {} to {}", text, type_name,
                                       bound_text(type, range.low), bound_text(type, range.high)));
  }
  return number->negative ? ~number->magnitude + 1 : number->magnitude;
}

}  // namespace

std::vector<Entry> process_values(const sim::Device& device) {
  std::vector<Entry> values;
  for (const canopen::ObjectDescription& object : device.file().dictionary->objects()) {
    for (unsigned sub = 0; object.index >= 0x2000 && sub <= object.highest_sub; ++sub) {
      const auto entry = device.process_value(object.index, static_cast<std::uint8_t>(sub));
      if (entry) values.push_back(*entry);
    }
  }
  return values;
}

std::expected<Entry, std::string> find_process_value(const sim::Device& device, std::string_view text) {
  const canopen::DictionaryDescription& description = *device.file().dictionary;
  const auto object = text::parse_object(text);
  if (object && description.find(object->index, object->sub)) {
    return device.process_value(object->index, object->sub);
  }
  std::vector<std::string> named;
  std::vector<std::string_view> names;
  Entry found;
  for (const Entry& entry : process_values(device)) {
    names.push_back(description.name(entry));
    if (!ascii::equal_ignoring_case(names.back(), text)) continue;
    found = entry;
    named.push_back(canopen::object_text(entry.index, entry.sub));
  }
  if (named.size() == 1) return found;
  if (named.size() > 1) {
    constexpr std::size_t enough = 4;
    const bool more = named.size() > enough;
    if (more) named.resize(enough);
    return std::unexpected(fmt::format("\"{}\" is the name of more than one object; expected one of {}{}",
                                       text, fmt::join(named, ", "), more ? ", ..." : ""));
  }
  if (object) return device.process_value(object->index, object->sub);
  const std::string_view meant = text::nearest(text, names);
  return std::unexpected(
      fmt::format("the device has no value \"{}\"; expected index:sub-index such as "
                  "\"6000:01\", or a parameter's name{}",
                  text, meant.empty() ? "" : fmt::format(" (\"{}\"?)", meant)));
}

std::expected<std::uint64_t, std::string> parse_value(std::string_view text, const Entry& entry,
                                                      const canopen::DictionaryDescription& description) {
  const DataType type = entry.description->type;
  const auto pattern = pattern_of(text, type);
  if (!pattern) return pattern;
  const canopen::Limits& limits = description.limits(entry);
  if (limits.low && eds::less(type, *pattern, *limits.low)) {
    return std::unexpected(
        fmt::format("{} is below the device file's LowLimit {}", text, bound_text(type, *limits.low)));
  }
  if (limits.high && eds::less(type, *limits.high, *pattern)) {
    return std::unexpected(
        fmt::format("{} is above the device file's HighLimit {}", text, bound_text(type, *limits.high)));
  }
  if (type == DataType::real32) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(std::bit_cast<double>(*pattern)));
  }
  const unsigned unused = 64U - 8U * entry.description->length;
  return (*pattern << unused) >> unused;
}

std::string text_of(const text::Scalar& value) {
  return std::visit(
      [](const auto& held) -> std::string {
        if constexpr (std::is_same_v<std::decay_t<decltype(held)>, std::string>) {
          return held;
        } else {
          return fmt::format("{}", held);
        }
      },
      value);
}

std::string show_value(DataType type, std::uint64_t bits) {
  if (type == DataType::boolean) return (bits & 1) != 0 ? "true" : "false";
  if (type == DataType::real32)
    return fmt::format("{}", std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  if (type == DataType::real64) return fmt::format("{}", real(type, bits));
  if (canopen::is_signed(type)) return fmt::format("{}", extended(type, bits));
  return fmt::format("{}", bits);
}

text::Json json_value(DataType type, std::uint64_t bits) {
  if (type == DataType::boolean) return (bits & 1) != 0;
  if (is_real(type)) {
    const double value = real(type, bits);
    if (!std::isfinite(value)) return show_value(type, bits);
    return value;
  }
  if (canopen::is_signed(type)) return extended(type, bits);
  return bits;
}

}  // namespace canopus::plant
