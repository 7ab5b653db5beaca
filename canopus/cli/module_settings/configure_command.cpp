#include "canopus/cli/module_settings/configure_command.hpp"

#include <memory>

#include "canopus/ascii/number.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"

namespace canopus::cli {
namespace {

using Action = int (*)(const ConfigureArguments&);

std::string why_no_model(const std::string& name) {
  if (module_settings::find_tool(plant::configuration_tools(), name) != nullptr) return {};
  return fmt::format("\"{}\" is not known; expected one of {}", name,
                     module_settings::models_of(plant::configuration_tools()));
}

void add_model_option(Command& command, ConfigureArguments& arguments) {
  arguments.model = plant::configuration_tools().front()->model;
  command
      .add_option("--module", arguments.model,
                  "the module: " + module_settings::models_of(plant::configuration_tools()))
      ->type_name("MODEL")
      ->check(why_no_model)
      ->capture_default_str();
  command.add_old_spelling({.old = "--model", .now = "--module"});
}

/// Adds a command; each has arguments of its own.
struct Adder {
  Command& group;
  int& exit_code;

  std::pair<Command*, std::shared_ptr<ConfigureArguments>> add(const char* name, const char* help,
                                                               Action action) const {
    auto arguments = std::make_shared<ConfigureArguments>();
    Command* command = group.add_subcommand(name, help);
    command->callback([arguments, action, code = &exit_code] {
      *code = run_ignoring_sigpipe([&] {
        const std::string wrong = resolve_node(*arguments);
        return wrong.empty() ? action(*arguments) : configure_failed(configure_code::usage, wrong);
      });
    });
    return {command, arguments};
  }
  auto with_file(const char* name, const char* help, Action action) const {
    auto added = add(name, help, action);
    added.first->add_option("PROJECT", added.second->file, "the project's file")->required();
    return added;
  }
  auto online(const char* name, const char* help, Action action) const {
    auto added = add(name, help, action);
    add_online_options(*added.first, *added.second);
    added.first
        ->add_option("--module", added.second->model,
                     "the module, instead of the one that goes with the PLC's type")
        ->type_name("MODEL")
        ->check(why_no_model);
    added.first->add_old_spelling({.old = "--model", .now = "--module"});
    added.first
        ->add_option("--project", added.second->file, "the module of this project: its model and its number")
        ->type_name("FILE");
    return added;
  }
  static void add_online_options(Command& command, ConfigureArguments& arguments) {
    add_connection_options(command, arguments.plc);
    command.remove_option(command.get_option("--module"));  // of names of words, which no command here takes
    command
        .add_option("--number", arguments.module_number,
                    "the module: the number behind U, instead of the project's")
        ->type_name("0-254")
        ->check(number_from(0, 254));
  }
};

const std::vector<std::string_view> window_words{"basic",  "node",  "tpdo",     "rpdo",
                                                 "master", "slave", "consumer", "producer"};

void add_transfer_options(Command& command, ConfigureArguments& arguments) {
  Adder::add_online_options(command, arguments);
  command.add_option("--part", arguments.part, "part to transfer")
      ->type_name("PART")
      ->check(one_of_words({"all", "basic", "tpdo", "rpdo", "nmt"}))
      ->capture_default_str();
  command.add_option("--pdos", arguments.pdos, "PDO area: all, 5- (starting from 5) or 3-8")
      ->type_name("AREA")
      ->capture_default_str();
  command
      .add_option("--node", arguments.node_text,
                  "another CANopen node than the module, over the network: node-ID or name")
      ->type_name("NODE");
}

void add_offline(const Adder& adder) {
  {
    auto [command, arguments] = adder.with_file("new", "Create a project", new_project);
    add_model_option(*command, *arguments);
    command
        ->add_option("--number", arguments->module_number,
                     "the number behind U: its Module number, or its Module address / 16")
        ->type_name("0-254")
        ->check(number_from(0, 254));
  }
  {
    auto [command, arguments] = adder.with_file("show", "Show the settings of a project", show_project);
    command->add_option("WINDOW", arguments->window, "only these")->check(one_of_words(window_words));
    command->add_flag("--json", arguments->json, "one JSON object per row");
  }
  {
    auto [command, arguments] =
        adder.with_file("set", "Set fields; a row that is not there is added", set_in_project);
    command
        ->add_option(
            "WINDOW", arguments->window,
            "basic, node/NODE, tpdo/NUMBER, rpdo/NUMBER, master, slave/NODE, consumer/NODE, producer")
        ->required();
    command->add_option("FIELD=VALUE", arguments->settings,
                        "\"Node ID=5\", CAN-ID (11-bit)=0x181, \"map=A100:01:16 A100:02:16\"");
  }
  {
    auto [command, arguments] = adder.with_file("delete", "Delete a row", delete_from_project);
    command->add_option("WINDOW/NUMBER", arguments->window, "tpdo/3, slave/5 and so on")->required();
  }
  {
    auto [command, arguments] =
        adder.with_file("defaults", "Restore the default values of a window", restore_in_project);
    command->add_option("WINDOW", arguments->window, "basic, tpdo and so on")->required();
  }
  {
    auto [command, arguments] = adder.with_file(
        "undo", "Take back the latest change of a project, then the one before it (50 at most)",
        undo_in_project);
    command->add_flag("--json", arguments->json, "what was taken back as a JSON object");
  }
  {
    auto [command, arguments] = adder.with_file("check", "Check a project", check_project);
    command->add_flag("--json", arguments->json, "one JSON object per finding");
  }
  {
    auto [command, arguments] = adder.with_file("export", "Write a backup of a project", export_project);
    command->add_option("XML", arguments->other_file, "the backup, *.xml")->required();
  }
  {
    auto [command, arguments] = adder.with_file("import", "Read a backup into a project", import_project);
    command->add_option("XML", arguments->other_file, "the backup")->required();
  }
  {
    auto [command, arguments] = adder.add(
        "describe", "Describe the fields of a module's windows: meaning, range, default", describe_windows);
    add_model_option(*command, *arguments);
    command->add_option("WINDOW", arguments->window, "only this one")->check(one_of_words(window_words));
    command->add_flag("--json", arguments->json, "one JSON object per window and field");
  }
  {
    auto [command, arguments] =
        adder.add("objects", "List the objects that a module's PDOs can carry", list_mappable_objects);
    add_model_option(*command, *arguments);
    command->add_option("WINDOW", arguments->window, "only of these PDOs")
        ->check(one_of_words({"tpdo", "rpdo"}));
    command->add_flag("--json", arguments->json, "one JSON object per name and data type");
  }
  adder.add("recent", "List the ten projects used last",
            [](const ConfigureArguments&) { return list_recent_projects(); });
}

void add_nodes(const Adder& adder) {
  {
    auto [command, arguments] = adder.with_file(
        "nodes", "List the hardware data of the project's nodes, or have them save or restore", list_nodes);
    Adder::add_online_options(*command, *arguments);
    command->add_option("--node", arguments->node_text, "only this one: node-ID or name")->type_name("NODE");
    auto* const save =
        command->add_flag("--save", arguments->save, "Save Object Dictionary: 1010:01 of each node");
    command
        ->add_flag("--restore", arguments->restore,
                   "Restore Object Dictionary to default: 1011:01 of each node")
        ->excludes(save);
    command->add_flag("--yes", arguments->yes, "do it");
    command
        ->add_option(
            "--eds", arguments->device_files,
            "a device file, or a folder with them: EDS file version and EDS file revision of the nodes that "
            "it is for; may be given again")
        ->type_name("FILE")
        ->allow_extra_args(false);
    command->add_flag("--json", arguments->json, "one JSON object per node");
  }
  {
    auto [command, arguments] = adder.with_file(
        "identify", "Put a slave's device type and identity into the project's assignment list",
        identify_slave);
    Adder::add_online_options(*command, *arguments);
    command->add_option("NODE", arguments->node_text, "the slave: node-ID or name")->required();
    command
        ->add_option("--source", arguments->from,
                     "read them from the slave itself, or from the NMT master's list")
        ->type_name("WHICH")
        ->check(one_of_words({"slave", "master"}))
        ->capture_default_str();
    command->add_old_spelling({.old = "--from", .now = "--source"});
    command->add_flag("--json", arguments->json, "one JSON object per field");
  }
}

void add_online(const Adder& adder) {
  {
    auto [command, arguments] =
        adder.with_file("read", "Read settings of the module into a project", read_from_module);
    add_transfer_options(*command, *arguments);
  }
  {
    auto [command, arguments] =
        adder.with_file("diff", "Show the differences between module and project", compare_with_module);
    add_transfer_options(*command, *arguments);
    command->add_flag("--json", arguments->json, "one JSON object per field");
  }
  {
    auto [command, arguments] = adder.with_file(
        "write", "Download the project: write the differences into the module's flash ROM", write_to_module);
    add_transfer_options(*command, *arguments);
    command->add_flag("--yes", arguments->yes, "write; without it the differences are shown");
    command->add_flag("--stop", arguments->stop, "put the CPU module into STOP for it, and into RUN again");
    command->add_flag("--json", arguments->json, "one JSON object per difference and step");
  }
  {
    auto [command, arguments] = adder.online(
        "scan", "Network scan: list node-ID and product name of all CANopen nodes", scan_through_module);
    command->add_option("--nodes", arguments->nodes, "all, 5- (starting from 5) or 3-8, of 1 to 127")
        ->type_name("AREA")
        ->capture_default_str();
    auto* json = command->add_flag("--json", arguments->json, "one JSON object per node");
    command
        ->add_flag("--progress", arguments->progress,
                   "with --json: which node is asked, too, {\"current\": 5}")
        ->needs(json);
  }
  for (const bool writes : {false, true}) {
    auto [command, arguments] = writes
                                    ? adder.online("sdo-write", "SDO write to any CANopen node", write_object)
                                    : adder.online("sdo-read", "SDO read of any CANopen node", read_object);
    command->add_option("NODE", arguments->node_text, "node-ID or name; 0: the module itself")->required();
    command->add_option("OBJECT", arguments->object, "index and sub-index: 1018:02, 0x1018:0x02")->required();
    command->add_flag("--json", arguments->json, "the result as a JSON object");
    if (!writes) continue;
    command->add_option("DATA", arguments->data, "a number (0x... hexadecimal), or text")->required();
    command->add_option("--length", arguments->length, "of the data")
        ->type_name("LENGTH")
        ->check(one_of_words(
            {"STRING", "BYTE_LENGTH_1", "BYTE_LENGTH_2", "BYTE_LENGTH_4", "BYTE_LENGTH_6", "BYTE_LENGTH_8"}))
        ->capture_default_str();
  }
  {
    auto [command, arguments] =
        adder.online("status", "Module status: state, bus, errors in words", show_module_status);
    command->add_flag("--clear", arguments->clear, "clear the error display first");
    command->add_flag("--json", arguments->json, "one JSON object per line of it");
  }
  {
    auto [command, arguments] =
        adder.online("reset", "NMT master reset: reset and restart the connected NMT master", reset_module);
    command->add_flag("--yes", arguments->yes, "do it");
  }
}

}  // namespace

int configure_failed(int code, const std::string& message) {
  print_error("canopus configure: {}", message);
  return code;
}

std::expected<module_settings::PdoRange, std::string> parse_area(const std::string& text, unsigned most) {
  if (text == "all") return module_settings::PdoRange{1, most};
  const auto number = [](std::string_view digits) {
    return ascii::parse_number<std::uint32_t>(digits).value_or(0);
  };
  const std::size_t dash = text.find('-');
  const std::uint32_t first = number(std::string_view(text).substr(0, dash));
  const std::uint32_t last = dash == std::string::npos ? first
                             : dash + 1 == text.size() ? most
                                                       : number(std::string_view(text).substr(dash + 1));
  if (first < 1 || last < first || last > most) {
    return std::unexpected(
        fmt::format("\"{}\": expected all, 5- (starting from) or 3-8 (range), of 1 to {}", text, most));
  }
  return module_settings::PdoRange{first, last};
}

namespace {

void build_configure_command(Command& group, int& exit_code) {
  group.require_subcommand(1);
  group.footer(
      "A project holds the settings of one module (" +
      module_settings::models_of(plant::configuration_tools()) +
      "; CANopen 405 mode) and is one XML "
      "file.\n"
      "Exit codes: 0 done, 1 the module or the PLC refused or cannot be reached, 2 wrong command line, "
      "project or file,\n"
      "3 the CPU module is in RUN, 4 differences, or errors in the project.\n"
      "docs/configure.md goes through it.");
  const Adder adder{group, exit_code};
  add_offline(adder);
  add_online(adder);
  add_nodes(adder);
  add_setup_commands(group, exit_code);
}

}  // namespace

void add_configure_command(Command& app, int& exit_code) {
  app.add_subcommand("configure",
                     "Set up a communication module through its PLC, as its CANopen Configuration Tool does",
                     [&exit_code](Command& group) { build_configure_command(group, exit_code); });
}

}  // namespace canopus::cli
