#include "canopus/program/data_type.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/program/time_text.hpp"

namespace canopus::program {

namespace {

constexpr std::array<ElementaryInfo, elementary_count> infos = {{
    {"BOOL", Family::boolean, 1},
    {"SINT", Family::signed_integer, 8},
    {"INT", Family::signed_integer, 16},
    {"DINT", Family::signed_integer, 32},
    {"LINT", Family::signed_integer, 64},
    {"USINT", Family::unsigned_integer, 8},
    {"UINT", Family::unsigned_integer, 16},
    {"UDINT", Family::unsigned_integer, 32},
    {"ULINT", Family::unsigned_integer, 64},
    {"BYTE", Family::bits, 8},
    {"WORD", Family::bits, 16},
    {"DWORD", Family::bits, 32},
    {"LWORD", Family::bits, 64},
    {"REAL", Family::real, 32},
    {"LREAL", Family::real, 64},
    {"TIME", Family::duration, 64},
    {"LTIME", Family::duration, 64},
    {"DATE", Family::date, 64},
    {"LDATE", Family::date, 64},
    {"TOD", Family::date, 64},
    {"LTOD", Family::date, 64},
    {"DT", Family::date, 64},
    {"LDT", Family::date, 64},
    {"CHAR", Family::character, 8},
    {"WCHAR", Family::character, 16},
    {"STRING", Family::string, 8},
    {"WSTRING", Family::string, 16},
}};

constexpr std::array<std::pair<std::string_view, Elementary>, 4> long_names = {
    {{"TIME_OF_DAY", Elementary::tod},
     {"DATE_AND_TIME", Elementary::dt},
     {"LTIME_OF_DAY", Elementary::ltod},
     {"LDATE_AND_TIME", Elementary::ldt}}};

constexpr std::size_t longest_text = 2000;

template <typename Number>
std::string number_text(Number number) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
  std::string shown(text.data(), end);
  if constexpr (std::is_floating_point_v<Number>) {
    if (shown.find_first_not_of("-0123456789") == std::string::npos) shown += ".0";
  }
  return shown;
}

std::string string_text(const DataType& type, const Slot* value) {
  const std::uint32_t length = string_header(*value).length;
  const bool is_wide = type.base == Elementary::wstring;
  const char quote = is_wide ? '"' : '\'';
  std::string text(1, quote);
  for (std::uint32_t i = 0; i < length; ++i) {
    const unsigned bits = is_wide ? 16 : 8;
    const auto c =
        static_cast<unsigned>(value[1 + i * bits / 64] >> (i * bits % 64) & (is_wide ? 0xFFFFU : 0xFFU));
    if (c == '$' || c == static_cast<unsigned char>(quote)) {
      text += '$';
      text += static_cast<char>(c);
    } else if (c < 0x20 || c > 0x7E) {
      text += '$' + ascii::hex(c, is_wide ? 4 : 2);
    } else {
      text += static_cast<char>(c);
    }
  }
  return text + quote;
}

std::string scalar_text(const DataType& type, Slot value) {
  if (type.form == DataType::Form::enumeration) {
    for (const auto& [name, number] : type.values)
      if (number == static_cast<std::int64_t>(value)) return name;
  }
  const ElementaryInfo& kind = info(type.base);
  switch (kind.family) {
    case Family::boolean: return value != 0 ? "TRUE" : "FALSE";
    case Family::signed_integer: return number_text(static_cast<std::int64_t>(value));
    case Family::unsigned_integer: return number_text(value);
    case Family::bits: return "16#" + ascii::hex(value, kind.bits / 4);
    case Family::real:
      return kind.bits == 32 ? number_text(std::bit_cast<float>(static_cast<std::uint32_t>(value)))
                             : number_text(std::bit_cast<double>(value));
    case Family::duration:
      return (type.base == Elementary::ltime ? "LT#" : "T#") +
             duration_text(static_cast<std::int64_t>(value));
    case Family::character: {
      const bool is_wide = kind.bits == 16;
      const std::array<Slot, 2> text = {string_header(1, 1), value};
      DataType string{.base = is_wide ? Elementary::wstring : Elementary::string};
      return string_text(string, text.data());
    }
    case Family::date: break;
    case Family::string: return {};
  }
  const auto ns = static_cast<std::int64_t>(value);
  const std::string prefix = std::string(kind.name) + '#';
  if (type.base == Elementary::tod || type.base == Elementary::ltod) return prefix + time_of_day_text(ns);
  if (type.base == Elementary::date || type.base == Elementary::ldate) return prefix + date_text(ns);
  constexpr std::int64_t day = 86'400'000'000'000;
  const std::int64_t time = (ns % day + day) % day;
  return prefix + date_text(ns) + '-' + time_of_day_text(time);
}

void append_value(std::string& text, const DataType& type, const Slot* value) {
  if (text.size() > longest_text) return;
  if (type.is_string()) {
    text += string_text(type, value);
  } else if (type.is_scalar()) {
    text += scalar_text(type, *value);
  } else if (type.form == DataType::Form::array) {
    text += '[';
    for (std::int64_t i = type.low; i <= type.high && text.size() <= longest_text; ++i) {
      if (i != type.low) text += ", ";
      append_value(text, *type.element, value + static_cast<std::size_t>(i - type.low) * type.element->slots);
    }
    text += ']';
  } else {
    text += '(';
    bool is_first = true;
    for (const Member& member : type.members) {
      if (member.kind == MemberKind::in_out || member.kind == MemberKind::hidden) continue;
      if (!is_first) text += ", ";
      is_first = false;
      text += member.name + " := ";
      append_value(text, *member.type, value + member.offset);
    }
    text += ')';
  }
}

/// "16#FF", "2#1010_1010", "-12"; none: no integer, or more than 64 bits.
std::optional<Slot> parse_integer(std::string_view text) {
  std::string plain;
  for (const char c : text)
    if (c != '_') plain += c;
  std::string_view digits = plain;
  int base = 10;
  for (const auto& [prefix, value] : {std::pair{"16#", 16}, std::pair{"8#", 8}, std::pair{"2#", 2}}) {
    if (!digits.starts_with(prefix)) continue;
    digits.remove_prefix(std::string_view(prefix).size());
    base = value;
  }
  if (digits.starts_with('-')) {
    const auto number = ascii::parse_number<std::int64_t>(digits, base);
    return number ? std::optional(static_cast<Slot>(*number)) : std::nullopt;
  }
  return ascii::parse_number<std::uint64_t>(digits, base);
}

std::optional<Slot> parse_scalar(const DataType& type, std::string_view text) {
  if (type.form == DataType::Form::enumeration) {
    for (const auto& [name, number] : type.values)
      if (ascii::equal_ignoring_case(name, text)) return static_cast<Slot>(number);
    return std::nullopt;
  }
  const ElementaryInfo& kind = info(type.base);
  switch (kind.family) {
    case Family::boolean:
      if (text == "1" || ascii::equal_ignoring_case(text, "TRUE")) return Slot{1};
      if (text == "0" || ascii::equal_ignoring_case(text, "FALSE")) return Slot{0};
      return std::nullopt;
    case Family::signed_integer: {
      const auto value = parse_integer(text);
      if (!value ||
          (!text.starts_with('-') && *value > static_cast<Slot>(std::numeric_limits<std::int64_t>::max())))
        return std::nullopt;
      const auto number = static_cast<std::int64_t>(*value);
      const std::int64_t least = type.form == DataType::Form::subrange ? type.low : -1LL << (kind.bits - 1);
      const std::int64_t most =
          type.form == DataType::Form::subrange ? type.high : ~(-1LL << (kind.bits - 1));
      return number >= least && number <= most ? value : std::nullopt;
    }
    case Family::unsigned_integer:
    case Family::bits: {
      const auto value = parse_integer(text);
      if (!value || text.starts_with('-') || (kind.bits < 64 && *value >> kind.bits != 0))
        return std::nullopt;
      if (type.form == DataType::Form::subrange &&
          (*value < static_cast<Slot>(type.low) || *value > static_cast<Slot>(type.high)))
        return std::nullopt;
      return value;
    }
    case Family::real: {
      if (kind.bits == 64) {
        const auto value = ascii::parse_number<double>(text);
        return value ? std::optional(std::bit_cast<Slot>(*value)) : std::nullopt;
      }
      const auto value = ascii::parse_number<float>(text);
      return value ? std::optional(Slot{std::bit_cast<std::uint32_t>(*value)}) : std::nullopt;
    }
    case Family::duration: {
      const auto value = parse_duration(text);
      return value ? std::optional(static_cast<Slot>(*value)) : std::nullopt;
    }
    case Family::date: {
      const bool is_date = type.base == Elementary::date || type.base == Elementary::ldate;
      const bool is_time = type.base == Elementary::tod || type.base == Elementary::ltod;
      const auto value = is_date   ? parse_date(text)
                         : is_time ? parse_time_of_day(text)
                                   : parse_date_and_time(text);
      return value ? std::optional(static_cast<Slot>(*value)) : std::nullopt;
    }
    case Family::character:
      if (text.size() == 3 && text.front() == text.back()) text = text.substr(1, 1);
      if (text.size() != 1) return std::nullopt;
      return Slot{static_cast<unsigned char>(text.front())};
    case Family::string: break;
  }
  return std::nullopt;
}

std::optional<std::string> write_string(const DataType& type, std::string_view text, Slot* to) {
  const char quote = type.base == Elementary::wstring ? '"' : '\'';
  if (text.size() >= 2 && text.front() == quote && text.back() == quote)
    text = text.substr(1, text.size() - 2);
  if (text.size() > type.capacity) return "expected at most " + std::to_string(type.capacity) + " characters";
  const unsigned bits = type.base == Elementary::wstring ? 16 : 8;
  std::fill_n(to, type.slots, Slot{0});
  to[0] = string_header(static_cast<std::uint32_t>(text.size()), type.capacity);
  for (std::size_t i = 0; i < text.size(); ++i)
    to[1 + i * bits / 64] |= Slot{static_cast<unsigned char>(text[i])} << (i * bits % 64);
  return std::nullopt;
}

}  // namespace

const ElementaryInfo& info(Elementary type) noexcept { return infos[static_cast<std::size_t>(type)]; }

std::optional<Elementary> elementary_named(std::string_view name) noexcept {
  for (std::size_t i = 0; i < infos.size(); ++i)
    if (ascii::equal_ignoring_case(infos[i].name, name)) return static_cast<Elementary>(i);
  for (const auto& [long_name, type] : long_names)
    if (ascii::equal_ignoring_case(long_name, name)) return type;
  return std::nullopt;
}

const Member* DataType::member(std::string_view wanted) const noexcept {
  const auto found = std::ranges::find_if(
      members, [&](const Member& member) { return ascii::equal_ignoring_case(member.name, wanted); });
  return found == members.end() ? nullptr : &*found;
}

void write_initial(const DataType& type, Slot* to) {
  if (!type.initial.empty()) {
    std::ranges::copy(type.initial, to);
    return;
  }
  switch (type.form) {
    case DataType::Form::elementary:
      std::fill_n(to, type.slots, Slot{0});
      if (type.is_string()) *to = string_header(0, type.capacity);
      return;
    case DataType::Form::enumeration:
      *to = type.values.empty() ? 0 : static_cast<Slot>(type.values.front().second);
      return;
    case DataType::Form::subrange: *to = static_cast<Slot>(type.low); return;
    case DataType::Form::array: {
      if (type.slots == 0) return;
      write_initial(*type.element, to);
      for (std::uint32_t at = type.element->slots; at < type.slots; at += type.element->slots)
        std::copy_n(to, type.element->slots, to + at);
      return;
    }
    case DataType::Form::structure:
    case DataType::Form::block:
      std::fill_n(to, type.slots, Slot{0});
      for (const Member& member : type.members)
        if (member.kind != MemberKind::in_out) write_initial(*member.type, to + member.offset);
      return;
  }
}

bool is_value(const DataType& type, std::span<const Slot> slots) noexcept {
  if (slots.size() != type.slots || slots.empty()) return false;
  if (type.is_string()) {
    const StringHeader header = string_header(slots.front());
    return header.capacity == type.capacity && header.length <= header.capacity;
  }
  if (!type.is_scalar()) return false;
  const ElementaryInfo& kind = info(type.base);
  const auto number = static_cast<std::int64_t>(slots.front());
  if (type.form == DataType::Form::subrange && (number < type.low || number > type.high)) return false;
  if (kind.bits == 64) return true;
  if (kind.family != Family::signed_integer) return slots.front() >> kind.bits == 0;
  const std::int64_t half = std::int64_t{1} << (kind.bits - 1U);
  return number >= -half && number < half;
}

bool same_type(const DataType& a, const DataType& b) noexcept {
  if (&a == &b) return true;
  if (a.form != b.form || a.base != b.base || a.slots != b.slots || a.low != b.low || a.high != b.high ||
      a.capacity != b.capacity || a.values != b.values || a.members.size() != b.members.size())
    return false;
  if (a.form == DataType::Form::array) return same_type(*a.element, *b.element);
  for (std::size_t i = 0; i < a.members.size(); ++i) {
    const Member& one = a.members[i];
    const Member& other = b.members[i];
    if (!ascii::equal_ignoring_case(one.name, other.name) || one.offset != other.offset ||
        one.kind != other.kind || !same_type(*one.type, *other.type))
      return false;
  }
  return true;
}

std::string value_text(const DataType& type, const Slot* value) {
  std::string text;
  append_value(text, type, value);
  if (text.size() > longest_text) {
    text.resize(longest_text);
    text += "...";
  }
  return text;
}

std::optional<std::string> parse_value(const DataType& type, std::string_view text, Slot* to) {
  if (type.is_string()) return write_string(type, text, to);
  if (!type.is_scalar()) return "expected the name of one value, not of an array or a structure";
  const std::size_t hash = text.find('#');
  if (hash != std::string_view::npos) {
    const std::string_view prefix = text.substr(0, hash);
    const bool is_short_time =
        info(type.base).family == Family::duration &&
        (ascii::equal_ignoring_case(prefix, "T") || ascii::equal_ignoring_case(prefix, "LT"));
    if (is_short_time || elementary_named(prefix) == type.base ||
        ascii::equal_ignoring_case(prefix, type.name) ||
        (ascii::equal_ignoring_case(prefix, "D") && type.base == Elementary::date))
      text.remove_prefix(hash + 1);
  }
  const auto value = parse_scalar(type, text);
  if (!value) {
    std::string expected = "expected ";
    if (type.form == DataType::Form::enumeration) {
      for (const auto& [name, number] : type.values)
        expected += (&name == &type.values.front().first ? "" : ", ") + name;
      return expected;
    }
    expected += info(type.base).name;
    if (type.form == DataType::Form::subrange)
      expected += " from " + std::to_string(type.low) + " to " + std::to_string(type.high);
    return expected;
  }
  *to = *value;
  return std::nullopt;
}

}  // namespace canopus::program
