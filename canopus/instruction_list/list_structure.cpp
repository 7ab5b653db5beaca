// Step ladders (STL) and interrupt programs.

#include <algorithm>
#include <utility>

#include "canopus/ascii/words.hpp"
#include "canopus/instruction_list/list_compiler.hpp"

namespace canopus::instruction_list {

namespace {

/// S0, but not SM0 and SD0.
bool is_state(const Operand& operand) {
  return operand.kind == Operand::Kind::device && operand.name.size() > 1 && operand.name[0] == 'S' &&
         ascii::is_digit(operand.name[1]) && operand.bit < 0 && operand.digits == 0;
}

}  // namespace

// A state that goes OFF is executed once more, with all conditions OFF, so that its outputs and timers go OFF.
void ListCompiler::begin_state() {
  if (!is_state(operands_[0]) || !operands_[0].index.empty())
    return operand_error(operands_[0], "expected a state such as S20");
  if (routine_ != 0)
    return error("STL in a subroutine or interrupt program; expected it in the main program");
  if (!master_controls_.empty()) return error("STL between MC and MCR; expected it behind MCR");
  std::vector<Operand> states;
  const bool follows_another = row_ > 0 && text_->instructions[row_ - 1].name == "STL" && state_.has_value();
  if (follows_another) states = state_->sources;
  end_state();
  depth_ = 0;
  has_output_ = false;
  constexpr std::size_t most_joined = 8;
  if (states.size() == most_joined) return error("expected at most 8 STL in a row");
  states.push_back(operands_[0]);
  const std::uint32_t before = state();
  const std::uint32_t active = state();
  emit(Opcode::move, active, constant(1));
  for (const Operand& each : states) {
    const auto on = load_bit(each);
    if (!on) return;
    emit(Opcode::bit_and, active, active, *on);
  }
  const std::uint32_t runs = temporary();
  emit(Opcode::bit_or, runs, before, active);
  emit(Opcode::move, before, active);
  state_ = StateBlock{.sources = std::move(states), .slot = active, .row = row_};
  state_->over = emit(Opcode::jump_unless, runs);
}

void ListCompiler::end_state() {
  if (!state_) return;
  if (depth_ > 1 || (depth_ == 1 && !has_output_))
    error("the result of the contacts above is not used; expected an output such as OUT");
  land(state_->over);
  state_.reset();
  depth_ = stored_ = 0;
}

// Both states are ON for the rest of the scan as far as their outputs go: those of the source go OFF when it is executed next.
bool ListCompiler::transfer(std::uint32_t when) {
  if (!state_ || !is_state(operands_[0])) return false;
  const std::size_t over = emit(Opcode::jump_unless, when);
  if (store_bit(operands_[0], constant(1)))
    for (const Operand& source : state_->sources)
      if (source.name != operands_[0].name && !store_bit(source, constant(0))) break;
  land(over);
  return true;
}

void ListCompiler::begin_interrupt(Interrupt& interrupt) {
  interrupt.entry = static_cast<std::uint32_t>(here());
  depth_ = stored_ = 0;
}

void ListCompiler::allow_interrupts(bool are_allowed) {
  emit(Opcode::store_global, shared_.interrupts.enabled(), constant(are_allowed ? 1 : 0));
  // Within a subroutine those that wait could be executed within themselves.
  if (are_allowed && routine_ == 0) emit(Opcode::call, shared_.interrupts.waiting());
}

void ListCompiler::add_interrupts(const std::string& name, std::uint32_t frame, std::uint32_t instructions) {
  for (const Interrupt& each : interrupts_) {
    const auto cause = interrupt_cause(each.name, shared_.family);
    if (!cause) continue;  // an error of find_routines()
    program::InterruptProgram made{
        .name = name + '.' + each.name, .every = cause->every, .is_falling = cause->is_falling};
    if (!cause->input.empty()) {
      const auto point = shared_.devices.point(cause->input);
      if (!point) {
        error(each.row, each.name + ": " + point.error());
        continue;
      }
      made.input = *point;
      made.input_name = cause->input;
    }
    std::optional<program::DevicePoint> mask;
    if (const auto point = shared_.devices.point(cause->mask); !cause->mask.empty() && point) mask = *point;
    made.function = static_cast<std::uint32_t>(shared_.program.functions.size());
    shared_.program.functions.push_back({made.name, each.entry.value_or(0), instructions, frame});
    shared_.interrupts.add(std::move(made), mask, {file_, 1, text_->instructions[each.row].line});
  }
}

}  // namespace canopus::instruction_list
