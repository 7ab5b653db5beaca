#include "canopus/cli/command_line.hpp"

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "canopus/cli/analysis/trace_analysis.hpp"
#include "canopus/cli/bench/bench_command.hpp"
#include "canopus/cli/commands/bus_command.hpp"
#include "canopus/cli/commands/check_command.hpp"
#include "canopus/cli/commands/device_command.hpp"
#include "canopus/cli/commands/eds_command.hpp"
#include "canopus/cli/commands/master_command.hpp"
#include "canopus/cli/commands/module_command.hpp"
#include "canopus/cli/commands/nmt_command.hpp"
#include "canopus/cli/commands/plc_command.hpp"
#include "canopus/cli/commands/scan_command.hpp"
#include "canopus/cli/commands/sdo_command.hpp"
#include "canopus/cli/gateway/gateway_command.hpp"
#include "canopus/cli/lss/lss_command.hpp"
#include "canopus/cli/network/project_command.hpp"
#include "canopus/cli/project/configure_command.hpp"
#include "canopus/cli/reference/reference_command.hpp"
#include "canopus/cli/run/run_command.hpp"
#include "canopus/cli/run/web_command.hpp"
#include "canopus/cli/terminal/print.hpp"
#include "canopus/cli/trace/replay_command.hpp"
#include "canopus/cli/trace/trace_command.hpp"
#include "canopus/cli/users/users_command.hpp"
#include "canopus/cli/version.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {
namespace {

/// The program and the commands the words named, from the outermost to the innermost.
std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  std::vector<const CLI::App*> chain{&app};
  while (!chain.back()->get_subcommands().empty()) chain.push_back(chain.back()->get_subcommands().back());
  return chain;
}

/// "canopus plc read"
std::string name_of(std::span<const CLI::App* const> chain) {
  std::string name;
  for (const CLI::App* command : chain) name += (name.empty() ? "" : " ") + command->get_name();
  return name;
}

std::vector<std::string> commands_in(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

bool is_option(std::string_view word) { return word.size() > 1 && word.starts_with('-'); }

std::string suggestion_of(std::string_view word, const std::vector<std::string>& known) {
  return text::suggestion(word, std::vector<std::string_view>(known.begin(), known.end()));
}

/// What to say of an option that the command does not have.
std::string unknown_option(std::string_view word, std::span<const CLI::App* const> chain, std::size_t level) {
  word = word.substr(0, word.find('='));
  for (std::size_t inner = level + 1; inner < chain.size(); ++inner) {
    const auto names = options_of(*chain[inner]);
    if (std::ranges::find(names, word) == names.end()) continue;
    return fmt::format("{} comes behind the command: {} {}", word, name_of(chain.first(inner + 1)), word);
  }
  const auto names = options_of(*chain[level]);
  const std::string_view meant =
      text::nearest(word, std::vector<std::string_view>(names.begin(), names.end()));
  return meant.empty() ? fmt::format("unknown option \"{}\"", word)
                       : fmt::format("unknown option \"{}\"; did you mean \"{}\"?", word, meant);
}

/// What to say of the first word that no command took, the innermost command's first; nothing when all were
/// taken.
std::optional<std::string> unknown_word(std::span<const CLI::App* const> chain) {
  for (std::size_t level = chain.size(); level-- > 0;) {
    const auto left_over = chain[level]->remaining();
    if (left_over.empty()) continue;
    const auto option = std::ranges::find_if(left_over, is_option);
    const auto word = std::ranges::find_if_not(left_over, is_option);
    const auto commands = commands_in(*chain[level]);
    const bool wants_command = level + 1 == chain.size() && !commands.empty();
    if (wants_command && word != left_over.end()) {
      return fmt::format("unknown command \"{}\"{}", *word, suggestion_of(*word, commands));
    }
    if (option != left_over.end()) return unknown_option(*option, chain, level);
    return fmt::format("\"{}\" is one word too many", *word);
  }
  return std::nullopt;
}

void print_lines(Output& out, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out.line("{}", line);
}

/// What is wrong with the words.
std::string mistake(std::span<const CLI::App* const> chain, const CLI::ParseError& error) {
  const auto kind = static_cast<CLI::ExitCodes>(error.get_exit_code());
  if (kind == CLI::ExitCodes::ExtrasError || kind == CLI::ExitCodes::RequiredError) {
    if (const auto unknown = unknown_word(chain)) return *unknown;
    const auto commands = commands_in(*chain.back());
    if (!commands.empty()) {
      return "a command is missing" + suggestion_of("", commands);
    }
  }
  return error.what();
}

int explain(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    std::ostringstream help, nothing;
    (void)app.exit(error, help, nothing);
    print_lines(standard_output(), help.str());
    return exit_code::done;
  }
  const auto chain = commands_of(app);
  if (chain.size() == 1 && app.remaining().empty()) {
    print_lines(standard_error(), app.help());
    return exit_code::usage;
  }
  const std::string command = name_of(chain);
  print_error("{}: {}", command, mistake(chain, error));
  print_error("`{} --help` says more.", command);
  return exit_code::usage;
}

}  // namespace

int run_command_line(std::span<const std::string> words) {
  CLI::App app{"Canopus: CANopen communication modules of PLCs, and whole CANopen plants, as software",
               "canopus"};
  app.set_version_flag("-V,--version", std::string("canopus ") + version());
  app.require_subcommand(1);
  app.footer("`canopus COMMAND --help` says more about a command.");
  int code = exit_code::done;
  add_run_command(app, code);
  add_web_command(app, code);
  add_check_command(app, code);
  add_plc_command(app, code);
  add_device_command(app, code);
  add_eds_command(app, code);
  add_module_command(app, code);
  add_scan_command(app, code);
  add_sdo_command(app, code);
  add_nmt_command(app, code);
  add_gateway_command(app, code, version());
  add_lss_command(app, code);
  add_master_command(app, code);
  add_trace_command(app, code);
  add_trace_analysis(app, code);
  add_monitor_command(app, code);
  add_replay_command(app, code);
  add_bench_command(app, code);
  add_configure_command(app, code);
  add_project_command(app, code);
  add_users_command(app, code);
  add_reference_commands(app, code, version());

  std::vector<std::string> reversed(words.rbegin(), words.rend());  // as CLI11 takes them
  if (!words.empty() && words.front() == "help") {  // `canopus help run` is `canopus run --help`
    reversed.pop_back();
    reversed.insert(reversed.begin(), "--help");
  }
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::ParseError& error) {
    return explain(app, error);
  }
  return code;
}

}  // namespace canopus::cli
