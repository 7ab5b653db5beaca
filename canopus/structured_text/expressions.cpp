// Types of expressions, operators, literals and conversions.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/program/time_text.hpp"
#include "canopus/structured_text/unit_compiler.hpp"

namespace canopus::structured_text {

using program::Family;

namespace {

bool is_open(const DataType* type) {
  const OpenTypes& open = open_types();
  return type == &open.integer || type == &open.real || type == &open.word || type == &open.double_word;
}
bool is_device(const DataType* type) {
  return type == &open_types().word || type == &open_types().double_word;
}

Family family(const DataType& type) { return program::info(type.base).family; }
unsigned bits(const DataType& type) { return program::info(type.base).bits; }
bool is_integer(const DataType& type) {
  return type.is_scalar() && type.form != DataType::Form::enumeration &&
         (family(type) == Family::signed_integer || family(type) == Family::unsigned_integer);
}
bool is_number(const DataType& type) {
  return is_integer(type) || (type.is_scalar() && family(type) == Family::real);
}
/// A literal of a string that may be a character of this type: 'a' of CHAR, "a" of WCHAR.
bool is_character_of(const Expression& e, const DataType* type) {
  if (type == nullptr || !type->is_scalar()) return false;
  return (e.kind == Expression::Kind::string && type->base == Elementary::char_) ||
         (e.kind == Expression::Kind::wide_string && type->base == Elementary::wchar);
}
bool is_comparison(std::string_view name) {
  return name == "=" || name == "<>" || name == "<" || name == ">" || name == "<=" || name == ">=";
}
bool is_logic(std::string_view name) { return name == "AND" || name == "OR" || name == "XOR"; }

/// In the order of the opcodes: the 7 ones of a type.
enum class IntegerOpcode : std::uint8_t { add, sub, mul, div, mod, neg, wrap };
Opcode integer_opcode(IntegerOpcode which, const DataType& type) {
  const unsigned width = std::countr_zero(std::max(bits(type), 8U)) - 3U;
  const bool is_signed = family(type) == Family::signed_integer || family(type) == Family::duration ||
                         family(type) == Family::date;
  const unsigned row = width + (is_signed ? 0 : 4);
  static_assert(static_cast<unsigned>(Opcode::wrap_u64) == static_cast<unsigned>(Opcode::add_i8) + 7 * 7 + 6);
  return static_cast<Opcode>(static_cast<unsigned>(Opcode::add_i8) + 7 * row + static_cast<unsigned>(which));
}
enum class RealOpcode : std::uint8_t {
  add,
  sub,
  mul,
  div,
  neg,
  eq,
  ne,
  lt,
  le,
  round,
  trunc,
  from_int,
  from_uint
};
Opcode real_opcode(RealOpcode which, const DataType& type) {
  static_assert(static_cast<unsigned>(Opcode::from_uint_lreal) ==
                static_cast<unsigned>(Opcode::add_real) + 13 + 12);
  return static_cast<Opcode>(static_cast<unsigned>(Opcode::add_real) +
                             (type.base == Elementary::real ? 0 : 13) + static_cast<unsigned>(which));
}

}  // namespace

// Types

const DataType* UnitCompiler::natural(Expression& expression) {
  if (!expression.is_typed) {
    expression.type = find_natural(expression);
    expression.is_typed = true;
  }
  return expression.type;
}

const DataType* UnitCompiler::find_natural(Expression& e) {
  using Kind = Expression::Kind;
  switch (e.kind) {
    case Kind::wrong: return nullptr;
    case Kind::integer: return &open_types().integer;
    case Kind::real: return &open_types().real;
    case Kind::string: return type(Elementary::string);
    case Kind::wide_string: return type(Elementary::wstring);
    case Kind::typed_literal: {
      std::string_view name = e.name;
      if (name == "T") name = "TIME";
      if (name == "LT") name = "LTIME";
      if (name == "D") name = "DATE";
      if (name == "LD") name = "LDATE";
      const DataType* const found = declarations_.type_named(name, e.at);
      if (found == nullptr) error(e.at, "expected a type before #, found '" + std::string(e.name) + "'");
      return found;
    }
    case Kind::name:
    case Kind::member:
    case Kind::index:
    case Kind::typed_device: return place_type(e);
    case Kind::unary: {
      const DataType* const operand = natural(*e.children.front());
      if (operand == nullptr) return nullptr;
      if (e.name == "NOT") {
        if (operand == &open_types().integer) return operand;
        if (is_device(operand))
          return type(operand == &open_types().word ? Elementary::word : Elementary::dword);
        if (operand->is_scalar() && (family(*operand) == Family::boolean || family(*operand) == Family::bits))
          return operand;
        error(e.at, "expected BOOL or a bit string after NOT, found " + operand->name);
        return nullptr;
      }
      if (is_number(*operand) || (operand->is_scalar() && family(*operand) == Family::duration))
        return operand->form == DataType::Form::subrange ? type(operand->base) : operand;
      error(e.at, "expected a number after " + std::string(e.name) + ", found " + operand->name);
      return nullptr;
    }
    case Kind::binary: return binary_type(e);
    case Kind::call: return call_type(e);
    case Kind::typed_value: return declarations_.type_named(e.name, e.at);
    case Kind::list:
    case Kind::repeat:
    case Kind::fields: error(e.at, "expected a value"); return nullptr;
  }
  return nullptr;
}

/// The type of a variable, without code for its indices.
const DataType* UnitCompiler::place_type(Expression& e) {
  using Kind = Expression::Kind;
  if (e.kind == Kind::index) {
    const DataType* found = natural(*e.children.front());
    for (std::size_t i = 1; i < e.children.size() && found != nullptr; ++i) {
      if (found->form != DataType::Form::array) {
        error(e.at, "expected an array before [, found " + found->name);
        return nullptr;
      }
      found = found->element;
    }
    return found;
  }
  if (e.kind == Kind::member) {
    Expression& base = *e.children.front();
    if (is_this(base)) return member(e).type;
    if (const EnumerationValue* const value = qualified_value(e); value != nullptr) return value->type;
    const bool is_device_bit = base.kind == Kind::name && !is_variable(base.name) &&
                               declarations_.enumeration_values(base.name) == nullptr &&
                               declarations_.looks_like_device(base.name);
    if (is_device_bit) return member(e).type;
    const DataType* const whole = natural(base);
    if (whole == nullptr) return nullptr;
    if (whole->is_scalar()) {
      Elementary part = Elementary::boolean;
      const std::size_t before = declarations_.mistakes();
      if (partial_access(e, *whole, part)) return type(part);
      if (declarations_.mistakes() == before)
        error(e.at, whole->name + " has no element " + std::string(e.written));
      return nullptr;
    }
    const program::Member* const found = whole->member(e.name);
    if (found == nullptr || found->kind == program::MemberKind::hidden) {
      error(e.at, whole->name + " has no element " + std::string(e.written));
      return nullptr;
    }
    return found->type;
  }
  const Place found = place(e);
  if (found.kind == Place::Kind::none) return nullptr;
  const bool is_plain = e.kind == Kind::name && found.kind == Place::Kind::device &&
                        !found.device.point.is_bit &&
                        (unit_ == nullptr || !unit_->located.contains(e.name)) &&
                        declarations_.global_named(e.name, e.at) == nullptr;
  if (is_plain || (e.kind == Kind::name && found.kind == Place::Kind::device &&
                   found.device.form == DeviceAccess::Form::points && !is_variable(e.name)))
    return bits(*found.type) > 16 ? &open_types().double_word : &open_types().word;
  return found.type;
}

bool UnitCompiler::can_become(const DataType& from, const DataType& to) const {
  if (&from == &to) return true;
  if (from.is_string() && to.is_string()) return from.base == to.base;
  if (!from.is_scalar() || !to.is_scalar())
    return !from.is_scalar() && !from.is_string() && program::same_type(from, to);
  if (from.form == DataType::Form::enumeration || to.form == DataType::Form::enumeration) return false;
  if (from.base == to.base) return true;
  const Family f = family(from);
  const Family t = family(to);
  const unsigned from_bits = bits(from);
  const unsigned to_bits = bits(to);
  switch (f) {
    case Family::boolean: return t == Family::bits;
    case Family::bits: return t == Family::bits && from_bits < to_bits;
    case Family::signed_integer:
      return (t == Family::signed_integer && from_bits < to_bits) ||
             (t == Family::real && from_bits < to_bits);
    case Family::unsigned_integer:
      return (t == Family::unsigned_integer && from_bits < to_bits) ||
             (t == Family::signed_integer && from_bits < to_bits) ||
             (t == Family::real && from_bits < to_bits);
    case Family::real: return t == Family::real && from_bits < to_bits;
    case Family::duration: return to.base == Elementary::ltime;
    case Family::date:
      return (from.base == Elementary::date && to.base == Elementary::ldate) ||
             (from.base == Elementary::tod && to.base == Elementary::ltod) ||
             (from.base == Elementary::dt && to.base == Elementary::ldt);
    case Family::character: return t == Family::character && from_bits < to_bits;
    case Family::string: break;
  }
  return false;
}

/// The type in which an operator works on both; nullptr: there is none.
const DataType* UnitCompiler::common(const DataType* a, const DataType* b) {
  if (a == nullptr || b == nullptr) return nullptr;
  const OpenTypes& open = open_types();
  if (a == b) return a;
  if (is_open(b) && !is_open(a)) std::swap(a, b);
  if (is_open(a) && is_open(b)) {
    if (a == &open.integer) return b;
    if (b == &open.integer) return a;
    if (a == &open.real || b == &open.real)
      return a == &open.real && b == &open.real ? a : type(Elementary::real);
    return &open.double_word;
  }
  const DataType& typed = *b;
  if (is_open(a)) {
    if (!typed.is_scalar() || typed.form == DataType::Form::enumeration) return nullptr;
    const Family f = family(typed);
    if (a == &open.real) {
      for (const Elementary each : {Elementary::real, Elementary::lreal})
        if (can_become(typed, *type(each))) return type(each);
      return nullptr;
    }
    if (f == Family::real) return type(typed.base);
    const bool is_whole = f == Family::signed_integer || f == Family::unsigned_integer || f == Family::bits;
    if (!is_whole) return nullptr;
    if (a == &open.integer) return type(typed.base);
    const unsigned least = a == &open.word ? 16 : 32;
    if (bits(typed) >= least) return type(typed.base);
    return type(f == Family::bits ? (least == 16 ? Elementary::word : Elementary::dword)
                                  : (least == 16 ? Elementary::int_ : Elementary::dint));
  }
  if (can_become(*a, *b)) return b->form == DataType::Form::subrange ? type(b->base) : b;
  if (can_become(*b, *a)) return a->form == DataType::Form::subrange ? type(a->base) : a;
  // USINT and INT are both an INT; UINT and INT are both a DINT.
  constexpr std::array wider = {Elementary::int_, Elementary::dint, Elementary::lint, Elementary::real,
                                Elementary::lreal};
  for (const Elementary each : wider)
    if (can_become(*a, *type(each)) && can_become(*b, *type(each))) return type(each);
  return nullptr;
}

const DataType* UnitCompiler::beside(Expression& operand, const DataType* other) {
  if (is_character_of(operand, other)) return type(other->base);
  const DataType* const found = natural(operand);
  const bool is_negative = operand.kind == Expression::Kind::unary && operand.name == "-";
  const Expression& literal = is_negative ? *operand.children.front() : operand;
  if (found != &open_types().integer || literal.kind != Expression::Kind::integer || literal.is_based ||
      other == nullptr || is_open(other) || !is_integer(*other))
    return found;
  const unsigned size = bits(*other) - (family(*other) == Family::signed_integer ? 1 : 0);
  const std::uint64_t number = literal.number - (is_negative && literal.number > 0 ? 1 : 0);
  return size < 64 && number >> size != 0 ? resolved(found, nullptr, literal) : found;
}

const DataType* UnitCompiler::common_of(const std::vector<Expression*>& operands) {
  const DataType* found = nullptr;
  for (Expression* operand : operands) {
    const DataType* const each = natural(*operand);
    if (each == nullptr) return nullptr;
    const DataType* const both = found == nullptr ? each : common(found, each);
    if (both == nullptr) {
      error(operand->at, "expected " + found->name + ", found " + each->name);
      return nullptr;
    }
    found = both;
  }
  return found;
}

const DataType* UnitCompiler::resolved(const DataType* open, const DataType* want,
                                       const Expression& expression) {
  if (!is_open(open)) return open;
  const OpenTypes& types = open_types();
  const bool is_wanted = want != nullptr && want->is_scalar() && want->form != DataType::Form::enumeration;
  const Family wanted = is_wanted ? family(*want) : Family::string;
  const bool is_whole =
      wanted == Family::signed_integer || wanted == Family::unsigned_integer || wanted == Family::bits;
  if (open == &types.real)
    return is_wanted && wanted == Family::real ? type(want->base) : type(Elementary::lreal);
  if (open == &types.integer) {
    if (is_wanted && is_whole) return type(want->base);
    const bool is_bit = expression.kind == Expression::Kind::integer && expression.number <= 1;
    if (is_wanted && wanted == Family::boolean && is_bit) return type(want->base);
    if (is_wanted && wanted == Family::real && expression.kind == Expression::Kind::integer)
      return type(want->base);
    const bool is_small = expression.kind != Expression::Kind::integer || expression.number <= 0x7FFF;
    if (is_small && wanted != Family::real) return type(Elementary::int_);
    return type(expression.number <= 0x7FFFFFFF ? Elementary::dint
                : expression.number >> 63U == 0 ? Elementary::lint
                                                : Elementary::ulint);
  }
  const unsigned size = open == &types.word ? 16 : 32;
  if (is_wanted && is_whole && bits(*want) == size) return type(want->base);
  if (is_wanted && wanted == Family::bits) return type(size == 16 ? Elementary::word : Elementary::dword);
  return type(size == 16 ? Elementary::int_ : Elementary::dint);
}

const DataType* UnitCompiler::binary_type(Expression& e) {
  const DataType* const a = beside(*e.children[0], natural(*e.children[1]));
  const DataType* const b = beside(*e.children[1], natural(*e.children[0]));
  if (a == nullptr || b == nullptr) return nullptr;
  const auto wrong = [&](const std::string& what) {
    error(e.at, what);
    return nullptr;
  };
  const std::string name(e.name);
  if (is_comparison(e.name)) {
    const DataType* const both = common(a, b);
    if (both == nullptr || (!both->is_scalar() && !both->is_string())) {
      return wrong("expected values that can be compared by " + name + ", found " + a->name + " and " +
                   b->name);
    }
    return type(Elementary::boolean);
  }
  if (is_logic(e.name)) {
    const DataType* const both = common(a, b);
    if (both != nullptr && is_device(both))
      return type(both == &open_types().word ? Elementary::word : Elementary::dword);
    const bool is_good =
        both != nullptr && both->is_scalar() &&
        (both == &open_types().integer || family(*both) == Family::bits || family(*both) == Family::boolean);
    if (!is_good)
      return wrong("expected BOOL or bit strings beside " + name + ", found " + a->name + " and " + b->name);
    return both;
  }
  const bool a_is_time = a->is_scalar() && family(*a) == Family::duration;
  const bool b_is_time = b->is_scalar() && family(*b) == Family::duration;
  const bool a_is_date = a->is_scalar() && family(*a) == Family::date;
  const bool b_is_date = b->is_scalar() && family(*b) == Family::date;
  if (a_is_time || b_is_time || a_is_date || b_is_date) {
    if ((name == "+" || name == "-") && a_is_time && b_is_time) return common(a, b);
    if (name == "+" && a_is_date && b_is_time && a->base != Elementary::date && a->base != Elementary::ldate)
      return a;
    if (name == "-" && a_is_date && b_is_time && a->base != Elementary::date && a->base != Elementary::ldate)
      return a;
    if (name == "-" && a_is_date && a == b)
      return type(a->base == Elementary::ldate || a->base == Elementary::ltod || a->base == Elementary::ldt
                      ? Elementary::ltime
                      : Elementary::time);
    if ((name == "*" || name == "/") && a_is_time && is_number(*b)) return a;
    return wrong("there is no " + name + " of " + a->name + " and " + b->name);
  }
  const DataType* both = common(a, b);
  if (name == "**") {
    if (!is_number(*a) || !is_number(*b))
      return wrong("expected numbers beside **, found " + a->name + " and " + b->name);
    if (a == &open_types().real || a == &open_types().integer) return &open_types().real;
    return family(*a) == Family::real ? type(a->base) : type(Elementary::lreal);
  }
  if (both == nullptr || !is_number(*both))
    return wrong("expected numbers beside " + name + ", found " + a->name + " and " + b->name +
                 (both != nullptr && both->is_scalar() && family(*both) == Family::bits && !is_open(both)
                      ? ": " + both->name + "_TO_UINT or the like converts it"
                      : ""));
  if (name == "MOD" && family(*both) == Family::real)
    return wrong("expected integers beside MOD, found " + a->name + " and " + b->name);
  return is_open(both) ? both : type(both->base);
}

// Values

Value UnitCompiler::expression(Expression& e, const DataType* want, std::uint32_t into) {
  const SourcePosition outer = body_.at;
  body_.at = e.at;
  Value found = plain(e, want, want != nullptr && want->form == DataType::Form::elementary ? into : nowhere);
  if (found.type != nullptr && want != nullptr) found = convert(found, want, e.at, false, into);
  body_.at = outer;
  return found;
}

Value UnitCompiler::plain(Expression& e, const DataType* want, std::uint32_t into) {
  using Kind = Expression::Kind;
  const DataType* const open = natural(e);
  if (open == nullptr) return {};
  if (e.enable != nullptr || e.enable_output != nullptr) return enabled_value(e, want);
  switch (e.kind) {
    case Kind::integer:
    case Kind::real: return literal(e, want);
    case Kind::string:
    case Kind::wide_string:
      return is_character_of(e, want) ? character_literal(e, e.name, want) : string_literal(e);
    case Kind::typed_literal: return typed_literal(e);
    case Kind::name:
    case Kind::member:
    case Kind::index:
    case Kind::typed_device: {
      Place found = place(e);
      if (found.kind == Place::Kind::none) return {};
      if (is_device(open)) {
        found.type = resolved(open, want, e);
        found.device.type = found.type->base;
      }
      if (found.type->form == DataType::Form::block) {
        error(e.at, "expected a value, found the function block " + found.type->name);
        return {};
      }
      if (is_device_array(found)) {
        error(e.at, std::string(expected_element));
        return {};
      }
      return load(found);
    }
    case Kind::unary: return unary(e, want, into);
    case Kind::binary: return is_comparison(e.name) ? compare(e, into) : binary(e, want, into);
    case Kind::call: return call(e, want, into);
    case Kind::typed_value: return expression(*e.children.front(), open);
    default: return {};
  }
}

Value UnitCompiler::literal(Expression& e, const DataType* want) {
  const DataType* const found = resolved(natural(e), want, e);
  if (family(*found) == Family::real) {
    const double value = e.kind == Expression::Kind::real ? e.real : static_cast<double>(e.number);
    if (found->base == Elementary::lreal) return constant_value(std::bit_cast<Slot>(value), found);
    const auto narrow = static_cast<float>(value);
    if (std::isinf(narrow)) error(e.at, "expected a value within the range of REAL");
    return constant_value(std::bit_cast<std::uint32_t>(narrow), found);
  }
  // 16#FFFF is the bit pattern of -1 as well.
  const unsigned size = bits(*found);
  const bool is_pattern = e.is_based || family(*found) != Family::signed_integer || is_device(natural(e));
  const std::uint64_t end = is_pattern ? size : size - 1;
  if (size < 64 ? e.number >> end != 0 : !is_pattern && e.number >> 63U != 0) {
    error(e.at, "expected a value within the range of " + found->name + ", found " + std::string(e.written));
    return {};
  }
  Slot value = e.number;
  if (family(*found) == Family::signed_integer && size < 64)
    value = static_cast<Slot>(static_cast<std::int64_t>(value << (64 - size)) >> (64 - size));
  return constant_value(value, found);
}

Value UnitCompiler::typed_literal(Expression& e) {
  const DataType* const found = natural(e);
  std::vector<Slot> slots(found->slots);
  if (!found->is_scalar()) {
    error(e.at, "expected an elementary type or an enumeration before #, found " + found->name);
    return {};
  }
  if (family(*found) == Family::character) return character_literal(e, e.written, found);
  // Underscores within digits are for the eye alone.
  std::string text(e.written);
  if (found->form != DataType::Form::enumeration) std::erase(text, '_');
  if (family(*found) == Family::signed_integer) {
    // INT#16#FFFF is -1.
    for (const auto& [prefix, base] : {std::pair{"16#", 16}, std::pair{"8#", 8}, std::pair{"2#", 2}}) {
      if (!text.starts_with(prefix)) continue;
      const auto pattern = ascii::parse_number<std::uint64_t>(
          std::string_view(text).substr(std::string_view(prefix).size()), base);
      const unsigned size = bits(*found);
      if (!pattern || (size < 64 && *pattern >> size != 0)) break;
      return constant_value(
          static_cast<Slot>(static_cast<std::int64_t>(*pattern << (64 - size)) >> (64 - size)), found);
    }
  }
  if (const auto expected = program::parse_value(*found, text, slots.data())) {
    error(e.at, *expected + ", found '" + std::string(e.written) + "'");
    return {};
  }
  return constant_value(slots.front(), found);
}

std::optional<std::vector<std::uint16_t>> UnitCompiler::characters_of(const Expression& e,
                                                                      std::string_view text, bool is_wide) {
  std::vector<std::uint16_t> characters;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '$') {
      // A wide string's characters are those of UTF-8, a narrow one's its bytes.
      auto c = static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
      if (is_wide && c >= 0xC0) {
        const std::size_t more = c >= 0xF0 ? 3 : c >= 0xE0 ? 2 : 1;
        c &= 0x3FU >> more;
        for (std::size_t k = 0; k < more && i + 1 < text.size(); ++k)
          c = c << 6U | (static_cast<unsigned char>(text[++i]) & 0x3FU);
        if (c > 0xFFFF) error(e.at, "expected characters of 16 bits in a WSTRING");
      }
      characters.push_back(static_cast<std::uint16_t>(c));
      continue;
    }
    const char next = i + 1 < text.size() ? ascii::upper(text[i + 1]) : '\0';
    constexpr std::string_view letters = "LNPRT$'\"";
    constexpr std::array<std::uint16_t, 8> meanings = {'\n', '\n', '\f', '\r', '\t', '$', '\'', '"'};
    if (const std::size_t known = letters.find(next); next != '\0' && known != std::string_view::npos) {
      characters.push_back(meanings[known]);
      ++i;
      continue;
    }
    const std::size_t digits = is_wide ? 4 : 2;
    const auto code = i + digits < text.size() + 0
                          ? ascii::parse_number<std::uint16_t>(text.substr(i + 1, digits), 16)
                          : std::nullopt;
    if (!code) {
      error(e.at,
            std::string("expected $") + (is_wide ? "hhhh" : "hh") + " or one of $$ $' $\" $L $N $P $R $T");
      return std::nullopt;
    }
    characters.push_back(*code);
    i += digits;
  }
  if (characters.size() > 1024) {
    error(e.at, "expected at most 1024 characters");
    return std::nullopt;
  }
  return characters;
}

/// 'a' where a CHAR is expected.
Value UnitCompiler::character_literal(const Expression& e, std::string_view text, const DataType* wanted) {
  const auto characters = characters_of(e, text, wanted->base == Elementary::wchar);
  if (!characters) return {};
  if (characters->size() == 1) return constant_value(characters->front(), wanted);
  error(e.at, "expected one character for " + wanted->name + ", found " + std::to_string(characters->size()));
  return {};
}

Value UnitCompiler::string_literal(Expression& e) {
  const bool is_wide = e.kind == Expression::Kind::wide_string;
  const unsigned size = is_wide ? 16 : 8;
  const auto read = characters_of(e, e.name, is_wide);
  if (!read) return {};
  const std::vector<std::uint16_t>& characters = *read;
  const auto length = static_cast<std::uint32_t>(characters.size());
  const std::uint32_t first = body_.reserve(program::string_slots(length, size));
  if (body_.is_too_large) return {};
  body_.image[first] = program::string_header(length, length);
  for (std::size_t i = 0; i < characters.size(); ++i)
    body_.image[first + 1 + i * size / 64] |= Slot{characters[i]} << (i * size % 64);
  const std::uint32_t slot = body_.temporary();
  body_.emit(Opcode::address, slot, first);
  return {declarations_.string_of(is_wide, std::max(length, 1U)), slot};
}

std::uint16_t UnitCompiler::uses_of(std::uint32_t b, std::uint32_t c) const {
  return (body_.is_temporary(b) ? program::b_is_last : 0) | (body_.is_temporary(c) ? program::c_is_last : 0);
}

Value UnitCompiler::unary(Expression& e, const DataType* want, std::uint32_t into) {
  Expression& operand = *e.children.front();
  const DataType* found = resolved(natural(e), want, operand);
  if (e.name == "-" && operand.kind == Expression::Kind::integer) {
    // -32768: the literal alone is beyond the range. A literal that does not fit takes the next larger type.
    if (found->base == Elementary::ulint && natural(e) == &open_types().integer)
      found = type(Elementary::lint);
    if (family(*found) == Family::signed_integer) {
      const std::uint64_t end = std::uint64_t{1} << (bits(*found) - 1);
      if (operand.number > end) {
        error(e.at, "expected a value within the range of " + found->name + ", found -" +
                        std::string(operand.written));
        return {};
      }
      return constant_value(Slot{0} - operand.number, found);
    }
  }
  if (e.name == "NOT") {
    if (found->base == Elementary::int_ && natural(e) == &open_types().integer)
      found = type(Elementary::word);
    const Value value = expression(operand, found);
    if (value.type == nullptr) return {};
    const unsigned size = bits(*found);
    const std::uint32_t slot = target(into);
    body_.emit(Opcode::bit_xor, slot, value.slot,
               body_.constant(size == 64 ? ~Slot{0} : (Slot{1} << size) - 1),
               family(*found) == Family::boolean ? program::is_inversion | uses_of(value.slot, slot) : 0);
    return {found, slot};
  }
  if (e.name == "-" && family(*found) == Family::unsigned_integer) {
    error(e.at, "expected a type with a sign after -, found " + found->name);
    return {};
  }
  if (e.name == "-" && family(*found) == Family::bits) {
    error(e.at, "expected a number after -, found " + found->name);
    return {};
  }
  const Value value = expression(operand, found);
  if (value.type == nullptr || e.name == "+") return value;
  const std::uint32_t slot = target(into);
  body_.emit(family(*found) == Family::real ? real_opcode(RealOpcode::neg, *found)
                                            : integer_opcode(IntegerOpcode::neg, *found),
             slot, value.slot);
  return {found, slot};
}

std::pair<Value, Value> UnitCompiler::operands(Expression& e, const DataType* a_type,
                                               const DataType* b_type) {
  Value a = expression(*e.children[0], a_type);
  if (a.type != nullptr && a.type->is_scalar() && has_call(*e.children[1])) {
    const std::uint32_t kept = body_.temporary();
    body_.emit(Opcode::move, kept, a.slot);
    a.slot = kept;
  }
  const Value b = expression(*e.children[1], b_type);
  return {a, b};
}

Value UnitCompiler::binary(Expression& e, const DataType* want, std::uint32_t into) {
  const DataType* const open = natural(e);
  if (family(*open) == Family::duration || family(*open) == Family::date) return time_arithmetic(e, into);
  const DataType* found = resolved(open, want, e);
  if (is_logic(e.name)) {
    if (open == &open_types().integer && family(*found) != Family::bits) found = type(Elementary::dword);
    const auto [a, b] = operands(e, found, found);
    if (a.type == nullptr || b.type == nullptr) return {};
    const std::uint32_t slot = target(into);
    body_.emit(e.name == "AND"  ? Opcode::bit_and
               : e.name == "OR" ? Opcode::bit_or
                                : Opcode::bit_xor,
               slot, a.slot, b.slot,
               family(*found) == Family::boolean ? program::of_bool | uses_of(a.slot, b.slot) : 0);
    return {found, slot};
  }
  if (e.name == "**") {
    const bool is_real = found->base == Elementary::real;
    // The exponent may be any number.
    Value a = expression(*e.children[0], found);
    const DataType* const exponent_type = resolved(natural(*e.children[1]), found, *e.children[1]);
    Value b = expression(*e.children[1], exponent_type);
    if (a.type == nullptr || b.type == nullptr) return {};
    b = numeric_conversion(b, found, nowhere, false);
    return native(is_real ? "EXPT_REAL" : "EXPT_LREAL", {a, b}, found);
  }
  if (family(*found) == Family::bits) {  // D0 + 1 where a WORD is expected: bit strings have no arithmetic
    error(e.at, "expected " + found->name + ", found a number of " + std::string(e.name) +
                    ": INT_TO_WORD or the like converts it");
    return {};
  }
  const auto [a, b] = operands(e, found, found);
  if (a.type == nullptr || b.type == nullptr) return {};
  constexpr std::string_view names = "+-*/";
  const bool is_real = family(*found) == Family::real;
  const std::size_t which = e.name == "MOD" ? 4 : names.find(e.name);
  const std::uint32_t slot = target(into);
  body_.emit(is_real ? real_opcode(static_cast<RealOpcode>(which), *found)
                     : integer_opcode(static_cast<IntegerOpcode>(which), *found),
             slot, a.slot, b.slot);
  return {found, slot};
}

Value UnitCompiler::time_arithmetic(Expression& e, std::uint32_t into) {
  const DataType* const found = natural(e);
  const DataType* const b_natural = natural(*e.children[1]);
  if (e.name == "*" || e.name == "/") {
    const DataType* const factor_type = resolved(b_natural, type(Elementary::lint), *e.children[1]);
    const auto [a, factor] = operands(e, found, factor_type);
    if (a.type == nullptr || factor.type == nullptr) return {};
    if (family(*factor_type) != Family::real) {
      const std::uint32_t slot = target(into);
      body_.emit(e.name == "*" ? Opcode::mul_i64 : Opcode::div_i64, slot, a.slot, factor.slot);
      return {found, slot};
    }
    return native(e.name == "*" ? "MUL_TIME" : "DIV_TIME",
                  {a, numeric_conversion(factor, type(Elementary::lreal), nowhere, false)}, found);
  }
  const auto [a, b] = operands(e, natural(*e.children[0]), b_natural);
  if (a.type == nullptr || b.type == nullptr) return {};
  const std::uint32_t slot = target(into);
  body_.emit(e.name == "+" ? Opcode::add_i64 : Opcode::sub_i64, slot, a.slot, b.slot);
  if (found->base == Elementary::tod || found->base == Elementary::ltod) {
    // A time of day beyond midnight goes on at 0:00.
    return native("TIME_PART", {{found, slot}}, found);
  }
  return {found, slot};
}

Value UnitCompiler::compare(Expression& e, std::uint32_t into) {
  const DataType* both = common(beside(*e.children[0], natural(*e.children[1])),
                                beside(*e.children[1], natural(*e.children[0])));
  if (both == nullptr) return {};
  if (is_open(both)) {
    const Expression& larger =
        e.children[0]->number > e.children[1]->number ? *e.children[0] : *e.children[1];
    both = resolved(both, nullptr, larger);
  }
  const auto [a, b] = operands(e, both, both);
  if (a.type == nullptr || b.type == nullptr) return {};
  return compare_values(e.name, {both, a.slot}, {both, b.slot}, into);
}

Value UnitCompiler::compare_values(std::string_view name, Value a, Value b, std::uint32_t into) {
  const DataType* both = a.type;
  const DataType* const boolean = type(Elementary::boolean);
  if (both->is_string()) {
    const Value order = native(both->base == Elementary::string ? "COMPARE_STRING" : "COMPARE_WSTRING",
                               {a, b}, type(Elementary::lint));
    a = order;
    b = constant_value(0, type(Elementary::lint));
    both = type(Elementary::lint);
  }
  if (name == ">" || name == ">=") {
    std::swap(a, b);
    name = name == ">" ? "<" : "<=";
  }
  const std::size_t which = name == "=" ? 0 : name == "<>" ? 1 : name == "<" ? 2 : 3;
  const std::uint32_t slot = target(into);
  if (family(*both) == Family::real) {
    body_.emit(real_opcode(static_cast<RealOpcode>(static_cast<std::size_t>(RealOpcode::eq) + which), *both),
               slot, a.slot, b.slot);
  } else {
    const bool has_sign = bits(*both) < 64 || family(*both) == Family::signed_integer ||
                          family(*both) == Family::duration || family(*both) == Family::date;
    constexpr std::array with_sign = {Opcode::eq, Opcode::ne, Opcode::lt, Opcode::le};
    constexpr std::array without = {Opcode::eq, Opcode::ne, Opcode::ltu, Opcode::leu};
    body_.emit((has_sign ? with_sign : without)[which], slot, a.slot, b.slot);
  }
  return {boolean, slot};
}

// Conversions

Value UnitCompiler::convert(Value value, const DataType* to, SourcePosition at, bool is_explicit,
                            std::uint32_t into) {
  if (value.type == nullptr) return {};
  if (!is_explicit && !can_become(*value.type, *to)) {
    std::string message = "expected " + to->name + ", found " + value.type->name;
    const auto is_elementary = [](const DataType& each) {
      return each.is_string() || (each.is_scalar() && each.form != DataType::Form::enumeration);
    };
    if (is_elementary(*value.type) && is_elementary(*to))
      message += ": " + std::string(program::info(value.type->base).name) + "_TO_" +
                 std::string(program::info(to->base).name) + " converts it";
    error(at, std::move(message));
    return {};
  }
  if (!to->is_scalar() || value.type == to) return value;
  Value found = numeric_conversion(value, to, into, false);
  if (to->form == DataType::Form::subrange) {
    const bool is_same = value.type->form == DataType::Form::subrange && value.type->low >= to->low &&
                         value.type->high <= to->high;
    if (!is_same)
      body_.emit(Opcode::check_range, found.slot,
                 declarations_.add_element({.low = to->low, .high = to->high}));
    found.type = to;
  }
  return found;
}

Value UnitCompiler::numeric_conversion(Value value, const DataType* to, std::uint32_t into, bool truncates) {
  const DataType& from = *value.type;
  if (from.base == to->base) return {to, value.slot};
  const Family f = family(from);
  const Family t = family(*to);
  const auto emit = [&](Opcode opcode, std::uint32_t slot, std::uint16_t extra = 0) {
    const std::uint32_t result = target(into);
    body_.emit(opcode, result, slot, 0, extra);
    return Value{to, result};
  };
  if (t == Family::boolean) {
    const std::uint32_t slot = target(into);
    if (f == Family::real) {
      body_.emit(real_opcode(RealOpcode::ne, from), slot, value.slot, body_.constant(0));
    } else {
      body_.emit(Opcode::ne, slot, value.slot, body_.constant(0));
    }
    return {to, slot};
  }
  if (f == Family::real) {
    if (t == Family::real)
      return emit(to->base == Elementary::lreal ? Opcode::real_to_lreal : Opcode::lreal_to_real, value.slot);
    if (t == Family::bits && bits(from) == bits(*to)) return {to, value.slot};  // the same bits
    return emit(real_opcode(truncates ? RealOpcode::trunc : RealOpcode::round, from), value.slot,
                static_cast<std::uint16_t>(to->base));
  }
  if (t == Family::real) {
    if (f == Family::bits && bits(from) == bits(*to)) return {to, value.slot};
    const bool has_sign = f == Family::signed_integer || f == Family::duration || f == Family::date;
    return emit(real_opcode(has_sign ? RealOpcode::from_int : RealOpcode::from_uint, *to), value.slot);
  }
  const bool from_signed = f == Family::signed_integer || f == Family::duration || f == Family::date;
  const bool to_signed = t == Family::signed_integer || t == Family::duration || t == Family::date;
  const unsigned from_bits = bits(from);
  const unsigned to_bits = bits(*to);
  const bool is_contained = to_bits == 64 || (from_signed == to_signed && from_bits <= to_bits) ||
                            (!from_signed && from_bits < to_bits);
  if (is_contained) return {to, value.slot};
  return emit(integer_opcode(IntegerOpcode::wrap, *to), value.slot);
}

}  // namespace canopus::structured_text
