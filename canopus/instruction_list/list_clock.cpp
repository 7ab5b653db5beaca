// Instructions of the clock, and refresh within a scan.

#include "canopus/instruction_list/clock_functions.hpp"
#include "canopus/instruction_list/list_compiler.hpp"

namespace canopus::instruction_list {

void ListCompiler::clock_instruction(const NamedInstruction& named, Elementary type) {
  switch (named.instruction->action) {
    case Action::read_clock: return clock_words(false);
    case Action::set_clock: return clock_words(true);
    case Action::compare_time: return compare_times(false);
    case Action::compare_time_zone: return compare_times(true);
    case Action::add_times: {
      const auto a = located(operands_[0], Elementary::word);
      const auto b = located(operands_[1], Elementary::word);
      const auto to = located(operands_[2], Elementary::word);
      if (!a || !b || !to) return;
      const std::uint32_t slots = record({0, 0, 0, 0, 0, 0, named.variant});
      locate(slots, 1, *a);
      locate(slots, 3, *b);
      locate(slots, 5, *to);
      return native(clock_functions::add_times, slots);
    }
    case Action::to_seconds: {
      const auto seconds = time_of_day(operands_[0]);
      if (!seconds) return;
      if (type == Elementary::int_) {  // a time from 09:06:08 on does not fit
        shared_.program.elements.push_back({.low = 0, .high = 32'767});
        emit(Opcode::check_range, *seconds, static_cast<std::uint32_t>(shared_.program.elements.size() - 1));
      }
      (void)store(operands_[1], type, *seconds);
      return;
    }
    default: break;
  }
  const auto seconds = load(operands_[0], type);
  const auto to = located(operands_[1], Elementary::word);
  if (!seconds || !to) return;
  const std::uint32_t slots = record({0, 0, 0});
  emit(Opcode::move, slots + 1, *seconds);
  locate(slots, 2, *to);
  native(clock_functions::store_time, slots);
}

void ListCompiler::clock_words(bool sets) {
  const auto words = located(operands_[0], Elementary::word);
  if (!words) return;
  if (sets) {
    const std::uint32_t slots = record({0, 0, shared_.family == Family::fx3 ? 1U : 0U});
    locate(slots, 1, *words);
    return native(clock_functions::set_clock, slots);
  }
  const auto registers = clock_registers();
  if (!registers) return;
  const std::uint32_t slots = record({registers->first, 0, registers->second, 0, 0});
  locate(slots, 4, *words);
  native(clock_functions::read_clock, slots);
}

std::optional<std::pair<std::uint32_t, ListCompiler::Slot>> ListCompiler::clock_registers() {
  using clock_functions::ClockForm;
  const bool is_fx = shared_.family == Family::fx3 || shared_.family == Family::fx5;
  const ClockForm form = is_fx                         ? ClockForm::fx
                         : shared_.family == Family::q ? ClockForm::bcd
                                                       : ClockForm::binary;
  auto registers = named(shared_.family == Family::fx3   ? "D8013"
                         : shared_.family == Family::fx5 ? "SD8013"
                                                         : "SD210",
                         operands_[0]);
  if (!registers) return std::nullopt;
  return std::pair(add_device(std::move(*registers)), static_cast<Slot>(form));
}

void ListCompiler::compare_clock(std::string_view name, unsigned variant) {
  const auto found = [&]() -> std::optional<std::uint32_t> {
    const auto a = located(operands_[0], Elementary::word);
    const auto b = located(operands_[1], Elementary::word);
    const auto target = load(operands_[2], Elementary::int_);
    const auto registers = clock_registers();
    if (!a || !b || !target || !registers) return std::nullopt;
    const bool is_date = !name.contains("TM");  // "LDTM" has DT in it, too
    const std::uint32_t slots =
        record({0, 0, 0, 0, 0, is_date ? 1U : 0U, variant, registers->first, 0, registers->second});
    locate(slots, 1, *a);
    locate(slots, 3, *b);
    emit(Opcode::move, slots + 5, *target);
    native(clock_functions::compare_clock, slots);
    return slots;
  }();
  const unsigned place = name.starts_with("LD") ? 0 : name.starts_with("AND") ? 1 : 2;
  if (found)
    combine(place, *found);
  else if (place == 0)
    push_result();
}

std::optional<std::uint32_t> ListCompiler::time_of_day(const Operand& operand) {
  const auto words = located(operand, Elementary::word);
  if (!words) return std::nullopt;
  const std::uint32_t slots = record({0, 0});
  locate(slots, 1, *words);
  native(clock_functions::time_of_day, slots);
  return slots;
}

// TCMP: the time of the constants greater, equal, less than that of the words. TZCP: the third time below, within, above.
void ListCompiler::compare_times(bool is_zone) {
  if (is_zone) {
    const auto low = time_of_day(operands_[0]);
    const auto high = time_of_day(operands_[1]);
    const auto value = time_of_day(operands_[2]);
    if (low && high && value) store_comparison(*low, *high, *value);
    return;
  }
  const std::uint32_t sum = temporary();
  emit(Opcode::move, sum, constant(0));
  for (std::size_t i = 0; i < 3; ++i) {
    const auto each = load(operands_[i], Elementary::int_);
    if (!each) return;
    emit(Opcode::mul_i64, sum, sum, constant(60));
    emit(Opcode::add_i64, sum, sum, *each);
  }
  const auto time = time_of_day(operands_[3]);
  if (time) store_comparison(sum, sum, *time);
}

void ListCompiler::refresh() {
  const auto first = located(operands_[0], Elementary::boolean);
  const auto count = load(operands_[1], Elementary::int_);
  if (!first || !count) return;
  const std::uint32_t slots = record({0, 0, 0});
  locate(slots, 1, *first);
  emit(Opcode::move, slots + 3, *count);
  native(clock_functions::refresh, slots);
}

}  // namespace canopus::instruction_list
