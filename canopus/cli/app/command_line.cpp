#include "canopus/cli/app/command_line.hpp"

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "canopus/cli/app/users_command.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/bus/scan_command.hpp"
#include "canopus/cli/files/check_command.hpp"
#include "canopus/cli/files/eds_command.hpp"
#include "canopus/cli/module_settings/configure_command.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/new/new_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/options/parser.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/module_command.hpp"
#include "canopus/cli/run/campaign_command.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/text/version.hpp"

namespace canopus::cli {
namespace {

using Named = std::span<const Parsing::Named>;

std::vector<std::string> commands_in(const Command& command) {
  std::vector<std::string> names;
  for (const Command& inner : command.commands()) names.push_back(inner.name());
  return names;
}

std::vector<std::string> options_of(const Command& command) {
  std::vector<std::string> names;
  for (const Option& option : command.options())
    names.insert(names.end(), option.names().rbegin(), option.names().rend());
  return names;
}

bool is_option(std::string_view word) { return word.size() > 1 && word.starts_with('-'); }

std::string suggestion_of(std::string_view word, const std::vector<std::string>& known) {
  return text::suggestion(word, std::vector<std::string_view>(known.begin(), known.end()));
}

/// The error text for an option that the command does not have.
std::string unknown_option(std::string_view word, Named chain, std::size_t level) {
  word = word.substr(0, word.find('='));
  for (std::size_t inner = level + 1; inner < chain.size(); ++inner) {
    const auto names = options_of(*chain[inner].command);
    if (std::ranges::find(names, word) == names.end()) continue;
    return fmt::format("{} comes behind the command: {} {}", word, chain[inner].command->full_name(), word);
  }
  const auto names = options_of(*chain[level].command);
  const std::string_view meant =
      text::nearest(word, std::vector<std::string_view>(names.begin(), names.end()));
  return meant.empty() ? fmt::format("unknown option \"{}\"", word)
                       : fmt::format("unknown option \"{}\"; did you mean \"{}\"?", word, meant);
}

/// The error text for the first argument that no command accepts, beginning with the innermost command;
/// nothing when all were accepted.
std::optional<std::string> unknown_word(Named chain) {
  for (std::size_t level = chain.size(); level-- > 0;) {
    const std::vector<std::string>& left_over = chain[level].left_over;
    if (left_over.empty()) continue;
    const auto option = std::ranges::find_if(left_over, is_option);
    const auto word = std::ranges::find_if_not(left_over, is_option);
    const auto commands = commands_in(*chain[level].command);
    const bool wants_command = level + 1 == chain.size() && !commands.empty();
    if (wants_command && word != left_over.end()) {
      return fmt::format("unknown command \"{}\"{}", *word, suggestion_of(*word, commands));
    }
    if (option != left_over.end()) return unknown_option(*option, chain, level);
    return fmt::format("unexpected argument \"{}\"", *word);
  }
  return std::nullopt;
}

void print_lines(Output& out, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out.line("{}", line);
}

/// The error text for the arguments.
std::string mistake(const Parsing& parsing) {
  const Named chain = parsing.commands;
  if (parsing.result == Parsing::Result::misfit) {
    if (const auto unknown = unknown_word(chain)) return *unknown;
    const auto commands = commands_in(*chain.back().command);
    if (!commands.empty()) {
      return "a command is missing" + suggestion_of("", commands);
    }
  }
  return parsing.text;
}

int explain(Command& program, const Parsing& parsing) {
  if (parsing.result == Parsing::Result::answered) {
    print_lines(standard_output(), parsing.text);
    return exit_code::done;
  }
  if (parsing.commands.size() == 1 && parsing.commands.front().left_over.empty()) {
    print_lines(standard_error(), help_of(program));
    return exit_code::usage;
  }
  const std::string command = parsing.commands.back().command->full_name();
  print_error("{}: {}", command, mistake(parsing));
  print_error("`{} --help` says more.", command);
  return exit_code::usage;
}

}  // namespace

void add_commands(Command& app, int& code) {
  app.set_version_flag("-V,--version", std::string("canopus ") + text::program_version());
  app.require_subcommand(1);
  app.footer("`canopus COMMAND --help` describes a command.");
  add_run_command(app, code);
  add_web_command(app, code);
  add_check_command(app, code);
  add_new_command(app, code);
  add_campaign_command(app, code);
  add_schema_command(app, code);
  add_plc_command(app, code);
  add_device_command(app, code);
  add_eds_command(app, code);
  add_module_command(app, code);
  add_scan_command(app, code);
  add_sdo_command(app, code);
  add_nmt_command(app, code);
  add_gateway_command(app, code, text::program_version());
  add_lss_command(app, code);
  add_master_command(app, code);
  app.add_subcommand("trace", "Decode, convert and compare traces of CAN buses", [&code](Command& trace) {
    trace.require_subcommand(1);
    add_trace_info(trace, code);
    add_trace_convert(trace, code);
    add_trace_diff(trace, code);
    add_trace_show(trace, code);
    add_trace_stats(trace, code);
    add_trace_plot(trace, code);
    add_trace_export(trace, code);
  });
  add_monitor_command(app, code);
  add_replay_command(app, code);
  add_bench_command(app, code);
  add_configure_command(app, code);
  add_project_command(app, code);
  add_users_command(app, code);
  add_reference_commands(app, code, text::program_version());
}

int run_command_line(std::span<const std::string> words) {
  Command app{"Canopus: CANopen communication modules of PLCs, and whole CANopen plants, as software",
              "canopus"};
  int code = exit_code::done;
  add_commands(app, code);
  std::vector<std::string> asked(words.begin(), words.end());
  if (!words.empty() && words.front() == "help") {  // `canopus help run` is `canopus run --help`
    asked.erase(asked.begin());
    asked.emplace_back("--help");
  }
  const Parsing parsing = parse_words(app, asked, [](std::string_view hint) { print_error("{}", hint); });
  return parsing.result == Parsing::Result::ran ? code : explain(app, parsing);
}

}  // namespace canopus::cli
