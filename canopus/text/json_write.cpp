// The text of a JSON value.

#include <array>
#include <charconv>

#include "canopus/ascii/hex.hpp"
#include "canopus/text/json.hpp"

namespace canopus::text {
namespace {

/// Replacement for octets that are not UTF-8: U+FFFD.
constexpr std::string_view replacement = "\xEF\xBF\xBD";

/// The number of octets of the first character, or of what is there of one. `text` is not empty.
struct Utf8Sequence {
  std::size_t octets = 1;
  bool is_whole = false;
};
constexpr Utf8Sequence first_sequence(std::string_view text) {
  const auto octet = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = octet(0);
  if (lead < 0x80) return {1, true};
  if (lead < 0xC2 || lead > 0xF4) return {1, false};
  const std::size_t length = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  // No longer form than needed, no surrogates, nothing beyond U+10FFFF.
  unsigned low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  unsigned high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  for (std::size_t i = 1; i < length; ++i, low = 0x80, high = 0xBF) {
    if (i >= text.size() || octet(i) < low || octet(i) > high) return {i, false};
  }
  return {length, true};
}

void write_control(std::string& out, char c) {
  switch (c) {
    case '\b': out += "\\b"; return;
    case '\t': out += "\\t"; return;
    case '\n': out += "\\n"; return;
    case '\f': out += "\\f"; return;
    case '\r': out += "\\r"; return;
    default: break;
  }
  out += "\\u" + ascii::lower_hex(static_cast<unsigned char>(c), 4);
}

void write_string(std::string& out, std::string_view text) {
  out += '"';
  while (!text.empty()) {
    const char c = text.front();
    const Utf8Sequence sequence = first_sequence(text);
    if (!sequence.is_whole) {
      out += replacement;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      write_control(out, c);
    } else {
      if (c == '"' || c == '\\') out += '\\';
      out += text.substr(0, sequence.octets);
    }
    text.remove_prefix(sequence.octets);
  }
  out += '"';
}

template <typename Integer>
void write_integer(std::string& out, Integer value) {
  std::array<char, 24> digits{};
  out.append(digits.data(), std::to_chars(digits.begin(), digits.end(), value).ptr);
}

}  // namespace

void Json::write(std::string& out) const {
  if (is_null()) {
    out += "null";
  } else if (const auto* const flag = std::get_if<bool>(&value_)) {
    out += *flag ? "true" : "false";
  } else if (const auto* const whole = std::get_if<std::int64_t>(&value_)) {
    write_integer(out, *whole);
  } else if (const auto* const positive = std::get_if<std::uint64_t>(&value_)) {
    write_integer(out, *positive);
  } else if (const auto* const number = std::get_if<double>(&value_)) {
    out += real_text(*number);
  } else if (const auto* const text = std::get_if<std::string>(&value_)) {
    write_string(out, *text);
  } else if (const auto* const elements = std::get_if<Array>(&value_)) {
    out += '[';
    for (std::size_t i = 0; i < elements->size(); ++i) {
      if (i > 0) out += ',';
      (*elements)[i].write(out);
    }
    out += ']';
  } else {
    out += '{';
    bool is_first = true;
    for (const auto& [key, value] : items()) {
      if (!is_first) out += ',';
      is_first = false;
      write_string(out, key);
      out += ':';
      value.write(out);
    }
    out += '}';
  }
}

std::string Json::dump() const {
  std::string out;
  write(out);
  return out;
}

}  // namespace canopus::text
