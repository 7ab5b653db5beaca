// [[plc.task]], when the PROGRAMs of a CPU are executed, and its files of labels.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "canopus/ascii/words.hpp"
#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/plc/execution/cpu_devices.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

namespace {

using plc::TaskKind;

constexpr std::size_t most_tasks = 64;
constexpr can::Duration shortest_interval = std::chrono::microseconds(100);
constexpr can::Duration longest_interval = std::chrono::seconds(60);
constexpr unsigned lowest_priority = 32;

std::optional<TaskKind> kind_named(std::string_view written) {
  for (std::size_t i = 0; i < plc::task_kind_count; ++i)
    if (name(static_cast<TaskKind>(i)) == written) return static_cast<TaskKind>(i);
  return std::nullopt;
}

/// A key of another kind's tasks.
void refuse(text::TableReader& table, std::string_view key, std::string_view kind) {
  if (table.find(key) != nullptr)
    table.error(key, fmt::format("only a task with kind = \"{}\" has it", kind));
}

void read_interval(text::TableReader& table, plc::ProgramTask& task) {
  if (task.kind != TaskKind::fixed_scan) return refuse(table, "every", "fixed scan");
  const auto every = table.parsed("every", text::parse_duration, true);
  if (!every) return;
  if (*every < shortest_interval || *every > longest_interval)
    return table.error("every", "a fixed scan is every 100us to 60s");
  task.every = *every;
}

void read_event(text::TableReader& table, const plc::CpuModel& cpu, plc::ProgramTask& task) {
  if (task.kind != TaskKind::event) return refuse(table, "on", "event");
  const auto on = table.text("on", true);
  if (!on) return;
  const auto point = plc::CpuDeviceNames(cpu).point(ascii::upper(*on));
  if (!point || !point->is_bit)
    return table.error("on", point ? "expected a bit device, such as \"X10\"" : point.error());
  task.on = ascii::upper(*on);
  task.on_point = *point;
}

TaskSection read_task(text::TableReader& table, const plc::CpuModel& cpu) {
  TaskSection section{.place = table.place()};
  plc::ProgramTask& task = section.task;
  task.name = table.text("name", true).value_or("");
  if (const auto kind = table.text("kind", true)) {
    const auto known = kind_named(*kind);
    if (!known)
      table.error("kind", "expected \"scan\", \"initial\", \"fixed scan\", \"event\" or \"standby\"");
    task.kind = known.value_or(TaskKind::scan);
    if (known) {
      read_interval(table, task);
      read_event(table, cpu, task);
    } else {
      table.find("every");
      table.find("on");
    }
  }
  task.priority =
      static_cast<unsigned>(table.integer("priority", 1, lowest_priority, "expected 1 (the first) to 32")
                                .value_or(lowest_priority));
  table.elements("programs", [&](const toml::node& element) {
    const auto* const written = element.as_string();
    const text::Place place = text::place_of(element.source());
    if (written == nullptr) {
      return table.error(place, fmt::format("programs = {}: expected names of PROGRAMs, such as [\"Main\"]",
                                            text::describe_found(element)));
    }
    task.programs.push_back(written->get());
    section.program_places.push_back(place);
  });
  if (table.find("programs") == nullptr)
    table.error("programs", "expected names of PROGRAMs, such as [\"Main\"]");
  return section;
}

}  // namespace

std::vector<ProgramFile> read_label_files(text::TableReader& table) {
  constexpr std::size_t most_files = 100;
  std::vector<ProgramFile> files;
  table.elements("labels", [&](const toml::node& element) {
    const auto* const path = element.as_string();
    const text::Place place = text::place_of(element.source());
    if (path == nullptr || !ascii::lower(path->get()).ends_with(".csv") || files.size() == most_files) {
      return table.error(
          place,
          fmt::format("labels = {}: expected up to {} files of global labels, such as [\"labels.csv\"]",
                      text::describe_found(element), most_files));
    }
    files.push_back({place, path->get()});
  });
  return files;
}

std::vector<TaskSection> read_tasks(text::TableReader& table, const plc::CpuModel& cpu) {
  std::vector<TaskSection> tasks;
  std::map<std::string, text::Place> names;
  std::map<std::string, text::Place> programs;
  table.tables("task", "plc.task", [&](text::TableReader& inner) {
    if (tasks.size() == most_tasks)
      return inner.error(inner.place(), fmt::format("expected at most {} tasks", most_tasks));
    TaskSection section = read_task(inner, cpu);
    if (const auto [other, is_new] = names.try_emplace(section.task.name, inner.place("name")); !is_new) {
      inner.error("name", fmt::format("another task is \"{}\" already, in line {}", section.task.name,
                                      other->second.line));
    }
    for (std::size_t i = 0; i < section.task.programs.size(); ++i) {
      const auto [other, is_new] =
          programs.try_emplace(ascii::upper(section.task.programs[i]), section.program_places[i]);
      if (!is_new) {
        inner.error(section.program_places[i],
                    fmt::format("programs: \"{}\" belongs to a task already, in line {}",
                                section.task.programs[i], other->second.line));
      }
    }
    tasks.push_back(std::move(section));
  });
  return tasks;
}

}  // namespace canopus::plant
