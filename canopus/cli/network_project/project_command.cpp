#include "canopus/cli/network_project/project_command.hpp"

#include <memory>
#include <utility>

#include <fmt/format.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/network_project/network_load.hpp"
#include "canopus/text/bit_rate.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using Action = int (*)(const ProjectArguments&);

/// Adds a command; each has arguments of its own.
struct Adder {
  Command& group;
  int& exit_code;

  std::pair<Command*, std::shared_ptr<ProjectArguments>> add(const char* name, const char* help,
                                                             Action action, Command* below = nullptr) const {
    auto arguments = std::make_shared<ProjectArguments>();
    Command* command = (below != nullptr ? below : &group)->add_subcommand(name, help);
    command->add_option("PROJECT", arguments->project, "folder with nodelist.cpj, or a file *.cpj")
        ->required();
    command->add_option("--network", arguments->network, "number of the network in the list, from 1")
        ->type_name("NUMBER")
        ->check(number_from(1, 1000));
    command->add_flag("--json", arguments->bus.json, "one JSON object per line");
    command->callback([arguments, action, code = &exit_code] { *code = action(*arguments); });
    return {command, arguments};
  }
};

void add_dry_run(Command& command, ProjectArguments& arguments) {
  command.add_flag("--dry-run", arguments.dry_run,
                   "show the changes and the load of the bus, but write nothing");
}

constexpr const char* node_help = "node-ID, or name in the project";

void add_node(Command& command, ProjectArguments& arguments, bool required) {
  command.add_option("NODE", arguments.node, node_help)->required(required);
}

void add_node_id(Command& command, unsigned& node_id, const char* help) {
  command.add_option("--node-id", node_id, help)->type_name("1-127")->check(number_from(1, 127));
}

void add_looking(const Adder& adder) {
  {
    auto [command, arguments] =
        adder.add("show", "List the nodes of a project, or the configuration of one", show_network);
    add_node(*command, *arguments, false);
    command->add_flag("--all", arguments->all_values,
                      "of a node: every object, not only the configured ones");
  }
  {
    auto [command, arguments] =
        adder.add("check", "Check files, bit rate, CAN-IDs, PDOs, SYNC, heartbeats and load", check_network);
    command->add_flag("--strict", arguments->strict, "treat warnings as mistakes");
    command
        ->add_option("--plant", arguments->plant,
                     "plant file whose module sends and receives PDOs of this network, too")
        ->type_name("PLANT");
  }
}

void add_changing(const Adder& adder) {
  {
    auto [command, arguments] = adder.add("new", "Make a project without nodes", new_network);
    command->add_option("--name", arguments->name, "of the network")->type_name("NAME");
  }
  {
    auto [command, arguments] =
        adder.add("add", "Add a node: its DCF or XDC is made of a device file", add_network_node);
    command->add_option("EDS", arguments->file, "device file: EDS, DCF, XDD or XDC")->required();
    add_node_id(*command, arguments->node_id, "default: the lowest free one");
    command->add_option("--name", arguments->name, "of the node; without it the product's")
        ->type_name("NAME");
    command->add_option("--bit-rate", arguments->bit_rate, "default: that of the other nodes")
        ->type_name("RATE");
  }
  {
    auto [command, arguments] = adder.add("remove", "Remove a node and its DCF", remove_network_node);
    add_node(*command, *arguments, true);
  }
  {
    auto [command, arguments] =
        adder.add("set", "Give objects of a node values, or change a node or the network", set_in_network);
    add_node(*command, *arguments, false);
    command->add_option("OBJECT=VALUE", arguments->items,
                        "1017=500, \"Producer heartbeat time=500\", '1800:01=$NODEID+0x180'");
    command
        ->add_option_function(
            "--name",
            [arguments = arguments](const std::string& name) {
              arguments->name = name;
              arguments->is_named = true;
              return std::string();
            },
            "of the node, or without NODE of the network")
        ->type_name("NAME");
    add_node_id(*command, arguments->node_id, "new node-ID; COB-IDs that contain it are changed, too");
    command
        ->add_option_function(
            "--reference",
            [arguments = arguments](const std::string& reference) {
              arguments->reference = reference;
              arguments->has_reference = true;
              return std::string();
            },
            "reference designation, for example -M1")
        ->type_name("TEXT");
    auto* const present = command->add_flag("--present", arguments->present, "the node is on the bus");
    command->add_flag("--absent", arguments->absent, "the node is configured, but not there")
        ->excludes(present);
    command->add_option("--bit-rate", arguments->bit_rate, "of all nodes (without NODE), for example 500k")
        ->type_name("RATE");
  }
  {
    auto [command, arguments] =
        adder.add("unset", "Remove values of objects: their defaults are used", unset_in_network);
    add_node(*command, *arguments, true);
    command->add_option("OBJECT", arguments->items, "1017, \"Producer heartbeat time\"")->required();
  }
  {
    auto [command, arguments] =
        adder.add("note", "Write a note about a node: shown, and in the report", note_in_network);
    add_node(*command, *arguments, true);
    command->add_option("TEXT", arguments->note, "text of the note; \"\" removes it")->required();
  }
  adder.add("undo", "Revert the latest change, then the one before it (50 at most)", undo_in_network);
  {
    auto [command, arguments] = adder.add(
        "concise", "Write a node's configuration as a concise DCF, for 1F22H of a master", write_concise_dcf);
    add_node(*command, *arguments, true);
    command->add_option("FILE", arguments->file, "the file to be written")->required();
  }
}

void add_bus(Command& command, ProjectArguments& arguments) {
  add_bus_options(command, arguments.bus, "for each answer of a node", false);
}

void add_online(const Adder& adder) {
  {
    auto [command, arguments] =
        adder.add("diff", "Show the differences between devices and project", compare_network);
    add_node(*command, *arguments, false);
    add_bus(*command, *arguments);
  }
  {
    auto [command, arguments] =
        adder.add("write", "Write the differences into the devices, and read them back", write_network);
    add_node(*command, *arguments, false);
    add_bus(*command, *arguments);
    command->add_flag("--yes", arguments->yes, "write; without it what would be written is shown");
    command->add_flag("--save", arguments->save, "and have the devices save it (1010:01)");
  }
  {
    auto [command, arguments] =
        adder.add("read", "Copy different values from the devices into the project", read_network);
    add_node(*command, *arguments, false);
    add_bus(*command, *arguments);
  }
  {
    auto [command, arguments] = adder.add(
        "adopt",
        "Make a project of a running network: scan it, match device files, and read the configuration",
        adopt_network);
    command->add_option("--eds", arguments->eds, "a device file, or a folder with them; may be given again")
        ->type_name("FILE")
        ->required()
        ->allow_extra_args(false);
    command->add_option("--nodes", arguments->nodes, "only these node-IDs, for example 1-32")
        ->type_name("FIRST-LAST")
        ->capture_default_str();
    command->add_option("--bit-rate", arguments->bit_rate, "what the DCFs will say")->type_name("RATE");
    command->add_flag("--no-values", arguments->no_values,
                      "read the identity of the devices, but not their configuration");
    add_bus(*command, *arguments);
  }
  {
    auto [command, arguments] =
        adder.add("accept", "Accept a replaced device: its identity becomes the project's", accept_device);
    add_node(*command, *arguments, true);
    add_bus(*command, *arguments);
    command->add_flag("--yes", arguments->yes, "do it; without it what would change is shown");
  }
  {
    auto [command, arguments] = adder.add(
        "report", "Write an HTML page: nodes, process data, load, findings, and differences from the devices",
        report_network);
    command->add_option("FILE", arguments->file, "the page to be written, *.html")->required();
    command->add_flag("--devices", arguments->with_devices, "ask the devices, too");
    add_bus(*command, *arguments);
  }
}

void add_dcfs(const Adder& adder) {
  Command* dcf = adder.group.add_subcommand("dcf", "Save a node's DCF, or take over another one's values");
  dcf->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, int (*run)(const ProjectArguments&),
                       const char* file) {
    auto [command, arguments] = adder.add(name, what, run, dcf);
    add_node(*command, *arguments, true);
    command->add_option("FILE", arguments->file, file)->required();
  };
  add("save", "Write the DCF or XDC of a node to a file", save_dcf, "the file to be written");
  add("compare", "Show which configured values a DCF has otherwise than the project", compare_dcf,
      "DCF or XDC of the same device");
  add("load", "Take over the configured values of a DCF: those, and no others", load_dcf,
      "DCF or XDC of the same device");
}

void add_pdos(const Adder& adder) {
  Command* pdo = adder.group.add_subcommand("pdo", "List, map and link the PDOs of a project");
  pdo->require_subcommand(1);
  {
    auto [command, arguments] = adder.add(
        "list", "List PDOs: CAN-ID, type, what is mapped, and where it goes", list_network_pdos, pdo);
    add_node(*command, *arguments, false);
    command->add_flag("--all", arguments->all_values, "disabled PDOs, too");
  }
  const auto add_pdo = [](Command& command, ProjectArguments& arguments) {
    add_node(command, arguments, true);
    command.add_option("PDO", arguments.pdo, "tpdo1, rpdo2 and so on")->required();
  };
  {
    auto [command, arguments] =
        adder.add("map", "Map objects into a PDO, set its CAN-ID, type and times, and switch it on",
                  map_network_pdo, pdo);
    add_pdo(*command, *arguments);
    command->add_option("OBJECT", arguments->items, "what is mapped, in order; none: the mapping stays");
    command
        ->add_option("--can-id", arguments->cob_id,
                     "for example 0x181; free: one that nothing in the project has")
        ->type_name("ID");
    command->add_option("--type", arguments->type, "transmission type")->type_name("0-255");
    command->add_option("--inhibit", arguments->inhibit, "inhibit time, for example 10ms")->type_name("TIME");
    command->add_option("--event", arguments->event, "event timer, for example 100ms")->type_name("TIME");
    add_dry_run(*command, *arguments);
  }
  {
    auto [command, arguments] =
        adder.add("off", "Switch a PDO off (bit 31 of its COB-ID)", switch_network_pdo_off, pdo);
    add_pdo(*command, *arguments);
    add_dry_run(*command, *arguments);
  }
  {
    auto [command, arguments] =
        adder.add("link", "Send a signal of one node to another: CAN-ID and both mappings are chosen",
                  link_network_signals, pdo);
    command
        ->add_option(
            "FROM TO", arguments->items,
            "NODE.SIGNAL each, for example 2.6004 or \"Pump.Target velocity\"; `canopus project show PROJECT "
            "NODE --all` lists the objects of a node")
        ->required()
        ->expected(2);
    add_dry_run(*command, *arguments);
  }
}

}  // namespace

int project_failed(int code, const std::string& message) {
  print_error("canopus project: {}", message);
  return code;
}

std::expected<std::uint32_t, std::string> bit_rate_of(const std::string& text) {
  if (text.empty()) return 0;
  auto bit_rate = text::parse_bit_rate(text);
  if (!bit_rate)
    return std::unexpected(fmt::format("--bit-rate {}: {}", eds::printable(text), bit_rate.error()));
  return bit_rate;
}

static void warn_if_unfinished(const ProjectFolder& folder) {
  if (const auto sentence = folder.unfinished()) print_error("canopus project: {}", *sentence);
}

int with_network(
    const ProjectArguments& arguments,
    const std::function<int(const ProjectFolder&, const network_project::NetworkProject&)>& action) {
  auto folder = ProjectFolder::open(arguments.project, ProjectFolder::For::looking);
  if (!folder) return project_failed(project_code::file, folder.error());
  const auto project = folder->read(arguments.network);
  warn_if_unfinished(*folder);
  if (!project) return project_failed(project_code::file, project.error());
  return action(*folder, *project);
}

/// Prints the effect of a change on the bus load, without making it.
static void print_load(const ProjectArguments& arguments, const network_project::NetworkLoad& before,
                       const network_project::NetworkLoad& after) {
  if (arguments.bus.json) {
    return print_json(text::Json{{"event", "dry run"},
                                 {"bit_rate", after.bit_rate},
                                 {"load", after.steady},
                                 {"load_before", before.steady},
                                 {"load_at_most", after.most},
                                 {"load_at_most_before", before.most},
                                 {"unlimited", after.unlimited},
                                 {"unlimited_before", before.unlimited}});
  }
  print_line(
      "load {:.1f} % (was {:.1f} %) by timers and SYNC, {:.1f} % (was {:.1f} %) at most; nothing is written",
      after.steady * 100, before.steady * 100, after.most * 100, before.most * 100);
}

int change_network(const ProjectArguments& arguments, const std::string& title,
                   const std::function<int(ProjectFolder&, network_project::NetworkProject&)>& action) {
  // Nothing is made in a folder that has no project, and none is about to be made.
  if (auto looked = ProjectFolder::open(arguments.project, ProjectFolder::For::looking);
      looked && !looked->unfinished()) {
    if (const auto project = looked->read(arguments.network); !project) {
      return project_failed(project_code::file, project.error());
    }
  }
  const auto purpose = arguments.dry_run ? ProjectFolder::For::looking : ProjectFolder::For::changing;
  auto folder = ProjectFolder::open(arguments.project, purpose);
  if (!folder) return project_failed(project_code::file, folder.error());
  warn_if_unfinished(*folder);
  auto project = folder->read(arguments.network);
  if (!project) return project_failed(project_code::file, project.error());
  if (!arguments.dry_run) {
    return run_ignoring_sigpipe([&] {
      const int code = action(*folder, *project);
      const bool is_kept =
          code == project_code::done || code == project_code::no_answer || code == project_code::different;
      if (!is_kept) return code;
      const auto saved = folder->save(*project, title);
      return saved ? code : project_failed(project_code::file, saved.error());
    });
  }
  const network_project::NetworkLoad before = reckon_load(*project);
  const int code = action(*folder, *project);
  if (code == project_code::done) print_load(arguments, before, reckon_load(*project));
  return code;
}

namespace {

void build_project_command(Command& group, int& exit_code) {
  group.require_subcommand(1);
  group.footer(
      "A project is a folder: nodelist.cpj names the nodes, and each has its DCF beside it. Other tools read "
      "and write the\n"
      "same files; what is not changed stays byte for byte.\n"
      "Exit codes: 0 done, 1 no bus, or a node does not answer, 2 wrong command line, 3 a file cannot be "
      "read or written,\n"
      "4 differences, or errors in the project, 5 the project cannot be as asked for, 6 a node refused a "
      "value.\n"
      "docs/project.md goes through it.");
  const Adder adder{group, exit_code};
  add_changing(adder);
  add_looking(adder);
  add_dcfs(adder);
  add_pdos(adder);
  add_online(adder);
}

}  // namespace

void add_project_command(Command& app, int& exit_code) {
  app.add_subcommand("project", "Set up a CANopen network: nodes, values and PDOs as CiA 306 files",
                     [&exit_code](Command& group) { build_project_command(group, exit_code); });
}

}  // namespace canopus::cli
