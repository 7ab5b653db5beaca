#include "canopus/instruction_list/interrupt_programs.hpp"

#include <utility>

#include "canopus/ascii/number.hpp"

namespace canopus::instruction_list {

namespace {

using program::Opcode;
using program::SourcePosition;

/// I00x to I50x: edges of X0 to X5; I6xx, I7xx, I8xx: every xx ms [FX programming manuals: interrupt pointers].
std::expected<InterruptCause, std::string> fx3_cause(const std::string& pointer) {
  const auto number = ascii::parse_number<unsigned>(pointer.substr(1));
  const std::string expected =
      pointer +
      ": expected I000 to I501 (inputs X0 to X5; last digit 1 rising, 0 falling) or I610 to I899 (every 10 "
      "to 99 ms)";
  if (pointer.size() != 4 || !number) return std::unexpected(expected);
  const unsigned group = *number / 100;
  const unsigned rest = *number % 100;
  if (group <= 5 && rest <= 1)
    return InterruptCause{.input = "X" + std::to_string(group),
                          .is_falling = rest == 0,
                          .mask = "M805" + std::to_string(group)};
  if (group >= 6 && group <= 8 && rest >= 10)
    return InterruptCause{.every = rest * 1'000'000LL, .mask = "M805" + std::to_string(group)};
  return std::unexpected(expected);
}

}  // namespace

std::expected<InterruptCause, std::string> interrupt_cause(const std::string& pointer, Family family) {
  if (family == Family::fx3) return fx3_cause(pointer);
  // The intervals are the defaults of the CPU parameter.
  constexpr std::int64_t intervals[] = {100, 40, 20, 10};
  const auto number = ascii::parse_number<unsigned>(pointer.substr(1));
  if (number && *number >= 28 && *number <= 31)
    return InterruptCause{.every = intervals[*number - 28] * 1'000'000};
  return std::unexpected(
      pointer + ": expected I28 to I31 (every 100, 40, 20, 10 ms): there are no interrupts of modules");
}

void InterruptPrograms::add(program::InterruptProgram interrupt, std::optional<program::DevicePoint> mask,
                            SourcePosition position) {
  Entry entry{std::move(interrupt), mask, position};
  entry.waits = static_cast<std::uint32_t>(program_.initial.size());
  program_.initial.push_back(0);
  entries_.push_back(std::move(entry));
}

std::uint32_t InterruptPrograms::enabled() {
  if (!enabled_) {
    enabled_ = static_cast<std::uint32_t>(program_.initial.size());
    program_.initial.push_back(0);
  }
  return *enabled_;
}

std::uint32_t InterruptPrograms::waiting() {
  if (!waiting_) {
    waiting_ = static_cast<std::uint32_t>(program_.functions.size());
    program_.functions.push_back({.name = "EI"});
  }
  return *waiting_;
}

void InterruptPrograms::emit(const Entry& entry, Opcode code, std::uint32_t a, std::uint32_t b,
                             std::uint32_t c) {
  program_.code.push_back({code, 0, a, b, c});
  program_.positions.push_back(entry.position);
}

void InterruptPrograms::finish() {
  if (entries_.empty() && !waiting_) return;
  constexpr std::uint32_t value = 0;  // slots of the frame that all of this shares
  constexpr std::uint32_t zero = 1;
  constexpr std::uint32_t one = 2;
  const auto frame = static_cast<std::uint32_t>(program_.initial.size());
  program_.initial.insert(program_.initial.end(), {0, 0, 1});
  const auto here = [&] { return static_cast<std::uint32_t>(program_.code.size()); };
  const std::uint32_t is_enabled = enabled();
  for (Entry& entry : entries_) {
    const std::uint32_t begin = here();
    emit(entry, Opcode::load_global, value, is_enabled);
    emit(entry, Opcode::jump_if, value, 0, 3);
    emit(entry, Opcode::store_global, entry.waits, one);
    emit(entry, Opcode::return_);
    if (entry.mask) {
      program::DeviceAccess mask{.point = *entry.mask,
                                 .form = program::DeviceAccess::Form::bit,
                                 .type = program::Elementary::boolean};
      mask.text = entry.interrupt.name;
      program_.devices.push_back(std::move(mask));
      emit(entry, Opcode::read_device, value, static_cast<std::uint32_t>(program_.devices.size() - 1));
      emit(entry, Opcode::jump_if, value, 0, 2);
    }
    emit(entry, Opcode::call, entry.interrupt.function);
    emit(entry, Opcode::return_);
    entry.interrupt.function = static_cast<std::uint32_t>(program_.functions.size());
    program_.functions.push_back({entry.interrupt.name, begin, here() - begin, frame});
  }
  if (waiting_) {
    const std::uint32_t begin = here();
    const Entry none;
    for (const Entry& entry : entries_) {
      emit(entry, Opcode::load_global, value, entry.waits);
      emit(entry, Opcode::jump_unless, value, 0, 3);
      emit(entry, Opcode::store_global, entry.waits, zero);
      emit(entry, Opcode::call, entry.interrupt.function);
    }
    emit(entries_.empty() ? none : entries_.back(), Opcode::return_);
    program_.functions[*waiting_] = {"EI", begin, here() - begin, frame};
  }
  for (Entry& entry : entries_) program_.interrupts.push_back(std::move(entry.interrupt));
}

}  // namespace canopus::instruction_list
