#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/plc_access.hpp"
#include "canopus/cli/plc/plc_program.hpp"
#include "canopus/cli/plc/plc_signals.hpp"
#include "canopus/cli/plc/transfer_setups.hpp"
#include "canopus/client/plc_client.hpp"
#include "canopus/client/plc_point.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

namespace {

using client::PlcPoint;

int read(const PlcPoint& point, const PlcArguments& arguments) {
  return with_client(arguments, [&](client::PlcClient& client) {
    const auto texts = read_points(client, point, arguments);
    if (!texts) return plc_failed(refused, texts.error());
    std::size_t width = 0;  // X0.15 is longer than X1.0
    for (std::uint32_t i = 0; i < texts->size(); ++i)
      width = std::max(width, shown_address(point, arguments, i).size());
    for (std::uint32_t i = 0; i < texts->size(); ++i)
      print_line("{:<{}}  {}", shown_address(point, arguments, i), width, (*texts)[i]);
    return done;
  });
}

int write_bits(const PlcPoint& point, const PlcArguments& arguments) {
  std::vector<std::uint8_t> bits;
  for (const std::string& text : arguments.values) {
    const auto bit = client::parse_plc_bit(text);
    if (!bit) return plc_failed(usage, bit.error());
    bits.push_back(*bit ? 1 : 0);
  }
  return with_client(arguments, [&](client::PlcClient& client) {
    return write_and_verify(client, point, arguments, std::span<const std::uint8_t>(bits));
  });
}

int write_words(const PlcPoint& point, const PlcArguments& arguments) {
  std::vector<std::uint16_t> words;
  for (const std::string& text : arguments.values) {
    const auto word = client::parse_plc_word(text);
    if (!word) return plc_failed(usage, word.error());
    words.push_back(*word);
  }
  return with_client(arguments, [&](client::PlcClient& client) {
    return write_and_verify(client, point, arguments, std::span<const std::uint16_t>(words));
  });
}

int write(const PlcPoint& point, const PlcArguments& arguments) {
  return point.is_bit() ? write_bits(point, arguments) : write_words(point, arguments);
}

int switch_bit(const PlcPoint& point, const PlcArguments& arguments, bool on) {
  if (!point.is_bit())
    return plc_failed(
        usage, shown_address(point, arguments) + " is a word; set and reset take bit devices (Y1, M100)");
  return with_client(arguments, [&](client::PlcClient& client) {
    const std::uint8_t bit = on ? 1 : 0;
    return write_and_verify(client, point, arguments, std::span<const std::uint8_t>(&bit, 1));
  });
}

int operate(const PlcArguments& arguments, client::PlcOperation operation,
            const std::function<int(client::PlcClient&)>& then) {
  if (arguments.modbus) return plc_failed(usage, "Modbus TCP has no remote operation of a CPU");
  const bool is_run_or_stop =
      operation == client::PlcOperation::run || operation == client::PlcOperation::stop;
  if (arguments.frame_1e && !is_run_or_stop)
    return plc_failed(usage, "1E frames have no remote PAUSE and reset; 3E frames do");
  return with_client(arguments, [&](client::PlcClient& client) {
    const auto result = client.operate(operation);
    return result ? then(client) : plc_failed(refused, result.error());
  });
}

int no_more(client::PlcClient& /*client*/) { return done; }

/// A CPU in STOP answers PAUSE with 0000H, too, and stays in STOP [SH-080931 11.2].
int refuse_pause_in_stop(client::PlcClient& client) {
  const auto stopped = client.read_bits({.at = {.device = plc::Device::sm, .number = 203}}, 1);
  if (!stopped || stopped->front() == 0) return done;
  return plc_failed(refused, "the CPU is in STOP and stays there: PAUSE is reached from RUN alone");
}

int type(client::PlcClient& client, const PlcArguments& arguments) {
  const auto found = client.read_type();
  if (!found) return plc_failed(refused, found.error());
  if (arguments.json) {
    print_json(text::Json{{"name", found->name}, {"code", found->code}});
  } else if (arguments.modbus) {
    print_line("{}", found->name);
  } else {
    print_line("{}  {:04X}H", found->name, found->code);
  }
  return done;
}

int with_point(const PlcArguments& arguments,
               const std::function<int(const PlcPoint&, const PlcArguments&)>& action) {
  const auto point = plc_point(arguments.address, arguments);
  return point ? action(*point, arguments) : plc_failed(usage, point.error());
}

/// The same, or the action for a signal of a plant or for a variable of a program.
int with_name(const PlcArguments& arguments, int (*with_point_action)(const PlcPoint&, const PlcArguments&),
              int (*with_signal)(const PlcArguments&), int (*with_variable)(const PlcArguments&)) {
  if (is_signal(arguments)) {
    return arguments.count == 1 ? with_signal(arguments)
                                : plc_failed(usage, "--count: a signal is one value; expected an address");
  }
  return is_variable(arguments) ? with_variable(arguments) : with_point(arguments, with_point_action);
}

/// Empty, or what is wrong with the name.
std::string use_setup(const std::string& name, PlcArguments& arguments) {
  const auto setup = find_transfer_setup(name);
  if (!setup) return setup.error();
  use_setup(*setup, arguments);
  arguments.setup = name;
  return {};
}

void add_address(Command& command, PlcArguments& arguments, const char* help) {
  command.add_option("ADDRESS", arguments.address, help)->required();
}

void add_verify_option(Command& command, PlcArguments& arguments) {
  command.add_flag("--no-verify", arguments.no_verify, "do not read the values back");
}

void add_reading_options(Command& command, PlcArguments& arguments) {
  command.add_option("-n,--count", arguments.count, "points: words, or bits of a bit device")
      ->type_name("NUMBER")
      ->check(number_from(1, 65536))
      ->capture_default_str();
  command.add_option("--format", arguments.format, "how words are shown")
      ->type_name("dec|hex|both")
      ->check(one_of_words({"dec", "hex", "both"}))
      ->capture_default_str();
  command.add_flag("--signed", arguments.as_signed, "decimal from -32768 to 32767");
}

constexpr const char* address_or_name =
    "the first device or buffer memory address; a signal of a plant: drive.6041, drive.Statusword; or a "
    "variable of a program: "
    "Main.step";

void add_program_options(Command& command, PlcArguments& arguments) {
  command
      .add_option("--at", arguments.at,
                  "control server of the plant; ADDRESS is a variable then [127.0.0.1:29540]")
      ->type_name("HOST:PORT");
  command
      .add_option("--name", arguments.plc,
                  "name of the PLC in the plant file, if several have the signal or a program")
      ->type_name("NAME");
}

/// The subcommands for the program that a simulated PLC runs.
void add_program_commands(Command& plc, const std::shared_ptr<PlcArguments>& arguments, int& exit_code) {
  const auto add = [&](const char* name, const char* help, std::function<int(const PlcArguments&)> action) {
    Command& command = *plc.add_subcommand(name, help);
    add_program_options(command, *arguments);
    command.add_option("--timeout", arguments->timeout, "to connect, and for the answer")
        ->capture_default_str();
    command.add_flag("--json", arguments->json, "the answer as one JSON object");
    // The shared pointer keeps the arguments as long as the command.
    command.callback([arguments, &exit_code, action = std::move(action)] { exit_code = action(*arguments); });
    return &command;
  };
  const auto add_name = [&](Command& command, bool is_required) {
    command.add_option("NAME", arguments->address, "Main.step, list[3].x")->required(is_required);
  };
  const auto add_place = [&](Command& command, bool is_required) {
    command.add_option("FILE:LINE", arguments->address, "main.st:12")->required(is_required);
  };
  const auto control = [](const char* request) {
    return [request](const PlcArguments& all) { return control_program(all, request); };
  };
  add("program", "Show the state of the program that the CPU runs, its scan, tasks, breaks and forces",
      show_program);
  auto* forcing = add("force", "Give a variable a value before and after every scan", force_variable);
  add_name(*forcing, true);
  forcing->add_option("VALUE", arguments->values, "1234, TRUE, T#1s")->required();
  add_name(*add("unforce", "Release a forced variable, or all", release_variable), false);
  add("halt", "Execute the program no further; plant time goes on, and Y stay", control("halt program"));
  add("scan", "Execute one scan of the program, then halt it", control("single scan"));
  add("continue", "Execute a halted program further", control("continue program"));
  add_place(*add("break", "Halt the program before a line", set_break), true);
  add_place(*add("clear-break", "Remove a break, or all", clear_break), false);
  add("change", "Online change: compile the program's files anew; variables keep their values",
      change_program);
}

}  // namespace

void add_plc_option(Command& command, const char* help, std::function<void(const PlcPlace&)> use) {
  command
      .add_option_function(
          "--plc",
          [use = std::move(use)](const std::string& text) {
            const auto place = parse_plc_place(text);
            if (!place) return place.error();
            use(*place);
            return std::string();
          },
          help)
      ->type_name("[HOST:]PORT")
      ->expected(1, 2)
      ->allow_extra_args(false);
  const auto port = [](std::string_view value) { return std::optional(":" + std::string(value)); };
  command.add_old_spelling({.old = "--host", .now = "--plc"});
  command.add_old_spelling({.old = "--port", .now = "--plc", .value = port});
}

void add_connection_options(Command& command, PlcArguments& arguments) {
  // The first: options are taken in this order, so each of the others takes the place of the setup's value.
  Option* const setup = command.add_option_function(
      "--setup", [&arguments](const std::string& name) { return use_setup(name, arguments); },
      "a transfer setup by its name (canopus configure setup); the other options go before its values");
  setup->type_name("NAME");
  add_plc_option(command, "address of the PLC [127.0.0.1], its port [5007, with --modbus 502], or both",
                 [&arguments](const PlcPlace& place) {
                   if (place.host) arguments.connection.host = *place.host;
                   if (place.port) arguments.port = *place.port;
                 });
  command.add_flag("--3e", arguments.frame_3e, "3E frames (the default)");
  command.add_flag("--4e", arguments.frame_4e, "4E frames, with serial numbers");
  command.add_flag("--1e", arguments.frame_1e, "1E frames (A-compatible)");
  command
      .add_flag("--modbus", arguments.modbus,
                "Modbus TCP: an AS300 by its devices, any other PLC by addresses")
      ->excludes(setup);
  Option* const ascii = command.add_flag("--ascii", arguments.connection.ascii, "ASCII instead of binary");
  command
      .add_flag_callback(
          "--binary", [&arguments] { arguments.connection.ascii = false; }, "binary (the default)")
      ->excludes(ascii);
  Option* const udp = command.add_flag("--udp", arguments.connection.udp, "UDP instead of TCP");
  command
      .add_flag_callback(
          "--tcp", [&arguments] { arguments.connection.udp = false; }, "TCP (the default)")
      ->excludes(udp);
  command
      .add_option(
          "--cpu", arguments.cpu,
          "Multiple CPU: No.1 to No.4 of a multiple CPU system instead of the control CPU (3E and 4E)")
      ->type_name("CPU")
      ->check(one_of_words({"none", "1", "2", "3", "4"}))
      ->capture_default_str();
  command
      .add_option("--password", arguments.connection.remote_password,
                  "remote password of the port; the variable keeps it out of the list of processes")
      ->envname("CANOPUS_PLC_PASSWORD")
      ->type_name("TEXT");
  command.add_option("--unit", arguments.unit, "Modbus: unit identifier [255: any]")
      ->type_name("0-255")
      ->check(number_from(0, 255));
  command.add_option("--timeout", arguments.timeout, "to connect and for each answer")
      ->type_name("TIME")
      ->capture_default_str();
  command.add_flag("--octal", arguments.octal, "X and Y are counted in octal, as by an FX");
  command.add_option("--module", arguments.module, "module of names such as U0:error_status")
      ->type_name("MODEL");
}

namespace {

/// Adds commands of `canopus plc` that have a PLC.
struct Adder {
  Command& plc;
  std::shared_ptr<PlcArguments> arguments;  ///< each command keeps them
  int& exit_code;

  Command* operator()(const char* name, const char* help, std::function<int()> action) const {
    Command& command = *plc.add_subcommand(name, help);
    add_connection_options(command, *arguments);
    command.callback([kept = arguments, &code = exit_code, action = std::move(action)] { code = action(); });
    return &command;
  }
};

void add_access_commands(const Adder& add) {
  const auto& arguments = add.arguments;
  auto* reading = add("read", "Show words or bits, a signal or a variable",
                      [arguments] { return with_name(*arguments, read, read_signal, read_variable); });
  add_address(*reading, *arguments, address_or_name);
  add_reading_options(*reading, *arguments);
  add_plant_option(*reading, *arguments);
  add_program_options(*reading, *arguments);

  auto* writing = add("write", "Write words or bits, a signal or a variable",
                      [arguments] { return with_name(*arguments, write, write_signal, write_variable); });
  add_address(*writing, *arguments, address_or_name);
  add_plant_option(*writing, *arguments);
  add_program_options(*writing, *arguments);
  writing
      ->add_option("VALUE", arguments->values,
                   "1234, -5, 0x4D2, 4D2H; ON or OFF for bits; T#1s of a variable")
      ->required();
  add_verify_option(*writing, *arguments);

  for (const bool on : {true, false}) {
    auto* switching =
        add(on ? "set" : "reset", on ? "Turn a bit device ON" : "Turn a bit device OFF", [arguments, on] {
          return with_point(*arguments, [on](const PlcPoint& point, const PlcArguments& all) {
            return switch_bit(point, all, on);
          });
        });
    add_address(*switching, *arguments, "Y1, M100");
    add_verify_option(*switching, *arguments);
  }
}

void add_watch_command(const Adder& add) {
  const auto& arguments = add.arguments;
  auto* watching = add("watch", "Show values and then every change, with its time", [arguments] {
    return with_name(*arguments, watch_plc, watch_signal, watch_variable);
  });
  add_address(*watching, *arguments, address_or_name);
  add_reading_options(*watching, *arguments);
  add_plant_option(*watching, *arguments);
  add_program_options(*watching, *arguments);
  watching->add_option("--interval", arguments->interval, "time between two readings")
      ->type_name("TIME")
      ->capture_default_str();
  watching->add_option("--for", arguments->duration, "stop after this time instead of Ctrl-C")
      ->type_name("TIME");
  auto* csv =
      watching->add_flag("--csv", arguments->csv, "a row of all values for each change, for a spreadsheet");
  watching->add_flag("--json", arguments->json, "one JSON object per line with the changes")->excludes(csv);
}

void add_file_commands(const Adder& add) {
  const auto& arguments = add.arguments;
  auto* dumping = add("dump", "Write ranges as CSV, for load", [arguments] { return dump_plc(*arguments); });
  dumping
      ->add_option("RANGE", arguments->values, "D100..D199, Y0..Y1F, U0\\G13000..U0\\G13011, or one address")
      ->required();
  dumping->add_option("-o,--output", arguments->file, "instead of the standard output")->type_name("FILE");

  auto* loading =
      add("load", "Write the values of a dump back", [arguments] { return load_plc(*arguments); });
  loading->add_option("FILE", arguments->file, "CSV of addresses and values; - is the standard input")
      ->required();
  add_verify_option(*loading, *arguments);
}

/// Lists of names, without a PLC.
void add_list_commands(const Adder& add) {
  const auto& arguments = add.arguments;
  add.plc.add_subcommand("names", "List the words that have names, for U0:NAME")
      ->callback([&exit_code = add.exit_code] { exit_code = list_plc_names(); });

  Command& signals =
      *add.plc.add_subcommand("signals", "List the signals of a plant and their words, for NODE.OBJECT");
  add_plant_option(signals, *arguments);
  signals.add_option("--name", arguments->plc, "only those of this PLC of the plant")->type_name("NAME");
  signals.callback([arguments, &exit_code = add.exit_code] { exit_code = list_signals(*arguments); });
}

void add_remote_commands(const Adder& add) {
  const auto& arguments = add.arguments;
  using client::PlcOperation;
  add("run", "Remote RUN", [arguments] { return operate(*arguments, PlcOperation::run, no_more); });
  add("stop", "Remote STOP", [arguments] { return operate(*arguments, PlcOperation::stop, no_more); });
  add("pause", "Remote PAUSE: the program stops, outputs stay as they are",
      [arguments] { return operate(*arguments, PlcOperation::pause, refuse_pause_in_stop); });
  add("reset-cpu",
      "Remote reset, in STOP and where the CPU allows it: devices are cleared, modules start anew",
      [arguments] { return operate(*arguments, PlcOperation::reset, no_more); });
  auto* asking = add("type", "Show the CPU's name and code", [arguments] {
    return with_client(*arguments, [&](client::PlcClient& client) { return type(client, *arguments); });
  });
  asking->add_flag("--json", arguments->json, "as one JSON object");
}

void build_plc_command(Command& plc, int& exit_code) {
  const auto arguments = std::make_shared<PlcArguments>();
  plc.require_subcommand(1);
  plc.footer(
      "Addresses: D100, M0, X1F (X Y B W SB SW in hexadecimal), U3\\G256 for buffer memory; quote the "
      "backslash.\n"
      "U3:error_status is buffer memory by the name of the module's manual (canopus plc names).\n"
      "With --modbus: an AS300's D100, SR7, M0, X0.5, X0 (word), or coil:5 discrete:5 holding:5 input:5.\n"
      "drive.6041, drive.Statusword, line1:4.6041: a signal that the plant exchanges by PDO, with its unit "
      "and its bits in words; "
      "canopus plc\nsignals lists them.\n"
      "Main.step, list[3].x, counter: variables of the program that a simulated PLC runs, over the control "
      "server of\nthe plant ([plant] control), as for program, force, unforce, halt, scan, continue, break, "
      "clear-break, change.\n"
      "What is written is read back: a CPU answers as if all were well when a word or an input cannot be "
      "written.\n"
      "Exit code: 0 done, 1 the PLC refused, shows something else than what was written, or could not be "
      "reached,\n"
      "2 wrong command line.");
  const Adder add{plc, arguments, exit_code};
  add_access_commands(add);
  add_watch_command(add);
  add_file_commands(add);
  add_list_commands(add);
  add_remote_commands(add);
  add_program_commands(plc, arguments, exit_code);
}

}  // namespace

void add_plc_command(Command& app, int& exit_code) {
  app.add_subcommand("plc", "Read and write a PLC over the MELSEC communication protocol or Modbus TCP",
                     [&exit_code](Command& plc) { build_plc_command(plc, exit_code); });
}

}  // namespace canopus::cli
