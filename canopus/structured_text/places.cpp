// Variables: where they are, and how they are read and written.

#include <algorithm>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/structured_text/unit_compiler.hpp"

namespace canopus::structured_text {

using program::Family;
using program::Member;
using program::MemberKind;

namespace {

/// TRUE, or a value of an enumeration.
Place literal_place(const DataType* type, Slot value) {
  Place found{.kind = Place::Kind::constant, .type = type, .value = value};
  found.is_constant = true;
  found.why_constant = "expected a variable";
  return found;
}

}  // namespace

bool UnitCompiler::is_constant_external(std::string_view name) const {
  if (unit_ == nullptr) return false;
  const auto found = unit_->externals.find(name);
  return found != unit_->externals.end() && found->second;
}

bool UnitCompiler::is_variable(std::string_view name) {
  const auto has = [name](const UnitInfo* scope) {
    return scope != nullptr && (scope->members.contains(name) || scope->located.contains(name));
  };
  return has(unit_) || (unit_ != nullptr && has(unit_->owner)) ||
         declarations_.global_named(name, body_.at) != nullptr;
}

Place UnitCompiler::device_place(const DeviceAccess& access, const DataType* array, bool is_constant) {
  Place found{.kind = Place::Kind::device, .is_constant = is_constant, .device = access};
  if (is_constant) found.why_constant = expected_variable;
  found.type = array != nullptr && !array->is_scalar() ? array : type(access.type);
  return found;
}

/// `place` is the member's, without regard to what it may be used for.
Place UnitCompiler::member_place(const UnitInfo& scope, const Member& member, Place place) {
  if (member.kind == MemberKind::in_out) {
    if (place.kind == Place::Kind::frame)
      return {.kind = Place::Kind::indirect, .type = member.type, .slot = place.slot};
    place.type = type(Elementary::lint);
    return {.kind = Place::Kind::indirect, .type = member.type, .slot = load(place).slot};
  }
  if (!member.is_constant) return place;
  place.is_constant = true;
  place.why_constant = expected_variable;
  if (!member.type->is_scalar()) return place;
  place.kind = Place::Kind::constant;
  place.value = scope.constants.at(member.offset);
  return place;
}

std::optional<Place> UnitCompiler::own_variable(Expression& expression) {
  const auto wrong = [&](const std::string& message) {
    error(expression.at, message);
    return Place{};
  };
  for (const UnitInfo* const scope :
       {static_cast<const UnitInfo*>(unit_),
        unit_ == nullptr ? nullptr : static_cast<const UnitInfo*>(unit_->owner)}) {
    if (scope == nullptr) break;
    const bool is_own = scope == unit_;
    if (const auto found = scope->members.find(expression.name); found != scope->members.end()) {
      const Member& member = scope->type->members[found->second];
      if (!is_own && member.kind == MemberKind::temporary) continue;
      Place place{.kind = Place::Kind::frame, .type = member.type, .slot = member.offset};
      if (!is_own)
        place = {
            .kind = Place::Kind::indirect, .type = member.type, .slot = this_slot, .offset = member.offset};
      if (constants_only_ && (!member.is_constant || member.kind == MemberKind::in_out))
        return wrong("expected a constant, found the variable " + std::string(expression.written));
      if (constants_only_ && !member.type->is_scalar())
        return wrong("expected a constant of an elementary type");
      return member_place(*scope, member, place);
    }
    if (const auto found = scope->located.find(expression.name); found != scope->located.end()) {
      const auto& [device, type, is_constant] = found->second;
      if (!constants_only_) return device_place(device, type, is_constant);
      return wrong("expected a constant, found the device " + device.text);
    }
  }
  return std::nullopt;
}

std::string UnitCompiler::what_it_is(std::string_view name) {
  if (const UnitInfo* const unit = declarations_.unit_named(name); unit != nullptr && unit->unit != nullptr)
    return unit->unit->kind == Unit::Kind::program
               ? ": it is a PROGRAM, whose variables are its own; use VAR_GLOBAL"
               : "";
  const bool is_decimal =
      name.size() > 1 && name[0] == 'K' && std::ranges::all_of(name.substr(1), ascii::is_digit);
  if (is_decimal) return "; expected " + std::string(name.substr(1));
  const bool is_hexadecimal = name.size() > 1 && name[0] == 'H' &&
                              name.find_first_not_of("0123456789ABCDEF", 1) == std::string_view::npos;
  return is_hexadecimal ? "; expected 16#" + std::string(name.substr(1)) : "";
}
Place UnitCompiler::named(Expression& expression) {
  const std::string_view name = expression.name;
  if (name == "TRUE" || name == "FALSE") {
    return literal_place(type(Elementary::boolean), name == "TRUE" ? 1U : 0U);
  }
  if (const auto own = own_variable(expression)) return *own;
  const std::size_t before = declarations_.mistakes();
  if (const GlobalInfo* const global = declarations_.global_named(name, expression.at); global != nullptr) {
    Place place{.kind = Place::Kind::global, .type = global->type, .offset = global->place};
    place.is_constant = global->section->is_constant || is_constant_external(name);
    if (place.is_constant) place.why_constant = expected_variable;
    if (global->section->is_constant) {
      if (global->type->is_scalar() && !global->located) {
        place.kind = Place::Kind::constant;
        place.value = declarations_.program().initial[global->place];
        return place;
      }
    }
    if (constants_only_) {
      error(expression.at, "expected a constant, found the variable " + std::string(expression.written));
      return {};
    }
    return global->located ? device_place(*global->located, global->type, place.is_constant) : place;
  }
  if (declarations_.mistakes() != before) return {};
  if (const auto* const values = declarations_.enumeration_values(name); values != nullptr) {
    if (values->size() > 1) {
      error(expression.at,
            "expected TYPE#" + std::string(expression.written) + ": several enumerations have this value");
      return {};
    }
    return literal_place(values->front().type, static_cast<Slot>(values->front().value));
  }
  if (declarations_.looks_like_device(name)) {
    if (constants_only_) {
      error(expression.at, "expected a constant, found the device " + std::string(expression.written));
      return {};
    }
    auto access = declarations_.device(name, {}, expression.at);
    return access ? device_place(*access) : Place{};
  }
  error(expression.at, "there is no variable " + std::string(expression.written) + what_it_is(name));
  return {};
}

/// Bits of an integer or bit string: x.3, x.%X3, x.%B1, x.%W0, x.%D1 [IEC 61131-3 6.5.5.2]; the first one's number.
std::optional<unsigned> UnitCompiler::partial_access(Expression& expression, const DataType& whole,
                                                     Elementary& part) {
  std::string_view text = expression.name;
  part = Elementary::boolean;
  unsigned size = 1;
  if (text.starts_with('%') && text.size() > 2) {
    switch (text[1]) {
      case 'X': break;
      case 'B': part = Elementary::byte, size = 8; break;
      case 'W': part = Elementary::word, size = 16; break;
      case 'D': part = Elementary::dword, size = 32; break;
      default: return std::nullopt;
    }
    text.remove_prefix(2);
  }
  const auto number = ascii::parse_number<unsigned>(text);
  const program::ElementaryInfo& kind = program::info(whole.base);
  const bool has_bits = kind.family == Family::bits || kind.family == Family::signed_integer ||
                        kind.family == Family::unsigned_integer;
  if (!number || !has_bits) return std::nullopt;
  if ((*number + 1) * size > kind.bits) {
    error(expression.at,
          "expected a number from 0 to " + std::to_string(kind.bits / size - 1) + " behind the point");
    return std::nullopt;
  }
  return *number * size;
}

Place UnitCompiler::member_of(const Place& whole, const Member& member) {
  Place found = whole;
  found.type = member.type;
  if (whole.kind == Place::Kind::frame)
    found.slot += member.offset;
  else
    found.offset += member.offset;
  if (member.kind == MemberKind::in_out) {
    Place reference = found;
    reference.type = type(Elementary::lint);
    found = {.kind = Place::Kind::indirect, .type = member.type, .slot = load(reference).slot};
  }
  return found;
}

const EnumerationValue* UnitCompiler::qualified_value(const Expression& member) {
  const Expression& base = *member.children.front();
  if (base.kind != Expression::Kind::name || is_variable(base.name)) return nullptr;
  const auto* const values = declarations_.enumeration_values(member.name);
  if (values == nullptr) return nullptr;
  const auto found = std::ranges::find_if(*values, [&](const EnumerationValue& value) {
    return ascii::equal_ignoring_case(value.type->name, base.name);
  });
  return found == values->end() ? nullptr : &*found;
}
Place UnitCompiler::member(Expression& expression) {
  Expression& base = *expression.children.front();
  if (const EnumerationValue* const value = qualified_value(expression); value != nullptr) {
    return literal_place(value->type, static_cast<Slot>(value->value));
  }
  // D100.3: a bit of a word device
  if (base.kind == Expression::Kind::name && !is_variable(base.name) &&
      declarations_.enumeration_values(base.name) == nullptr && declarations_.looks_like_device(base.name)) {
    auto access =
        declarations_.device(std::string(base.name) + '.' + std::string(expression.name), {}, expression.at);
    return access ? device_place(*access) : Place{};
  }
  if (is_this(base)) {
    if (const auto own = own_variable(expression)) return *own;
  }
  const Place whole = place(base);
  if (whole.kind == Place::Kind::none) return {};
  if (whole.type->is_scalar()) {
    Elementary part = Elementary::boolean;
    const std::size_t before = declarations_.mistakes();
    const auto bit = partial_access(expression, *whole.type, part);
    if (!bit) {
      if (declarations_.mistakes() == before)
        error(expression.at, whole.type->name + " has no element " + std::string(expression.written));
      return {};
    }
    Place found{.kind = Place::Kind::partial,
                .type = type(part),
                .whole = std::make_shared<Place>(whole),
                .first_bit = *bit};
    found.is_constant = whole.is_constant;
    found.why_constant = whole.why_constant;
    return found;
  }
  const Member* const member = whole.type->member(expression.name);
  const bool is_block = whole.type->form == DataType::Form::block;
  if (member == nullptr || member->kind == MemberKind::hidden ||
      (is_block && member->kind != MemberKind::input && member->kind != MemberKind::output)) {
    if (member != nullptr && member->kind != MemberKind::hidden) {
      error(expression.at,
            "expected an input or output of " + whole.type->name + ": " + member->name + " is its own");
    } else {
      error(expression.at, whole.type->name + " has no element " + std::string(expression.written));
    }
    return {};
  }
  Place found = member_of(whole, *member);
  if (is_block && member->kind == MemberKind::output) {
    found.is_constant = true;
    found.why_constant = "expected a variable: an output of a function block can only be read";
  }
  return found;
}

Place UnitCompiler::indexed(Expression& expression) {
  Place found = place(*expression.children.front());
  for (std::size_t i = 1; i < expression.children.size() && found.kind != Place::Kind::none; ++i) {
    if (found.type->form != DataType::Form::array) {
      error(expression.at, "expected an array before [, found " + found.type->name);
      return {};
    }
    found = element_of(found, *expression.children[i], i + 1 == expression.children.size());
  }
  return found;
}

Place UnitCompiler::element_of(Place array, Expression& index, bool is_last) {
  const DataType& kind = *array.type;
  const DataType* const open = natural(index);
  if (open == nullptr) return {};
  const DataType* const index_type = resolved(open, nullptr, index);
  const Family family = index_type->is_scalar() ? program::info(index_type->base).family : Family::string;
  if (family != Family::signed_integer && family != Family::unsigned_integer) {
    error(index.at, "expected an integer as an index, found " + index_type->name);
    return {};
  }
  Place found = array;
  found.type = kind.element;
  const auto constant_index = [&]() -> std::optional<std::int64_t> {
    if (index.kind == Expression::Kind::integer) return static_cast<std::int64_t>(index.number);
    if (index.kind == Expression::Kind::unary && index.name == "-" &&
        index.children.front()->kind == Expression::Kind::integer)
      return -static_cast<std::int64_t>(index.children.front()->number);
    return std::nullopt;
  }();
  if (constant_index) {
    if (*constant_index < kind.low || *constant_index > kind.high) {
      error(index.at,
            "expected an index from " + std::to_string(kind.low) + " to " + std::to_string(kind.high));
      return {};
    }
    const auto distance = static_cast<std::uint32_t>(*constant_index - kind.low) * kind.element->slots;
    if (array.kind == Place::Kind::device)
      found.device.point.number += distance * array.device.count;
    else if (array.kind == Place::Kind::frame)
      found.slot += distance;
    else
      found.offset += distance;
    return found;
  }
  const Value value = expression(index, index_type);
  if (value.type == nullptr) return {};
  program::ElementAccess access{
      .offset = array.slot, .size = kind.element->slots, .low = kind.low, .high = kind.high};
  if (array.kind == Place::Kind::device) {
    access.size *= array.device.count;  // points or words of an element
    if (!array.has_index) {
      found.slot = body_.temporary();
      body_.emit(Opcode::move, found.slot, body_.constant(0));
    }
    body_.emit(Opcode::index_at, found.slot, value.slot, declarations_.add_element(access));
    found.has_index = true;
    return found;
  }
  if (array.kind == Place::Kind::frame && kind.element->is_scalar() && is_last) {
    found.kind = Place::Kind::element;
    found.slot = value.slot;
    found.offset = declarations_.add_element(access);
    return found;
  }
  const std::uint32_t at = body_.temporary();
  if (array.kind == Place::Kind::frame || array.kind == Place::Kind::global) {
    const bool is_frame = array.kind == Place::Kind::frame;
    if (!is_frame) access.offset = array.offset;
    body_.emit(is_frame ? Opcode::element_address : Opcode::global_element_address, at, value.slot,
               declarations_.add_element(access));
  } else {
    body_.emit(Opcode::move, at, address_of(array));
    body_.emit(Opcode::index_at, at, value.slot, declarations_.add_element(access));
  }
  found.kind = Place::Kind::indirect;
  found.slot = at;
  found.offset = 0;
  return found;
}

Place UnitCompiler::place(Expression& expression) {
  using Kind = Expression::Kind;
  switch (expression.kind) {
    case Kind::name: return named(expression);
    case Kind::member: return member(expression);
    case Kind::index: return indexed(expression);
    case Kind::typed_device: {
      const Expression& base = *expression.children.front();
      auto access = declarations_.device(base.name, expression.name, expression.at);
      return access ? device_place(*access) : Place{};
    }
    case Kind::wrong: return {};
    default: error(expression.at, "expected a variable"); return {};
  }
}

std::uint32_t UnitCompiler::address_of(const Place& place) {
  switch (place.kind) {
    case Place::Kind::frame: {
      const std::uint32_t slot = body_.temporary();
      body_.emit(Opcode::address, slot, place.slot);
      return slot;
    }
    case Place::Kind::global: return body_.constant(place.offset);
    case Place::Kind::indirect: {
      if (place.offset == 0) return place.slot;
      const std::uint32_t slot = body_.temporary();
      body_.emit(Opcode::add_u64, slot, place.slot, body_.constant(place.offset));
      return slot;
    }
    case Place::Kind::element: {
      const std::uint32_t slot = body_.temporary();
      body_.emit(Opcode::element_address, slot, place.slot, place.offset);
      return slot;
    }
    default: return 0;
  }
}

Value UnitCompiler::load(const Place& place) {
  if (place.kind == Place::Kind::none) return {};
  if (place.kind == Place::Kind::constant) return constant_value(place.value, place.type);
  if (!place.type->is_scalar()) return {place.type, address_of(place)};
  switch (place.kind) {
    case Place::Kind::frame: return {place.type, place.slot};
    case Place::Kind::partial: {
      const Value whole = load(*place.whole);
      const std::uint32_t slot = body_.temporary();
      body_.emit(Opcode::shr, slot, whole.slot, body_.constant(place.first_bit));
      const unsigned bits = program::info(place.type->base).bits;
      body_.emit(Opcode::bit_and, slot, slot, body_.constant((Slot{1} << bits) - 1));
      return {place.type, slot};
    }
    default: break;
  }
  const std::uint32_t slot = body_.temporary();
  if (place.kind == Place::Kind::global) body_.emit(Opcode::load_global, slot, place.offset);
  if (place.kind == Place::Kind::indirect) body_.emit(Opcode::load_at, slot, place.slot, place.offset);
  if (place.kind == Place::Kind::element) body_.emit(Opcode::load_element, slot, place.slot, place.offset);
  if (place.kind == Place::Kind::device)
    body_.emit(Opcode::read_device, slot, declarations_.add_device(place.device), place.slot,
               place.has_index ? 1 : 0);
  return {place.type, slot};
}

void UnitCompiler::store(const Place& place, Value value) {
  switch (place.kind) {
    case Place::Kind::frame:
      if (place.slot != value.slot) body_.emit(Opcode::move, place.slot, value.slot);
      return;
    case Place::Kind::global: body_.emit(Opcode::store_global, place.offset, value.slot); return;
    case Place::Kind::indirect: body_.emit(Opcode::store_at, place.slot, value.slot, place.offset); return;
    case Place::Kind::element:
      body_.emit(Opcode::store_element, value.slot, place.slot, place.offset);
      return;
    case Place::Kind::device:
      body_.emit(Opcode::write_device, declarations_.add_device(place.device), value.slot, place.slot,
                 place.has_index ? 1 : 0);
      return;
    case Place::Kind::partial: {
      const Value whole = load(*place.whole);
      const unsigned bits = program::info(place.type->base).bits;
      const Slot mask = ((Slot{1} << bits) - 1) << place.first_bit;
      const std::uint32_t shifted = body_.temporary();
      const std::uint32_t rest = body_.temporary();
      body_.emit(Opcode::shl, shifted, value.slot, body_.constant(place.first_bit));
      body_.emit(Opcode::bit_and, rest, whole.slot, body_.constant(~mask));
      body_.emit(Opcode::bit_or, rest, rest, shifted);
      // An integer's sign may have changed, and a value has left its subrange.
      const Value changed = convert({type(Elementary::lword), rest}, place.whole->type, body_.at, true);
      return store(*place.whole, changed);
    }
    case Place::Kind::none:
    case Place::Kind::constant: return;
  }
}

}  // namespace canopus::structured_text
