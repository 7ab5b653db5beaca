// Calls of functions and function blocks.

#include <algorithm>
#include <array>
#include <string_view>

#include "canopus/ascii/words.hpp"
#include "canopus/structured_text/standard.hpp"
#include "canopus/structured_text/unit_compiler.hpp"

namespace canopus::structured_text {

using program::Member;
using program::MemberKind;

/// Its name is that of its result, too.
bool UnitCompiler::is_own_function(std::string_view name) const {
  return unit_ != nullptr && unit_->unit->kind == Unit::Kind::function && unit_->unit->name == name;
}

UnitInfo* UnitCompiler::own_block() {
  if (unit_ == nullptr) return nullptr;
  return unit_->unit->kind == Unit::Kind::block ? unit_ : unit_->owner;
}

bool UnitCompiler::is_this(const Expression& expression) {
  return expression.kind == Expression::Kind::name && expression.name == "THIS" && own_block() != nullptr &&
         !is_variable(expression.name);
}

UnitInfo* UnitCompiler::method_of(Expression& callee) {
  UnitInfo* block = nullptr;
  bool is_inside = false;
  if (callee.kind == Expression::Kind::name && !is_variable(callee.name)) {
    block = own_block();
    is_inside = true;
  } else if (callee.kind == Expression::Kind::member) {
    Expression& instance = *callee.children.front();
    is_inside = is_this(instance);
    const DataType* const type = is_inside ? nullptr : natural(instance);
    if (type != nullptr && type->form == DataType::Form::block) block = declarations_.unit_of(*type);
    if (is_inside) block = own_block();
  }
  if (block == nullptr) return nullptr;
  const auto found = block->methods.find(callee.name);
  if (found == block->methods.end()) return nullptr;
  if (found->second->unit->is_private && !is_inside)
    error(callee.at,
          "expected a method that is PUBLIC: " + std::string(callee.written) + " is its block's own");
  return found->second;
}

std::uint32_t UnitCompiler::instance_address(Expression& callee) {
  const bool is_inside = callee.kind == Expression::Kind::name || is_this(*callee.children.front());
  if (!is_inside) return address_of(place(*callee.children.front()));
  if (unit_->owner != nullptr) return this_slot;
  const std::uint32_t slot = body_.temporary();
  body_.emit(Opcode::address, slot, 0);
  return slot;
}

// EN and ENO [IEC 61131-3 6.6.1.6]

void UnitCompiler::extract_enable(Expression& e, const UnitInfo* unit) {
  std::erase_if(e.arguments, [&](Argument& argument) {
    const bool is_enable = argument.name == (argument.is_output ? "ENO" : "EN");
    if (!is_enable || (unit != nullptr && unit->type->member(argument.name) != nullptr)) return false;
    ExpressionPtr& kept = argument.is_output ? e.enable_output : e.enable;
    if (kept != nullptr) return false;
    kept = std::move(argument.value);
    if (argument.is_output) e.inverts_enable_output = argument.is_negated;
    return true;
  });
}

/// call() where EN is TRUE; ENO says so.
template <typename Call>
void UnitCompiler::if_enabled(Expression& e, Call call) {
  const ExpressionPtr enable = std::move(e.enable);
  const ExpressionPtr output = std::move(e.enable_output);
  const auto report = [&](bool is_enabled) {
    if (output == nullptr) return;
    const Place to = writable(*output, *type(Elementary::boolean));
    if (to.kind == Place::Kind::none) return;
    store(to, constant_value(is_enabled != e.inverts_enable_output ? 1 : 0, to.type));
  };
  std::optional<std::size_t> skip;
  if (enable != nullptr) {
    const Value condition = expression(*enable, type(Elementary::boolean));
    if (condition.type == nullptr) return;
    skip = body_.emit(Opcode::jump_unless, condition.slot);
  }
  call();
  report(true);
  if (!skip) return;
  const std::size_t end = body_.emit(Opcode::jump);
  body_.land(*skip);
  report(false);
  body_.land(end);
}

/// Where EN is FALSE, the result is the initial value of its type.
Value UnitCompiler::enabled_value(Expression& e, const DataType* want) {
  const std::uint32_t result = body_.temporary();
  const std::size_t before = body_.emit(Opcode::move, result, result);
  Value value;
  if_enabled(e, [&] {
    value = plain(e, want, nowhere);
    if (value.type != nullptr) body_.emit(Opcode::move, result, value.slot);
  });
  if (value.type == nullptr) return {};
  const std::uint32_t initial = body_.reserve(value.type->slots);
  if (body_.is_too_large) return {};
  program::write_initial(*value.type, body_.image.data() + initial);
  body_.code[before].b = initial;
  if (!value.type->is_scalar()) body_.code[before].code = Opcode::address;
  return {value.type, result};
}

/// Of a function or a method whose result is needed.
const DataType* UnitCompiler::result_of(Expression& e, UnitInfo& function) {
  const Expression& callee = *e.children.front();
  if (constants_only_) {
    error(e.at, "expected a constant, found a call of " + std::string(callee.written));
    return nullptr;
  }
  if (!declarations_.require(function, e.at)) return nullptr;
  extract_enable(e, &function);
  if (function.result == nullptr)
    error(e.at, "expected a " + std::string(text_of(function.unit->kind)) +
                    " with a result: " + std::string(callee.written) + " has none");
  return function.result;
}

namespace {

/// What a call of a PROGRAM or a function block by its own name must be instead.
std::string expected_instance(const UnitInfo& unit, const Expression& callee) {
  const std::string name(callee.written);
  if (unit.unit != nullptr && unit.unit->kind == Unit::Kind::program)
    return "expected a function or an instance: the CPU executes the PROGRAM " + name + " by itself";
  return "expected an instance: a variable of type " + name;
}

}  // namespace

const DataType* UnitCompiler::call_type(Expression& e) {
  Expression& callee = *e.children.front();
  if (UnitInfo* const method = method_of(callee); method != nullptr) return result_of(e, *method);
  if (callee.kind == Expression::Kind::name && (!is_variable(callee.name) || is_own_function(callee.name))) {
    if (UnitInfo* const unit = declarations_.unit_named(callee.name);
        unit != nullptr && unit->unit != nullptr) {
      if (unit->unit->kind != Unit::Kind::function) {
        error(e.at, expected_instance(*unit, callee));
        return nullptr;
      }
      return result_of(e, *unit);
    }
    extract_enable(e, nullptr);
    return standard_type(e);
  }
  error(e.at,
        "expected a function: a call of a function block is a statement, and its outputs are read as "
        "instance.output");
  return nullptr;
}

Value UnitCompiler::call(Expression& e, const DataType* want, std::uint32_t into) {
  Expression& callee = *e.children.front();
  if (UnitInfo* const method = method_of(callee); method != nullptr) return function_call(e, *method);
  if (UnitInfo* const unit = declarations_.unit_named(callee.name); unit != nullptr && unit->unit != nullptr)
    return function_call(e, *unit);
  return standard_call(e, want, into);
}

namespace {

/// Instructions of MELSEC that GX Works has as functions, too.
bool is_instruction(std::string_view name) {
  constexpr std::array<std::string_view, 17> names = {"MOV",  "DMOV",  "BMOV",  "FMOV", "SET", "RST",
                                                      "OUT",  "PLS",   "PLF",   "INC",  "DEC", "DINC",
                                                      "DDEC", "OUT_T", "OUT_C", "FROM", "TO"};
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

void UnitCompiler::call_statement(Expression& e) {
  Expression& callee = *e.children.front();
  const auto call_function = [&](UnitInfo& function) {
    if (!declarations_.require(function, e.at)) return;
    extract_enable(e, &function);
    if_enabled(e, [&] { (void)function_call(e, function); });
  };
  if (UnitInfo* const method = method_of(callee); method != nullptr) return call_function(*method);
  if (callee.kind == Expression::Kind::name && (!is_variable(callee.name) || is_own_function(callee.name))) {
    UnitInfo* const unit = declarations_.unit_named(callee.name);
    if (unit != nullptr && unit->unit != nullptr && unit->unit->kind == Unit::Kind::function)
      return call_function(*unit);
    if (is_split(callee.name)) {
      extract_enable(e, nullptr);
      return if_enabled(e, [&] { split_call(e); });
    }
    if (is_standard_function(callee.name)) {
      (void)expression(e, nullptr);
      return;
    }
    if (unit != nullptr) return error(e.at, expected_instance(*unit, callee));
    return error(e.at, "there is no function or function block instance " + std::string(callee.written) +
                           (is_instruction(callee.name)
                                ? ": instructions are for lists; expected :=, IF, or a block such as TON"
                                : ""));
  }
  const Place instance = place(callee);
  if (instance.kind == Place::Kind::none) return;
  if (instance.type->form != DataType::Form::block)
    return error(e.at, "expected a function block instance, found a variable of type " + instance.type->name);
  UnitInfo* const unit = declarations_.unit_of(*instance.type);
  if (unit == nullptr) return error(e.at, "expected a function block instance");
  extract_enable(e, unit);
  if_enabled(e, [&] { block_call(e, instance); });
}

bool UnitCompiler::bind(Expression& e, UnitInfo& unit, std::vector<Bound>& to) {
  const std::size_t before = declarations_.mistakes();
  const auto is_parameter = [](const Member& member) {
    return member.kind == MemberKind::input || member.kind == MemberKind::in_out ||
           member.kind == MemberKind::output;
  };
  // The result of a function is no parameter.
  const auto is_result = [&](const Member& member) {
    return unit.result != nullptr && ascii::equal_ignoring_case(member.name, unit.unit->name);
  };
  std::size_t next = 0;
  for (Argument& argument : e.arguments) {
    const Member* member = nullptr;
    if (argument.name.empty()) {
      // In the order of the declaration.
      std::size_t number = 0;
      for (const Member& each : unit.type->members) {
        if (!is_parameter(each) || is_result(each)) continue;
        if (number++ == next) member = &each;
      }
      ++next;
      if (member == nullptr) {
        error(argument.at, "expected at most " + std::to_string(number) + " arguments");
        return false;
      }
    } else {
      member = unit.type->member(argument.name);
      if (member != nullptr && (!is_parameter(*member) || is_result(*member))) member = nullptr;
      if (member == nullptr) {
        error(argument.at, unit.type->name + " has no input or output " + std::string(argument.name));
        continue;
      }
      if (argument.is_output != (member->kind == MemberKind::output)) {
        error(argument.at, argument.is_output ? "expected := : " + member->name + " is an input"
                                              : "expected => : " + member->name + " is an output");
        continue;
      }
    }
    if (std::ranges::any_of(to, [&](const Bound& bound) { return bound.member == member; })) {
      error(argument.at, "expected " + member->name + " once");
      continue;
    }
    if (argument.value != nullptr) to.push_back({member, &argument});
  }
  for (const Member& member : unit.type->members) {
    const bool is_given =
        std::ranges::any_of(to, [&](const Bound& bound) { return bound.member == &member; });
    if (member.kind == MemberKind::in_out && !is_given)
      error(e.at, "expected a variable for " + member.name + " (VAR_IN_OUT)");
  }
  return declarations_.mistakes() == before;
}

Place UnitCompiler::writable(Expression& e, const DataType& wanted) {
  Place found = place(e);
  if (found.kind == Place::Kind::none) return {};
  if (found.is_constant) {
    error(e.at, std::string(found.why_constant));
    return {};
  }
  if (found.type != &wanted && !program::same_type(*found.type, wanted) &&
      !(found.type->is_string() && wanted.is_string() && found.type->base == wanted.base)) {
    error(e.at, "expected a variable of type " + wanted.name + ", found " + found.type->name);
    return {};
  }
  return found;
}

Value UnitCompiler::function_call(Expression& e, UnitInfo& unit) {
  std::vector<Bound> bound;
  if (!bind(e, unit, bound)) return {};
  const program::Function& function = declarations_.program().functions[unit.function];
  const std::uint32_t frame = function.frame;
  const std::uint32_t instance = unit.owner == nullptr ? nowhere : instance_address(*e.children.front());
  // All arguments are computed before the first one is written: one of them may call the same function.
  struct Input {
    const Member* member;
    Value value;
  };
  std::vector<Input> inputs;
  std::vector<std::pair<Bound, Place>> outputs;
  for (std::size_t i = 0; i < bound.size(); ++i) {
    const auto& [member, argument] = bound[i];
    if (member->kind == MemberKind::output) {
      Place to = place(*argument->value);
      if (to.kind == Place::Kind::none) return {};
      if (to.is_constant) {
        error(argument->at, std::string(to.why_constant));
        return {};
      }
      outputs.emplace_back(bound[i], std::move(to));
    } else if (member->kind == MemberKind::in_out) {
      const Place variable = writable(*argument->value, *member->type);
      if (variable.kind == Place::Kind::none) return {};
      if (variable.kind == Place::Kind::device || variable.kind == Place::Kind::partial) {
        error(argument->at,
              "expected a variable, not a device or a bit, for " + member->name + " (VAR_IN_OUT)");
        return {};
      }
      inputs.push_back({member, {type(Elementary::lint), address_of(variable)}});
    } else {
      Value value = expression(*argument->value, member->type);
      if (value.type == nullptr) return {};
      const bool calls_follow =
          std::any_of(bound.begin() + static_cast<std::ptrdiff_t>(i) + 1, bound.end(),
                      [this](const Bound& later) { return has_call(*later.argument->value); });
      if (calls_follow && value.type->is_scalar()) {
        const std::uint32_t kept = body_.temporary();
        body_.emit(Opcode::move, kept, value.slot);
        value.slot = kept;
      }
      inputs.push_back({member, value});
    }
  }
  for (const Member& member : unit.type->members) {
    const bool is_given =
        std::ranges::any_of(inputs, [&](const Input& input) { return input.member == &member; });
    if (member.kind == MemberKind::input && !is_given)
      body_.emit(Opcode::reset_global, frame + member.offset, member.type->slots);
  }
  for (const auto& [member, value] : inputs) {
    const Place to{.kind = Place::Kind::global,
                   .type = member->kind == MemberKind::in_out ? type(Elementary::lint) : member->type,
                   .offset = frame + member->offset};
    assign_value(to, value, e.at);
  }
  if (instance != nowhere) body_.emit(Opcode::store_global, frame + this_slot, instance);
  body_.emit(Opcode::call, unit.function);
  for (const auto& [output, to] : outputs) {
    const Member& member = *output.member;
    assign_output(to,
                  load({.kind = Place::Kind::global, .type = member.type, .offset = frame + member.offset}),
                  *output.argument);
  }
  if (unit.result == nullptr) return {};
  const Member& result = unit.type->members[unit.members.at(unit.unit->name)];
  const Value value =
      load({.kind = Place::Kind::global, .type = unit.result, .offset = frame + result.offset});
  if (unit.result->is_scalar()) return value;
  // The next call overwrites it.
  if (unit.result->is_string()) {
    const program::ElementaryInfo& kind = program::info(unit.result->base);
    const std::uint32_t copy = body_.string_temporary(unit.result->capacity, kind.bits);
    const Place to{.kind = Place::Kind::frame, .type = unit.result, .slot = copy};
    assign_value(to, value, e.at);
    return {unit.result, address_of(to)};
  }
  const Place to{
      .kind = Place::Kind::frame, .type = unit.result, .slot = body_.temporary(unit.result->slots)};
  assign_value(to, value, e.at);
  return {unit.result, address_of(to)};
}

void UnitCompiler::block_call(Expression& e, const Place& instance) {
  UnitInfo* const unit = declarations_.unit_of(*instance.type);
  if (unit == nullptr) return error(e.at, "expected a function block instance");
  std::vector<Bound> bound;
  if (!bind(e, *unit, bound)) return;
  for (const auto& [member, argument] : bound) {
    if (member->kind == MemberKind::input) {
      const Place to = member_of(instance, *member);
      const bool is_direct = to.kind == Place::Kind::frame && to.type->is_scalar();
      const Value value = expression(*argument->value, member->type, is_direct ? to.slot : nowhere);
      if (value.type != nullptr && !(is_direct && value.slot == to.slot))
        assign_value(to, value, argument->at);
    } else if (member->kind == MemberKind::in_out) {
      const Place variable = writable(*argument->value, *member->type);
      if (variable.kind == Place::Kind::none) return;
      if (variable.kind == Place::Kind::device || variable.kind == Place::Kind::partial)
        return error(argument->at,
                     "expected a variable, not a device or a bit, for " + member->name + " (VAR_IN_OUT)");
      Place to = instance;
      to.type = type(Elementary::lint);
      if (to.kind == Place::Kind::frame)
        to.slot += member->offset;
      else
        to.offset += member->offset;
      store(to, {to.type, address_of(variable)});
    }
  }
  if (unit->standard == nullptr) {
    body_.emit(Opcode::call_block, address_of(instance), unit->function);
  } else if (instance.kind == Place::Kind::frame) {
    body_.emit(Opcode::native, declarations_.native(unit->standard->run), instance.slot);
  } else {
    body_.emit(Opcode::native_at, declarations_.native(unit->standard->run), address_of(instance));
  }
  for (const auto& [member, argument] : bound) {
    if (member->kind != MemberKind::output) continue;
    const Place to = place(*argument->value);
    if (to.kind == Place::Kind::none) continue;
    if (to.is_constant) {
      error(argument->at, std::string(to.why_constant));
      continue;
    }
    assign_output(to, load(member_of(instance, *member)), *argument);
  }
}

void UnitCompiler::assign_output(const Place& to, Value value, const Argument& argument) {
  if (argument.is_negated) {
    if (value.type->base != Elementary::boolean)
      return error(argument.at, "expected a BOOL output behind NOT");
    const std::uint32_t slot = body_.temporary();
    body_.emit(Opcode::bit_xor, slot, value.slot, body_.constant(1));
    value.slot = slot;
  }
  value = convert(value, to.type, argument.at, false);
  if (value.type != nullptr) assign_value(to, value, argument.at);
}

Value UnitCompiler::native(std::string_view name, const std::vector<Value>& arguments,
                           const DataType* result) {
  const auto slots = static_cast<std::uint32_t>(arguments.size() + 1);
  const std::uint32_t first = body_.temporary(slots);
  for (std::uint32_t i = 1; i < slots; ++i) body_.emit(Opcode::move, first + i, arguments[i - 1].slot);
  body_.emit(Opcode::native, declarations_.native(program::native_named(name)), first);
  return {result, first};
}

Value UnitCompiler::native_string(std::string_view name, const std::vector<Value>& arguments, bool is_wide,
                                  std::uint32_t capacity) {
  constexpr std::uint32_t longest = 1024;
  capacity = std::clamp(capacity, 1U, longest);
  const DataType* const result = declarations_.string_of(is_wide, capacity);
  const std::uint32_t text = body_.string_temporary(capacity, is_wide ? 16 : 8);
  const auto slots = static_cast<std::uint32_t>(arguments.size() + 1);
  const std::uint32_t first = body_.temporary(slots);
  body_.emit(Opcode::address, first, text);
  for (std::uint32_t i = 1; i < slots; ++i) body_.emit(Opcode::move, first + i, arguments[i - 1].slot);
  const std::string whole = std::string(name) + (is_wide ? "_WSTRING" : "_STRING");
  body_.emit(Opcode::native, declarations_.native(program::native_named(whole)), first);
  return {result, first};
}

}  // namespace canopus::structured_text
