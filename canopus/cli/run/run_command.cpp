#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/cli/files/given_file.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/options/real_time_option.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/run/run_loop.hpp"
#include "canopus/cli/run/web_options.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/file/trace_file.hpp"

namespace canopus::cli {

namespace {
constexpr std::string_view without_time = "true";  // what a flag without a value gets

struct RunWords {
  RunOptions options;
  std::string duration;
  std::string operational;
  const Option* page = nullptr;  ///< --web
  std::string web;
  std::vector<std::string> web_settings;
  RealTimeOption real_time;
};

/// The plant and how its time goes. Returns --virtual.
Option* add_time_options(Command& command, RunWords& words) {
  command
      .add_option("PLANT", words.options.plant,
                  "Plant file (TOML, see docs/plant-file.md), or a folder with plant.toml")
      ->required();
  command
      .add_option("--for", words.duration, "Stop after this much plant time, for example 10s, 500ms, 2min")
      ->type_name("TIME")
      ->check([](const std::string& text) {
        const auto duration = text::parse_duration(text);
        return duration ? std::string() : duration.error();
      });
  auto* virtual_time = command.add_flag(
      "--virtual", words.options.virtual_time,
      "Virtual time: as fast as possible, the same every time, without --step without clients");
  command
      .add_flag(
          "--step", words.options.step,
          "Drive the plant from outside: its time moves only when a client of the control server asks for "
          "scans or time (docs/control.md); without `control` in the plant file on a free port")
      ->needs(virtual_time);
  command.add_flag("--free-ports", words.options.free_ports,
                   "Every server uses a free port instead of the plant file's, and prints it");
  return virtual_time;
}

/// --web and what needs it, or excludes it.
void add_page_options(Command& command, RunWords& words, Option* virtual_time) {
  auto* web =
      command
          .add_option("--web", words.web,
                      "Show the plant on a page in the browser, at this address of this machine; without one "
                      "on a free port (docs/web.md). It says where, and opens nothing by itself")
          ->type_name("[ADDRESS:PORT]")
          ->expected(0, 1)
          ->excludes(virtual_time)
          ->check([](const std::string& text) {
            if (text.empty()) return std::string();
            const auto place = text::parse_host_and_port(text);
            return place ? std::string() : place.error();
          });
  command
      .add_option("--web-settings", words.web_settings,
                  "The settings of a module of the plant, a project of `canopus configure`, are on the page, "
                  "too; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->needs(web)
      ->check([&words](const std::string& file) {
        auto settings = read_web_settings(file);
        if (!settings) return settings.error();
        words.options.web_settings.push_back(std::move(*settings));
        return std::string();
      });
  command
      .add_flag(
          "--allow-native", words.options.allows_native_code,
          "Run programs of PLCs that are shared objects (program = [\"main.so\"]): native code, with all "
          "your rights. Only for a plant that you trust; never with the page")
      ->excludes(web);
  add_web_access_options(command, "--web-", words.options.web_access, web);
  words.page = web;
}

/// How it is executed, and with which real buses.
void add_execution_options(Command& command, RunWords& words, Option* virtual_time) {
  command.add_option("--seed", words.options.seed, "Seed of everything random, instead of the plant file's")
      ->check(number_from(0, std::numeric_limits<std::uint64_t>::max()))
      ->type_name("N");
  command
      .add_option("--threads", words.options.threads,
                  "With --virtual: at most so many threads run the parts of the plant that share nothing; "
                  "without it one for each processor. The output is the same with any number")
      ->needs(virtual_time)
      ->check(number_from(1, 256))
      ->type_name("N");
  add_real_time_option(command, words.real_time);
  command.get_option("--realtime")->excludes(virtual_time);
  command
      .add_option(
          "--bus", words.options.links,
          "Put a bus of the plant on a real one, or on a trace: BUS=ADDRESS, with one bus ADDRESS alone; "
          "again for the next bus (docs/commands.md has the addresses)")
      ->type_name("[BUS=]ADDRESS")
      ->allow_extra_args(false);
  command.add_old_spelling({.old = "--link", .now = "--bus"});
}

void add_recording_options(Command& command, RunWords& words) {
  command
      .add_option("--trace", words.options.trace,
                  "Record every frame: as candump log (*.log or no extension), or *.pcap, *.pcapng, *.asc, "
                  "*.trc, *.csv")
      ->type_name("FILE")
      ->check([](const std::string& path) {
        const auto format = trace::trace_format_of(path);
        return format ? std::string() : format.error();
      });
  command
      .add_option(
          "--vcd", words.options.vcd,
          "Record the wire bit by bit as a waveform (VCD, for PulseView, GTKWave, sigrok-cli); slower")
      ->type_name("FILE");
  command
      .add_option("--svg", words.options.svg,
                  "At the end, draw the lifts: position, doors and calls over time (docs/lift.md)")
      ->type_name("FILE");
}

/// What is expected of the run, and how it is reported.
void add_report_options(Command& command, RunWords& words) {
  command
      .add_flag(
          "--expect-operational", words.operational,
          "Exit code 3 unless all nodes are operational at the end; =TIME: unless they were within this "
          "plant time, and without --for the run ends as soon as they are")
      ->check([](const std::string& text) {
        if (text == without_time) return std::string();
        const auto duration = text::parse_duration(text);
        return duration ? std::string() : duration.error();
      });
  auto* json =
      command.add_flag("--json", words.options.json, "One JSON object per line (see docs/events.md)");
  command.add_flag("-q,--quiet", words.options.quiet, "Print errors alone")->excludes(json);
}

/// Returns the exit code.
int run(RunWords& words) {
  const GivenPlant plant = given_plant(words.options.plant);
  if (!plant.wrong.empty()) {
    print_error("canopus run: {}", plant.wrong);
    return 2;
  }
  words.options.plant = plant.path;
  if (!words.duration.empty()) words.options.duration = *text::parse_duration(words.duration);
  words.options.real_time = words.real_time.wanted();
  if (words.page->count() != 0) {
    words.options.web = words.web.empty() ? text::HostAndPort{} : *text::parse_host_and_port(words.web);
  }
  words.options.expect_operational = !words.operational.empty();
  if (words.options.expect_operational && words.operational != without_time) {
    words.options.operational_within = *text::parse_duration(words.operational);
  }
  return run_plant(words.options);
}

void build_run_command(Command& command, int& exit_code) {
  // The callback keeps the words as long as the command.
  auto words = std::make_shared<RunWords>();
  Option* const virtual_time = add_time_options(command, *words);
  add_page_options(command, *words, virtual_time);
  add_execution_options(command, *words, virtual_time);
  add_recording_options(command, *words);
  add_report_options(command, *words);
  command.footer(
      "Without --json and --quiet a terminal shows a live table, a pipe gets one line per event.\n"
      "Exit codes: 0 ended as asked, 1 could not start, could not write a file or the output, or an error "
      "in\n"
      "Canopus stopped a part of the plant, 2 wrong plant file or usage, 3 not operational as expected.\n"
      "Each MC protocol or Modbus port takes 16 connections (the one that is silent longest gives way after "
      "10 s), "
      "waits 5 s\n"
      "for the rest of a request and 30 s for replies that a client does not take; docs/mc-protocol.md.\n"
      "Example: canopus run plant.toml --virtual --expect-operational=30s");
  command.callback([words, &exit_code] { exit_code = run(*words); });
}

}  // namespace

void add_run_command(Command& app, int& exit_code) {
  app.add_subcommand("run", "Run a plant file until Ctrl-C",
                     [&exit_code](Command& command) { build_run_command(command, exit_code); });
}

}  // namespace canopus::cli
