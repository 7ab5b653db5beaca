#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "canopus/cli/files/given_file.hpp"
#include "canopus/cli/network_project/project_folder.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/plc_arguments.hpp"
#include "canopus/cli/run/run_loop.hpp"
#include "canopus/cli/run/web_options.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

struct WebArguments {
  std::string project;
  unsigned network = 1;
  std::string bus;
  bool no_devices = false;
  std::vector<std::string> device_files;
  std::string listen;
  PlcArguments plc;  // of a module project
  web::WebAccess access;
  std::string duration;
  bool json = false;
  bool quiet = false;
};

/// As a TOML string.
std::string in_toml(std::string_view text) {
  using Json = text::Json;
  return Json(text::printable(text)).dump();
}

/// A plant of one bus: the real one, or a simulated one with the project's nodes.
std::string plant_text(const WebArguments& arguments, const network_project::NetworkProject& project,
                       const std::string& list, bool with_devices) {
  constexpr std::uint32_t default_bit_rate = 500'000;
  const std::uint32_t bit_rate = project.bit_rate() != 0 ? project.bit_rate() : default_bit_rate;
  const std::string& name = project.network().name;
  std::string text = fmt::format("[plant]\nname = {}\n[[bus]]\nname = \"network\"\nbit_rate = {}\n",
                                 in_toml(name.empty() ? arguments.project : name), bit_rate);
  if (!arguments.bus.empty()) return text + fmt::format("link = {}\n", in_toml(arguments.bus));
  if (!with_devices) return text;
  return text + fmt::format("project = {}\nproject_network = {}\n",
                            in_toml(std::filesystem::absolute(list).string()), arguments.network);
}

/// A run has a bus at least.
std::string plant_without_devices(const std::string& name) {
  return fmt::format("[plant]\nname = {}\n[[bus]]\nname = \"none\"\nbit_rate = 500_000\n", in_toml(name));
}

/// Whether a plant can be built from it; otherwise prints the errors, which do not prevent editing the
/// project.
bool has_devices(const std::string& text, const std::string& list) {
  class : public plant::PlantObserver {
  } no_observer;
  if (plant::load_plant(list, no_observer, standard_error(), {.text = text}) != nullptr) return true;
  print_error("canopus web: {}: the nodes of the project are not simulated; the page shows what is wrong",
              list);
  return false;
}

/// Common to runs with and without a project.
int run_page(const WebArguments& arguments, RunOptions options) {
  options.web = text::HostAndPort{};
  options.web_access = arguments.access;
  if (!arguments.listen.empty()) options.web = *text::parse_host_and_port(arguments.listen);
  if (!arguments.duration.empty()) options.duration = *text::parse_duration(arguments.duration);
  options.quiet = arguments.quiet;
  options.json = arguments.json;
  return run_plant(options);
}

/// The page of a folder; `given` is empty: of the working folder.
int run_start(const WebArguments& arguments, const std::string& given) {
  std::error_code error;
  const std::string folder = given.empty() ? std::filesystem::current_path(error).string()
                                           : std::filesystem::canonical(given, error).string();
  if (error) {
    print_error("canopus web: the folder {}: {}", given.empty() ? "." : given, error.message());
    return 1;
  }
  RunOptions options{.plant = "canopus", .plant_text = plant_without_devices("Canopus")};
  options.web_project = web::WebProject{.start = folder};
  return run_page(arguments, std::move(options));
}

/// Options of other commands that lead to the same PLC; the remote password goes by the environment, which
/// other users cannot read.
std::vector<std::string> way_of(const PlcArguments& plc) {
  std::vector<std::string> way{"--plc=" + plc_place_text(plc.connection.host, plc.port),
                               "--timeout=" + plc.timeout};
  const auto frame = frame_of(plc);
  if (frame == client::PlcConnection::Frame::frame_4e) way.emplace_back("--4e");
  if (frame == client::PlcConnection::Frame::frame_1e) way.emplace_back("--1e");
  if (plc.cpu != "none") way.push_back("--cpu=" + plc.cpu);
  if (plc.connection.ascii) way.emplace_back("--ascii");
  if (plc.connection.udp) way.emplace_back("--udp");
  if (!plc.connection.remote_password.empty())
    ::setenv("CANOPUS_PLC_PASSWORD", plc.connection.remote_password.c_str(), 1);
  return way;
}

/// The page of a module's settings.
int run_settings(const WebArguments& arguments) {
  constexpr int file_error = 3;
  auto settings = read_web_settings(arguments.project);
  if (!settings) {
    print_error("canopus web: {}; `canopus configure new` makes one", settings.error());
    return file_error;
  }
  settings->plc = way_of(arguments.plc);
  settings->setup = arguments.plc.setup;
  settings->device_files = arguments.device_files;
  if (settings->device_files.empty()) {
    const std::filesystem::path folder = std::filesystem::path(arguments.project).parent_path();
    settings->device_files = {folder.empty() ? "." : folder.string()};
  }
  settings->is_live = true;
  RunOptions options{.plant = arguments.project, .plant_text = plant_without_devices(arguments.project)};
  options.web_project = web::WebProject{};
  options.web_settings = {std::move(*settings)};
  return run_page(arguments, std::move(options));
}

int run_project(const WebArguments& arguments) {
  constexpr int file_error = 3;
  auto folder = ProjectFolder::open(arguments.project, ProjectFolder::For::looking);
  if (!folder) {
    print_error("canopus web: {}", folder.error());
    return file_error;
  }
  const auto unfinished = folder->unfinished();
  if (unfinished) print_error("canopus web: {}; until then its nodes are not simulated", *unfinished);
  const auto project = folder->read(arguments.network);
  if (!project) {
    print_error("canopus web: {}; `canopus project new` makes a project", project.error());
    return file_error;
  }
  const std::string list = folder->shown_list();
  // The plant is built from the present files, some of which may already be changed.
  bool with_devices =
      !unfinished && arguments.bus.empty() && !arguments.no_devices && !project->nodes().empty();
  if (with_devices) with_devices = has_devices(plant_text(arguments, *project, list, true), list);
  RunOptions options{.plant = list, .plant_text = plant_text(arguments, *project, list, with_devices)};
  // The project's own folder has its DCFs, which are device files, too.
  options.web_project = web::WebProject{
      .project = arguments.project, .network = arguments.network, .device_files = arguments.device_files};
  if (options.web_project->device_files.empty())
    options.web_project->device_files = {folder->folder().string()};
  return run_page(arguments, std::move(options));
}

/// A plant is run as by `canopus run PLANT --web`.
int run_plant_on_page(const WebArguments& arguments) {
  RunOptions options{.plant = given_plant(arguments.project).path};
  if (!arguments.bus.empty()) options.links.push_back(arguments.bus);
  return run_page(arguments, std::move(options));
}

int run_given(const WebArguments& arguments) {
  const std::string& given = arguments.project;
  if (given.empty()) return run_start(arguments, given);
  const FileKind kind = kind_of_file(given);
  switch (kind) {
    case FileKind::project: return run_project(arguments);
    case FileKind::module_project: return run_settings(arguments);
    case FileKind::folder: return run_start(arguments, given);
    case FileKind::unknown:
    case FileKind::plant: {
      std::error_code ignored;
      const std::filesystem::path list = std::filesystem::path(given) / "nodelist.cpj";
      return std::filesystem::exists(list, ignored) ? run_project(arguments) : run_plant_on_page(arguments);
    }
    default: print_error("canopus web: {}", describe_given_file(given, kind)); return 2;
  }
}

void build_web_command(Command& command, int& exit_code) {
  auto arguments = std::make_shared<WebArguments>();
  auto* project =
      command.add_option("PROJECT", arguments->project,
                         "folder with nodelist.cpj, a file *.cpj, a module project *.xml (canopus "
                         "configure), or a plant file *.toml, as of `canopus run PLANT --web`; of another "
                         "folder, or without it of this one, the page offers the plants and projects, a new "
                         "project, and a built-in plant");
  command.add_option("--network", arguments->network, "number of the network in the list, from 1")
      ->type_name("NUMBER")
      ->check(number_from(1, 1000))
      ->needs(project);
  auto* bus = command
                  .add_option("--bus", arguments->bus,
                              "the real bus, for example socketcan:can0; without it the project's nodes are "
                              "simulated (docs/commands.md has the addresses)")
                  ->type_name("ADDRESS");
  command.add_flag("--no-devices", arguments->no_devices, "neither a bus nor simulated nodes: files alone")
      ->excludes(bus)
      ->needs(project);
  bus->needs(project);
  command
      .add_option("--eds", arguments->device_files,
                  "a device file, or a folder with them, for devices that are found on the bus; may be given "
                  "again; without it the project's folder")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command
      .add_option("--listen", arguments->listen,
                  "address and port of this machine for the page; without it a free port (docs/web.md)")
      ->type_name("ADDRESS:PORT")
      ->check([](const std::string& text) {
        const auto place = text::parse_host_and_port(text);
        return place ? std::string() : place.error();
      });
  command.option_group("The PLC of a module project");
  add_connection_options(command, arguments->plc);
  for (const char* name : {"--modbus", "--unit", "--octal", "--module"})
    command.remove_option(command.get_option(name));
  command.option_group("Options");
  add_web_access_options(command, "--", arguments->access);
  command.add_option("--for", arguments->duration, "Stop after this time, for example 10s")
      ->type_name("TIME")
      ->check([](const std::string& text) {
        const auto duration = text::parse_duration(text);
        return duration ? std::string() : duration.error();
      });
  auto* json = command.add_flag("--json", arguments->json, "One JSON object per line (see docs/events.md)");
  command.add_flag("-q,--quiet", arguments->quiet, "Print errors alone")->excludes(json);
  command.footer(
      "It prints the address of the page. Anyone who has the key in this address may edit the project. On a "
      "real\n"
      "bus nothing is written before a user has armed writing on the page.\n"
      "Example: canopus web line1 --bus socketcan:can0");
  command.callback([arguments, &exit_code] { exit_code = run_given(*arguments); });
}

}  // namespace

void add_web_command(Command& app, int& exit_code) {
  app.add_subcommand("web", "Show and edit a project on a page in the browser, on a bus or simulated",
                     [&exit_code](Command& command) { build_web_command(command, exit_code); });
}

}  // namespace canopus::cli
