#include "canopus/cli/reference/reference_command.hpp"

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "canopus/cli/commands/bus_command.hpp"
#include "canopus/cli/reference/command_description.hpp"
#include "canopus/cli/reference/completion_script.hpp"
#include "canopus/cli/reference/manual_page.hpp"
#include "canopus/cli/terminal/option_checks.hpp"
#include "canopus/cli/terminal/print.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {
namespace {

void add_completion_command(CLI::App& app) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("completion", "Print the completion of commands and options for a shell");
  command->add_option("SHELL", *shell, "bash, zsh or fish")
      ->required()
      ->check(one_of_words({"bash", "zsh", "fish"}));
  command->footer(
      "For this shell alone:      source <(canopus completion bash)\n"
      "For every bash from now:   canopus completion bash > "
      "~/.local/share/bash-completion/completions/canopus\n"
      "For every zsh:             canopus completion zsh > _canopus, in a directory of $fpath\n"
      "For every fish:            canopus completion fish > ~/.config/fish/completions/canopus.fish");
  command->callback(
      [shell, &app] { standard_output().content(completion_script(describe(app), *shell_of(*shell))); });
}

struct ManualOptions {
  std::string command;
  bool list = false;
};

int print_manual(CLI::App& app, const ManualOptions& options, std::string_view version) {
  const CommandDescription program = describe(app);
  if (options.list) {
    print_line("");
    for (const CommandDescription& command : program.commands) print_line("{}", command.word());
    return exit_code::done;
  }
  if (options.command.empty()) {
    standard_output().content(manual_page(program, version));
    return exit_code::done;
  }
  std::vector<std::string_view> known;
  for (const CommandDescription& command : program.commands) {
    if (command.word() == options.command) {
      standard_output().content(manual_page(command, version));
      return exit_code::done;
    }
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    known.push_back(command->get_name());
  print_error("canopus reference man: unknown command \"{}\"{}", options.command,
              text::suggestion(options.command, known));
  return exit_code::usage;
}

}  // namespace

void add_reference_commands(CLI::App& app, int& code, std::string_view version) {
  add_completion_command(app);
  CLI::App* reference =
      app.add_subcommand("reference", "Print pages about all commands, for packages and sites");
  reference->require_subcommand(1);
  auto options = std::make_shared<ManualOptions>();
  CLI::App* manual = reference->add_subcommand("man", "Print a manual page in roff");
  manual->add_option("COMMAND", options->command,
                     "The page of this command; without it the program's own page");
  manual->add_flag(
      "--list", options->list,
      "Print which pages there are instead: a command a line, the program's own as an empty line");
  manual->footer("Example: canopus reference man run | man -l -");
  manual->callback([options, &app, &code, version] { code = print_manual(app, *options, version); });
  CLI::App* markdown =
      reference->add_subcommand("markdown", "Print one page of all commands and options in Markdown");
  markdown->callback([&app] { standard_output().content(markdown_page(describe(app))); });
}

}  // namespace canopus::cli
