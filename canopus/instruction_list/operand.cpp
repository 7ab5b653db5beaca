#include "canopus/instruction_list/operand.hpp"

#include <algorithm>
#include <optional>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::instruction_list {

namespace {

using Kind = Operand::Kind;

constexpr std::size_t most_characters = 256;

bool is_number(std::string_view text) { return !text.empty() && std::ranges::all_of(text, ascii::is_digit); }

/// E1.5, E-2, E1.5+3: the exponent stands behind a sign.
std::optional<double> real_of(std::string_view text) {
  std::string plain(text);
  const std::size_t sign = plain.find_first_of("+-", 1);
  if (sign != std::string::npos && plain.find('E') == std::string::npos) plain.insert(sign, 1, 'E');
  std::erase(plain, '+');
  return ascii::parse_number<double>(plain);
}

/// Cuts Z1 or V1 off the end.
void cut_index(std::string_view& text, std::string& index, Family family) {
  const std::size_t at = text.find_last_of(family == Family::fx3 ? "ZV" : "Z");
  if (at == std::string_view::npos || at < 2 || !is_number(text.substr(at + 1))) return;
  if (!ascii::is_digit(text[at - 1]) && !ascii::is_letter(text[at - 1])) return;
  index = text.substr(at);
  text = text.substr(0, at);
}

/// T0, ST0, C0, Z0: a letter and a number.
bool numbered(std::string_view text, std::string_view letters, Kind kind, Operand& operand) {
  if (!text.starts_with(letters) || !is_number(text.substr(letters.size()))) return false;
  const auto number = ascii::parse_number<std::uint32_t>(text.substr(letters.size()));
  if (!number) return false;
  operand.kind = kind;
  operand.number = *number;
  return true;
}

std::optional<std::string> parse_device(std::string_view text, Family family, Operand& operand) {
  cut_index(text, operand.index, family);
  if (text.size() > 2 && text[0] == 'K' && ascii::is_digit(text[1]) && ascii::is_letter(text[2])) {
    operand.digits = static_cast<unsigned>(text[1] - '0');
    if (operand.digits < 1 || operand.digits > 8) return "expected K1 to K8 before a bit device";
    text.remove_prefix(2);
  }
  if (const std::size_t point = text.find('.'); point != std::string_view::npos) {
    const auto bit = ascii::parse_number<unsigned>(text.substr(point + 1), 16);
    if (!bit || *bit > 15 || text.size() != point + 2) return "expected a bit .0 to .F of a word";
    operand.bit = static_cast<int>(*bit);
    text = text.substr(0, point);
  }
  operand.name = text;
  if (numbered(text, "T", Kind::timer, operand) || numbered(text, "C", Kind::counter, operand)) return {};
  if (family != Family::fx3) {
    (void)numbered(text, "ST", Kind::retentive_timer, operand);
    return {};
  }
  if (numbered(text, "Z", Kind::index_register, operand) ||
      numbered(text, "V", Kind::index_register, operand)) {
    if (operand.number > 7) return "expected Z0 to Z7 or V0 to V7";
    if (text[0] == 'V') operand.number += 8;
  } else if (text == "Z" || text == "V") {
    operand.kind = Kind::index_register;
    operand.number = text == "Z" ? 0 : 8;
  }
  return {};
}

}  // namespace

std::expected<Operand, std::string> parse_operand(std::string_view text, Family family) {
  Operand operand;
  operand.written = text;
  if (text.size() > most_characters) return std::unexpected("expected at most 256 characters");
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    operand.kind = Kind::text;
    operand.text = text.substr(1, text.size() - 2);
    return operand;
  }
  const std::string capitals = ascii::upper(text);
  std::string_view rest = capitals;
  if (numbered(rest, "P", Kind::pointer, operand) || numbered(rest, "N", Kind::nesting, operand))
    return operand;
  const char first = rest.empty() ? '\0' : rest.front();
  const bool has_digits = rest.size() > 1;
  if (has_digits && (first == 'K' || first == 'H')) {
    std::string_view number = rest;
    cut_index(number, operand.index, family);
    const auto value = ascii::parse_number<std::int64_t>(number.substr(1), first == 'K' ? 10 : 16);
    if (value && (first == 'K' || number[1] != '-')) {
      operand.kind = Kind::integer;
      operand.value = *value;
      operand.is_hexadecimal = first == 'H';
      return operand;
    }
    operand.index.clear();
    if (first == 'H') return std::unexpected("expected a hexadecimal constant such as H1F");
  }
  if (has_digits && first == 'E') {
    const auto value = real_of(rest.substr(1));
    if (!value) return std::unexpected("expected a real constant such as E1.5 or E1.5+3");
    operand.kind = Kind::real;
    operand.real = *value;
    return operand;
  }
  if (rest.empty()) return std::unexpected("expected a device or a constant");
  if (auto error = parse_device(rest, family, operand)) return std::unexpected(std::move(*error));
  return operand;
}

}  // namespace canopus::instruction_list
