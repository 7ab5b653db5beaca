// `canopus configure setup ...`: transfer setups, with the names that the tool's windows print.

#include <array>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canopus/cli/module_settings/configure_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/transfer_setups.hpp"
#include "canopus/module_settings/module_windows.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using SetupLine = text::Json;

struct SetupArguments {
  std::string name;
  std::string new_name;
  std::string password;  ///< of a test
  std::optional<std::string> host, timeout, cpu, cpu_type, model;
  std::optional<std::uint16_t> port;
  bool frame_3e = false, frame_4e = false, frame_1e = false;
  bool tcp = false, udp = false, binary = false, ascii = false;
  bool json = false;
};

int setup_trouble(const SetupTrouble& trouble) {
  return configure_failed(trouble.is_refused ? configure_code::usage : configure_code::failed,
                          trouble.message);
}

SetupLine setup_json(const std::string& name, const TransferSetup& setup) {
  SetupLine line{{"name", name}, {"host", setup.host}};
  line["port"] = setup.port == 0 ? SetupLine() : SetupLine(setup.port);
  line["frame"] = setup.frame;
  line["code"] = setup.ascii ? "ASCII" : "binary";
  line["protocol"] = setup.udp ? "UDP" : "TCP";
  line["timeout"] = setup.timeout;
  line["cpu"] = setup.cpu == 0 ? SetupLine() : SetupLine(setup.cpu);
  line["cpu_type"] = setup.cpu_type.empty() ? SetupLine() : SetupLine(setup.cpu_type);
  line["model"] = setup.model.empty() ? SetupLine() : SetupLine(setup.model);
  return line;
}

/// The settings of the wizard, in its order [RJ71CN91 3.2 Transfer setup].
void print_setup(const std::string& name, const TransferSetup& setup) {
  const std::string_view asked = "asked of the CPU module";
  const std::string_view series = setup.cpu_type.empty() ? asked : cpu_series(setup.cpu_type);
  const std::string_view type = setup.cpu_type.empty() ? asked : std::string_view(setup.cpu_type);
  const std::string port = setup.port == 0 ? "5007" : std::to_string(setup.port);
  const std::string frame = setup.frame + (setup.ascii ? " ASCII" : " binary");
  const std::string cpu = multiple_cpu(setup.cpu);
  const std::array rows = std::to_array<std::pair<std::string_view, std::string_view>>({
      {"Select transfer setup", name},
      {"PC side I/F", "Ethernet board"},
      {"Connect module", "CPU module"},
      {"Protocol", setup.udp ? "UDP" : "TCP"},
      {"Time out", setup.timeout},
      {"PLC side I/F", "CPU module"},
      {"CPU series", series},
      {"CPU type", type},
      {"Host(IP Address)", setup.host},
      {"Port", port},
      {"Frame", frame},
      {"Station type", "Host station"},
      {"Connect CPU series", series},
      {"Multiple CPU", cpu},
      {"Module", setup.model.empty() ? "the one that goes with the CPU" : std::string_view(setup.model)},
  });
  for (const auto& [what, value] : rows) print_line("{:<23} {}", what, value);
}

int list_setups(const SetupArguments& arguments) {
  const auto setups = read_transfer_setups();
  if (!setups) return configure_failed(configure_code::usage, setups.error());
  for (const auto& [name, setup] : *setups) {
    if (arguments.json) {
      print_json(setup_json(name, setup));
      continue;
    }
    print_line("{:<20} {}:{}, {}, {}{}{}", name, setup.host, setup.port == 0 ? 5007 : setup.port,
               setup.udp ? "UDP" : "TCP", setup.frame, setup.ascii ? " ASCII" : "",
               setup.cpu == 0 ? "" : ", CPU " + multiple_cpu(setup.cpu));
  }
  return configure_code::done;
}

int show_setup(const SetupArguments& arguments) {
  const auto setup = find_transfer_setup(arguments.name);
  if (!setup) return configure_failed(configure_code::usage, setup.error());
  if (arguments.json) {
    print_json(setup_json(arguments.name, *setup));
  } else {
    print_setup(arguments.name, *setup);
  }
  return configure_code::done;
}

void apply_arguments(const SetupArguments& arguments, TransferSetup& setup) {
  const auto apply = [](const auto& given, auto& value) {
    if (given) value = *given;
  };
  apply(arguments.host, setup.host);
  apply(arguments.port, setup.port);
  apply(arguments.timeout, setup.timeout);
  apply(arguments.cpu_type, setup.cpu_type);
  apply(arguments.model, setup.model);
  if (setup.cpu_type == "any") setup.cpu_type.clear();
  if (setup.model == "any") setup.model.clear();
  if (arguments.cpu)
    setup.cpu = *arguments.cpu == "none" ? 0 : static_cast<unsigned>(std::stoul(*arguments.cpu));
  if (arguments.tcp || arguments.udp) setup.udp = arguments.udp;
  if (arguments.binary || arguments.ascii) setup.ascii = arguments.ascii;
  if (arguments.frame_3e) setup.frame = "3E";
  if (arguments.frame_4e) setup.frame = "4E";
  if (arguments.frame_1e) setup.frame = "1E";
}

int set_setup(const SetupArguments& arguments) {
  const auto done = change_transfer_setups([&](TransferSetups& setups) {
    std::string why = why_no_setup_name(arguments.name);
    if (!why.empty()) return why;
    TransferSetup& setup = setups[arguments.name];
    apply_arguments(arguments, setup);
    why = why_no_setup(setup);
    return why.empty() ? why : fmt::format("{}: {}", arguments.name, why);
  });
  return done ? configure_code::done : setup_trouble(done.error());
}

int rename_setup(const SetupArguments& arguments) {
  const auto done = change_transfer_setups([&](TransferSetups& setups) {
    if (!setups.contains(arguments.name)) return no_such_setup(arguments.name, setups);
    if (std::string why = why_no_setup_name(arguments.new_name); !why.empty()) return why;
    if (setups.contains(arguments.new_name)) return fmt::format("{}: is there already", arguments.new_name);
    auto setup = setups.extract(arguments.name);
    setup.key() = arguments.new_name;
    setups.insert(std::move(setup));
    return std::string();
  });
  return done ? configure_code::done : setup_trouble(done.error());
}

int remove_setup(const SetupArguments& arguments) {
  const auto done = change_transfer_setups([&](TransferSetups& setups) {
    return setups.erase(arguments.name) != 0 ? std::string() : no_such_setup(arguments.name, setups);
  });
  return done ? configure_code::done : setup_trouble(done.error());
}

/// [Comm. Test]
int test_setup(const SetupArguments& arguments) {
  const auto setup = find_transfer_setup(arguments.name);
  if (!setup) return configure_failed(configure_code::usage, setup.error());
  PlcArguments plc;
  use_setup(*setup, plc);
  plc.connection.remote_password = arguments.password;
  return with_client(plc, [&](client::PlcClient& client) {
    const auto found = client.read_type();
    if (!found) return configure_failed(configure_code::failed, found.error());
    if (arguments.json) {
      print_json(SetupLine{{"name", found->name}, {"code", found->code}});
    } else {
      print_line("{}  {:04X}H", found->name, found->code);
    }
    if (setup->cpu_type.empty() || is_of_cpu_type(found->name, setup->cpu_type)) return configure_code::done;
    return configure_failed(configure_code::failed,
                            fmt::format("the CPU module is a {}; CPU type of {} is {}", found->name,
                                        arguments.name, setup->cpu_type));
  });
}

/// [Configure] to [Finish].
void add_setup_options(Command& command, SetupArguments& arguments) {
  add_plc_option(command, "Host(IP Address) [127.0.0.1] and port [5007] of the PLC",
                 [&arguments](const PlcPlace& place) {
                   if (place.host) arguments.host = place.host;
                   if (place.port) arguments.port = place.port;
                 });
  auto* const frame_3e = command.add_flag("--3e", arguments.frame_3e, "3E frames (the default)");
  auto* const frame_4e = command.add_flag("--4e", arguments.frame_4e, "4E frames, with serial numbers");
  auto* const frame_1e = command.add_flag("--1e", arguments.frame_1e, "1E frames (A-compatible)");
  frame_3e->excludes(frame_4e)->excludes(frame_1e);
  frame_4e->excludes(frame_1e);
  auto* const binary = command.add_flag("--binary", arguments.binary, "binary (the default)");
  command.add_flag("--ascii", arguments.ascii, "ASCII")->excludes(binary);
  auto* const tcp = command.add_flag("--tcp", arguments.tcp, "Protocol: TCP (the default)");
  command.add_flag("--udp", arguments.udp, "Protocol: UDP")->excludes(tcp);
  command.add_option("--timeout", arguments.timeout, "Time out, to connect and for each answer [3s]")
      ->type_name("TIME");
  command.add_option("--cpu", arguments.cpu, "Multiple CPU: none, or No.1 to No.4 [none]")
      ->type_name("CPU")
      ->check(one_of_words({"none", "1", "2", "3", "4"}));
  std::vector<std::string_view> types(cpu_types().begin(), cpu_types().end());
  types.emplace_back("any");
  command.add_option("--cpu-type", arguments.cpu_type, "CPU type that the test expects, R04 or R08SF [any]")
      ->type_name("TYPE")
      ->check(one_of_words(types));
  command
      .add_option("--module", arguments.model,
                  "the module: " + module_settings::models_of(plant::configuration_tools()) + " [any]")
      ->type_name("MODEL")
      ->check([](const std::string& name) {
        if (name == "any" || module_settings::find_tool(plant::configuration_tools(), name) != nullptr)
          return std::string();
        return fmt::format("\"{}\" is not known; expected any or one of {}", name,
                           module_settings::models_of(plant::configuration_tools()));
      });
  command.add_old_spelling({.old = "--model", .now = "--module"});
}

}  // namespace

void add_setup_commands(Command& configure, int& exit_code) {
  Command* const group =
      configure.add_subcommand("setup", "Transfer setups: ways to PLCs, kept by name, for --setup NAME");
  group->require_subcommand(1);
  group->footer(
      "The tool's Transfer Setup: `list` and --setup NAME are its \"Select transfer setup\", `set` of a new "
      "name "
      "<New> with\n"
      "[Configure] and the wizard to [Finish], `test` [Comm. Test], `rename` and `remove` \"Rename/Remove "
      "Setups\".\n"
      "They lie in $XDG_STATE_HOME/canopus/transfer-setups, else in ~/.local/state/canopus; remote passwords "
      "are not kept.\n"
      "Exit codes: 0 done, 1 the PLC refused or cannot be reached, or has another CPU type, 2 wrong command "
      "line or file.");
  using Setup = int (*)(const SetupArguments&);
  const auto add = [&](const char* name, const char* help, Setup action) {
    auto arguments = std::make_shared<SetupArguments>();
    Command* command = group->add_subcommand(name, help);
    command->callback([arguments, action, code = &exit_code] {
      *code = run_ignoring_sigpipe([&] { return action(*arguments); });
    });
    return std::pair(command, arguments);
  };
  const auto add_named = [&](const char* name, const char* help, Setup action) {
    auto added = add(name, help, action);
    added.first->add_option("NAME", added.second->name, "of the setup")->required();
    return added;
  };
  {
    auto [command, arguments] = add("list", "List the setups", list_setups);
    command->add_flag("--json", arguments->json, "one JSON object per setup");
  }
  {
    auto [command, arguments] = add_named("show", "Show a setup as the wizard has it", show_setup);
    command->add_flag("--json", arguments->json, "as one JSON object");
  }
  {
    auto [command, arguments] =
        add_named("set", "Make a setup, or change what is given of one that is there", set_setup);
    add_setup_options(*command, *arguments);
  }
  {
    auto [command, arguments] =
        add_named("test", "Comm. Test: ask the CPU module for its name and code", test_setup);
    command
        ->add_option("--password", arguments->password, "remote password of the port; setups never store it")
        ->envname("CANOPUS_PLC_PASSWORD")
        ->type_name("TEXT");
    command->add_flag("--json", arguments->json, "as one JSON object");
  }
  {
    auto [command, arguments] = add("rename", "Rename a setup", rename_setup);
    command->add_option("OLD", arguments->name, "the name that it has")->required();
    command->add_option("NEW", arguments->new_name, "the name that it gets")->required();
  }
  add_named("remove", "Remove a setup", remove_setup);
}

}  // namespace canopus::cli
