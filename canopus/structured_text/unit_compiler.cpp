#include "canopus/structured_text/unit_compiler.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "canopus/ascii/words.hpp"
#include "canopus/program/execution.hpp"

namespace canopus::structured_text {

using program::Family;
using program::Member;
using program::MemberKind;

namespace {

MemberKind member_kind(VariableSection::Kind kind) {
  switch (kind) {
    case VariableSection::Kind::input: return MemberKind::input;
    case VariableSection::Kind::output: return MemberKind::output;
    case VariableSection::Kind::in_out: return MemberKind::in_out;
    case VariableSection::Kind::temporary: return MemberKind::temporary;
    case VariableSection::Kind::local:
    case VariableSection::Kind::external:
    case VariableSection::Kind::global: break;
  }
  return MemberKind::local;
}

/// Labels of a CASE: each value has one branch.
class CaseLabels {
 public:
  explicit CaseLabels(bool has_sign) : has_sign_(has_sign) {}
  [[nodiscard]] bool has_sign() const noexcept { return has_sign_; }
  /// What is wrong with the values from `low` to `high`.
  std::optional<std::string> add(Slot low, Slot high, SourcePosition at) {
    constexpr Slot sign = Slot{1} << 63U;
    if (has_sign_) low ^= sign, high ^= sign;  // in this order without a sign
    if (low > high) return "expected a first value that is not above the last one";
    const auto next = ranges_.upper_bound(high);
    if (next != ranges_.begin() && std::prev(next)->second.high >= low)
      return "expected values that no other label has: line " + std::to_string(std::prev(next)->second.line) +
             " has them already";
    ranges_.emplace(low, Range{high, at.line});
    return std::nullopt;
  }

 private:
  struct Range {
    Slot high;
    std::uint32_t line;
  };
  bool has_sign_;
  std::map<Slot, Range> ranges_;
};

}  // namespace

const OpenTypes& open_types() {
  static const OpenTypes types;
  return types;
}

bool UnitCompiler::compile_unit() {
  const Unit& unit = *unit_->unit;
  const std::size_t before = declarations_.mistakes();
  if (is_called()) {
    if (unit.result != nullptr) unit_->result = declarations_.type_of(*unit.result, unit_);
    if (unit_->result != nullptr && unit_->result->form == DataType::Form::block)
      error(unit.result->at, "expected a data type as the result");
  }
  (void)declare_variables();
  body_.at = unit.at;
  if (reset_slots_ > 0) body_.emit(Opcode::reset, reset_first_, reset_slots_);
  add_edges();
  statements(unit.body);
  body_.at = unit.end;
  body_.emit(Opcode::return_);
  if (body_.is_too_large) error(unit.at, "its variables need too much memory");
  if (declarations_.mistakes() != before) return false;

  program::Program& program = declarations_.program();
  program::Function function{.name = std::string(unit.written)};
  function.entry = static_cast<std::uint32_t>(program.code.size());
  function.instructions = static_cast<std::uint32_t>(body_.code.size());
  program.code.insert(program.code.end(), body_.code.begin(), body_.code.end());
  program.positions.insert(program.positions.end(), body_.positions.begin(), body_.positions.end());
  if (!declarations_.may_hold(body_.image.size(), unit.at)) return false;
  unit_->type->slots = static_cast<std::uint32_t>(body_.image.size());
  if (unit.kind == Unit::Kind::block) {
    unit_->type->initial = body_.image;
  } else {
    if (program.initial.size() + body_.image.size() > program::most_slots) {
      error(unit.at, "the program's variables need too much memory");
      return false;
    }
    function.frame = declarations_.allocate(unit_->type->slots);
    std::ranges::copy(body_.image, program.initial.begin() + function.frame);
  }
  unit_->function = static_cast<std::uint32_t>(program.functions.size());
  program.functions.push_back(std::move(function));
  return true;
}

// Inputs come first: a function's caller writes them before the rest gets its initial values.
bool UnitCompiler::declare_variables() {
  const Unit& unit = *unit_->unit;
  const bool is_function = is_called();
  const auto each = [&](auto wanted) {
    for (const VariableSection& section : unit.sections) {
      if (!wanted(section.kind)) continue;
      for (const VariableNode& node : section.variables) (void)declare(section, node);
    }
  };
  using Kind = VariableSection::Kind;
  if (unit_->owner != nullptr && body_.reserve(1) != this_slot) return false;
  each([](Kind kind) { return kind == Kind::external; });
  each([](Kind kind) { return kind == Kind::input || kind == Kind::in_out; });
  reset_first_ = static_cast<std::uint32_t>(body_.image.size());
  if (is_function) {
    if (unit_->result != nullptr) {
      unit_->members.emplace(unit.name, unit_->type->members.size());
      const std::uint32_t slot = body_.reserve(unit_->result->slots);
      if (!body_.is_too_large) program::write_initial(*unit_->result, body_.image.data() + slot);
      unit_->type->members.push_back({std::string(unit.written), unit_->result, slot, MemberKind::output});
    }
    each([](Kind kind) { return kind == Kind::output || kind == Kind::local || kind == Kind::temporary; });
  } else {
    each([](Kind kind) { return kind == Kind::temporary; });
  }
  reset_slots_ = static_cast<std::uint32_t>(body_.image.size()) - reset_first_;
  if (!is_function) each([](Kind kind) { return kind == Kind::output || kind == Kind::local; });
  return true;
}

/// Type and CONSTANT are those of the global variable; the unit may promise that it does not write it [IEC 61131-3 6.5.2.2].
bool UnitCompiler::declare_external(const VariableSection& section, const VariableNode& node) {
  const auto wrong = [&](SourcePosition at, std::string message) {
    error(at, std::move(message));
    return false;
  };
  const std::size_t before = declarations_.mistakes();
  const GlobalInfo* const global = declarations_.global_named(node.name, node.at);
  if (global == nullptr) {
    if (declarations_.mistakes() != before) return false;
    return wrong(node.at, "expected the name of a global variable: there is no VAR_GLOBAL " +
                              std::string(node.written));
  }
  if (node.initial != nullptr)
    return wrong(node.initial->at, "expected no initial value: its VAR_GLOBAL has it");
  if (global->section->is_constant && !section.is_constant)
    return wrong(node.at, "expected VAR_EXTERNAL CONSTANT: its VAR_GLOBAL is CONSTANT");
  const DataType* const type = declarations_.type_of(*node.type, unit_);
  if (type == nullptr) {
    declarations_.failed();
    return false;
  }
  if (!program::same_type(*type, *global->type))
    return wrong(node.at, "expected " + global->type->name + " as in its VAR_GLOBAL, found " + type->name);
  unit_->externals.emplace(node.name, section.is_constant);
  return true;
}

bool UnitCompiler::declare(const VariableSection& section, const VariableNode& node) {
  const auto wrong = [&](SourcePosition at, std::string message) {
    error(at, std::move(message));
    return false;
  };
  if (node.type == nullptr) return false;
  if (unit_->members.contains(node.name) || unit_->located.contains(node.name) ||
      unit_->externals.contains(node.name) || (is_called() && node.name == unit_->unit->name))
    return wrong(node.at, "expected another name: " + std::string(node.written) + " is declared already");
  if (section.kind == VariableSection::Kind::external) {
    return declare_external(section, node);
  }
  const DataType* const type = declarations_.type_of(*node.type, unit_);
  if (type == nullptr) {
    declarations_.failed();
    return false;
  }
  const bool is_function = is_called();
  const bool is_block = type->form == DataType::Form::block;
  if (is_block && (is_function || section.kind == VariableSection::Kind::temporary) &&
      section.kind != VariableSection::Kind::in_out)
    return wrong(node.at, "expected a data type: a function block needs a variable that keeps its values");
  if (section.is_retained && (is_function || section.kind == VariableSection::Kind::temporary ||
                              section.kind == VariableSection::Kind::in_out))
    return wrong(node.at, "expected no RETAIN here");
  if (!node.location.empty()) {
    if (section.kind != VariableSection::Kind::local)
      return wrong(node.location_at, "expected AT in VAR or VAR_GLOBAL alone");
    auto access = declarations_.locate(node, *type);
    if (!access) return false;
    unit_->located.emplace(node.name, LocatedVariable{std::move(*access), type, section.is_constant});
    return true;
  }
  const MemberKind kind = member_kind(section.kind);
  const bool is_reference = kind == MemberKind::in_out;
  if (is_reference && node.initial != nullptr)
    return wrong(node.initial->at, "expected no initial value: it is a variable of the caller");
  if (is_reference && unit_->unit->kind == Unit::Kind::program)
    return wrong(node.at, "expected no VAR_IN_OUT in a program");
  const std::uint32_t slot = body_.reserve(is_reference ? 1 : type->slots);
  if (body_.is_too_large) return wrong(node.at, "the variables need too much memory");
  if (!is_reference) {
    program::write_initial(*type, body_.image.data() + slot);
    if (node.initial != nullptr) {
      std::vector<Slot> initial(body_.image.begin() + slot, body_.image.begin() + slot + type->slots);
      declarations_.initialize(*type, *node.initial, initial.data(), unit_);
      std::ranges::copy(initial, body_.image.begin() + slot);
    }
  }
  if (section.is_constant && type->is_scalar() && !is_reference) unit_->constants[slot] = body_.image[slot];
  unit_->members.emplace(node.name, unit_->type->members.size());
  unit_->type->members.push_back(
      {std::string(node.written), type, slot, kind, section.is_constant, section.is_retained});
  if (node.edge != VariableNode::Edge::none) {
    if (kind != MemberKind::input || type->base != Elementary::boolean || is_function)
      return wrong(node.at, "expected R_EDGE and F_EDGE at a BOOL input of a function block or program");
    edges_.push_back({slot, body_.reserve(1), node.edge == VariableNode::Edge::rising});
  }
  return true;
}

/// Inputs with an edge are TRUE for one call: a hidden variable keeps what they were.
void UnitCompiler::add_edges() {
  const std::uint32_t one = edges_.empty() ? 0 : body_.constant(1);
  for (const auto& [slot, before, is_rising] : edges_) {
    const std::uint32_t now = body_.temporary();
    const std::uint32_t was_not = body_.temporary();
    if (is_rising) {
      body_.emit(Opcode::move, now, slot);
    } else {
      body_.emit(Opcode::bit_xor, now, slot, one);
    }
    body_.emit(Opcode::bit_xor, was_not, before, one);
    body_.emit(Opcode::bit_and, slot, now, was_not);
    body_.emit(Opcode::move, before, now);
  }
  body_.release();
}

bool UnitCompiler::constant(Expression& value, const DataType& type, Slot* to) {
  const std::size_t before = declarations_.mistakes();
  body_.at = value.at;
  const Value found = expression(value, &type);
  if (declarations_.mistakes() != before || found.type == nullptr || body_.is_too_large) return false;
  const std::uint32_t result = body_.reserve(type.slots);
  if (type.is_scalar()) {
    body_.emit(Opcode::move, result, found.slot);
  } else {
    body_.image[result] = program::string_header(0, type.capacity);
    const std::uint32_t arguments = body_.reserve(2);
    body_.emit(Opcode::address, arguments, result);
    body_.emit(Opcode::move, arguments + 1, found.slot);
    const char* const assign = type.base == Elementary::string ? "ASSIGN_STRING" : "ASSIGN_WSTRING";
    body_.emit(Opcode::native, declarations_.native(program::native_named(assign)), arguments);
  }
  body_.emit(Opcode::end);
  std::vector<Slot> memory = body_.image;
  program::Execution execution{
      body_.code, body_.positions, declarations_.program(), memory, body_.image, nullptr, 0, 10'000};
  if (const auto fault = program::execute(execution, 0, 0)) {
    error(value.at, "expected a value that can be computed: " + fault_text({}, *fault));
    return false;
  }
  std::copy_n(memory.begin() + result, type.slots, to);
  return true;
}

// Statements

void UnitCompiler::statements(const Statements& list) {
  for (const Statement& each : list) {
    body_.release();
    body_.at = each.at;
    statement(each);
    if (body_.is_too_large) return;
  }
  body_.release();
}

void UnitCompiler::statement(const Statement& statement) {
  using Kind = Statement::Kind;
  switch (statement.kind) {
    case Kind::assign: return assign(*statement.target, *statement.value);
    case Kind::call: return call_statement(*statement.target);
    case Kind::if_: return if_(statement);
    case Kind::case_: return case_(statement);
    case Kind::for_: return for_(statement);
    case Kind::while_: return while_(statement);
    case Kind::repeat: return repeat(statement);
    case Kind::exit:
      if (loops_.empty()) return error(statement.at, "expected EXIT within FOR, WHILE or REPEAT");
      loops_.back().exits.push_back(body_.emit(Opcode::jump));
      return;
    case Kind::continue_:
      if (loops_.empty()) return error(statement.at, "expected CONTINUE within FOR, WHILE or REPEAT");
      loops_.back().continues.push_back(body_.emit(Opcode::jump));
      return;
    case Kind::return_: body_.emit(Opcode::return_); return;
  }
}

void UnitCompiler::assign(Expression& target_expression, Expression& value) {
  Place to = place(target_expression);
  if (to.kind == Place::Kind::device) {
    // A word device takes what its words can hold: INT, UINT or WORD.
    const DataType* const device = natural(target_expression);
    const DataType* const wanted = natural(value);
    if (device != nullptr && wanted != nullptr &&
        (device == &open_types().word || device == &open_types().double_word)) {
      to.type = resolved(device, wanted, target_expression);
      to.device.type = to.type->base;
    }
  }
  if (to.kind == Place::Kind::none) {
    (void)natural(value);
    return;
  }
  if (to.is_constant) return error(target_expression.at, std::string(to.why_constant));
  if (is_device_array(to)) return error(target_expression.at, std::string(expected_element));
  if (to.type->form == DataType::Form::block)
    return error(target_expression.at, "expected a variable: a function block cannot be assigned");
  const bool is_direct = to.kind == Place::Kind::frame && to.type->is_scalar();
  const Value from = expression(value, to.type, is_direct ? to.slot : nowhere);
  if (from.type == nullptr) return;
  if (is_direct && from.slot == to.slot) return;
  assign_value(to, from, value.at);
}

void UnitCompiler::assign_value(const Place& to, Value value, SourcePosition at) {
  if (to.type->is_scalar()) return store(to, value);
  if (to.type->is_string()) {
    const std::uint32_t arguments = body_.temporary(2);
    body_.emit(Opcode::move, arguments, address_of(to));
    body_.emit(Opcode::move, arguments + 1, value.slot);
    const char* const name = to.type->base == Elementary::string ? "ASSIGN_STRING" : "ASSIGN_WSTRING";
    body_.emit(Opcode::native, declarations_.native(program::native_named(name)), arguments);
    return;
  }
  if (!program::same_type(*to.type, *value.type))
    return error(at, "expected " + to.type->name + ", found " + value.type->name);
  body_.emit(Opcode::copy_at, address_of(to), value.slot, to.type->slots);
}

bool UnitCompiler::has_call(const Expression& expression) {
  if (expression.enable != nullptr || expression.enable_output != nullptr) return true;
  if (expression.kind == Expression::Kind::call) return true;
  return std::ranges::any_of(expression.children,
                             [this](const ExpressionPtr& child) { return has_call(*child); });
}

/// Neither a change nor an error can come of it: it may be left out.
bool UnitCompiler::has_no_effect(const Expression& expression) {
  using Kind = Expression::Kind;
  if (expression.enable != nullptr || expression.enable_output != nullptr) return false;
  switch (expression.kind) {
    case Kind::integer:
    case Kind::real:
    case Kind::typed_literal: return true;
    case Kind::name:
      return is_variable(expression.name) || expression.name == "TRUE" || expression.name == "FALSE";
    case Kind::member: return has_no_effect(*expression.children.front());
    case Kind::unary: return has_no_effect(*expression.children.front());
    case Kind::binary:
      return expression.name != "/" && expression.name != "MOD" && expression.name != "**" &&
             has_no_effect(*expression.children[0]) && has_no_effect(*expression.children[1]);
    default: return false;
  }
}

std::vector<std::size_t> UnitCompiler::jump_unless(Expression& condition) {
  const DataType* const boolean = type(Elementary::boolean);
  if (condition.kind == Expression::Kind::binary && condition.name == "AND" &&
      natural(condition) == boolean && has_no_effect(*condition.children[1])) {
    std::vector<std::size_t> jumps = jump_unless(*condition.children[0]);
    const std::vector<std::size_t> more = jump_unless(*condition.children[1]);
    jumps.insert(jumps.end(), more.begin(), more.end());
    return jumps;
  }
  if (condition.kind == Expression::Kind::unary && condition.name == "NOT") {
    const Value value = expression(*condition.children[0], boolean);
    return {body_.emit(Opcode::jump_if, value.slot)};
  }
  const Value value = expression(condition, boolean);
  // A comparison of integers right before becomes part of the jump.
  if (!body_.code.empty() && value.type != nullptr) {
    const program::Instruction last = body_.code.back();
    struct Fused {
      Opcode compare, jump;
      bool swaps;
    };
    constexpr std::array fused = {
        Fused{Opcode::eq, Opcode::jump_ne, false},  Fused{Opcode::ne, Opcode::jump_eq, false},
        Fused{Opcode::lt, Opcode::jump_le, true},   Fused{Opcode::le, Opcode::jump_lt, true},
        Fused{Opcode::ltu, Opcode::jump_leu, true}, Fused{Opcode::leu, Opcode::jump_ltu, true}};
    const auto* const found = std::ranges::find(fused, last.code, &Fused::compare);
    if (found != fused.end() && last.a == value.slot && condition.kind == Expression::Kind::binary) {
      body_.code.pop_back();
      body_.positions.pop_back();
      return {found->swaps ? body_.emit(found->jump, last.c, last.b)
                           : body_.emit(found->jump, last.b, last.c)};
    }
  }
  return {body_.emit(Opcode::jump_unless, value.slot)};
}

void UnitCompiler::if_(const Statement& statement) {
  std::vector<std::size_t> ends;
  for (const Branch& branch : statement.branches) {
    std::vector<std::size_t> skips;
    body_.at = branch.at;
    if (branch.condition != nullptr) skips = jump_unless(*branch.condition);
    statements(branch.body);
    if (&branch != &statement.branches.back()) ends.push_back(body_.emit(Opcode::jump));
    for (const std::size_t skip : skips) body_.land(skip);
  }
  for (const std::size_t end : ends) body_.land(end);
}

void UnitCompiler::case_(const Statement& statement) {
  const DataType* selector_type = natural(*statement.value);
  if (selector_type == nullptr) return;
  selector_type = resolved(selector_type, nullptr, *statement.value);
  if (!selector_type->is_scalar() || program::info(selector_type->base).family == Family::real)
    return error(statement.value->at, "expected an integer or an enumeration, found " + selector_type->name);
  const Value value = expression(*statement.value, selector_type);
  if (value.type == nullptr) return;
  // Statements of a branch use its slots again: it is compared before them all.
  struct Entry {
    const Branch* branch;
    std::vector<std::size_t> jumps;
  };
  std::vector<Entry> entries;
  CaseLabels labels(program::info(selector_type->base).bits < 64 ||
                    program::info(selector_type->base).family == Family::signed_integer);
  const Branch* otherwise = nullptr;
  for (const Branch& branch : statement.branches) {
    if (branch.labels.empty()) {
      otherwise = &branch;
      continue;
    }
    Entry entry{&branch, {}};
    for (const TypeNode::Range& label : branch.labels) {
      Slot low = 0;
      Slot high = 0;
      body_.at = label.low->at;
      if (!declarations_.constant(*label.low, *selector_type, &low, unit_)) continue;
      if (label.high == nullptr) {
        if (const auto wrong = labels.add(low, low, label.low->at)) error(label.low->at, *wrong);
        entry.jumps.push_back(body_.emit(Opcode::jump_eq, value.slot, body_.constant(low)));
        continue;
      }
      if (!declarations_.constant(*label.high, *selector_type, &high, unit_)) continue;
      if (const auto wrong = labels.add(low, high, label.low->at)) error(label.low->at, *wrong);
      const bool has_sign = labels.has_sign();
      const std::size_t below =
          body_.emit(has_sign ? Opcode::jump_lt : Opcode::jump_ltu, value.slot, body_.constant(low));
      entry.jumps.push_back(
          body_.emit(has_sign ? Opcode::jump_le : Opcode::jump_leu, value.slot, body_.constant(high)));
      body_.land(below);
    }
    entries.push_back(std::move(entry));
  }
  const std::size_t no_label = body_.emit(Opcode::jump);
  std::vector<std::size_t> ends;
  for (const Entry& entry : entries) {
    for (const std::size_t jump : entry.jumps) body_.land(jump);
    statements(entry.branch->body);
    ends.push_back(body_.emit(Opcode::jump));
  }
  body_.land(no_label);
  if (otherwise != nullptr) statements(otherwise->body);
  for (const std::size_t end : ends) body_.land(end);
}

void UnitCompiler::for_(const Statement& statement) {
  const Place variable = place(*statement.target);
  if (variable.kind == Place::Kind::none) return;
  if (variable.is_constant) return error(statement.target->at, std::string(variable.why_constant));
  const Family family =
      variable.type->is_scalar() ? program::info(variable.type->base).family : Family::string;
  if (family != Family::signed_integer && family != Family::unsigned_integer)
    return error(statement.target->at, "expected an integer variable, found " + variable.type->name);
  const DataType* const counted = type(variable.type->base);
  // The limit and the step are computed once [IEC 61131-3 7.3.3.4.2], and are kept beside each other.
  const std::uint32_t limits = body_.reserve(2);
  const bool is_frame =
      variable.kind == Place::Kind::frame && variable.type->form == DataType::Form::elementary;
  const std::uint32_t counter = is_frame ? variable.slot : body_.reserve(1);
  const Value first = expression(*statement.value, counted);
  const Value limit = expression(*statement.limit, counted);
  Value step;
  if (statement.step != nullptr) {
    // A step may be negative where the variable has no sign; its own type is then wider.
    step = expression(*statement.step, type(Elementary::lint));
    if (statement.step->kind == Expression::Kind::integer && statement.step->number == 0)
      error(statement.step->at, "expected a step that is not 0");
  } else {
    step = constant_value(1, type(Elementary::lint));
  }
  if (first.type == nullptr || limit.type == nullptr || step.type == nullptr || body_.is_too_large) return;
  body_.emit(Opcode::move, limits, limit.slot);
  body_.emit(Opcode::move, limits + 1, step.slot);
  body_.emit(Opcode::move, counter, first.slot);
  if (!is_frame) store(variable, {counted, counter});
  const std::size_t skip = body_.emit(Opcode::for_first, counter, limits);
  loops_.emplace_back();
  const std::size_t begin = body_.here();
  if (!is_frame) {
    body_.release();
    store(place(*statement.target), {counted, counter});
  }
  statements(statement.body);
  body_.at = statement.at;
  for (const std::size_t jump : loops_.back().continues) body_.land(jump);
  const std::size_t next = body_.emit(Opcode::for_next, counter, limits);
  body_.land(next, begin);
  // Behind the last round the variable is one step beyond the limit, or what becomes of that in its type.
  const Opcode wraps[] = {Opcode::wrap_i8, Opcode::wrap_i16, Opcode::wrap_i32, Opcode::move,
                          Opcode::wrap_u8, Opcode::wrap_u16, Opcode::wrap_u32, Opcode::move};
  const auto number = static_cast<std::size_t>(counted->base) - static_cast<std::size_t>(Elementary::sint);
  body_.emit(wraps[number], counter, counter);
  if (!is_frame) store(place(*statement.target), {counted, counter});
  for (const std::size_t jump : loops_.back().exits) body_.land(jump);
  body_.land(skip);
  loops_.pop_back();
}

void UnitCompiler::while_(const Statement& statement) {
  loops_.emplace_back();
  const std::size_t begin = body_.here();
  const std::vector<std::size_t> skips = jump_unless(*statement.value);
  statements(statement.body);
  body_.at = statement.at;
  for (const std::size_t jump : loops_.back().continues) body_.land(jump);
  const std::size_t again = body_.emit(Opcode::loop);
  body_.land(again, begin);
  for (const std::size_t jump : skips) body_.land(jump);
  for (const std::size_t jump : loops_.back().exits) body_.land(jump);
  loops_.pop_back();
}

void UnitCompiler::repeat(const Statement& statement) {
  loops_.emplace_back();
  const std::size_t begin = body_.here();
  statements(statement.body);
  body_.at = statement.value->at;
  for (const std::size_t jump : loops_.back().continues) body_.land(jump);
  const std::vector<std::size_t> again = jump_unless(*statement.value);
  const std::size_t done = body_.emit(Opcode::jump);
  for (const std::size_t jump : again) body_.land(jump);
  const std::size_t loop = body_.emit(Opcode::loop);
  body_.land(loop, begin);
  body_.land(done);
  for (const std::size_t jump : loops_.back().exits) body_.land(jump);
  loops_.pop_back();
}

}  // namespace canopus::structured_text
