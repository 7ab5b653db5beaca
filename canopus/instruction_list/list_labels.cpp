// Labels as operands: those that stand for a device, and those that are variables.

#include <algorithm>
#include <utility>

#include "canopus/ascii/words.hpp"
#include "canopus/instruction_list/list_compiler.hpp"

namespace canopus::instruction_list {

using program::DataType;
using Kinds = program::Family;

namespace {

program::Opcode wrap(program::Elementary type) {
  using program::Opcode;
  const program::ElementaryInfo& kind = program::info(type);
  const bool is_signed = kind.family == Kinds::signed_integer;
  switch (kind.bits) {
    case 8: return is_signed ? Opcode::wrap_i8 : Opcode::wrap_u8;
    case 16: return is_signed ? Opcode::wrap_i16 : Opcode::wrap_u16;
    case 32: return is_signed ? Opcode::wrap_i32 : Opcode::wrap_u32;
    default: return Opcode::move;
  }
}

bool is_integer(program::Elementary type) {
  switch (program::info(type).family) {
    case Kinds::signed_integer:
    case Kinds::unsigned_integer:
    case Kinds::bits: return true;
    default: return false;
  }
}

}  // namespace

// Local labels hide global ones. A bit of a label's word is written as that of a device: count.3.
std::expected<Operand, std::string> ListCompiler::operand_of(const std::string& text) {
  const auto named = [&](std::string_view name) -> const Label* {
    const Label* found = nullptr;
    for (const Label& label : shared_.labels) {
      const bool is_local = ascii::equal_ignoring_case(label.program, name_);
      if (!ascii::equal_ignoring_case(label.name, name) || (!label.program.empty() && !is_local)) continue;
      if (found == nullptr || is_local) found = &label;
    }
    return found;
  };
  std::string_view bit;
  std::string_view name = text;
  const Label* label = named(name);
  if (const std::size_t point = text.rfind('.'); label == nullptr && point != std::string::npos) {
    label = named(name.substr(0, point));
    bit = name.substr(point);
  }
  if (label != nullptr && !label->device.empty()) {
    auto operand = parse_operand(label->device + std::string(bit), shared_.family);
    if (operand) operand->written = text;
    return operand;
  }
  if (label != nullptr && !bit.empty())
    return std::unexpected("it is a variable; expected a label with a device for a bit");
  if (label != nullptr && !label->program.empty()) return variable_of(*label, text);
  const auto& symbols = shared_.program.symbols;
  const auto global = std::ranges::find_if(symbols, [&](const program::Symbol& symbol) {
    return !symbol.is_program && ascii::equal_ignoring_case(symbol.name, text);
  });
  const bool is_index_register =
      global != symbols.end() && shared_.index_registers && global->place - *shared_.index_registers < 8;
  if (global == symbols.end() || global->type->form != DataType::Form::elementary || is_index_register)
    return parse_operand(text, shared_.family);
  Operand made;
  made.kind = Operand::Kind::variable;
  made.written = text;
  made.number = global->place;
  made.type = global->type->base;
  made.is_constant_variable = global->is_constant;
  return made;
}

std::expected<Operand, std::string> ListCompiler::variable_of(const Label& label, const std::string& text) {
  const auto type = program::elementary_named(label.type);
  if (!type || program::info(*type).family == Kinds::string)
    return std::unexpected("its type is " + label.type +
                           "; expected an elementary one, or a label with a device");
  Operand made;
  made.kind = Operand::Kind::variable;
  made.written = text;
  made.type = *type;
  made.is_local = true;
  const auto [found, is_new] = local_variables_.try_emplace(ascii::upper(label.name), 0);
  if (is_new) {
    found->second = reserve(1);
    shared_.program.types.push_back({.form = DataType::Form::elementary, .base = *type, .name = label.type});
    members_.push_back({.name = label.name, .type = &shared_.program.types.back(), .offset = found->second});
  }
  made.number = found->second;
  return made;
}

bool ListCompiler::fits(const Operand& variable, Elementary type) {
  const bool fits = variable.type == type || (is_integer(variable.type) && is_integer(type) &&
                                              program::info(variable.type).bits == program::info(type).bits);
  if (!fits)
    operand_error(variable, "it is " + std::string(program::info(variable.type).name) + "; expected " +
                                std::string(program::info(type).name));
  return fits;
}

std::optional<std::uint32_t> ListCompiler::load_variable(const Operand& variable, Elementary type) {
  if (!fits(variable, type)) return std::nullopt;
  const std::uint32_t value = temporary();
  emit(variable.is_local ? Opcode::move : Opcode::load_global, value, variable.number);
  if (variable.type != type && wrap(type) != Opcode::move) emit(wrap(type), value, value);
  return value;
}

bool ListCompiler::store_variable(const Operand& variable, Elementary type, std::uint32_t value) {
  if (!fits(variable, type)) return false;
  if (variable.is_constant_variable) {
    operand_error(variable, "it is CONSTANT; expected a label that can be written");
    return false;
  }
  std::uint32_t wrapped = value;
  if (is_integer(type) && wrap(variable.type) != Opcode::move) {
    wrapped = temporary();
    emit(wrap(variable.type), wrapped, value);
  }
  emit(variable.is_local ? Opcode::move : Opcode::store_global, variable.number, wrapped);
  return true;
}

}  // namespace canopus::instruction_list
