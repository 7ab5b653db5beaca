#include "canopus/cli/new/new_command.hpp"

#include <algorithm>
#include <cctype>
#include <expected>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/cli/bus/scan_command.hpp"
#include "canopus/cli/files/device_file_match.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/plant/new_plant.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;
using plant::NewDevice;
using plant::NewPlant;

/// What ends the command: an exit code and a sentence. No sentence: it was printed.
struct Failure {
  int code = exit_code::usage;
  std::string sentence;
};
using Result = std::expected<void, Failure>;

std::unexpected<Failure> usage(std::string sentence) {
  return std::unexpected(Failure{exit_code::usage, std::move(sentence)});
}

/// A plant before it is written: what its files are called, and their texts.
struct Draft {
  NewPlant plant;
  std::vector<std::string> texts;  ///< of the device files, as plant.devices

  void add(const DeviceFileCandidate& file, std::uint8_t node_id, const std::string& name);
};

/// "IO block 16/16" -> "io-block-16-16": short, in small letters, good as name of a device and of a file.
std::string simple_name(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string name;
  for (const char c : text.substr(0, longest)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (name.ends_with('-')) name.pop_back();
  return name;
}

void Draft::add(const DeviceFileCandidate& file, std::uint8_t node_id, const std::string& name) {
  std::string base = simple_name(name);
  if (base.empty()) base = simple_name(fs::path(file.path).stem().string());
  if (base.empty()) base = "device";
  const auto is_used = [&](const std::string& wanted) {
    return std::ranges::any_of(plant.devices, [&](const NewDevice& other) { return other.name == wanted; });
  };
  std::string unique = base;
  for (unsigned number = 2; is_used(unique); ++number) unique = fmt::format("{}-{}", base, number);
  const auto same = std::ranges::find(texts, file.text);
  std::string extension = fs::path(file.path).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::string path = same != texts.end()
                               ? plant.devices[static_cast<std::size_t>(same - texts.begin())].path
                               : "devices/" + unique + extension;
  plant.devices.push_back({unique, node_id, path, file.file});
  texts.push_back(file.text);
}

// --- questions at a terminal

/// The answer to a question, without blanks around it; the error: there is none, as the input has ended.
std::expected<std::string, Failure> ask(Output& out, std::string_view question) {
  out.line("{}", question);
  std::string answer;
  if (!std::getline(std::cin, answer)) return usage("the input ended; nothing was written");
  const auto first = answer.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : answer.substr(first, answer.find_last_not_of(" \t\r") + 1 - first);
}

Result ask_for_what_is_missing(NewPlantOptions& options, Output& out) {
  const auto modules = plant::module_catalogue();
  for (std::size_t i = 0; i < modules.size(); ++i) {
    out.line("  {}  {}, {}", i + 1, modules[i].data_sheet->model, modules[i].data_sheet->maker);
  }
  const auto module = ask(out, fmt::format("Module (1 to {}, or its name):", modules.size()));
  if (!module) return std::unexpected(module.error());
  options.module = *module;
  if (module->size() == 1 && *module >= "1" && *module <= std::to_string(modules.size())) {
    options.module = modules[static_cast<std::size_t>(module->front() - '1')].data_sheet->model;
  }
  if (options.from_bus || !options.devices.empty()) return {};
  for (;;) {
    const auto device =
        ask(out, "Device file (EDS, DCF, XDD or XDC; NODE=FILE with a node-ID; empty: no more):");
    if (!device) return std::unexpected(device.error());
    if (device->empty()) return {};
    options.devices.push_back(*device);
  }
}

// --- devices

Result add_files(const NewPlantOptions& options, Draft& draft) {
  for (const std::string& text : options.devices) {
    const std::size_t equals = text.find('=');
    const unsigned asked = equals == std::string::npos ? 0 : parse_node(text.substr(0, equals));
    if (equals != std::string::npos && equals <= 4 && asked == 0) {
      return usage(
          fmt::format("--device {}: expected FILE, or NODE=FILE with a node-ID from 1 to 127", text));
    }
    std::vector<std::string> skipped;
    const auto files = read_device_files({asked == 0 ? text : text.substr(equals + 1)}, skipped);
    if (!files) return usage("--device " + files.error());
    for (const DeviceFileCandidate& file : *files) {
      unsigned node_id = asked;
      if (node_id == 0 && file.file->commissioning) node_id = file.file->commissioning->node_id.value_or(0);
      const auto has_it = [&](const NewDevice& other) { return other.node_id == node_id; };
      const bool is_taken = std::ranges::any_of(draft.plant.devices, has_it);
      if (is_taken && asked != 0) {
        return usage(fmt::format("--device {}: another device has node-ID {} already", text, node_id));
      }
      if (node_id == 0 || is_taken) {  // node-ID 1 is left to the module
        std::vector<NewDevice> others = draft.plant.devices;
        others.push_back({"", 1, "", nullptr});
        node_id = plant::free_node_id(others);
      }
      if (node_id == 0) return usage("there are more devices than node-IDs");
      draft.add(file, static_cast<std::uint8_t>(node_id), "");
    }
  }
  return {};
}

Result add_found(const NewPlantOptions& options, Draft& draft, Output& out, Output& err) {
  if (options.eds.empty()) return usage("--from-bus: --eds is missing: device files, or folders of them");
  std::vector<std::string> skipped;
  const auto files = read_device_files(options.eds, skipped);
  for (const std::string& reason : skipped) err.line("canopus new: left out: {}", reason);
  if (!files) return usage(files.error());
  std::vector<client::FoundNode> found;
  const int code = with_bus(options.bus, [&](BusLoop& bus, can::Duration time_out) {
    return scan_bus(bus, {1, 127}, time_out, found);
  });
  if (code != exit_code::done) return std::unexpected(Failure{code, ""});
  for (const client::FoundNode& node : found) {
    const DeviceFileChoice choice = choose_device_file(*files, node);
    if (choice.candidate == nullptr) {
      err.line("canopus new: node {} ({}): no device file matches it: left out", node.node_id,
               node.name.value_or("no name"));
      continue;
    }
    out.line("node {} ({}): {}, match: {}", node.node_id, node.name.value_or("no name"),
             choice.candidate->path, describe(choice.match));
    draft.add(*choice.candidate, node.node_id, node.name.value_or(""));
  }
  if (!draft.plant.devices.empty()) return {};
  return std::unexpected(
      Failure{exit_code::failed, found.empty() ? "no node answers" : "no node has a device file"});
}

Result choose_module(const NewPlantOptions& options, NewPlant& plant) {
  plant.module = plant::find_module(options.module);
  if (plant.module != nullptr) return {};
  if (options.module.empty()) return usage("--module is missing; expected one of " + plant::quoted_models());
  std::vector<std::string_view> models;
  for (const auto& entry : plant::module_catalogue()) models.push_back(entry.data_sheet->model);
  return usage(fmt::format("--module: there is no module \"{}\"{}; expected one of {}", options.module,
                           text::suggestion(options.module, models), plant::quoted_models()));
}

Result choose_bit_rate(const NewPlantOptions& options, NewPlant& plant) {
  const auto rate =
      options.bit_rate.empty() ? plant::common_bit_rate(plant.devices) : bit_rate_of(options.bit_rate);
  if (!rate) return usage(rate.error());
  plant.bit_rate = *rate;
  return {};
}

// --- files

constexpr std::string_view pytest_plugin = "pytest_plugins = [\"canopus_plc.pytest_plugin\"]\n";

constexpr std::string_view plant_test =
    R"py("""Tests of this plant, in virtual time: each test has a plant of its own, from plant.toml."""


def test_every_device_becomes_operational(canopus_plant):
    while set(canopus_plant.states().values()) != {"operational"}:
        assert canopus_plant.time < 60, f"after {canopus_plant.time} s: {canopus_plant.states()}"
        canopus_plant.run(0.1)
)py";

/// The files of the folder that were made; removed again unless they are kept.
class NewFolder {
 public:
  explicit NewFolder(fs::path folder) : folder_(std::move(folder)) {}
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder() {
    std::error_code ignored;
    if (is_kept_) return;
    for (const fs::path& path : made_) fs::remove(path, ignored);
    fs::remove(folder_ / "devices", ignored);
    if (is_new_) fs::remove(folder_, ignored);
  }

  Result make() {
    std::error_code error;
    if (fs::exists(folder_, error)) {
      if (!fs::is_directory(folder_, error)) return usage(fmt::format("{}: is no folder", folder_.string()));
      if (!fs::is_empty(folder_, error)) {
        return usage(fmt::format("{}: the folder is not empty; expected a new one", folder_.string()));
      }
    } else {
      is_new_ = true;
    }
    fs::create_directories(folder_ / "devices", error);
    if (error) return usage(fmt::format("{}: {}", folder_.string(), error.message()));
    return {};
  }
  Result write(const std::string& name, std::string_view content) {
    made_.insert(folder_ / name);
    if (const auto done = write_new_file((folder_ / name).string(), content); !done)
      return usage(done.error());
    return {};
  }
  void keep(Output& out) {
    is_kept_ = true;
    for (const fs::path& path : made_) out.line("{}", path.string());
  }

 private:
  fs::path folder_;
  std::set<fs::path> made_;
  bool is_new_ = false;
  bool is_kept_ = false;
};

/// "PYTHONPATH=/src/python " of a program in its build folder, or installed with the package there; empty: Python finds canopus_plc itself.
std::string python_path() {
  std::error_code none;
  const fs::path folder = fs::read_symlink("/proc/self/exe", none).parent_path();
  for (const char* place : {"../python", "../../python", "../share/canopus/python"}) {
    const fs::path python = (folder / place).lexically_normal();
    if (fs::exists(python / "canopus_plc" / "pytest_plugin.py", none))
      return fmt::format("PYTHONPATH={} ", python.string());
  }
  return {};
}

Result write_plant(const NewPlantOptions& options, Draft draft, Output& out, Output& err) {
  NewFolder folder(options.folder);
  Result result = folder.make();
  for (std::size_t i = 0; i < draft.texts.size() && result; ++i) {
    result = folder.write(draft.plant.devices[i].path, draft.texts[i]);
  }
  if (!result) return result;
  // Read as a run reads it: what is wrong is said now, and the words of the PDOs become comments.
  class : public plant::PlantObserver {
  } observer;
  const std::string path = (fs::path(options.folder) / "plant.toml").string();
  const auto plant = plant::load_plant(path, observer, err, {.text = plant::plant_text(draft.plant)});
  if (!plant) return std::unexpected(Failure{});
  draft.plant.has_program = true;
  result = folder.write("plant.toml", plant::plant_text(draft.plant, plant->connections()));
  if (result) result = folder.write("main.st", plant::program_text(plant->connections()));
  if (result && options.test) result = folder.write("test_plant.py", plant_test);
  if (result && options.test) result = folder.write("conftest.py", pytest_plugin);
  if (!result) return result;
  folder.keep(out);
  out.line("");
  out.line("canopus run {} --virtual --expect-operational=60s", path);
  if (options.test) out.line("{}python3 -m pytest {}", python_path(), options.folder);
  return {};
}

Result new_plant_of(NewPlantOptions options, Output& out, Output& err) {
  if (options.from_bus && !options.devices.empty()) return usage("--from-bus and --device: one of them");
  if (options.module.empty() && is_terminal(STDIN_FILENO)) {
    if (const auto answered = ask_for_what_is_missing(options, out); !answered) return answered;
  }
  Draft draft;
  draft.plant.name = options.name.empty()
                         ? fs::absolute(options.folder).lexically_normal().filename().string()
                         : options.name;
  if (auto chosen = choose_module(options, draft.plant); !chosen) return chosen;
  if (auto added = options.from_bus ? add_found(options, draft, out, err) : add_files(options, draft);
      !added) {
    return added;
  }
  if (draft.plant.devices.empty()) return usage("--device is missing: a device file (EDS, DCF, XDD or XDC)");
  draft.plant.module_node_id = plant::free_node_id(draft.plant.devices);
  if (draft.plant.module_node_id == 0) return usage("no node-ID is left for the module");
  if (auto chosen = choose_bit_rate(options, draft.plant); !chosen) return chosen;
  return write_plant(options, std::move(draft), out, err);
}

void build_new_command(Command& command, int& exit_code) {
  auto options = std::make_shared<NewPlantOptions>();
  command.add_option("FOLDER", options->folder, "Folder of the plant, new or empty")->required();
  std::string models;
  for (const auto& entry : plant::module_catalogue()) {
    models += (models.empty() ? "" : ", ") + std::string(entry.data_sheet->model);
  }
  command.add_option("--module", options->module, "PLC module: " + models)->type_name("MODEL");
  command
      .add_option("--device", options->devices,
                  "Device file (EDS, DCF, XDD, XDC), or a folder of them; with NODE= its node-ID, else that "
                  "of a DCF, or "
                  "the next free one")
      ->type_name("[NODE=]FILE")
      ->allow_extra_args(false);
  command
      .add_option("--bit-rate", options->bit_rate,
                  "Bit rate of the bus; without it one that all device files support")
      ->type_name("RATE");
  command.add_option("--name", options->name, "Name of the plant; without it the folder's")
      ->type_name("NAME");
  Option* from_bus =
      command.add_flag("--from-bus", options->from_bus, "The devices are those that answer on --bus");
  command.add_option("--eds", options->eds, "Device files and folders of them, for --from-bus")
      ->type_name("FILE")
      ->needs(from_bus);
  command.add_flag("--test", options->test, "A test of the plant for pytest as well");
  add_bus_options(command, options->bus, "for each answer of a node", false);
  command.footer(
      "At a terminal it asks for what is missing. The plant boots at the first run: the module is the NMT "
      "master, and\n"
      "words of it hold PDO1 of every device. main.st is a PLC program to begin with: these words are its "
      "variables.\n"
      "Exit codes: 0 written, 1 no node answers, 2 wrong usage or files.\n"
      "Example: canopus new line --module ME3CAN1-Q --device io.eds --device 5=drive.eds --test");
  command.callback(
      [options, &exit_code] { exit_code = new_plant(*options, standard_output(), standard_error()); });
}

}  // namespace

int new_plant(const NewPlantOptions& options, Output& out, Output& err) {
  const Result result = new_plant_of(options, out, err);
  if (result) return exit_code::done;
  if (!result.error().sentence.empty()) err.line("canopus new: {}", result.error().sentence);
  return result.error().code;
}

void add_new_command(Command& app, int& exit_code) {
  app.add_subcommand("new", "Write a plant of a module and devices that boots at the first run",
                     [&exit_code](Command& command) { build_new_command(command, exit_code); });
}

}  // namespace canopus::cli
