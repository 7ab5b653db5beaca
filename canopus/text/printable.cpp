#include "canopus/text/printable.hpp"

#include <cstdint>
#include <cstring>
#include <cwchar>
#include <optional>

#include <fmt/format.h>
#include <locale.h>

namespace canopus::text {
namespace {

struct Character {
  std::optional<char32_t> code;  ///< nothing: no UTF-8
  std::size_t size = 1;          ///< octets; 1 of what is no UTF-8
};

/// The first character of a text that is not empty [RFC 3629]: no overlong forms, no surrogates.
Character first_character(std::string_view text) {
  const auto octet = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t lead = octet(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < size) return {};
  char32_t code = lead & (0x7FU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((octet(i) & 0xC0U) != 0x80) return {};
    code = code << 6 | (octet(i) & 0x3FU);
  }
  constexpr char32_t least[] = {0x80, 0x800, 0x10000};
  if (code < least[size - 2] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return {};
  return {code, size};
}

/// A character that a terminal or a person would not take as text.
bool is_control(char32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) ||        // C0, DEL, C1
         code == 0x2028 || code == 0x2029 ||                    // line and paragraph separator
         code == 0x061C || code == 0x200E || code == 0x200F ||  // marks of direction
         (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

/// The number of octets at the beginning that need no escape: printable ASCII characters.
std::size_t plain_octets(std::string_view text) {
  constexpr std::uint64_t every = 0x0101'0101'0101'0101;  // eight at a time
  std::size_t count = 0;
  for (std::uint64_t eight = 0; count + sizeof eight <= text.size(); count += sizeof eight) {
    std::memcpy(&eight, text.data() + count, sizeof eight);
    // The highest bit of an octet: not ASCII, below 20H, or DEL.
    if (((eight | (eight - 0x20 * every) | (eight + every)) & (0x80 * every)) != 0) break;
  }
  while (count < text.size() && text[count] >= 0x20 && text[count] < 0x7F) ++count;
  return count;
}

std::string escape(char32_t code) {
  switch (code) {
    case '\n': return "\\n";
    case '\r': return "\\r";
    case '\t': return "\\t";
    default: break;
  }
  const auto number = static_cast<std::uint32_t>(code);
  return number < 0x80 ? fmt::format("\\x{:02X}", number) : fmt::format("\\u{:04X}", number);
}

/// Columns as the C library counts them for UTF-8, independent of the user's locale.
class Columns {
 public:
  Columns() : locale_(::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr)) {}
  ~Columns() {
    if (locale_ != nullptr) ::freelocale(locale_);
  }
  Columns(const Columns&) = delete;
  Columns& operator=(const Columns&) = delete;

  [[nodiscard]] std::size_t of(char32_t code) const {
    if (code < 0x80 || locale_ == nullptr) return 1;
    const locale_t before = ::uselocale(locale_);
    const int columns = ::wcwidth(static_cast<wchar_t>(code));
    ::uselocale(before);
    return columns < 0 ? 1 : static_cast<std::size_t>(columns);
  }

 private:
  locale_t locale_;
};

/// The columns of the first character.
std::size_t columns_of(const Character& character) {
  static const Columns columns;
  return character.code ? columns.of(*character.code) : 1;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  while (true) {
    const std::size_t plain = plain_octets(text);
    safe.append(text.substr(0, plain));
    text.remove_prefix(plain);
    if (text.empty()) break;
    const Character next = first_character(text);
    if (!next.code) {
      safe += fmt::format("\\x{:02X}", static_cast<std::uint8_t>(text.front()));
    } else if (is_control(*next.code)) {
      safe += escape(*next.code);
    } else {
      safe += text.substr(0, next.size);
    }
    text.remove_prefix(next.size);
  }
  return safe;
}

std::string printable_json(std::string_view json) {
  std::string safe;
  safe.reserve(json.size());
  while (true) {
    const std::size_t plain = plain_octets(json);
    safe.append(json.substr(0, plain));
    json.remove_prefix(plain);
    if (json.empty()) break;
    const Character next = first_character(json);
    if (next.code && is_control(*next.code)) {
      safe += fmt::format("\\u{:04x}", static_cast<std::uint32_t>(*next.code));
    } else {
      safe += json.substr(0, next.size);
    }
    json.remove_prefix(next.size);
  }
  return safe;
}

std::size_t columns_of(std::string_view printable_text) {
  std::size_t columns = 0;
  while (!printable_text.empty()) {
    const Character next = first_character(printable_text);
    columns += columns_of(next);
    printable_text.remove_prefix(next.size);
  }
  return columns;
}

std::string_view clipped(std::string_view printable_text, std::size_t columns) {
  std::size_t size = 0;
  while (size < printable_text.size()) {
    const Character next = first_character(printable_text.substr(size));
    const std::size_t wide = columns_of(next);
    if (wide > columns) break;
    columns -= wide;
    size += next.size;
  }
  return printable_text.substr(0, size);
}

}  // namespace canopus::text
