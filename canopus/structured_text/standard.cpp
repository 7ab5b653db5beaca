#include "canopus/structured_text/standard.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/structured_text/unit_compiler.hpp"

namespace canopus::structured_text {

using program::Family;

enum class Standard : std::uint8_t {
  op,  ///< the operator `as`
  not_,
  move,
  absolute,
  of_real,  ///< SQRT ...: the native function has the name of the function and of the type
  atan2,
  shift,
  rotate,
  select,
  multiplex,
  maximum,
  minimum,
  limit,
  length,
  find,
  left_right,
  mid,
  concat,
  insert,
  delete_,
  replace,
  date_parts,     ///< CONCAT_DATE ...: of integers
  date_and_time,  ///< CONCAT_DATE_TOD
  day_of_week,
  is_valid,
  is_valid_bcd,
  swap_bytes,
  same,  ///< bytes are in the order of the machine
  truncate
};

namespace {

struct Function {
  std::string_view name;
  Standard which;
  std::string_view parameters;  ///< "IN,N"; "IN*": IN1, IN2 ...
  std::string_view as{};        ///< operator
};

constexpr std::array functions = {
    Function{"ADD", Standard::op, "IN*", "+"},
    Function{"MUL", Standard::op, "IN*", "*"},
    Function{"SUB", Standard::op, "IN1,IN2", "-"},
    Function{"DIV", Standard::op, "IN1,IN2", "/"},
    Function{"MOD", Standard::op, "IN1,IN2", "MOD"},
    Function{"EXPT", Standard::op, "IN1,IN2", "**"},
    Function{"AND", Standard::op, "IN*", "AND"},
    Function{"OR", Standard::op, "IN*", "OR"},
    Function{"XOR", Standard::op, "IN*", "XOR"},
    Function{"GT", Standard::op, "IN*", ">"},
    Function{"GE", Standard::op, "IN*", ">="},
    Function{"EQ", Standard::op, "IN*", "="},
    Function{"LE", Standard::op, "IN*", "<="},
    Function{"LT", Standard::op, "IN*", "<"},
    Function{"NE", Standard::op, "IN1,IN2", "<>"},
    Function{"ADD_TIME", Standard::op, "IN1,IN2", "+"},
    Function{"ADD_LTIME", Standard::op, "IN1,IN2", "+"},
    Function{"ADD_TOD_TIME", Standard::op, "IN1,IN2", "+"},
    Function{"ADD_LTOD_LTIME", Standard::op, "IN1,IN2", "+"},
    Function{"ADD_DT_TIME", Standard::op, "IN1,IN2", "+"},
    Function{"ADD_LDT_LTIME", Standard::op, "IN1,IN2", "+"},
    Function{"SUB_TIME", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_LTIME", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_DATE_DATE", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_LDATE_LDATE", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_TOD_TIME", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_LTOD_LTIME", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_TOD_TOD", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_LTOD_LTOD", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_DT_TIME", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_LDT_LTIME", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_DT_DT", Standard::op, "IN1,IN2", "-"},
    Function{"SUB_LDT_LDT", Standard::op, "IN1,IN2", "-"},
    Function{"MUL_TIME", Standard::op, "IN1,IN2", "*"},
    Function{"MUL_LTIME", Standard::op, "IN1,IN2", "*"},
    Function{"DIV_TIME", Standard::op, "IN1,IN2", "/"},
    Function{"DIV_LTIME", Standard::op, "IN1,IN2", "/"},
    Function{"NOT", Standard::not_, "IN"},
    Function{"MOVE", Standard::move, "IN"},
    Function{"ABS", Standard::absolute, "IN"},
    Function{"SQRT", Standard::of_real, "IN"},
    Function{"LN", Standard::of_real, "IN"},
    Function{"LOG", Standard::of_real, "IN"},
    Function{"EXP", Standard::of_real, "IN"},
    Function{"SIN", Standard::of_real, "IN"},
    Function{"COS", Standard::of_real, "IN"},
    Function{"TAN", Standard::of_real, "IN"},
    Function{"ASIN", Standard::of_real, "IN"},
    Function{"ACOS", Standard::of_real, "IN"},
    Function{"ATAN", Standard::of_real, "IN"},
    Function{"ATAN2", Standard::atan2, "Y,X"},
    Function{"SHL", Standard::shift, "IN,N"},
    Function{"SHR", Standard::shift, "IN,N"},
    Function{"ROL", Standard::rotate, "IN,N"},
    Function{"ROR", Standard::rotate, "IN,N"},
    Function{"SEL", Standard::select, "G,IN0,IN1"},
    Function{"MUX", Standard::multiplex, "K,IN*"},
    Function{"MAX", Standard::maximum, "IN*"},
    Function{"MIN", Standard::minimum, "IN*"},
    Function{"LIMIT", Standard::limit, "MN,IN,MX"},
    Function{"LEN", Standard::length, "IN"},
    Function{"LEFT", Standard::left_right, "IN,L"},
    Function{"RIGHT", Standard::left_right, "IN,L"},
    Function{"MID", Standard::mid, "IN,L,P"},
    Function{"CONCAT", Standard::concat, "IN*"},
    Function{"INSERT", Standard::insert, "IN1,IN2,P"},
    Function{"DELETE", Standard::delete_, "IN,L,P"},
    Function{"REPLACE", Standard::replace, "IN1,IN2,L,P"},
    Function{"FIND", Standard::find, "IN1,IN2"},
    Function{"CONCAT_DATE", Standard::date_parts, "YEAR,MONTH,DAY"},
    Function{"CONCAT_TOD", Standard::date_parts, "HOUR,MINUTE,SECOND,MILLISECOND"},
    Function{"CONCAT_DT", Standard::date_parts, "YEAR,MONTH,DAY,HOUR,MINUTE,SECOND,MILLISECOND"},
    Function{"CONCAT_LDATE", Standard::date_parts, "YEAR,MONTH,DAY"},
    Function{"CONCAT_LTOD", Standard::date_parts, "HOUR,MINUTE,SECOND,MILLISECOND"},
    Function{"CONCAT_LDT", Standard::date_parts, "YEAR,MONTH,DAY,HOUR,MINUTE,SECOND,MILLISECOND"},
    Function{"CONCAT_DATE_TOD", Standard::date_and_time, "DATE,TOD"},
    Function{"CONCAT_DATE_LTOD", Standard::date_and_time, "DATE,LTOD"},
    Function{"DAY_OF_WEEK", Standard::day_of_week, "IN"},
    Function{"IS_VALID", Standard::is_valid, "IN"},
    Function{"IS_VALID_BCD", Standard::is_valid_bcd, "IN"},
    Function{"TO_BIG_ENDIAN", Standard::swap_bytes, "IN"},
    Function{"FROM_BIG_ENDIAN", Standard::swap_bytes, "IN"},
    Function{"TO_LITTLE_ENDIAN", Standard::same, "IN"},
    Function{"FROM_LITTLE_ENDIAN", Standard::same, "IN"},
    Function{"TRUNC", Standard::truncate, "IN"},
};

const Function* function_named(std::string_view name) {
  const auto* const found = std::ranges::find(functions, name, &Function::name);
  return found == functions.end() ? nullptr : found;
}

/// ADD_INT, SHL_WORD ...: an overloaded function whose inputs are of that type [IEC 61131-3 table 21].
struct TypedFunction {
  const Function* function;
  std::string_view type;
};
std::optional<TypedFunction> typed_function_named(std::string_view name) {
  const std::size_t end = name.find('_');
  if (end == std::string_view::npos || !program::elementary_named(name.substr(end + 1))) return std::nullopt;
  const Function* const function = function_named(name.substr(0, end));
  if (function == nullptr) return std::nullopt;
  switch (function->which) {
    case Standard::op:
    case Standard::not_:
    case Standard::move:
    case Standard::absolute:
    case Standard::of_real:
    case Standard::shift:
    case Standard::rotate:
    case Standard::select:
    case Standard::multiplex:
    case Standard::maximum:
    case Standard::minimum:
    case Standard::limit: return TypedFunction{function, name.substr(end + 1)};
    default: return std::nullopt;
  }
}

/// INT_TO_REAL, TO_REAL, REAL_TRUNC_INT, TRUNC_INT, WORD_BCD_TO_UINT, BCD_TO_UINT, UINT_TO_BCD_WORD, TO_BCD_WORD.
struct Conversion {
  std::optional<Elementary> from;  ///< none: whatever the argument is
  Elementary to;
  enum class Verb : std::uint8_t { plain, truncate, from_bcd, to_bcd } verb = Verb::plain;
};
std::optional<Conversion> conversion_named(std::string_view name) {
  using Verb = Conversion::Verb;
  constexpr std::array<std::pair<std::string_view, Verb>, 4> verbs = {{{"BCD_TO_", Verb::from_bcd},
                                                                       {"TO_BCD_", Verb::to_bcd},
                                                                       {"TRUNC_", Verb::truncate},
                                                                       {"TO_", Verb::plain}}};
  for (const auto& [text, verb] : verbs) {
    std::size_t at = name.starts_with(text) ? 0 : name.find('_' + std::string(text));
    if (at == std::string_view::npos) continue;
    std::optional<Elementary> from;
    if (at > 0) {
      from = program::elementary_named(name.substr(0, at));
      if (!from) continue;
      ++at;
    }
    if (const auto to = program::elementary_named(name.substr(at + text.size())))
      return Conversion{from, *to, verb};
  }
  return std::nullopt;
}

bool is_bits(const DataType& type) {
  return type.is_scalar() && (program::info(type.base).family == Family::bits ||
                              program::info(type.base).family == Family::boolean);
}
bool is_whole(const DataType& type) {
  const Family family = program::info(type.base).family;
  return type.is_scalar() && (family == Family::signed_integer || family == Family::unsigned_integer);
}

/// What a conversion between two types is not.
bool has_conversion(const DataType& from, Elementary to) {
  const Family f = program::info(from.base).family;
  const Family t = program::info(to).family;
  if (!from.is_scalar() && !from.is_string()) return false;
  const auto is_time = [](Family family) { return family == Family::duration || family == Family::date; };
  if (f == Family::string && t == Family::string) return true;
  if (f == Family::date && t != Family::date && t != Family::string) return false;
  if (t == Family::date && f != Family::date && f != Family::string) return false;
  if (f == Family::date && t == Family::date) {
    const auto is_full = [](Elementary type) { return type == Elementary::dt || type == Elementary::ldt; };
    const auto is_clock = [](Elementary type) { return type == Elementary::tod || type == Elementary::ltod; };
    return is_full(from.base) || is_clock(from.base) == is_clock(to) || (is_full(to) && !is_clock(from.base));
  }
  if ((f == Family::boolean && is_time(t)) || (t == Family::boolean && is_time(f))) return false;
  // The first character of a string of the same width [IEC 61131-3 table 27].
  if (f == Family::string && t == Family::character)
    return program::info(from.base).bits == program::info(to).bits;
  if (f == Family::character || t == Family::character)
    return t == Family::string || f == t || t == Family::bits || f == Family::bits;
  return true;
}

constexpr std::int64_t millisecond = 1'000'000;

/// GT(a, b, c) is a > b and b > c.
bool is_order(std::string_view name) { return name.starts_with('<') || name.starts_with('>') || name == "="; }

/// CONCAT_DATE ... CONCAT_LDT, SPLIT_DATE ... SPLIT_LDT: the type that is made or taken.
struct DateFunction {
  Elementary type;
  std::string native;  ///< that of the long type is the same: both are nanoseconds
};
std::optional<DateFunction> date_function(std::string_view name) {
  const std::size_t end = name.find('_');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view verb = name.substr(0, end + 1);
  std::string_view type = name.substr(end + 1);
  if (verb != "CONCAT_" && verb != "SPLIT_") return std::nullopt;
  constexpr std::array types = {Elementary::date,  Elementary::tod,  Elementary::dt,
                                Elementary::ldate, Elementary::ltod, Elementary::ldt};
  const auto* const found =
      std::ranges::find(types, type, [](Elementary each) { return program::info(each).name; });
  if (found == types.end()) return std::nullopt;
  if (type.starts_with('L')) type.remove_prefix(1);
  return DateFunction{*found, std::string(verb) + std::string(type)};
}

}  // namespace

bool is_split(std::string_view name) { return name.starts_with("SPLIT_") && date_function(name).has_value(); }

bool is_standard_function(std::string_view name) {
  return function_named(name) != nullptr || conversion_named(name).has_value() ||
         typed_function_named(name).has_value();
}

/// SPLIT_DATE(IN := d, YEAR => y, MONTH => m, DAY => k): the standard functions with several results.
void UnitCompiler::split_call(Expression& e) {
  const DateFunction function = *date_function(e.name);
  constexpr std::array<std::string_view, 7> parts = {"YEAR",   "MONTH",  "DAY",        "HOUR",
                                                     "MINUTE", "SECOND", "MILLISECOND"};
  const std::size_t first = function.native == "SPLIT_TOD" ? 3 : 0;
  const std::size_t count = (function.native == "SPLIT_DATE" ? 3 : parts.size()) - first;
  const DataType* const taken = type(function.type);
  const std::uint32_t slots = body_.temporary(static_cast<std::uint32_t>(count) + 1);
  bool has_value = false;
  for (Argument& argument : e.arguments) {
    if (argument.is_output || argument.value == nullptr || (!argument.name.empty() && argument.name != "IN"))
      continue;
    const Value value = expression(*argument.value, taken);
    if (value.type == nullptr) return;
    body_.emit(Opcode::move, slots + static_cast<std::uint32_t>(count), value.slot);
    has_value = true;
  }
  if (!has_value) return error(e.at, "expected IN := a value of type " + taken->name);
  body_.emit(Opcode::native, declarations_.native(program::native_named(function.native)), slots);
  for (Argument& argument : e.arguments) {
    if (!argument.is_output) continue;
    const auto* const part = std::find(parts.begin() + first, parts.begin() + first + count, argument.name);
    if (part == parts.begin() + first + count)
      return error(argument.at, std::string(e.name) + " has no output " + std::string(argument.name));
    if (argument.value == nullptr) continue;
    const Place to = place(*argument.value);
    if (to.kind == Place::Kind::none) return;
    if (to.is_constant || !to.type->is_scalar() || !is_whole(*to.type) ||
        program::info(to.type->base).bits < 16)
      return error(argument.at, "expected a variable of an integer type of 16 bits or more");
    store(to, {to.type, slots + static_cast<std::uint32_t>(part - parts.begin() -
                                                           static_cast<std::ptrdiff_t>(first))});
  }
}

/// Arguments in the order of the parameters, without names.
bool UnitCompiler::arrange(Expression& call, std::string_view names, std::size_t least, std::size_t most) {
  for (const Argument& argument : call.arguments) {
    if (argument.value == nullptr || argument.is_output) {
      error(argument.at, "expected a value");
      return false;
    }
  }
  const bool is_formal = !call.arguments.empty() && !call.arguments.front().name.empty();
  if (is_formal) {
    std::vector<std::string_view> order;
    std::string_view variadic;
    std::size_t fixed = 0;
    for (std::string_view rest = names; !rest.empty();) {
      const std::size_t comma = std::min(rest.find(','), rest.size());
      std::string_view name = rest.substr(0, comma);
      rest.remove_prefix(std::min(comma + 1, rest.size()));
      if (name.ends_with('*'))
        variadic = name.substr(0, name.size() - 1);
      else
        order.push_back(name), ++fixed;
    }
    std::vector<Argument> arranged(call.arguments.size());
    for (Argument& argument : call.arguments) {
      const auto found = std::ranges::find(order, argument.name);
      std::optional<std::size_t> number;
      if (found != order.end()) {
        number = static_cast<std::size_t>(found - order.begin());
      } else if (!variadic.empty() && argument.name.starts_with(variadic)) {
        number = ascii::parse_number<std::size_t>(argument.name.substr(variadic.size()));
        // IN1 is the first one, but of MUX IN0.
        const std::size_t begin = fixed > 0 ? 0 : 1;
        if (number && *number >= begin)
          *number += fixed - begin;
        else
          number.reset();
      }
      if (!number || *number >= arranged.size() || arranged[*number].value != nullptr) {
        error(argument.at, "expected inputs " + std::string(names) + ", found " + std::string(argument.name));
        return false;
      }
      arranged[*number].at = argument.at;
      arranged[*number].value = std::move(argument.value);
    }
    call.arguments = std::move(arranged);
  } else if (std::ranges::any_of(call.arguments,
                                 [](const Argument& argument) { return !argument.name.empty(); })) {
    error(call.at, "expected names for all inputs or for none");
    return false;
  }
  if (call.arguments.size() < least || call.arguments.size() > most) {
    error(call.at, "expected " + std::to_string(least) + (least == most ? "" : " or more") +
                       " inputs: " + std::string(names));
    return false;
  }
  return true;
}

std::vector<Expression*> UnitCompiler::arguments_of(Expression& call, std::size_t from) {
  std::vector<Expression*> found;
  for (std::size_t i = from; i < call.arguments.size(); ++i) found.push_back(call.arguments[i].value.get());
  return found;
}

namespace {

/// The inputs of a typed function, but for what selects, and for places of a shift and an exponent.
void type_inputs(Expression& call, const Function& function, std::string_view type) {
  const bool has_selector = function.which == Standard::select || function.which == Standard::multiplex;
  const bool has_one =
      function.which == Standard::shift || function.which == Standard::rotate || function.name == "EXPT";
  const std::size_t end = has_one ? 1 : call.arguments.size();
  for (std::size_t i = has_selector ? 1 : 0; i < end; ++i) {
    auto typed = std::make_unique<Expression>();
    typed->kind = Expression::Kind::typed_value;
    typed->at = call.arguments[i].value->at;
    typed->name = type;
    typed->children.push_back(std::move(call.arguments[i].value));
    call.arguments[i].value = std::move(typed);
  }
}

}  // namespace

const DataType* UnitCompiler::standard_type(Expression& e) {
  const auto wrong = [&](const DataType* found, std::string_view expected) -> const DataType* {
    if (found != nullptr)
      error(e.arguments.front().at, "expected " + std::string(expected) + ", found " + found->name);
    return nullptr;
  };
  if (const auto conversion = conversion_named(e.name); conversion && function_named(e.name) == nullptr) {
    if (!arrange(e, "IN", 1, 1)) return nullptr;
    return type(conversion->to);
  }
  const Function* function = function_named(e.name);
  std::string_view of_inputs;
  if (function == nullptr) {
    if (const auto typed = typed_function_named(e.name)) {
      function = typed->function;
      of_inputs = typed->type;
      e.name = function->name;
    }
  }
  if (function == nullptr) {
    error(e.at, "there is no function " + std::string(e.written));
    return nullptr;
  }
  const bool is_variadic = function->parameters.ends_with('*');
  const auto named = static_cast<std::size_t>(std::ranges::count(function->parameters, ',')) + 1;
  constexpr std::size_t most_inputs = 1000;
  if (!arrange(e, function->parameters, is_variadic ? 2 : named, is_variadic ? most_inputs : named))
    return nullptr;
  if (!of_inputs.empty()) type_inputs(e, *function, of_inputs);
  const auto argument = [&](std::size_t number) { return natural(*e.arguments[number].value); };
  switch (function->which) {
    case Standard::op: {
      if (is_order(function->as) && e.arguments.size() > 2) {
        const DataType* const found = common_of(arguments_of(e));
        if (found == nullptr) return nullptr;
        return found->is_scalar() || found->is_string() ? type(Elementary::boolean)
                                                        : wrong(found, "values that can be compared");
      }
      // It becomes the operator's expression.
      ExpressionPtr left = std::move(e.arguments.front().value);
      for (std::size_t i = 1; i < e.arguments.size(); ++i) {
        const bool is_last = i + 1 == e.arguments.size();
        auto both = std::make_unique<Expression>();
        both->kind = Expression::Kind::binary;
        both->at = e.at;
        both->name = function->as;
        both->children.push_back(std::move(left));
        both->children.push_back(std::move(e.arguments[i].value));
        if (!is_last) {
          left = std::move(both);
          continue;
        }
        e.kind = Expression::Kind::binary;
        e.name = function->as;
        e.children = std::move(both->children);
      }
      e.arguments.clear();
      return find_natural(e);
    }
    case Standard::not_: {
      e.kind = Expression::Kind::unary;
      e.children.clear();
      e.children.push_back(std::move(e.arguments.front().value));
      e.arguments.clear();
      return find_natural(e);
    }
    case Standard::move: return argument(0);
    case Standard::absolute: {
      const DataType* const found = argument(0);
      if (found == nullptr || !found->is_scalar()) return wrong(found, "a number");
      const bool is_number = is_whole(*found) || program::info(found->base).family == Family::real;
      return is_number ? found : wrong(found, "a number");
    }
    case Standard::of_real:
    case Standard::atan2: {
      const DataType* const found =
          function->which == Standard::atan2 ? common_of(arguments_of(e)) : argument(0);
      if (found == nullptr) return nullptr;
      if (found == &open_types().integer || found == &open_types().real) return type(Elementary::lreal);
      if (!found->is_scalar() || program::info(found->base).family != Family::real)
        return wrong(found, "REAL or LREAL");
      return type(found->base);
    }
    case Standard::shift:
    case Standard::rotate: {
      const DataType* found = argument(0);
      if (found == nullptr) return nullptr;
      if (found == &open_types().word) found = type(Elementary::word);
      if (found == &open_types().double_word) found = type(Elementary::dword);
      return is_bits(*found) ? found : wrong(found, "a bit string such as WORD");
    }
    case Standard::select:
    case Standard::multiplex: return common_of(arguments_of(e, 1));
    case Standard::maximum:
    case Standard::minimum:
    case Standard::limit: {
      const DataType* const found = common_of(arguments_of(e));
      if (found != nullptr && !found->is_scalar() && !found->is_string())
        return wrong(found, "values of an elementary type");
      return found;
    }
    case Standard::length:
    case Standard::find: {
      const DataType* const found = argument(0);
      if (found == nullptr || !found->is_string()) return wrong(found, "a string");
      return type(Elementary::int_);
    }
    case Standard::left_right:
    case Standard::mid:
    case Standard::concat:
    case Standard::insert:
    case Standard::delete_:
    case Standard::replace: {
      const DataType* const found = argument(0);
      if (found == nullptr || !found->is_string()) return wrong(found, "a string");
      return type(found->base);
    }
    case Standard::date_parts: return type(date_function(e.name)->type);
    case Standard::date_and_time: return type(e.name == "CONCAT_DATE_TOD" ? Elementary::dt : Elementary::ldt);
    case Standard::day_of_week: return type(Elementary::usint);
    case Standard::is_valid: {
      const DataType* const found = argument(0);
      if (found == nullptr) return nullptr;
      return found->is_scalar() && program::info(found->base).family == Family::real
                 ? type(Elementary::boolean)
                 : wrong(found, "REAL or LREAL");
    }
    case Standard::is_valid_bcd: {
      const DataType* const found = argument(0);
      if (found == nullptr) return nullptr;
      return is_bits(*found) || found == &open_types().word ? type(Elementary::boolean)
                                                            : wrong(found, "a bit string");
    }
    case Standard::swap_bytes:
    case Standard::same: {
      const DataType* found = argument(0);
      if (found == nullptr) return nullptr;
      if (found == &open_types().word) found = type(Elementary::word);
      return is_bits(*found) || is_whole(*found) ? found : wrong(found, "an integer or a bit string");
    }
    case Standard::truncate: {
      const DataType* const found = argument(0);
      if (found == nullptr) return nullptr;
      return found->is_scalar() && program::info(found->base).family == Family::real
                 ? type(Elementary::dint)
                 : wrong(found, "REAL or LREAL");
    }
  }
  return nullptr;
}

/// What a function among the later ones changes, the earlier ones do not show. Empty after an error.
std::vector<Value> UnitCompiler::kept_values(const std::vector<Expression*>& given, const DataType* wanted) {
  std::vector<Value> values;
  for (Expression* each : given) {
    const Value value = expression(*each, wanted);
    if (value.type == nullptr) return {};
    const std::uint32_t kept = body_.temporary();
    body_.emit(Opcode::move, kept, value.slot);
    values.push_back({wanted, kept});
  }
  return values;
}

/// GT(a, b, c): a > b and b > c.
Value UnitCompiler::compare_all(std::string_view name, Expression& e) {
  const std::vector<Expression*> given = arguments_of(e);
  const DataType* const both = resolved(common_of(given), nullptr, *given.front());
  const std::vector<Value> values = kept_values(given, both);
  if (values.empty()) return {};
  const std::uint32_t all = body_.temporary();
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    const Value one = compare_values(name, values[i], values[i + 1], i == 0 ? all : nowhere);
    if (i != 0) body_.emit(Opcode::bit_and, all, all, one.slot);
  }
  return {type(Elementary::boolean), all};
}

Value UnitCompiler::selection(Standard which, Expression& e, const DataType* want) {
  const DataType* const found = resolved(natural(e), want, *e.arguments.back().value);
  std::size_t first = 0;
  Value selector;
  if (which == Standard::select || which == Standard::multiplex) {
    first = 1;
    Expression& choice = *e.arguments.front().value;
    const DataType* choice_type = type(Elementary::boolean);
    if (which == Standard::multiplex) {
      const DataType* const open = natural(choice);
      if (open == nullptr) return {};
      choice_type = resolved(open, nullptr, choice);
      if (!is_whole(*choice_type)) {
        error(choice.at, "expected an integer, found " + choice_type->name);
        return {};
      }
    }
    selector = expression(choice, choice_type);
    if (selector.type == nullptr) return {};
  }
  const std::vector<Value> values = kept_values(arguments_of(e, first), found);
  if (values.empty()) return {};
  const std::uint32_t result = body_.temporary();
  // result = value, where `smaller` is below `larger`
  const auto take_if = [&](std::uint32_t smaller, std::uint32_t larger, std::uint32_t value) {
    const std::uint32_t is_below = compare_values("<", {found, smaller}, {found, larger}, nowhere).slot;
    const std::size_t skip = body_.emit(Opcode::jump_unless, is_below);
    body_.emit(Opcode::move, result, value);
    body_.land(skip);
  };
  switch (which) {
    case Standard::select: {
      body_.emit(Opcode::move, result, values[0].slot);
      const std::size_t skip = body_.emit(Opcode::jump_unless, selector.slot);
      body_.emit(Opcode::move, result, values[1].slot);
      body_.land(skip);
      break;
    }
    case Standard::multiplex: {
      body_.emit(Opcode::check_range, selector.slot,
                 declarations_.add_element({.low = 0, .high = static_cast<std::int64_t>(values.size()) - 1}));
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t skip = body_.emit(Opcode::jump_ne, selector.slot, body_.constant(i));
        body_.emit(Opcode::move, result, values[i].slot);
        body_.land(skip);
      }
      break;
    }
    case Standard::limit:  // MIN(MAX(IN, MN), MX)
      body_.emit(Opcode::move, result, values[1].slot);
      take_if(result, values[0].slot, values[0].slot);
      take_if(values[2].slot, result, values[2].slot);
      break;
    default:
      body_.emit(Opcode::move, result, values[0].slot);
      for (std::size_t i = 1; i < values.size(); ++i) {
        const std::uint32_t value = values[i].slot;
        if (which == Standard::maximum)
          take_if(result, value, value);
        else
          take_if(value, result, value);
      }
  }
  return {found, result};
}

Value UnitCompiler::string_function(Standard which, Expression& e) {
  const bool is_wide = natural(*e.arguments.front().value)->base == Elementary::wstring;
  const DataType* const string = type(is_wide ? Elementary::wstring : Elementary::string);
  const bool has_two = which == Standard::find || which == Standard::concat || which == Standard::insert ||
                       which == Standard::replace;
  std::vector<Value> values;
  std::uint32_t capacity = 0;
  for (std::size_t i = 0; i < e.arguments.size(); ++i) {
    const bool is_text = i == 0 || (has_two && i == 1) || which == Standard::concat;
    Expression& argument = *e.arguments[i].value;
    const DataType* const open = natural(argument);
    if (open == nullptr) return {};
    if (!is_text && !is_whole(*open)) {
      error(argument.at, "expected an integer, found " + open->name);
      return {};
    }
    const Value value = expression(argument, is_text ? string : resolved(open, nullptr, argument));
    if (value.type == nullptr) return {};
    if (is_text) capacity += value.type->capacity;
    values.push_back(value);
  }
  switch (which) {
    case Standard::length:
      return native(is_wide ? "LEN_WSTRING" : "LEN_STRING", values, type(Elementary::int_));
    case Standard::find:
      return native(is_wide ? "FIND_WSTRING" : "FIND_STRING", values, type(Elementary::int_));
    case Standard::concat: {
      Value result = values.front();
      std::uint32_t size = values.front().type->capacity;
      for (std::size_t i = 1; i < values.size(); ++i) {
        size += values[i].type->capacity;
        result = native_string("CONCAT", {result, values[i]}, is_wide, size);
      }
      return result;
    }
    default: return native_string(e.name, values, is_wide, capacity);
  }
}

Value UnitCompiler::standard_call(Expression& e, const DataType* want, std::uint32_t into) {
  const DataType* const found = natural(e);
  if (const auto conversion = conversion_named(e.name); conversion && function_named(e.name) == nullptr) {
    Expression& argument = *e.arguments.front().value;
    const DataType* const open = natural(argument);
    if (open == nullptr) return {};
    const Elementary to = conversion->to;
    using Verb = Conversion::Verb;
    const bool is_bcd = conversion->verb == Verb::from_bcd || conversion->verb == Verb::to_bcd;
    const DataType* from = conversion->from ? type(*conversion->from) : resolved(open, nullptr, argument);
    if (is_bcd && !conversion->from && open == &open_types().integer)  // a literal: BCD_TO_UINT(16#1234)
      from = type(conversion->verb == Verb::from_bcd ? Elementary::lword : Elementary::ulint);
    if (from->is_string()) from = open;
    if (!has_conversion(*from, to)) {
      error(e.at, "there is no conversion of " + from->name + " to " + found->name);
      return {};
    }
    const Value value = expression(argument, from);
    if (value.type == nullptr) return {};
    const Family f = program::info(value.type->base).family;
    const Family t = program::info(to).family;
    if (is_bcd) {
      const bool is_from = conversion->verb == Verb::from_bcd;
      if (is_from ? f != Family::bits || t != Family::unsigned_integer
                  : f != Family::unsigned_integer || t != Family::bits) {
        error(e.at, "expected BCD of a bit string, and an integer without a sign");
        return {};
      }
      if (is_from)
        return numeric_conversion(native("BCD_TO", {value}, type(Elementary::ulint)), found, into, false);
      return native("TO_BCD", {value, constant_value(program::info(to).bits, type(Elementary::usint))},
                    found);
    }
    if (conversion->verb == Verb::truncate && f != Family::real) {
      error(e.at, "expected REAL or LREAL, found " + value.type->name);
      return {};
    }
    const Value kind = constant_value(static_cast<Slot>(t == Family::string ? value.type->base : to),
                                      type(Elementary::usint));
    if (value.type->is_string() && t == Family::string) {
      if (value.type->base == to) return value;
      const bool is_wide = to == Elementary::wstring;
      const std::uint32_t text = body_.string_temporary(value.type->capacity, is_wide ? 16 : 8);
      const std::uint32_t slots = body_.temporary(2);
      body_.emit(Opcode::address, slots, text);
      body_.emit(Opcode::move, slots + 1, value.slot);
      const char* const name = is_wide ? "STRING_TO_WSTRING" : "WSTRING_TO_STRING";
      body_.emit(Opcode::native, declarations_.native(program::native_named(name)), slots);
      return {declarations_.string_of(is_wide, value.type->capacity), slots};
    }
    if (t == Family::string) return native_string("TO", {value, kind}, to == Elementary::wstring, 80);
    if (value.type->is_string())
      return native(value.type->base == Elementary::wstring ? "FROM_WSTRING" : "FROM_STRING", {value, kind},
                    found);
    if (f == Family::date && t == Family::date) {
      const bool is_date = to == Elementary::date || to == Elementary::ldate;
      const bool is_time = to == Elementary::tod || to == Elementary::ltod;
      if (is_date || is_time) return native(is_date ? "DATE_PART" : "TIME_PART", {value}, found);
      return {found, value.slot};
    }
    if (f == Family::duration && t == Family::duration) return {found, value.slot};
    if (f == Family::duration || t == Family::duration) {
      // A number is milliseconds, as MELSEC's timers and most others count.
      const Value ms = constant_value(millisecond, type(Elementary::lint));
      const std::uint32_t slot = body_.temporary();
      if (f == Family::duration) {
        body_.emit(Opcode::div_i64, slot, value.slot, ms.slot);
        return numeric_conversion({type(Elementary::lint), slot}, found, into, false);
      }
      const Value number = numeric_conversion(value, type(Elementary::lint), nowhere, false);
      body_.emit(Opcode::mul_i64, slot, number.slot, ms.slot);
      return {found, slot};
    }
    return numeric_conversion(value, found, into, conversion->verb == Verb::truncate);
  }
  const Function& function = *function_named(e.name);
  const auto one = [&](const DataType* wanted) { return expression(*e.arguments.front().value, wanted); };
  const std::string suffix = found->base == Elementary::real ? "_REAL" : "_LREAL";
  switch (function.which) {
    case Standard::op: return compare_all(function.as, e);  // the others became operators
    case Standard::not_: return {};
    case Standard::move: return one(resolved(found, want, *e.arguments.front().value));
    case Standard::absolute: {
      const DataType* const kind = resolved(found, want, *e.arguments.front().value);
      const Value value = one(kind);
      if (value.type == nullptr) return {};
      if (program::info(kind->base).family == Family::real)
        return native(kind->base == Elementary::real ? "ABS_REAL" : "ABS_LREAL", {value}, type(kind->base));
      // The least number wraps around, as its negation does.
      const std::uint32_t slot = body_.temporary();
      body_.emit(Opcode::move, slot, value.slot);
      if (program::info(kind->base).family == Family::signed_integer) {
        const std::size_t skip = body_.emit(Opcode::jump_le, body_.constant(0), slot);
        constexpr std::array negations = {Opcode::neg_i8, Opcode::neg_i16, Opcode::neg_i32, Opcode::neg_i64};
        body_.emit(
            negations[static_cast<std::size_t>(kind->base) - static_cast<std::size_t>(Elementary::sint)],
            slot, slot);
        body_.land(skip);
      }
      return {type(kind->base), slot};
    }
    case Standard::of_real: {
      const Value value = one(found);
      return value.type == nullptr ? Value{} : native(std::string(e.name) + suffix, {value}, found);
    }
    case Standard::atan2: {
      const Value y = one(found);
      const Value x = expression(*e.arguments[1].value, found);
      if (y.type == nullptr || x.type == nullptr) return {};
      return native("ATAN2" + suffix, {y, x}, found);
    }
    case Standard::shift:
    case Standard::rotate: {
      const Value value = one(found);
      const DataType* const open = natural(*e.arguments[1].value);
      if (value.type == nullptr || open == nullptr) return {};
      if (!is_whole(*open)) {
        error(e.arguments[1].at, "expected an integer, found " + open->name);
        return {};
      }
      const Value places = expression(*e.arguments[1].value, resolved(open, nullptr, *e.arguments[1].value));
      if (places.type == nullptr) return {};
      body_.emit(Opcode::check_range, places.slot, declarations_.add_element({.low = 0, .high = 0x7FFFFFFF}));
      const unsigned bits = program::info(found->base).bits;
      if (function.which == Standard::rotate)
        return native(e.name, {value, places, constant_value(bits, type(Elementary::usint))}, found);
      const std::uint32_t slot = target(into);
      body_.emit(e.name == "SHL" ? Opcode::shl : Opcode::shr, slot, value.slot, places.slot);
      if (e.name == "SHL" && bits < 64)
        body_.emit(Opcode::bit_and, slot, slot, body_.constant((Slot{1} << bits) - 1));
      return {found, slot};
    }
    case Standard::select:
    case Standard::multiplex:
    case Standard::maximum:
    case Standard::minimum:
    case Standard::limit: return selection(function.which, e, want);
    case Standard::length:
    case Standard::find:
    case Standard::left_right:
    case Standard::mid:
    case Standard::concat:
    case Standard::insert:
    case Standard::delete_:
    case Standard::replace: return string_function(function.which, e);
    case Standard::date_parts: {
      std::vector<Value> parts;
      for (Expression* part : arguments_of(e)) {
        parts.push_back(expression(*part, type(Elementary::lint)));
        if (parts.back().type == nullptr) return {};
      }
      return native(date_function(e.name)->native, parts, found);
    }
    case Standard::date_and_time: {
      const Value date = one(type(Elementary::date));
      const Value time = expression(*e.arguments[1].value,
                                    type(e.name == "CONCAT_DATE_TOD" ? Elementary::tod : Elementary::ltod));
      if (date.type == nullptr || time.type == nullptr) return {};
      const std::uint32_t slot = target(into);
      body_.emit(Opcode::add_i64, slot, date.slot, time.slot);
      return {found, slot};
    }
    case Standard::day_of_week: {
      const Value date = one(type(Elementary::ldate));
      return date.type == nullptr ? Value{} : native("DAY_OF_WEEK", {date}, found);
    }
    case Standard::is_valid: {
      const DataType* const kind =
          resolved(natural(*e.arguments.front().value), nullptr, *e.arguments.front().value);
      const Value value = one(kind);
      if (value.type == nullptr) return {};
      return native(kind->base == Elementary::real ? "IS_VALID_REAL" : "IS_VALID_LREAL", {value}, found);
    }
    case Standard::is_valid_bcd: {
      const Value value = one(type(Elementary::lword));
      return value.type == nullptr ? Value{} : native("IS_VALID_BCD", {value}, found);
    }
    case Standard::same:
    case Standard::swap_bytes: {
      const DataType* const kind = resolved(found, want, *e.arguments.front().value);
      const Value value = one(kind);
      const unsigned bits = program::info(kind->base).bits;
      if (value.type == nullptr || function.which == Standard::same || bits < 16) return value;
      const Value swapped = native("SWAP_BYTES", {value, constant_value(bits / 8, type(Elementary::usint))},
                                   type(Elementary::lword));
      return numeric_conversion(swapped, type(kind->base), into, false);
    }
    case Standard::truncate: {
      const DataType* const kind =
          resolved(natural(*e.arguments.front().value), nullptr, *e.arguments.front().value);
      const Value value = one(kind);
      return value.type == nullptr ? Value{} : numeric_conversion(value, found, into, true);
    }
  }
  return {};
}

}  // namespace canopus::structured_text
