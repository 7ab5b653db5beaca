#include "canopus/instruction_list/list_compiler.hpp"

#include <algorithm>
#include <utility>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/instruction_list/device_functions.hpp"

namespace canopus::instruction_list {

using program::DataType;
using program::DeviceAccess;
using Bits = device_functions::Rotation;

namespace {

constexpr std::size_t most_results = 64;  // open LD, and MPS
constexpr std::size_t most_routines = 4096;
constexpr std::uint32_t last_pointer = 4095;

bool is_pointer_row(const InstructionRow& row) {
  return row.name.size() > 1 && row.name[0] == 'P' && row.operands.empty() &&
         std::ranges::all_of(std::string_view(row.name).substr(1), ascii::is_digit);
}

/// I610: what an interrupt executes.
bool is_interrupt_row(const InstructionRow& row) {
  return row.name.size() > 1 && row.name[0] == 'I' && row.operands.empty() &&
         std::ranges::all_of(std::string_view(row.name).substr(1), ascii::is_digit);
}

bool ends_routine(Action action) {
  return action == Action::main_end || action == Action::return_ || action == Action::interrupt_return ||
         action == Action::end;
}

bool is_output(Action action) {
  switch (action) {
    case Action::contact:
    case Action::pulse_contact:
    case Action::block:
    case Action::stack:
    case Action::invert:
    case Action::pulse_result:
    case Action::edge_relay:
    case Action::compare:
    case Action::compare_text:
    case Action::compare_clock:
    case Action::nothing: return false;
    default: return true;
  }
}

std::size_t most_loops(Family family) { return family == Family::fx3 ? 5 : 16; }

}  // namespace

// Errors

void ListCompiler::error(std::size_t row, std::string message) {
  const std::uint32_t line = text_->instructions.empty()
                                 ? 1
                                 : text_->instructions[std::min(row, text_->instructions.size() - 1)].line;
  shared_.errors.push_back({shared_.program.files[file_], line, std::move(message)});
}

void ListCompiler::operand_error(const Operand& operand, const std::string& message) {
  error(text_->instructions[row_].name + ": '" + operand.written + "': " + message);
}

// The frame

std::uint32_t ListCompiler::reserve(std::uint32_t slots) {
  const auto first = static_cast<std::uint32_t>(image_.size());
  if (shared_.program.initial.size() + image_.size() + slots > program::most_slots) {
    if (!std::exchange(shared_.is_too_large, true))
      error("the program needs too much memory; expected a smaller one");
    return 0;
  }
  image_.resize(image_.size() + slots);
  return first;
}

std::uint32_t ListCompiler::constant(Slot value) {
  const auto [found, is_new] = constants_.try_emplace(value, 0);
  if (is_new) {
    found->second = reserve(1);
    if (!shared_.is_too_large) image_[found->second] = value;
  }
  return found->second;
}

std::uint32_t ListCompiler::temporary() {
  std::vector<std::uint32_t>& slots = routine().temporaries;
  if (temporaries_used_ == slots.size()) slots.push_back(reserve(1));
  return slots[temporaries_used_++];
}

std::uint32_t ListCompiler::state() {
  const std::uint32_t slot = reserve(1);
  const InstructionRow& row = text_->instructions[row_];
  std::string name = row.name;
  for (const std::string& operand : row.operands) name += ' ' + operand;
  name += " #" + std::to_string(++members_named_[name]);
  members_.push_back({.name = std::move(name), .offset = slot, .kind = program::MemberKind::hidden});
  return slot;
}

std::uint32_t ListCompiler::record(std::initializer_list<Slot> values) {
  const std::uint32_t first = reserve(static_cast<std::uint32_t>(values.size() + 1));
  if (!shared_.is_too_large) std::ranges::copy(values, image_.begin() + first + 1);
  return first;
}

std::uint32_t ListCompiler::place_in_memory(std::size_t slots) {
  std::vector<Slot>& memory = shared_.program.initial;
  const auto first = static_cast<std::uint32_t>(memory.size());
  memory.resize(memory.size() + slots);
  return first;
}

// Code

std::size_t ListCompiler::emit(Opcode code, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                               std::uint16_t extra) {
  program::Program& program = shared_.program;
  program.code.push_back({code, extra, a, b, c});
  program.positions.push_back({file_, 1, text_->instructions.empty() ? 1 : text_->instructions[row_].line});
  return program.code.size() - 1;
}

void ListCompiler::native(program::Native function, std::uint32_t record) {
  std::vector<program::Native>& natives = shared_.program.natives;
  const auto [found, is_new] =
      shared_.natives.try_emplace(function, static_cast<std::uint32_t>(natives.size()));
  if (is_new) natives.push_back(function);
  emit(Opcode::native, found->second, record);
}

void ListCompiler::land(std::size_t jump, std::size_t target) {
  shared_.program.code[jump].c =
      static_cast<std::uint32_t>(static_cast<std::int64_t>(target) - static_cast<std::int64_t>(jump));
}

// A jump back counts towards the watchdog by its length, so that it must have one.
void ListCompiler::keep_distance(std::size_t target) {
  if (target == here()) emit(Opcode::move, constant(0), constant(0));
}

std::uint32_t ListCompiler::add_device(DeviceAccess access) {
  shared_.program.devices.push_back(std::move(access));
  return static_cast<std::uint32_t>(shared_.program.devices.size() - 1);
}

// Passes

void ListCompiler::compile(const ProgramText& text, std::string name) {
  text_ = &text;
  name_ = name;
  if (text.instructions.empty()) return error(0, "there is no instruction; expected END at least");
  const std::size_t errors = shared_.errors.size();
  const auto entry = static_cast<std::uint32_t>(here());
  find_routines();
  begin_routine();
  for (row_ = 0; row_ < text.instructions.size() && !shared_.is_too_large; ++row_) {
    compile_row();
    if (shared_.errors.size() >= most_errors) return;
  }
  row_ = text.instructions.size() - 1;
  if (!has_ended_) error("the program ends here without END");
  link();
  emit(Opcode::end);
  if (shared_.errors.size() != errors) return;
  refuse_recursion();

  program::Program& program = shared_.program;
  const auto frame = place_in_memory(0);
  program.initial.insert(program.initial.end(), image_.begin(), image_.end());
  const auto instructions = static_cast<std::uint32_t>(here() - entry);
  add_interrupts(name, frame, instructions);
  for (const auto& [number, pointer] : pointers_) {
    if (!pointer.function) continue;
    program::Function& function = program.functions[*pointer.function];
    function = {name + ".P" + std::to_string(number), pointer.entry.value_or(0), instructions, frame};
  }
  program.programs.push_back(static_cast<std::uint32_t>(program.functions.size()));
  program.functions.push_back({name, entry, instructions, frame});
  program.types.push_back({.form = DataType::Form::elementary, .base = Elementary::lword, .name = "LWORD"});
  const DataType* const word = &program.types.back();
  for (program::Member& member : members_)
    if (member.type == nullptr) member.type = word;
  program.types.push_back({.form = DataType::Form::block,
                           .name = name,
                           .slots = static_cast<std::uint32_t>(image_.size()),
                           .members = std::move(members_)});
  program.symbols.push_back(
      {.name = name, .type = &program.types.back(), .place = frame, .is_program = true});
}

void ListCompiler::find_routines() {
  routines_.push_back({});
  for (std::size_t row = 0; row < text_->instructions.size(); ++row) {
    const InstructionRow& each = text_->instructions[row];
    if (is_pointer_row(each)) {
      const auto number = ascii::parse_number<std::uint32_t>(std::string_view(each.name).substr(1));
      if (!number || *number > last_pointer) {
        error(row, each.name + ": expected P0 to P4095");
      } else if (!pointers_.try_emplace(*number, Pointer{row, routines_.size() - 1, {}, {}}).second) {
        error(row, each.name + ": there is another one of this number in line " +
                       std::to_string(text_->instructions[pointers_[*number].row].line));
      }
      continue;
    }
    if (is_interrupt_row(each)) {
      interrupts_.push_back({each.name, row, routines_.size() - 1, {}});
      continue;
    }
    const auto found = instruction_named(each.name, shared_.family);
    if (!found || !ends_routine(found->instruction->action)) continue;
    routines_.back().end = found->instruction->action;
    if (found->instruction->action == Action::end) break;
    if (routines_.size() == most_routines) {
      error(row, "expected at most " + std::to_string(most_routines) + " subroutines");
      break;
    }
    routines_.push_back({.first_row = row + 1});
  }
}

void ListCompiler::begin_routine() {
  depth_ = stored_ = 0;
  has_output_ = false;
  master_controls_.clear();
}

void ListCompiler::check_end_of_routine() {
  if (depth_ > 1 || (depth_ == 1 && !has_output_))
    error("the result of the contacts above is not used; expected an output such as OUT");
  if (stored_ != 0) error("MPS without MPP: expected one for each other");
  if (state_) error(state_->row, "STL without an end; expected RET behind the last state");
  state_.reset();
  for (const Loop& loop : loops_)
    error(loop.row, "FOR without NEXT: expected one before the end of the program");
  loops_.clear();
}

void ListCompiler::compile_row() {
  const InstructionRow& row = text_->instructions[row_];
  temporaries_used_ = 0;
  if (has_ended_) {
    if (row.name != "NOP") error(row.name + " stands behind END; expected nothing there");
    return;
  }
  if (is_pointer_row(row)) {
    const auto pointer = pointers_.find(
        ascii::parse_number<std::uint32_t>(std::string_view(row.name).substr(1)).value_or(last_pointer + 1));
    if (pointer == pointers_.end() || pointer->second.row != row_) return;
    if (depth_ > 1 || (depth_ == 1 && !has_output_))
      error(row.name + " stands in a rung; expected it before LD");
    depth_ = stored_ = 0;
    pointer->second.entry = static_cast<std::uint32_t>(here());
    return;
  }
  if (is_interrupt_row(row)) {
    const auto found = std::ranges::find(interrupts_, row_, &Interrupt::row);
    if (found != interrupts_.end()) begin_interrupt(*found);
    return;
  }
  const auto named = instruction_named(row.name, shared_.family);
  if (!named) {
    has_output_ = depth_ > 0;  // no further error for its contacts
    if (const AbsentInstruction* known = absent_instruction(row.name, shared_.family))
      return error("'" + row.name + "' is not there: " + std::string(known->missing));
    const std::string families = families_with(row.name);
    return error("'" + row.name + "' is not available for " + std::string(family_name(shared_.family)) +
                 (families.empty() ? std::string() : " but for " + families) +
                 "; see docs/instruction-list.md");
  }
  const auto letters = letters_of(*named->instruction);
  if (!letters || !parse_operands(*letters)) {
    // What follows is compiled as if it had been right.
    const Action action = named->instruction->action;
    if (is_output(action))
      has_output_ = depth_ > 0;
    else if (row.name.starts_with("LD"))
      push_result();
    return;
  }
  execute(*named);
  if (is_output(named->instruction->action)) has_output_ = true;
}

std::optional<std::string_view> ListCompiler::letters_of(const instruction_list::Instruction& instruction) {
  const InstructionRow& row = text_->instructions[row_];
  std::string_view rest = instruction.operands;
  std::string numbers;
  while (true) {
    const std::size_t bar = std::min(rest.find('|'), rest.size());
    const std::string_view letters = rest.substr(0, bar);
    const std::size_t count = (letters.size() + 1) / 2;
    if (count == row.operands.size()) return letters;
    if (!numbers.empty()) numbers += " or ";
    numbers += std::to_string(count);
    if (bar == rest.size()) break;
    rest.remove_prefix(bar + 1);
  }
  error(row.name + ": expected " + numbers + " operand" + (numbers == "1" ? "" : "s") + ", found " +
        std::to_string(row.operands.size()));
  return std::nullopt;
}

bool ListCompiler::parse_operands(std::string_view letters) {
  const InstructionRow& row = text_->instructions[row_];
  operands_.clear();
  letters_.clear();
  bool are_right = true;
  for (std::size_t i = 0; i < row.operands.size(); ++i) {
    const char letter = letters[2 * i];
    letters_ += letter;
    auto operand = operand_of(row.operands[i]);
    if (!operand) {
      error(row.name + ": '" + row.operands[i] + "': " + operand.error());
      are_right = false;
      continue;
    }
    const bool is_written = std::string_view("dWLEFxBAToN").contains(letter);
    if (letter == 'p' && operand->kind != Operand::Kind::pointer) {
      operand_error(*operand, "expected a pointer such as P10");
      are_right = false;
    } else if (letter == 'N' && operand->kind != Operand::Kind::nesting) {
      operand_error(*operand, "expected a nesting number such as N0");
      are_right = false;
    } else if (letter != 'p' && letter != 'N' &&
               (operand->kind == Operand::Kind::pointer || operand->kind == Operand::Kind::nesting)) {
      operand_error(*operand, "expected a device or a constant");
      are_right = false;
    } else if (is_written && (operand->is_constant() || operand->kind == Operand::Kind::text)) {
      operand_error(*operand, "expected a device, not a constant, as something is written there");
      are_right = false;
    }
    operands_.push_back(std::move(*operand));
  }
  return are_right;
}

void ListCompiler::check_interrupts() {
  for (const Interrupt& each : interrupts_) {
    if (const auto cause = interrupt_cause(each.name, shared_.family); !cause)
      error(each.row, cause.error());
    else if (each.routine == 0)
      error(each.row, each.name + " is an interrupt program; expected it behind FEND");
    else if (routines_[each.routine].end != Action::interrupt_return)
      error(each.row, each.name + " is an interrupt program, but its end is no IRET");
    const bool is_double = std::ranges::any_of(
        interrupts_, [&](const Interrupt& other) { return other.row < each.row && other.name == each.name; });
    if (is_double) error(each.row, each.name + ": there is another one of this number above");
  }
}

void ListCompiler::link() {
  check_interrupts();
  for (const Jump& jump : jumps_) {
    const auto pointer = pointers_.find(jump.pointer);
    if (pointer == pointers_.end() || !pointer->second.entry) {
      error(jump.row, "there is no P" + std::to_string(jump.pointer) + " in this program");
      continue;
    }
    program::Instruction& code = shared_.program.code[jump.instruction];
    land(jump.instruction, *pointer->second.entry);
    if (static_cast<std::int32_t>(code.c) <= 0) code.code = Opcode::loop;
  }
  for (const std::size_t jump : jumps_to_end_) land(jump);
  for (auto& [number, pointer] : pointers_) {
    if (pointer.function && routines_[pointer.routine].end != Action::return_)
      error(pointer.row, "P" + std::to_string(number) + " is called, but its end is no " +
                             (shared_.family == Family::fx3 ? "SRET" : "RET"));
    if (pointer.function && pointer.routine == 0)
      error(pointer.row, "P" + std::to_string(number) + " is called; expected it behind FEND");
  }
}

// What is left, when routines that nothing calls, and those that call nothing, have been removed again and again, is in a circle.
void ListCompiler::refuse_recursion() {
  const std::size_t count = routines_.size();
  std::vector<std::vector<std::size_t>> back(count);
  std::vector<std::size_t> in(count, 0);
  std::vector<std::size_t> out(count, 0);
  const auto each_edge = [&](std::size_t from, auto&& call) {
    for (const std::vector<std::size_t>* list : {&routines_[from].calls, &routines_[from].jumps})
      for (const std::size_t to : *list) call(to);
  };
  for (std::size_t from = 0; from < count; ++from)
    each_edge(from, [&](std::size_t to) {
      back[to].push_back(from);
      ++in[to];
      ++out[from];
    });
  std::vector<bool> is_removed(count);
  std::vector<std::size_t> open;
  const auto consider = [&](std::size_t number) {
    if (is_removed[number] || (in[number] != 0 && out[number] != 0)) return;
    is_removed[number] = true;
    open.push_back(number);
  };
  for (std::size_t number = 0; number < count; ++number) consider(number);
  while (!open.empty()) {
    const std::size_t number = open.back();
    open.pop_back();
    each_edge(number, [&](std::size_t to) {
      --in[to];
      consider(to);
    });
    for (const std::size_t from : back[number]) {
      --out[from];
      consider(from);
    }
  }
  for (std::size_t number = 0; number < count; ++number) {
    const bool calls_back =
        !is_removed[number] &&
        std::ranges::any_of(routines_[number].calls, [&](std::size_t to) { return !is_removed[to]; });
    if (calls_back)
      return error(routines_[number].first_row,
                   "this subroutine calls itself, or one that calls it; expected calls without a circle");
  }
}

// Results

std::uint32_t ListCompiler::result_slot(std::size_t depth) {
  std::vector<std::uint32_t>& slots = routine().results;
  while (slots.size() <= depth) slots.push_back(reserve(1));
  return slots[depth];
}

// An LD behind an output begins a rung, unless an ANB or ORB before the next output joins its block with what stands before it.
bool ListCompiler::begins_rung() const {
  if (!has_output_) return false;
  std::size_t depth = 0;
  for (std::size_t row = row_; row < text_->instructions.size(); ++row) {
    const std::string& name = text_->instructions[row].name;
    const auto found = instruction_named(name, shared_.family);
    if (!found) continue;
    const Action action = found->instruction->action;
    if (is_output(action) || (action == Action::stack && found->variant == 0)) return true;
    if (action == Action::block && --depth == 0) return false;
    if (action != Action::block && name.starts_with("LD")) ++depth;
  }
  return true;
}

void ListCompiler::push_result() {
  if (begins_rung()) {
    if (depth_ > 1) error("the contacts above are not joined; expected ANB or ORB before the last output");
    if (stored_ != 0) error("MPS without MPP above; expected one for each other");
    depth_ = stored_ = 0;
  }
  has_output_ = false;
  if (depth_ == most_results) {
    error("expected at most " + std::to_string(most_results) + " blocks that no ANB or ORB has joined");
    depth_ = 0;
  }
  ++depth_;
}

std::optional<std::uint32_t> ListCompiler::result() {
  if (depth_ == 0 && state_) {  // an output at the contact of STL
    depth_ = 1;
    emit(Opcode::move, result_slot(0), state_->slot);
  }
  if (depth_ > 0) return result_slot(depth_ - 1);
  error(text_->instructions[row_].name + " without contacts; expected LD or another contact before it");
  push_result();
  return std::nullopt;
}

std::optional<std::uint32_t> ListCompiler::condition() {
  const auto top = result();
  if (!top) return top;
  if (depth_ > 1) {
    error(text_->instructions[row_].name + ": the contacts above are not joined; expected ANB or ORB");
    depth_ = 1;
  }
  if (master_controls_.empty() && !state_) return top;
  const std::uint32_t both = temporary();
  emit(Opcode::bit_and, both, *top, state_ ? state_->slot : master_controls_.back().slot, program::of_bool);
  return both;
}

std::uint32_t ListCompiler::edge(std::uint32_t value, bool is_rising) {
  const std::uint32_t before = state();
  const std::uint32_t found = temporary();
  emit(Opcode::lt, found, is_rising ? before : value, is_rising ? value : before);
  emit(Opcode::move, before, value);
  return found;
}

void ListCompiler::invert(std::uint32_t value) {
  emit(Opcode::bit_xor, value, value, constant(1), program::is_inversion);
}

/// `place`: 0 LD, 1 AND, 2 OR. The value is used for nothing else.
void ListCompiler::combine(unsigned place, std::uint32_t value) {
  if (place == 0) {
    push_result();
    emit(Opcode::move, result_slot(depth_ - 1), value);
  } else if (const auto top = result()) {
    emit(place == 1 ? Opcode::bit_and : Opcode::bit_or, *top, *top, value,
         program::of_bool | program::c_is_last);
  }
}

// Program

void ListCompiler::master_control(bool begins) {
  if (state_) return error("MC and MCR between STL and RET; expected them outside");
  const std::uint32_t level = operands_[0].number;
  const std::uint32_t last = shared_.family == Family::fx3 ? 7 : 14;
  if (level > last) return operand_error(operands_[0], "expected N0 to N" + std::to_string(last));
  if (!begins) {
    if (std::ranges::none_of(master_controls_,
                             [&](const MasterControl& each) { return each.level == level; }))
      return error("MCR N" + std::to_string(level) + " without MC; expected one of this number above");
    std::erase_if(master_controls_, [&](const MasterControl& each) { return each.level >= level; });
    depth_ = 0;
    return;
  }
  if (!master_controls_.empty() && master_controls_.back().level >= level)
    return operand_error(operands_[0], "expected a larger number than that of the MC around it");
  const auto when = condition();
  if (!when) return;
  const std::uint32_t slot = state();
  emit(Opcode::move, slot, *when);
  if (store_bit(operands_[1], slot)) master_controls_.push_back({level, slot});
}

void ListCompiler::jump(bool is_conditional) {
  const std::uint32_t label = operands_[0].number;
  std::optional<std::size_t> over;
  if (is_conditional) {
    const auto when = condition();
    if (!when) return;
    const bool is_pulse = text_->instructions[row_].name.ends_with('P');
    over = emit(Opcode::jump_unless, is_pulse ? edge(*when, true) : *when);
  }
  if (shared_.family == Family::fx3 && label == 63 && !pointers_.contains(63)) {
    jumps_to_end_.push_back(emit(Opcode::jump));
  } else {
    if (const auto found = pointers_.find(label);
        found != pointers_.end() && found->second.routine != routine_)
      routine().jumps.push_back(found->second.routine);
    if (const auto found = pointers_.find(label); found != pointers_.end())
      keep_distance(found->second.entry.value_or(0));
    jumps_.push_back({emit(Opcode::jump), label, row_});
  }
  if (over) land(*over);
}

void ListCompiler::call() {
  const auto pointer = pointers_.find(operands_[0].number);
  if (pointer == pointers_.end())
    return operand_error(operands_[0], "there is no such pointer in this program");
  Pointer& to = pointer->second;
  if (!to.function) {
    to.function = static_cast<std::uint32_t>(shared_.program.functions.size());
    shared_.program.functions.emplace_back();
  }
  routine().calls.push_back(to.routine);
  emit(Opcode::call, *to.function);
}

// The manuals of the FX3 have 1 for numbers below (unverified); the others stop with an error.
void ListCompiler::for_() {
  if (loops_.size() == most_loops(shared_.family))
    return error("expected at most " + std::to_string(most_loops(shared_.family)) + " nested FOR");
  const std::uint32_t counter = reserve(3);
  if (shared_.is_too_large) return;
  image_[counter + 2] = 1;
  const auto limit = load(operands_[0], Elementary::int_);
  if (!limit) return;
  emit(Opcode::move, counter + 1, *limit);
  emit(Opcode::move, counter, constant(1));
  if (shared_.family == Family::fx3) {
    const std::size_t over = emit(Opcode::jump_le, constant(1), counter + 1);
    emit(Opcode::move, counter + 1, constant(1));
    land(over);
  } else {
    shared_.program.elements.push_back({.low = 1, .high = 32'767});
    emit(Opcode::check_range, counter + 1, static_cast<std::uint32_t>(shared_.program.elements.size() - 1));
  }
  loops_.push_back({counter, here(), row_});
  depth_ = 0;
}

void ListCompiler::next() {
  if (loops_.empty()) return error("NEXT without FOR; expected one above");
  const Loop loop = loops_.back();
  loops_.pop_back();
  keep_distance(loop.first);
  land(emit(Opcode::for_next, loop.counter, loop.counter + 1), loop.first);
  depth_ = 0;
}

void ListCompiler::break_(std::uint32_t when) {
  if (loops_.empty()) return error("BREAK without FOR; expected one above");
  const std::uint32_t counter = loops_.back().counter;
  const std::size_t over = emit(Opcode::jump_unless, when);
  // The repetition that is left counts as one that remains (unverified).
  const std::uint32_t remain = temporary();
  emit(Opcode::sub_i64, remain, counter + 1, counter);
  emit(Opcode::add_i64, remain, remain, constant(1));
  if (!store(operands_[0], Elementary::int_, remain)) return;
  jumps_.push_back({emit(Opcode::jump), operands_[1].number, row_});
  land(over);
}

void ListCompiler::execute(const NamedInstruction& named) {
  const std::string_view name = text_->instructions[row_].name;
  const Action action = named.instruction->action;
  const bool is_double = (named.forms & with_double) != 0;
  const bool is_unsigned = (named.forms & with_unsigned) != 0;
  Elementary type = is_unsigned ? (is_double ? Elementary::udint : Elementary::uint)
                                : (is_double ? Elementary::dint : Elementary::int_);
  if (letters_.starts_with('l') || letters_.ends_with('L')) type = Elementary::dint;
  if (letters_.starts_with('e')) type = Elementary::real;
  if (letters_.starts_with('f')) type = Elementary::lreal;

  switch (action) {
    case Action::contact: return contact(named.variant);
    case Action::pulse_contact: return pulse_contact(named.variant + (name.ends_with('I') ? 6U : 0U));
    case Action::block: return block(named.variant == 1);
    case Action::stack: return stack(named.variant);
    case Action::compare: return compare(name, named.variant, type);
    case Action::compare_text: return compare_text(name, named.variant);
    case Action::compare_clock: return compare_clock(name, named.variant);
    case Action::invert:
      if (const auto top = result()) invert(*top);
      return;
    case Action::pulse_result:
      if (const auto top = result()) emit(Opcode::move, *top, edge(*top, named.variant == 0));
      return;
    case Action::edge_relay:
      if (const auto top = result()) {
        const auto before = load_bit(operands_[0]);
        if (!before || !store_bit(operands_[0], *top)) return;
        const std::uint32_t found = temporary();
        emit(Opcode::lt, found, named.variant == 0 ? *before : *top, named.variant == 0 ? *top : *before);
        emit(Opcode::move, *top, found);
      }
      return;
    case Action::out: return out(0);
    case Action::out_high_speed: return out(10'000'000);
    case Action::out_millisecond: return out(1'000'000);
    case Action::nothing: return;
    case Action::end: has_ended_ = true; [[fallthrough]];
    case Action::main_end:
    case Action::return_:
    case Action::interrupt_return:
      check_end_of_routine();
      emit(action == Action::return_ || action == Action::interrupt_return ? Opcode::return_ : Opcode::end);
      if (!has_ended_ && routine_ + 1 < routines_.size()) ++routine_;
      return begin_routine();
    case Action::master_control: return master_control(true);
    case Action::master_control_reset: return master_control(false);
    case Action::jump: return jump(true);
    case Action::jump_always: return jump(false);
    case Action::jump_to_end: jumps_to_end_.push_back(emit(Opcode::jump)); return;
    case Action::state: return begin_state();
    case Action::state_end:
      if (!state_) return error(std::string(name) + " without STL; expected one above");
      return end_state();
    case Action::enable_interrupts: return allow_interrupts(true);
    case Action::disable_interrupts: return allow_interrupts(false);
    case Action::for_: return for_();
    case Action::next: return next();
    case Action::pulse:
      if (const auto when = condition()) (void)store_bit(operands_[0], edge(*when, named.variant == 0));
      return;
    default: break;
  }

  // The others are executed while the condition is ON, or once with each edge.
  const auto when = condition();
  if (!when) return;
  const bool is_pulse = (named.forms & with_pulse) != 0 || name == "FF";
  const std::uint32_t runs = is_pulse ? edge(*when, true) : *when;
  if (action == Action::break_) return break_(runs);
  if (action == Action::set && transfer(runs)) return;
  const std::size_t over = emit(Opcode::jump_unless, runs);
  switch (action) {
    case Action::set:
    case Action::reset: set_or_reset(action == Action::set); break;
    case Action::toggle:
      if (const auto value = load_bit(operands_[0])) {
        const std::uint32_t inverted = temporary();
        emit(Opcode::bit_xor, inverted, *value, constant(1), program::is_inversion | program::b_is_last);
        (void)store_bit(operands_[0], inverted);
      }
      break;
    case Action::shift_device: shift_device(); break;
    case Action::call: call(); break;
    case Action::arithmetic:
    case Action::real_arithmetic:
    case Action::real_multiply: arithmetic(named, type); break;
    case Action::multiply: multiply(named.variant == 1, type); break;
    case Action::logic: logic(named.variant, type); break;
    case Action::rotate: rotate(named.variant, is_double ? 32 : 16, type); break;
    case Action::shift: rotate(static_cast<unsigned>(Bits::shift_right) + named.variant, 16, type); break;
    case Action::shift_bits: shift_in(false, named.variant == 1, false); break;
    case Action::shift_words: shift_in(false, named.variant == 1, true); break;
    case Action::shift_in_bits: shift_in(true, named.variant == 1, false); break;
    case Action::shift_in_words: shift_in(true, named.variant == 1, true); break;
    case Action::block_move:
    case Action::fill_move:
    case Action::reset_range:
    case Action::reset_block: block_instruction(named, type); break;
    case Action::from:
    case Action::to: module_access(action == Action::to, name.starts_with('D')); break;
    case Action::move_text: move_text(); break;
    case Action::compare_to_bits:
    case Action::zone_compare: compare_to_bits(action == Action::zone_compare, type); break;
    case Action::read_clock:
    case Action::set_clock:
    case Action::compare_time:
    case Action::compare_time_zone:
    case Action::add_times:
    case Action::to_seconds:
    case Action::from_seconds: clock_instruction(named, type); break;
    case Action::refresh: refresh(); break;
    case Action::count_bits:
    case Action::mean:
    case Action::limit:
    case Action::square_root: calculation(action, type); break;
    default: values(named, type); break;
  }
  land(over);
}

}  // namespace canopus::instruction_list
