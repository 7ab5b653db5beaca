#include "canopus/structured_text/declarations.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/structured_text/unit_compiler.hpp"

namespace canopus::structured_text {

using program::Family;
using program::MemberKind;

namespace {

constexpr std::size_t most_errors = 100;
constexpr unsigned deepest_type = 200;  // functions over a type call themselves for what it consists of
constexpr std::size_t longest_array_name = 200;  // each dimension has a name with those behind it
constexpr unsigned most_nested_globals = 100;    // each is declared while the one before it is
constexpr std::size_t most_members = 5000;       // of a structure, or values of an enumeration
constexpr std::uint32_t usual_string_length = 80;
constexpr std::uint32_t longest_string = 1024;

}  // namespace

Declarations::Declarations(program::Program& to, const program::DeviceNames* devices,
                           std::vector<SourceError>& errors)
    : program_(to), devices_(devices), errors_(errors) {
  for (std::size_t i = 0; i < program::elementary_count; ++i) {
    const auto base = static_cast<Elementary>(i);
    DataType type{.base = base, .name = std::string(program::info(base).name)};
    if (program::info(base).family == Family::string) {
      type.capacity = usual_string_length;
      type.slots = program::string_slots(type.capacity, program::info(base).bits);
    }
    elementary_.push_back(&make(std::move(type)));
  }
  add_standard_blocks();
}

DataType& Declarations::make(DataType type) {
  DataType& made = program_.types.emplace_back(std::move(type));
  if (made.form == DataType::Form::array) depths_[&made] = depth_of(*made.element) + 1;
  if (made.form == DataType::Form::structure) {
    unsigned deepest = 0;
    for (const program::Member& member : made.members) deepest = std::max(deepest, depth_of(*member.type));
    depths_[&made] = deepest + 1;
  }
  return made;
}

void Declarations::add_standard_blocks() {
  for (const program::StandardBlock& block : program::standard_blocks()) {
    DataType type{.form = DataType::Form::block, .name = std::string(block.name)};
    type.slots = 0;
    UnitInfo& unit = units_[block.name];
    for (const auto& [name, base, kind] : block.variables) {
      unit.members.emplace(name, type.members.size());
      type.members.push_back({std::string(name), elementary(base), type.slots++, kind});
    }
    unit.standard = &block;
    unit.progress = Progress::done;
    unit.type = &make(std::move(type));
    unit_of_type_[unit.type] = &unit;
  }
}

void Declarations::error(SourcePosition at, std::string message) {
  ++mistakes_;
  const auto place = std::pair(std::uint64_t{at.file} << 32U | at.line, std::uint32_t{at.column});
  if (!error_places_.insert(place).second || errors_.size() >= most_errors) return;
  errors_.push_back({at, std::move(message)});
}

void Declarations::add(const SyntaxTree& tree) {
  const auto is_taken = [this](std::string_view name) {
    return has_type(name) || units_.contains(name) || globals_.contains(name) ||
           program::elementary_named(name).has_value();
  };
  for (const TypeDeclaration& declaration : tree.types) {
    if (is_taken(declaration.name)) {
      error(declaration.at,
            "expected another name: " + std::string(declaration.written) + " is declared already");
      continue;
    }
    types_[declaration.name].node = &declaration;
  }
  for (const Unit& unit : tree.units) {
    if (is_taken(unit.name)) {
      error(unit.at, "expected another name: " + std::string(unit.written) + " is declared already");
      continue;
    }
    UnitInfo& info = units_[unit.name];
    info.unit = &unit;
    unit_order_.push_back(&info);
    for (const Unit& method : unit.methods) {
      UnitInfo& own = methods_.emplace_back();
      own.unit = &method;
      own.owner = &info;
      if (!info.methods.emplace(method.name, &own).second) {
        error(method.at, "expected another name: there is a method " + std::string(method.written));
        continue;
      }
      unit_order_.push_back(&own);
    }
  }
  for (const VariableSection& section : tree.globals) {
    for (const VariableNode& variable : section.variables) {
      if (is_taken(variable.name)) {
        error(variable.at,
              "expected another name: " + std::string(variable.written) + " is declared already");
        continue;
      }
      GlobalInfo& global = globals_[variable.name];
      global.node = &variable;
      global.section = &section;
      global_order_.push_back(variable.name);
    }
  }
}

void Declarations::compile_all() {
  for (auto& [name, named] : types_) (void)type_named(name, named.node->at);
  for (const std::string_view name : global_order_) (void)global_named(name, globals_[name].node->at);
  for (UnitInfo* unit : unit_order_) (void)require(*unit, unit->unit->at);
  for (const std::string_view name : global_order_) {
    const GlobalInfo& global = globals_[name];
    if (global.progress != Progress::done || global.located) continue;
    program_.symbols.push_back({std::string(global.node->written), global.type, global.place, false,
                                global.section->is_constant, global.section->is_retained});
  }
  for (UnitInfo* unit : unit_order_) {
    if (unit->progress != Progress::done || unit->unit->kind != Unit::Kind::program) continue;
    const program::Function& function = program_.functions[unit->function];
    program_.symbols.push_back({function.name, unit->type, function.frame, true});
    program_.programs.push_back(unit->function);
  }
}

// Types

bool Declarations::has_type(std::string_view name) const { return types_.contains(name); }

const DataType* Declarations::string_of(bool is_wide, std::uint32_t capacity) {
  const DataType*& known = strings_[{is_wide, capacity}];
  if (known != nullptr) return known;
  const Elementary base = is_wide ? Elementary::wstring : Elementary::string;
  DataType type{.base = base,
                .name = std::string(program::info(base).name) + '[' + std::to_string(capacity) + ']'};
  type.capacity = capacity;
  type.slots = program::string_slots(capacity, program::info(base).bits);
  return known = &make(std::move(type));
}

const DataType* Declarations::type_named(std::string_view name, SourcePosition at) {
  if (const auto base = program::elementary_named(name)) return elementary(*base);
  if (const auto found = types_.find(name); found != types_.end()) {
    NamedType& named = found->second;
    if (named.progress == Progress::begun) {
      error(at, "expected a type that does not contain itself: " + std::string(named.node->written));
      return nullptr;
    }
    if (named.progress != Progress::untouched) return named.type;
    named.progress = Progress::begun;
    const DataType* const type = type_of(*named.node->type, nullptr);
    named.progress = Progress::failed;
    if (type == nullptr) return nullptr;
    // Its own name, and maybe its own initial value.
    if (!may_hold(type->slots, named.node->at)) return nullptr;
    DataType copy = *type;
    copy.name = named.node->written;
    DataType& own = make(std::move(copy));
    if (own.form == DataType::Form::block) {
      error(named.node->at, "expected a data type, not a function block");
      return nullptr;
    }
    if (own.form == DataType::Form::enumeration) {
      for (const auto& [value_name, value] : own.values) {
        auto& values = enumeration_values_[ascii::upper(value_name)];
        std::erase_if(values, [&](const EnumerationValue& known) { return known.type == type; });
        values.push_back({&own, value});
      }
    }
    if (named.node->initial != nullptr) {
      std::vector<Slot> initial(own.slots);
      program::write_initial(own, initial.data());
      initialize(own, *named.node->initial, initial.data(), nullptr);
      own.initial = std::move(initial);
    }
    named.type = &own;
    named.progress = Progress::done;
    return &own;
  }
  if (const auto found = units_.find(name); found != units_.end()) {
    UnitInfo& unit = found->second;
    const bool is_block = unit.unit == nullptr || unit.unit->kind == Unit::Kind::block;
    if (!is_block) {
      error(at, "expected a type or a function block, not a " + std::string(text_of(unit.unit->kind)));
      return nullptr;
    }
    return require(unit, at) ? unit.type : nullptr;
  }
  return nullptr;
}

const DataType* Declarations::type_of(const TypeNode& node, UnitInfo* scope) {
  if (const auto known = type_of_node_.find(&node); known != type_of_node_.end()) return known->second;
  if (nested_types_ >= deepest_type) {
    is_too_deep(node.at);
    return nullptr;
  }
  ++nested_types_;
  const DataType* const type = make_type(node, scope);
  --nested_types_;
  type_of_node_[&node] = type;
  return type;
}

unsigned Declarations::depth_of(const DataType& type) const {
  const auto found = depths_.find(&type);
  return found == depths_.end() ? 0 : found->second;
}

void Declarations::is_too_deep(SourcePosition at) {
  error(at, "expected at most " + std::to_string(deepest_type) +
                " arrays, structures and names of types within one another");
}

const DataType* Declarations::make_type(const TypeNode& node, UnitInfo* scope) {
  switch (node.kind) {
    case TypeNode::Kind::wrong: return nullptr;
    case TypeNode::Kind::named: {
      const DataType* const type = type_named(node.name, node.at);
      if (type == nullptr && !has_type(node.name) && !units_.contains(node.name))
        error(node.at, "expected a type, found '" + std::string(node.name) + "'");
      return type;
    }
    case TypeNode::Kind::string:
    case TypeNode::Kind::wide_string: {
      const bool is_wide = node.kind == TypeNode::Kind::wide_string;
      if (node.length == nullptr) return elementary(is_wide ? Elementary::wstring : Elementary::string);
      const auto length = integer_constant(*node.length, scope);
      if (!length) return nullptr;
      if (*length < 1 || *length > longest_string) {
        error(node.length->at, "expected a length from 1 to " + std::to_string(longest_string));
        return nullptr;
      }
      return string_of(is_wide, static_cast<std::uint32_t>(*length));
    }
    case TypeNode::Kind::array: return array_of(node, scope);
    case TypeNode::Kind::structure: return structure_of(node, scope);
    case TypeNode::Kind::enumeration: return enumeration_of(node, scope);
    case TypeNode::Kind::subrange: return subrange_of(node, scope);
  }
  return nullptr;
}

const DataType* Declarations::array_of(const TypeNode& node, UnitInfo* scope) {
  const DataType* element = type_of(*node.element, scope);
  if (element == nullptr) return nullptr;
  for (auto range = node.ranges.rbegin(); range != node.ranges.rend(); ++range) {
    if (depth_of(*element) >= deepest_type) {
      is_too_deep(node.at);
      return nullptr;
    }
    const auto low = integer_constant(*range->low, scope);
    const auto high = integer_constant(*range->high, scope);
    if (!low || !high) return nullptr;
    if (*low > *high || *high - *low >= static_cast<std::int64_t>(program::most_slots) ||
        *low < -0x80000000LL || *high > 0x7FFFFFFFLL) {
      error(range->low->at, "expected a first index and a last one that is not below it, and at most " +
                                std::to_string(program::most_slots) + " elements");
      return nullptr;
    }
    const std::uint64_t slots = static_cast<std::uint64_t>(*high - *low + 1) * element->slots;
    if (slots > program::most_slots) {
      error(node.at, "the array is too large: expected at most " + std::to_string(program::most_slots) +
                         " elements in all");
      return nullptr;
    }
    DataType array{.form = DataType::Form::array,
                   .slots = static_cast<std::uint32_t>(slots),
                   .low = *low,
                   .high = *high,
                   .element = element};
    array.name = "ARRAY[" + std::to_string(*low) + ".." + std::to_string(*high) + "] OF " + element->name;
    if (array.name.size() > longest_array_name)
      array.name.replace(longest_array_name, std::string::npos, "...");
    element = &make(std::move(array));
  }
  return element;
}

const DataType* Declarations::structure_of(const TypeNode& node, UnitInfo* scope) {
  if (node.fields.size() > most_members) {
    error(node.at, "expected at most " + std::to_string(most_members) + " elements");
    return nullptr;
  }
  DataType structure{.form = DataType::Form::structure, .name = "STRUCT"};
  structure.slots = 0;
  bool is_good = true;
  std::set<std::string_view> names;
  std::vector<std::pair<std::size_t, Expression*>> initial;
  for (const VariableNode& field : node.fields) {
    if (field.type == nullptr) continue;
    if (!names.insert(field.name).second)
      error(field.at, "expected another name: there is an element " + std::string(field.written));
    const DataType* const type = type_of(*field.type, scope);
    if (type != nullptr && type->form == DataType::Form::block) {
      error(field.at, "expected a data type: a structure has no function blocks");
      is_good = false;
      continue;
    }
    if (type != nullptr && depth_of(*type) >= deepest_type) {
      is_too_deep(field.at);
      is_good = false;
      continue;
    }
    if (type == nullptr || structure.slots + type->slots > program::most_slots) {
      if (type != nullptr) error(field.at, "the structure is too large");
      is_good = false;
      continue;
    }
    if (field.initial != nullptr) initial.emplace_back(structure.members.size(), field.initial.get());
    structure.members.push_back({std::string(field.written), type, structure.slots});
    structure.slots += type->slots;
  }
  if (node.fields.empty()) error(node.at, "expected at least one element");
  if (!is_good || node.fields.empty() || !may_hold(structure.slots, node.at)) return nullptr;
  std::vector<Slot> values(structure.slots);
  program::write_initial(structure, values.data());
  for (const auto& [number, value] : initial) {
    const program::Member& member = structure.members[number];
    initialize(*member.type, *value, values.data() + member.offset, scope);
  }
  structure.initial = std::move(values);
  return &make(std::move(structure));
}

const DataType* Declarations::enumeration_of(const TypeNode& node, UnitInfo* scope) {
  if (node.values.size() > most_members) {
    error(node.at, "expected at most " + std::to_string(most_members) + " values");
    return nullptr;
  }
  DataType type{.form = DataType::Form::enumeration, .base = Elementary::dint, .name = "enumeration"};
  if (!node.name.empty()) {
    const auto base = program::elementary_named(node.name);
    if (!base || program::info(*base).family > Family::bits || *base == Elementary::boolean) {
      error(node.at, "expected an integer type before the values");
      return nullptr;
    }
    type.base = *base;
  }
  std::int64_t next = 0;
  std::set<std::string> names;  // in capitals
  for (const TypeNode::Value& value : node.values) {
    if (value.number != nullptr) {
      const auto number = integer_constant(*value.number, scope);
      if (!number) return nullptr;
      next = *number;
    }
    if (!program::is_value({.base = type.base}, std::array{static_cast<Slot>(next)})) {
      error(value.at, "expected a value within the range of " + std::string(program::info(type.base).name) +
                          ", found " + std::to_string(next));
      return nullptr;
    }
    if (!names.insert(ascii::upper(value.name)).second)
      error(value.at, "expected another name: there is a value " + std::string(value.written));
    type.values.emplace_back(value.written, next);
    if (next < std::numeric_limits<std::int64_t>::max()) ++next;
  }
  if (type.values.empty()) return nullptr;
  const DataType& made = make(std::move(type));
  for (const auto& [name, number] : made.values)
    enumeration_values_[ascii::upper(name)].push_back({&made, number});
  return &made;
}

const DataType* Declarations::subrange_of(const TypeNode& node, UnitInfo* scope) {
  const DataType* const base = type_named(node.name, node.at);
  const auto low = integer_constant(*node.ranges.front().low, scope);
  const auto high = integer_constant(*node.ranges.front().high, scope);
  const bool is_integer = base != nullptr && base->form == DataType::Form::elementary &&
                          (program::info(base->base).family == Family::signed_integer ||
                           program::info(base->base).family == Family::unsigned_integer);
  if (!is_integer) {
    error(node.at, "expected an integer type before the range");
    return nullptr;
  }
  if (!low || !high) return nullptr;
  const bool is_signed = program::info(base->base).family == Family::signed_integer;
  const unsigned bits = program::info(base->base).bits;
  const std::int64_t least =
      is_signed ? (bits == 64 ? std::numeric_limits<std::int64_t>::min() : -(1LL << (bits - 1))) : 0;
  const std::int64_t most =
      bits == 64 ? std::numeric_limits<std::int64_t>::max() : (1LL << (is_signed ? bits - 1 : bits)) - 1;
  if (*low > *high || *low < least || *high > most) {
    error(node.ranges.front().low->at, "expected a range within " + base->name);
    return nullptr;
  }
  DataType type{.form = DataType::Form::subrange, .base = base->base, .low = *low, .high = *high};
  type.name = base->name + '(' + std::to_string(*low) + ".." + std::to_string(*high) + ')';
  return &make(std::move(type));
}

const std::vector<EnumerationValue>* Declarations::enumeration_values(std::string_view name) const {
  const auto found = enumeration_values_.find(name);
  return found == enumeration_values_.end() ? nullptr : &found->second;
}

// Units and variables

UnitInfo* Declarations::unit_named(std::string_view name) {
  const auto found = units_.find(name);
  return found == units_.end() ? nullptr : &found->second;
}

UnitInfo* Declarations::unit_of(const DataType& block) {
  const auto found = unit_of_type_.find(&block);
  return found == unit_of_type_.end() ? nullptr : found->second;
}

bool Declarations::require(UnitInfo& unit, SourcePosition at) {
  if (unit.progress == Progress::begun) {
    error(at, std::string(unit.unit->written) +
                  " is used by itself: a function or function block does not call itself");
    return false;
  }
  if (unit.progress == Progress::untouched) {
    if (depth_ >= program::most_nested_calls) {
      error(at, "expected at most " + std::to_string(program::most_nested_calls) +
                    " units that call each other in a row");
      return false;
    }
    ++depth_;
    unit.progress = Progress::begun;
    const std::size_t before = mistakes_;
    compile_unit(unit);
    unit.progress = mistakes_ == before ? Progress::done : Progress::failed;
    --depth_;
  }
  return unit.progress == Progress::done;
}

void Declarations::compile_unit(UnitInfo& unit) {
  // A method needs its block's variables, which are declared before anything calls it.
  if (unit.owner != nullptr && unit.owner->progress != Progress::begun &&
      !require(*unit.owner, unit.unit->at))
    return failed();
  DataType& type = make({.form = DataType::Form::block, .name = std::string(unit.unit->written)});
  type.slots = 0;
  unit.type = &type;
  unit_of_type_[&type] = &unit;
  UnitCompiler compiler(*this, &unit);
  (void)compiler.compile_unit();
}

GlobalInfo* Declarations::global_named(std::string_view name, SourcePosition at) {
  const auto found = globals_.find(name);
  if (found == globals_.end()) return nullptr;
  GlobalInfo& global = found->second;
  if (global.progress == Progress::begun) {
    error(at, "the value of " + std::string(global.node->written) + " depends on itself");
    return nullptr;
  }
  if (global.progress == Progress::untouched) {
    if (nested_globals_ >= most_nested_globals) {
      error(at, "expected at most " + std::to_string(most_nested_globals) +
                    " global variables that need each other in a row");
      return nullptr;
    }
    global.progress = Progress::begun;
    const std::size_t before = mistakes_;
    ++nested_globals_;
    declare(global);
    --nested_globals_;
    global.progress = mistakes_ == before ? Progress::done : Progress::failed;
  }
  return global.progress == Progress::done ? &global : nullptr;
}

void Declarations::declare(GlobalInfo& global) {
  const VariableNode& node = *global.node;
  if (node.type == nullptr) return error(node.at, "expected a type");
  const DataType* const type = type_of(*node.type, nullptr);
  if (type == nullptr) return failed();
  global.type = type;
  if (!node.location.empty()) {
    global.located = locate(node, *type);
    return;
  }
  if (!may_hold(type->slots, node.at)) return;
  std::vector<Slot> initial(type->slots);
  program::write_initial(*type, initial.data());
  if (node.initial != nullptr) initialize(*type, *node.initial, initial.data(), nullptr);
  if (program_.initial.size() + initial.size() > program::most_slots)
    return error(node.at, "the program's variables need more memory than " +
                              std::to_string(program::most_slots * sizeof(Slot)) + " bytes");
  global.place = allocate(type->slots);
  std::ranges::copy(initial, program_.initial.begin() + global.place);
}

std::optional<DeviceAccess> Declarations::locate(const VariableNode& node, const DataType& type) {
  const DataType* element = &type;
  while (element->form == DataType::Form::array) element = element->element;
  const auto wrong = [&](SourcePosition at, std::string message) {
    error(at, std::move(message));
    return std::nullopt;
  };
  if (!element->is_scalar())
    return wrong(node.at, "expected an elementary type, or an array of one: a device is one value");
  if (node.initial != nullptr)
    return wrong(node.initial->at, "expected no initial value: a device keeps its own");
  auto access = device(node.location, element->name, node.location_at);
  if (access && element != &type && access->form == DeviceAccess::Form::bit_of_word)
    return wrong(node.location_at, "expected a device without a point for an array");
  return access;
}

bool Declarations::may_hold(std::size_t slots, SourcePosition at) {
  held_ += slots;
  if (held_ <= 2 * program::most_slots) return true;
  error(at, "the types and variables of the program need too much memory");
  return false;
}

std::uint32_t Declarations::allocate(std::uint32_t slots) {
  const auto place = static_cast<std::uint32_t>(program_.initial.size());
  program_.initial.resize(program_.initial.size() + slots);
  return place;
}

// Initial values

bool Declarations::constant(Expression& value, const DataType& type, Slot* to, UnitInfo* scope) {
  UnitCompiler compiler(*this, scope, true);
  return compiler.constant(value, type, to);
}

std::optional<std::int64_t> Declarations::integer_constant(Expression& value, UnitInfo* scope) {
  Slot slot = 0;
  if (!constant(value, *elementary(Elementary::lint), &slot, scope)) return std::nullopt;
  return static_cast<std::int64_t>(slot);
}

void Declarations::initialize(const DataType& type, Expression& value, Slot* to, UnitInfo* scope) {
  if (type.is_scalar() || type.is_string()) {
    if (value.kind == Expression::Kind::list || value.kind == Expression::Kind::fields)
      return error(value.at, "expected a value of type " + type.name);
    (void)constant(value, type, to, scope);
    return;
  }
  if (type.form == DataType::Form::array) return initialize_array(type, value, to, scope);
  if (value.kind != Expression::Kind::fields) {
    if (value.kind == Expression::Kind::wrong) return;
    return error(value.at, "expected (element := value, ...)");
  }
  for (Argument& field : value.arguments) {
    const program::Member* const member = type.member(field.name);
    const bool is_settable =
        member != nullptr && (member->kind == MemberKind::field || member->kind == MemberKind::input ||
                              member->kind == MemberKind::output || member->kind == MemberKind::local);
    if (!is_settable) {
      error(field.at, type.name + " has no element " + std::string(field.name));
    } else if (field.value != nullptr) {
      initialize(*member->type, *field.value, to + member->offset, scope);
    }
  }
}

void Declarations::expand(Expression& list, std::vector<Expression*>& to, std::size_t most) {
  for (const ExpressionPtr& child : list.children) {
    if (child->kind != Expression::Kind::repeat) {
      if (to.size() <= most) to.push_back(child.get());
      continue;
    }
    for (std::uint64_t i = 0; i < child->number && to.size() <= most; ++i) {
      for (const ExpressionPtr& repeated : child->children) to.push_back(repeated.get());
      if (child->children.empty()) break;
    }
  }
}

void Declarations::initialize_array(const DataType& type, Expression& value, Slot* to, UnitInfo* scope) {
  if (value.kind != Expression::Kind::list) {
    if (value.kind == Expression::Kind::wrong) return;
    return error(value.at, "expected [value, value, ...]");
  }
  // Several dimensions may be one list: the last index changes first.
  const DataType* element = type.element;
  const bool is_nested =
      !value.children.empty() && (value.children.front()->kind == Expression::Kind::list ||
                                  (value.children.front()->kind == Expression::Kind::repeat &&
                                   !value.children.front()->children.empty() &&
                                   value.children.front()->children.front()->kind == Expression::Kind::list));
  while (!is_nested && element->form == DataType::Form::array) element = element->element;
  const std::size_t most = element->slots == 0 ? 0 : type.slots / element->slots;
  std::vector<Expression*> values;
  expand(value, values, most);
  if (values.size() > most) return error(value.at, "expected at most " + std::to_string(most) + " values");
  const Expression* last = nullptr;
  for (Expression* each : values) {
    if (each == last) {
      std::copy_n(to - element->slots, element->slots, to);  // of a repetition
    } else {
      initialize(*element, *each, to, scope);
    }
    last = each;
    to += element->slots;
  }
}

// Devices

bool Declarations::looks_like_device(std::string_view text) const {
  if (devices_ == nullptr) return false;
  if (text.starts_with('%') || text.contains('\\')) return true;
  if (text.size() > 2 && text[0] == 'K' && ascii::is_digit(text[1]) &&
      devices_->looks_like_device(text.substr(2)))
    return true;
  const std::size_t index = text.rfind('Z');
  if (index != std::string_view::npos && index > 1) text = text.substr(0, index);
  return devices_->looks_like_device(text);
}

std::optional<DeviceAccess> Declarations::device(std::string_view text, std::string_view type,
                                                 SourcePosition at) {
  DeviceAccess access;
  access.text = text;
  const auto wrong = [&](const std::string& what) {
    error(at, std::string(text) + ": " + what);
    return std::nullopt;
  };
  if (devices_ == nullptr)
    return wrong("expected a variable: the program is for no CPU, so it has no devices");
  std::string name(text);
  std::string iec_type;
  if (text.starts_with('%')) {
    // As GX Works writes them: %IX10 is X10, %MX0.5 M5, %MW0.100 D100, %MD0.100 two words from D100 on. Unverified.
    if (text.size() < 4) return wrong("expected an address such as %IX0, %QX0, %MX0.0 or %MW0.0");
    const char area = text[1];
    const char size = text[2];
    std::string_view number = text.substr(3);
    if (area == 'M') {
      const std::size_t point = number.find('.');
      if (point == std::string_view::npos || number.substr(0, point) != "0")
        return wrong("expected %MX0.n, %MW0.n or %MD0.n");
      number.remove_prefix(point + 1);
    }
    const char* const device = area == 'I' && size == 'X'                    ? "X"
                               : area == 'Q' && size == 'X'                  ? "Y"
                               : area == 'M' && size == 'X'                  ? "M"
                               : area == 'M' && (size == 'W' || size == 'D') ? "D"
                                                                             : nullptr;
    if (device == nullptr) return wrong("expected %IX, %QX, %MX, %MW or %MD");
    if (size == 'D' && type.empty()) iec_type = "DINT";
    name = device + std::string(number);
  }
  unsigned digits = 0;
  if (name.size() > 2 && name[0] == 'K' && name[1] >= '1' && name[1] <= '8' && !ascii::is_digit(name[2])) {
    digits = static_cast<unsigned>(name[1] - '0');
    name.erase(0, 2);
  }
  std::size_t bit_at = name.find('.');
  std::optional<unsigned> bit;
  if (bit_at != std::string::npos) {
    bit = bit_at + 2 == name.size() ? ascii::hex_value(name.back()) : std::nullopt;
    if (!bit) return wrong("expected a bit from 0 to F behind the point");
    name.resize(bit_at);
  }
  if (const std::size_t z = name.rfind('Z'); z != std::string::npos && z > 0 && z + 1 < name.size()) {
    const auto index = devices_->point(name.substr(z));
    if (!index) return wrong(index.error());
    access.is_indexed = true;
    access.index = *index;
    name.resize(z);
  }
  const auto point = devices_->point(name);
  if (!point) return wrong(point.error());
  access.point = *point;
  if (!iec_type.empty()) type = iec_type;

  std::optional<Elementary> wanted;
  if (!type.empty()) {
    constexpr std::pair<std::string_view, Elementary> letters[] = {{"U", Elementary::word},
                                                                   {"D", Elementary::dint},
                                                                   {"UD", Elementary::dword},
                                                                   {"E", Elementary::real},
                                                                   {"ED", Elementary::lreal}};
    for (const auto& [letter, meaning] : letters)
      if (type == letter) wanted = meaning;
    if (!wanted) wanted = program::elementary_named(type);
    if (!wanted && has_type(ascii::upper(type))) {
      const DataType* const named = type_named(ascii::upper(type), at);
      if (named != nullptr) wanted = named->base;
    }
    if (!wanted) {
      const std::string base(type.substr(0, type.find('(')));
      wanted = program::elementary_named(base);
    }
    if (!wanted || program::info(*wanted).family == Family::string)
      return wrong("expected an elementary type for it, found " + std::string(type));
  }
  const unsigned bits = wanted ? program::info(*wanted).bits : 0;
  if (bit) {
    if (access.point.is_bit)
      return wrong(text.starts_with('%') ? "expected one number behind %IX and %QX, as in %IX10"
                                         : "expected a word device before the point");
    if (wanted && bits != 1) return wrong("expected BOOL for a bit");
    access.form = DeviceAccess::Form::bit_of_word;
    access.count = static_cast<std::uint8_t>(*bit);
    access.type = Elementary::boolean;
  } else if (digits != 0) {
    if (!access.point.is_bit) return wrong("expected a bit device behind K" + std::to_string(digits));
    if (wanted && (bits == 1 || bits > 32 || 4 * digits > bits))
      return wrong("expected a type with room for its points");
    access.form = DeviceAccess::Form::points;
    access.count = static_cast<std::uint8_t>(4 * digits);
    access.type = wanted.value_or(digits <= 4 ? Elementary::int_ : Elementary::dint);
  } else if (access.point.is_bit) {
    if (wanted && bits != 1 && bits != 16 && bits != 32)
      return wrong("expected BOOL, or a type of 16 or 32 bits for as many points");
    access.form = bits <= 1 ? DeviceAccess::Form::bit : DeviceAccess::Form::points;
    access.count = static_cast<std::uint8_t>(std::max(bits, 1U));
    access.type = wanted.value_or(Elementary::boolean);
  } else {
    if (wanted && bits < 16) return wrong("expected a type of 16, 32 or 64 bits for a word device");
    access.form = DeviceAccess::Form::words;
    access.count = static_cast<std::uint8_t>(wanted ? bits / 16 : 1);
    access.type = wanted.value_or(Elementary::int_);
  }
  return access;
}

// Tables

std::uint32_t Declarations::native(program::Native function) {
  const auto [found, is_new] =
      natives_.try_emplace(function, static_cast<std::uint32_t>(program_.natives.size()));
  if (is_new) program_.natives.push_back(function);
  return found->second;
}

std::uint32_t Declarations::add_element(program::ElementAccess element) {
  program_.elements.push_back(element);
  return static_cast<std::uint32_t>(program_.elements.size() - 1);
}

std::uint32_t Declarations::add_device(DeviceAccess device) {
  program_.devices.push_back(std::move(device));
  return static_cast<std::uint32_t>(program_.devices.size() - 1);
}

}  // namespace canopus::structured_text
