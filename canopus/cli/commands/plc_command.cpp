#include "canopus/cli/commands/plc_command.hpp"

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

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "canopus/cli/commands/plc_access.hpp"
#include "canopus/cli/terminal/option_checks.hpp"
#include "canopus/cli/terminal/print.hpp"
#include "canopus/client/plc_address.hpp"
#include "canopus/client/plc_client.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

namespace {

using plc::melsec::Target;
using Arguments = PlcArguments;

int read(const Target& target, const Arguments& arguments) {
  return with_client(arguments, [&](client::PlcClient& client) {
    const auto texts = read_points(client, target, arguments);
    if (!texts) return complain(refused, texts.error());
    const std::size_t width = shown_address(target, arguments, arguments.count - 1).size();
    for (std::uint32_t i = 0; i < texts->size(); ++i)
      print_line("{:<{}}  {}", shown_address(target, arguments, i), width, (*texts)[i]);
    return done;
  });
}

int write_bits(const Target& target, const Arguments& arguments) {
  std::vector<std::uint8_t> bits;
  for (const std::string& text : arguments.values) {
    const auto bit = client::parse_plc_bit(text);
    if (!bit) return complain(usage, bit.error());
    bits.push_back(*bit ? 1 : 0);
  }
  return with_client(arguments, [&](client::PlcClient& client) {
    return write_and_verify(client, target, arguments, std::span<const std::uint8_t>(bits));
  });
}

int write_words(const Target& target, const Arguments& arguments) {
  std::vector<std::uint16_t> words;
  for (const std::string& text : arguments.values) {
    const auto word = client::parse_plc_word(text);
    if (!word) return complain(usage, word.error());
    words.push_back(*word);
  }
  return with_client(arguments, [&](client::PlcClient& client) {
    return write_and_verify(client, target, arguments, std::span<const std::uint16_t>(words));
  });
}

int write(const Target& target, const Arguments& arguments) {
  return is_bit(target) ? write_bits(target, arguments) : write_words(target, arguments);
}

int switch_bit(const Target& target, const Arguments& arguments, bool on) {
  if (!is_bit(target))
    return complain(
        usage, shown_address(target, arguments) + " is a word; set and reset take bit devices (Y1, M100)");
  return with_client(arguments, [&](client::PlcClient& client) {
    const std::uint8_t bit = on ? 1 : 0;
    return write_and_verify(client, target, arguments, std::span<const std::uint8_t>(&bit, 1));
  });
}

/// A CPU in STOP answers 0000H, too, and stays in STOP [SH-080931 11.2].
int pause(client::PlcClient& client) {
  if (const auto paused = client.remote_pause(); !paused) return complain(refused, paused.error());
  const auto stopped = client.read_bits({.device = plc::Device::sm, .number = 203}, 1);
  if (!stopped || stopped->front() == 0) return done;
  return complain(refused, "the CPU is in STOP and stays there: PAUSE is reached from RUN alone");
}

int type(client::PlcClient& client) {
  const auto found = client.read_type();
  if (!found) return complain(refused, found.error());
  print_line("{}  {:04X}H", found->name, found->code);
  return done;
}

int with_target(const Arguments& arguments,
                const std::function<int(const Target&, const Arguments&)>& action) {
  const auto target = plc_target(arguments.address, arguments);
  return target ? action(*target, arguments) : complain(usage, target.error());
}

void add_connection_options(CLI::App& command, Arguments& arguments) {
  command.add_option("--host", arguments.connection.host, "the PLC's address")->capture_default_str();
  command.add_option("--port", arguments.connection.port, "TCP port")
      ->type_name("PORT")
      ->check(number_from(1, 65535))
      ->capture_default_str();
  auto* frame_3e = command.add_flag("--3e", arguments.frame_3e, "3E frames (the default)");
  command.add_flag("--4e", arguments.connection.frame_4e, "4E frames, with serial numbers")
      ->excludes(frame_3e);
  command.add_flag("--ascii", arguments.connection.ascii, "ASCII instead of binary");
  command.add_option("--timeout", arguments.timeout, "to connect and for each answer")->capture_default_str();
  command.add_flag("--octal", arguments.octal, "X and Y are counted in octal, as by an FX");
  command.add_option("--module", arguments.module, "whose words a name as U0:error_status is about")
      ->type_name("MODEL");
}

void add_address(CLI::App& command, Arguments& arguments, const char* help) {
  command.add_option("ADDRESS", arguments.address, help)->required();
}

void add_verify_option(CLI::App& command, Arguments& arguments) {
  command.add_flag("--no-verify", arguments.no_verify, "do not read back what was written");
}

void add_reading_options(CLI::App& command, Arguments& arguments) {
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

}  // namespace

void add_plc_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& plc = *app.add_subcommand("plc", "Read and write a PLC over the MELSEC communication protocol");
  plc.require_subcommand(1);
  plc.footer(
      "Addresses: D100, M0, X1F (X Y B W SB SW in hexadecimal), U3\\G256 for buffer memory; quote the "
      "backslash.\n"
      "U3:error_status is buffer memory by the name of the module's manual (canopus plc names).\n"
      "What is written is read back: a CPU answers as if all were well when a word or an input cannot be "
      "written.\n"
      "Exit code: 0 done, 1 the PLC refused, shows something else than what was written, or could not be "
      "reached,\n"
      "2 wrong command line.");
  const auto add = [&](const char* name, const char* help, std::function<int()> action) {
    CLI::App& command = *plc.add_subcommand(name, help);
    add_connection_options(command, *arguments);
    // The shared pointer keeps the arguments as long as the command.
    command.callback([arguments, &exit_code, action = std::move(action)] { exit_code = action(); });
    return &command;
  };

  auto* reading = add("read", "Show words or bits", [arguments] { return with_target(*arguments, read); });
  add_address(*reading, *arguments, "the first device or buffer memory address");
  add_reading_options(*reading, *arguments);

  auto* writing = add("write", "Write words or bits", [arguments] { return with_target(*arguments, write); });
  add_address(*writing, *arguments, "the first device or buffer memory address");
  writing->add_option("VALUE", arguments->values, "1234, -5, 0x4D2, 4D2H; ON or OFF for bits")->required();
  add_verify_option(*writing, *arguments);

  for (const bool on : {true, false}) {
    auto* switching =
        add(on ? "set" : "reset", on ? "Turn a bit device ON" : "Turn a bit device OFF", [arguments, on] {
          return with_target(*arguments, [on](const Target& target, const Arguments& all) {
            return switch_bit(target, all, on);
          });
        });
    add_address(*switching, *arguments, "Y1, M100");
    add_verify_option(*switching, *arguments);
  }

  auto* watching = add("watch", "Show values and then every change, with its time",
                       [arguments] { return with_target(*arguments, watch_plc); });
  add_address(*watching, *arguments, "the first device or buffer memory address");
  add_reading_options(*watching, *arguments);
  watching->add_option("--interval", arguments->interval, "time between two readings")->capture_default_str();
  watching->add_option("--for", arguments->duration, "stop after this time instead of Ctrl-C");
  auto* csv =
      watching->add_flag("--csv", arguments->csv, "a row of all values for each change, for a spreadsheet");
  watching->add_flag("--json", arguments->json, "one JSON object per line with what has changed")
      ->excludes(csv);

  auto* dumping = add("dump", "Write ranges as CSV, for load", [arguments] { return dump_plc(*arguments); });
  dumping
      ->add_option("RANGE", arguments->values, "D100..D199, Y0..Y1F, U0\\G13000..U0\\G13011, or one address")
      ->required();
  dumping->add_option("-o,--output", arguments->file, "instead of the standard output")->type_name("FILE");

  auto* loading =
      add("load", "Write what dump has written back", [arguments] { return load_plc(*arguments); });
  loading->add_option("FILE", arguments->file, "CSV of addresses and values; - is the standard input")
      ->required();
  add_verify_option(*loading, *arguments);

  plc.add_subcommand("names", "List the words that have names, for U0:NAME")->callback([&exit_code] {
    exit_code = list_plc_names();
  });

  add("run", "Remote RUN", [arguments] {
    return with_client(*arguments, [](client::PlcClient& client) {
      const auto result = client.remote_run();
      return result ? done : complain(refused, result.error());
    });
  });
  add("stop", "Remote STOP", [arguments] {
    return with_client(*arguments, [](client::PlcClient& client) {
      const auto result = client.remote_stop();
      return result ? done : complain(refused, result.error());
    });
  });
  add("pause", "Remote PAUSE: the program stops, outputs stay as they are",
      [arguments] { return with_client(*arguments, pause); });
  add("type", "Show the CPU's name and code", [arguments] {
    return with_client(*arguments, [](client::PlcClient& client) { return type(client); });
  });
}

}  // namespace canopus::cli
