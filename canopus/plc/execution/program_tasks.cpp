#include "canopus/plc/execution/program_tasks.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <utility>

#include "canopus/ascii/words.hpp"

namespace canopus::plc {

namespace {

constexpr std::array<std::string_view, task_kind_count> names = {"scan", "initial", "fixed scan", "event",
                                                                 "standby"};

/// Its number in Program::functions.
std::optional<std::uint32_t> number_of(const program::Program& program, std::string_view wanted) {
  for (const std::uint32_t number : program.programs)
    if (ascii::equal_ignoring_case(program.functions[number].name, wanted)) return number;
  return std::nullopt;
}

bool names_program(const ProgramTask& task, std::string_view program) {
  return std::ranges::any_of(
      task.programs, [&](const std::string& one) { return ascii::equal_ignoring_case(one, program); });
}

}  // namespace

std::string_view name(TaskKind kind) noexcept { return names[static_cast<std::size_t>(kind)]; }

ProgramTasks::ProgramTasks(std::vector<ProgramTask> tasks, const program::Program& program) {
  for (ProgramTask& task : tasks) entries_.push_back({.task = std::move(task)});
  std::ranges::stable_sort(entries_, {}, [](const Entry& entry) { return entry.task.priority; });
  change(program);
}

void ProgramTasks::change(const program::Program& program) {
  std::erase_if(entries_, &Entry::is_of_others);
  Entry others{.task = {.name = "all other programs"}, .is_of_others = true};
  for (const std::uint32_t number : program.programs) {
    const std::string& name = program.functions[number].name;
    if (std::ranges::none_of(entries_, [&](const Entry& entry) { return names_program(entry.task, name); }))
      others.task.programs.push_back(name);
  }
  if (!others.task.programs.empty()) entries_.push_back(std::move(others));
  change_interrupts(program);
  std::size_t all = 0;
  for (Entry& entry : entries_) {
    if (entry.is_interrupt) {
      all += entry.programs.size();
      continue;
    }
    entry.programs.clear();
    for (const std::string& name : entry.task.programs)
      if (const auto number = number_of(program, name)) entry.programs.push_back(*number);
    all += entry.programs.size();
  }
  due_.reserve(all);
}

void ProgramTasks::change_interrupts(const program::Program& program) {
  std::vector<Entry> interrupts;
  for (const program::InterruptProgram& each : program.interrupts) {
    Entry made{.task = {.name = each.name,
                        .kind = each.every != 0 ? TaskKind::fixed_scan : TaskKind::event,
                        .programs = {each.name},
                        .every = can::Duration(each.every),
                        .on = each.input_name,
                        .on_point = each.input},
               .programs = {each.function},
               .is_interrupt = true,
               .is_falling = each.is_falling};
    const auto before = std::ranges::find_if(entries_, [&](const Entry& entry) {
      return entry.is_interrupt && entry.task.name == each.name && entry.task.kind == made.task.kind;
    });
    if (before != entries_.end()) {
      made.due = before->due;
      made.was_on = before->was_on;
      made.runs = before->runs;
    }
    interrupts.push_back(std::move(made));
  }
  std::erase_if(entries_, [](const Entry& entry) { return entry.is_interrupt; });
  entries_.insert(entries_.begin(), std::make_move_iterator(interrupts.begin()),
                  std::make_move_iterator(interrupts.end()));
}

void ProgramTasks::start(can::Time now) {
  is_first_scan_ = true;
  for (Entry& entry : entries_) {
    entry.was_on = false;
    if (entry.task.kind == TaskKind::fixed_scan) entry.due = can::later(now, entry.task.every);
  }
}

void ProgramTasks::add_due(Entry& entry) {
  due_.insert(due_.end(), entry.programs.begin(), entry.programs.end());
  ++entry.runs;
}

std::span<const std::uint32_t> ProgramTasks::scan_begins(program::DeviceImage& devices) {
  due_.clear();
  for (Entry& entry : entries_) {
    if (entry.task.kind != TaskKind::event) continue;
    std::uint32_t bit = 0;
    const bool is_on =
        devices.read_bits(entry.task.on_point, 1, bit) == program::DeviceError::none && bit != 0;
    const bool was_on = std::exchange(entry.was_on, is_on);
    if (is_on != was_on && is_on != entry.is_falling) add_due(entry);
  }
  const auto has = [&](TaskKind kind) {
    return std::ranges::any_of(entries_, [&](const Entry& entry) { return entry.task.kind == kind; });
  };
  const bool is_first = std::exchange(is_first_scan_, false);
  const TaskKind kind = is_first && has(TaskKind::initial) ? TaskKind::initial : TaskKind::scan;
  for (Entry& entry : entries_)
    if (entry.task.kind == kind) add_due(entry);
  return due_;
}

can::Time ProgramTasks::next_fixed_scan() const noexcept {
  can::Time next = can::never;
  for (const Entry& entry : entries_) next = std::min(next, entry.due);
  return next;
}

std::span<const std::uint32_t> ProgramTasks::fixed_scan(can::Time now) {
  due_.clear();
  for (Entry& entry : entries_) {
    if (entry.due > now) continue;
    entry.due = can::later(entry.due, entry.task.every);
    add_due(entry);
  }
  return due_;
}

std::vector<ProgramTasks::Row> ProgramTasks::rows() const {
  std::vector<Row> rows;
  for (const Entry& entry : entries_) rows.push_back({entry.task, entry.runs});
  return rows;
}

}  // namespace canopus::plc
