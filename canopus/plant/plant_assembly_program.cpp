// The racks of a plant and the programs of their CPUs.

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/ascii/words.hpp"
#include "canopus/c_program/c_program.hpp"
#include "canopus/instruction_list/compiler.hpp"
#include "canopus/instruction_list/label.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/label_file.hpp"
#include "canopus/plant/plant_assembly.hpp"
#include "canopus/plant/plc_program.hpp"
#include "canopus/plant/plcopen_source.hpp"
#include "canopus/plant/program_library.hpp"
#include "canopus/plc/cpu/device.hpp"
#include "canopus/plc/execution/instruction_time.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/program/variables.hpp"
#include "canopus/store/file_memory.hpp"
#include "canopus/structured_text/compiler.hpp"
#include "canopus/text/csv.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::plant {
namespace {

// The programs of a PLC in whatever language their files are: Structured Text, or instruction lists as CSV.

bool is_list(const structured_text::Source& source) {
  return source.name.size() > 4 &&
         ascii::equal_ignoring_case(std::string_view(source.name).substr(source.name.size() - 4), ".csv");
}

std::optional<instruction_list::Family> list_family(plc::CpuFamily family) {
  switch (family) {
    case plc::CpuFamily::q: return instruction_list::Family::q;
    case plc::CpuFamily::iqr: return instruction_list::Family::iqr;
    case plc::CpuFamily::fx3: return instruction_list::Family::fx3;
    case plc::CpuFamily::fx5: return instruction_list::Family::fx5;
    case plc::CpuFamily::as300: break;
  }
  return std::nullopt;
}

/// The place of a program's file among the sources.
std::size_t order_of(const program::Program& program, std::uint32_t number,
                     std::span<const structured_text::Source> sources) {
  const program::SourcePosition& begin = program.positions[program.functions[number].entry];
  const auto found = std::ranges::find(sources, program.files[begin.file], &structured_text::Source::name);
  return static_cast<std::size_t>(found - sources.begin());
}

/// One program of all files; a file .csv is an instruction list, with these labels. PROGRAMs are executed in the order of the files.
structured_text::Compilation compile_languages(std::span<const structured_text::Source> sources,
                                               const plc::CpuModel& cpu, const program::DeviceNames& devices,
                                               std::span<const instruction_list::Label> labels) {
  std::vector<structured_text::Source> texts;
  std::vector<instruction_list::Source> lists;
  for (const structured_text::Source& source : sources) {
    if (is_list(source))
      lists.push_back({source.name, source.text});
    else
      texts.push_back(source);
  }
  structured_text::Compilation made;
  if (!texts.empty() || lists.empty()) made = structured_text::compile(texts, &devices);
  if (lists.empty()) return made;
  const auto family = list_family(cpu.family);
  if (!family) {
    made.errors.push_back({lists.front().name, 1, 1,
                           "instruction lists are for CPUs of MELSEC; expected Structured Text for the " +
                               std::string(cpu.name)});
    made.program = nullptr;
    return made;
  }
  instruction_list::Compilation added =
      instruction_list::compile(lists, *family, devices, made.program, labels);
  for (instruction_list::CompileError& error : added.errors)
    made.errors.push_back({std::move(error.file), error.line, 1, std::move(error.message)});
  made.program = made.errors.empty() ? std::move(added.program) : nullptr;
  if (made.program != nullptr)
    std::ranges::stable_sort(made.program->programs, {},
                             [&](std::uint32_t number) { return order_of(*made.program, number, sources); });
  return made;
}

/// Every PROGRAM that a task names must be there.
void check_tasks(const PlcSection& plc, const program::Program& program,
                 std::vector<text::FileError>& errors) {
  std::vector<std::string_view> names;
  for (const std::uint32_t number : program.programs) names.emplace_back(program.functions[number].name);
  for (const TaskSection& section : plc.tasks) {
    for (std::size_t i = 0; i < section.task.programs.size(); ++i) {
      const std::string& wanted = section.task.programs[i];
      if (std::ranges::any_of(
              names, [&](std::string_view name) { return ascii::equal_ignoring_case(name, wanted); }))
        continue;
      errors.push_back(
          {section.program_places[i], fmt::format("programs: \"{}\": the program has no such PROGRAM{}",
                                                  wanted, text::suggestion(wanted, names))});
    }
  }
}

/// Without the program, if a task names a PROGRAM that it has not.
PlcProgram with_tasks_checked(const PlcSection& plc, PlcProgram made) {
  if (made.program != nullptr) check_tasks(plc, *made.program, made.errors);
  if (!made.errors.empty()) made.program = nullptr;
  return made;
}

bool is_native(const ProgramFile& file) { return c_program::is_shared_object(file.path); }

/// The program of a PLC whose file is a shared object.
PlcProgram load_native_code(const PlcSection& plc, const std::filesystem::path& folder) {
  text::FileErrors errors;
  const ProgramFile& file = *std::ranges::find_if(plc.program_files, is_native);
  if (plc.program_files.size() != 1) {
    errors.add(file.place, "program = \"{}\": expected a shared object alone, without other files",
               file.path);
  } else if (!plc.allows_native_code) {
    errors.add(
        file.place,
        "program = \"{}\" is native code, which can do here whatever you can; if you trust it, run the "
        "plant by canopus run --allow-native",
        file.path);
  } else if (!plc.label_files.empty()) {
    errors.add(
        plc.label_files.front().place,
        "labels = \"{}\": expected none beside a shared object, which has its variables' devices itself",
        plc.label_files.front().path);
  } else {
    auto made =
        c_program::load((folder / file.path).lexically_normal().string(), plc::CpuDeviceNames(plc.cpu_model));
    if (made) return with_tasks_checked(plc, {.program = std::move(*made)});
    errors.add(file.place, "program = \"{}\": {}", file.path, made.error());
  }
  return {.errors = errors.release()};
}

void add_mistakes(const ProgramFile& file, std::string_view key,
                  std::span<const structured_text::CompileError> mistakes, text::FileErrors& errors) {
  constexpr std::size_t longest = 500;  // a name of the file may have any length
  for (const structured_text::CompileError& error : mistakes) {
    const bool is_long = error.message.size() > longest;
    errors.add(file.place, "{} = \"{}\": {}:{}:{}: {}{}", key, file.path, error.file, error.line,
               error.column, std::string_view(error.message).substr(0, longest), is_long ? " ..." : "");
  }
}

/// The bytes of a program as they are, but UTF-16 as UTF-8; false after an error. CP932 stays: those are the bytes of a text on a real PLC.
bool decode_text(const ProgramFile& file, std::string& bytes, text::FileErrors& errors) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    if (auto utf8 = text::utf8_of(bytes)) {
      bytes = std::move(*utf8);
    } else {
      errors.add(file.place, "program = \"{}\": {}", file.path, utf8.error());
      return false;
    }
  }
  if (!bytes.contains('\0')) return true;
  errors.add(file.place,
             "program = \"{}\": there is a zero byte; expected UTF-8, or UTF-16 with a byte order mark",
             file.path);
  return false;
}

/// The Structured Text of a PLCopen XML.
std::string plcopen_text(const ProgramFile& file, const std::string& path, std::string_view bytes,
                         text::FileErrors& errors) {
  PlcopenSource made = structured_text_of_plcopen(path, bytes);
  add_mistakes(file, "program", made.errors, errors);
  return std::move(made.text);
}

/// A file of labels as Structured Text. Its name is another one: the text is not that of a program in this format.
structured_text::Source label_source(const ProgramFile& file, const std::filesystem::path& folder,
                                     std::vector<plc::DeviceLabel>& labels,
                                     std::vector<instruction_list::Label>& list_labels,
                                     std::vector<LabelComment>& comments, text::FileErrors& errors) {
  const std::string path = (folder / file.path).lexically_normal().string();
  const auto text = text::read_file_or_reason(path);
  if (!text) {
    errors.add(file.place, "labels = \"{}\": {}", file.path, text.error());
    return {};
  }
  LabelFile made = read_labels(path, *text);
  add_mistakes(file, "labels", made.errors, errors);
  labels.insert(labels.end(), made.labels.begin(), made.labels.end());
  list_labels.insert(list_labels.end(), made.list_labels.begin(), made.list_labels.end());
  comments.insert(comments.end(), made.comments.begin(), made.comments.end());
  return {path + " (labels)", std::move(made.text)};
}

/// Comments of labels become those of the program's variables.
void add_comments(program::Program& program, std::span<const LabelComment> comments) {
  std::map<std::string, const std::string*> by_name;
  for (const LabelComment& each : comments)
    if (!each.comment.empty()) by_name.emplace(ascii::upper(each.name), &each.comment);
  if (by_name.empty()) return;
  const auto find = [&](const std::string& name, std::string& to) {
    if (const auto found = by_name.find(ascii::upper(name)); found != by_name.end()) to = *found->second;
  };
  for (program::Symbol& symbol : program.symbols) {
    if (!symbol.is_program) {
      find(symbol.name, symbol.comment);
      continue;
    }
    const auto type = std::ranges::find_if(
        program.types, [&](const program::DataType& each) { return &each == symbol.type; });
    if (type == program.types.end()) continue;
    for (program::Member& member : type->members) find(symbol.name + '.' + member.name, member.comment);
  }
}

/// The latest label is a local one: its file has the name of a list.
void check_local_labels(const ProgramFile& file, const PlcSection& plc,
                        std::span<const instruction_list::Label> labels, text::FileErrors& errors) {
  if (labels.empty() || labels.back().program.empty()) return;
  const std::string& name = labels.back().program;
  if (std::ranges::any_of(plc.program_files, [&](const ProgramFile& each) {
        return ascii::lower(each.path).ends_with(".csv") &&
               ascii::equal_ignoring_case(instruction_list::program_name(each.path), name);
      }))
    return;
  errors.add(file.place,
             "labels = \"{}\": these are local labels (class VAR) of a program {}; expected an instruction "
             "list {}.csv in program",
             file.path, name, name);
}

}  // namespace

PlcProgram compile_program(const PlcSection& plc, const std::string& plant_file) {
  const std::filesystem::path folder = std::filesystem::path(plant_file).parent_path();
  if (std::ranges::any_of(plc.program_files, is_native)) return load_native_code(plc, folder);
  text::FileErrors errors;
  std::vector<structured_text::Source> sources;
  std::vector<const ProgramFile*> files;  // of each source
  std::vector<plc::DeviceLabel> labels;
  std::vector<instruction_list::Label> list_labels;
  std::vector<LabelComment> comments;
  for (const ProgramFile& file : plc.program_files) {
    if (file.path.starts_with(ProgramFile::library)) {
      if (std::ranges::any_of(std::span(plc.program_files.data(), &file), [&](const ProgramFile& other) {
            return ascii::equal_ignoring_case(other.path, file.path);
          })) {
        errors.add(file.place, "program = \"{}\": it is in the list twice", file.path);
        continue;
      }
      std::vector<structured_text::Source> before;
      std::ranges::copy_if(sources, std::back_inserter(before), [](const structured_text::Source& source) {
        return source.name.starts_with(ProgramFile::library);
      });
      auto library = library_sources(file.path, plc, before);
      if (!library) errors.add(file.place, "program = \"{}\": {}", file.path, library.error());
      for (auto& source : library.value_or(std::vector<structured_text::Source>{})) {
        sources.push_back(std::move(source));
        files.push_back(&file);
      }
      continue;
    }
    const std::string path = (folder / file.path).lexically_normal().string();
    auto text = text::read_file_or_reason(path);
    if (!text) {
      errors.add(file.place, "program = \"{}\": {}", file.path, text.error());
      continue;
    }
    const bool is_list = ascii::lower(path).ends_with(".csv");  // has its own encodings
    if (!is_list && !decode_text(file, *text, errors)) continue;
    if (ascii::lower(path).ends_with(".xml")) *text = plcopen_text(file, path, *text, errors);
    sources.push_back({path, std::move(*text)});
    files.push_back(&file);
  }
  for (const ProgramFile& file : plc.label_files) {
    sources.push_back(label_source(file, folder, labels, list_labels, comments, errors));
    files.push_back(&file);
    check_local_labels(file, plc, list_labels, errors);
  }
  if (!errors.empty()) return {nullptr, errors.release()};
  const plc::CpuDeviceNames devices(plc.cpu_model);
  structured_text::Compilation made = compile_languages(sources, plc.cpu_model, devices, list_labels);
  for (const structured_text::CompileError& error : made.errors) {
    std::size_t number = 0;
    while (number + 1 < sources.size() && sources[number].name != error.file) ++number;
    const ProgramFile& file = *files[number];
    add_mistakes(file, number < files.size() - plc.label_files.size() ? "program" : "labels", {&error, 1},
                 errors);
  }
  if (made.program != nullptr) add_comments(*made.program, comments);
  sources.resize(sources.size() - plc.label_files.size());  // those are no text of the program
  PlcProgram result{std::move(made.program), errors.release()};
  result.labels = std::move(labels);
  for (structured_text::Source& source : sources)
    result.sources.push_back({std::move(source.name), std::move(source.text)});
  return with_tasks_checked(plc, std::move(result));
}

std::vector<plc::ProgramTask> tasks_of(const PlcSection& plc) {
  std::vector<plc::ProgramTask> tasks;
  for (const TaskSection& section : plc.tasks) tasks.push_back(section.task);
  return tasks;
}

bool has_retained(const program::Program& program) {
  bool found = false;
  program::for_each_variable(program, [&](const program::SingleVariable& variable) {
    found = variable.is_retained && !variable.is_constant;
    return !found;
  });
  return found;
}

void Assembly::add_rack(const PlcSection& plc, std::size_t number) {
  const std::size_t part = parts_.division.racks[number];
  PlcProgram made;
  if (!plc.program_files.empty()) {
    made = compile_program(plc, parts_.file.path);
    errors_.add(made.errors);
    if (made.program != nullptr && made.program->plugin != nullptr) {
      const ProgramFile& file = plc.program_files.front();
      warn(file.place, "program = \"{}\" is native code: it runs with all your rights", file.path);
    }
  }
  std::optional<can::Duration> scan = plc.scan;
  if (made.program != nullptr && !scan) scan = plc::estimated_scan(*made.program, plc.cpu_model.family);
  parts_.racks.push_back(std::make_unique<plc::Rack>(parts_.timeline_of(part), plc.cpu_model, scan));
  const bool has_kept = made.program != nullptr && has_retained(*made.program);
  if (!plc.store.empty() && plc.modules.empty() && !has_kept) {
    warn(plc.store_place, "store = \"{}\": the PLC has no module that could store anything", plc.store);
  }
  if (made.program == nullptr) {
    parts_.executions.push_back(nullptr);
    return;
  }
  module::NonVolatileMemory* memory = nullptr;
  const auto report = [&observer = *parts_.events[part], name = plc.name](const std::string& text,
                                                                          can::Time now) {
    observer.on({now, Failure{fmt::format("PLC {}", name), fmt::format("{}; the CPU is in STOP", text)}});
  };
  if (!plc.store.empty() && has_kept) {
    const StoredAs stored = stores_.claim(plc, errors_);
    parts_.program_memories.push_back(std::make_unique<store::FileMemory>(stored.folder, stored.owner));
    memory = parts_.program_memories.back().get();
  }
  parts_.executions.push_back(
      std::make_unique<plc::ProgramExecution>(parts_.timeline_of(part), *parts_.racks.back(),
                                              plc::ProgramParts{.program = std::move(made.program),
                                                                .sources = std::move(made.sources),
                                                                .labels = std::move(made.labels),
                                                                .tasks = tasks_of(plc),
                                                                .watchdog = plc.watchdog,
                                                                .memory = memory},
                                              report));
  for (const std::string& variable : parts_.executions.back()->not_restored())
    warn(plc.store_place, "store = \"{}\": RETAIN variable {}; it has its initial value", plc.store,
         variable);
}

}  // namespace canopus::plant
