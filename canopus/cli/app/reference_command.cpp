#include <memory>
#include <string>

#include "canopus/cli/app/completion_script.hpp"
#include "canopus/cli/app/manual_page.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {
namespace {

/// With all commands in it.
const Command& whole(Command& app) {
  app.build_all();
  return app;
}

void build_completion_command(Command& command, Command& app) {
  auto shell = std::make_shared<std::string>();
  command.add_option("SHELL", *shell, "bash, zsh or fish")
      ->required()
      ->check(one_of_words({"bash", "zsh", "fish"}));
  command.footer(
      "For this shell alone:      source <(canopus completion bash)\n"
      "For every bash from now:   canopus completion bash > "
      "~/.local/share/bash-completion/completions/canopus\n"
      "For every zsh:             canopus completion zsh > _canopus, in a directory of $fpath\n"
      "For every fish:            canopus completion fish > ~/.config/fish/completions/canopus.fish");
  command.callback(
      [shell, &app] { standard_output().content(completion_script(whole(app), *shell_of(*shell))); });
}

struct ManualOptions {
  std::string command;
  bool list = false;
};

int print_manual(Command& app, const ManualOptions& options, std::string_view version) {
  const Command& program = whole(app);
  if (options.list) {
    print_line("");
    for (const Command& command : program.commands()) print_line("{}", command.name());
    return exit_code::done;
  }
  if (options.command.empty()) {
    standard_output().content(manual_page(program, version));
    return exit_code::done;
  }
  std::vector<std::string_view> known;
  for (const Command& command : program.commands()) {
    if (command.name() == options.command) {
      standard_output().content(manual_page(command, version));
      return exit_code::done;
    }
    known.push_back(command.name());
  }
  print_error("canopus reference man: unknown command \"{}\"{}", options.command,
              text::suggestion(options.command, known));
  return exit_code::usage;
}

void build_reference_command(Command& reference, Command& app, int& code, std::string_view version) {
  reference.require_subcommand(1);
  auto options = std::make_shared<ManualOptions>();
  Command* manual = reference.add_subcommand("man", "Print a manual page in roff");
  manual->add_option("COMMAND", options->command,
                     "The page of this command; without it the program's own page");
  manual->add_flag(
      "--list", options->list,
      "Print which pages there are instead: a command a line, the program's own as an empty line");
  manual->footer("Example: canopus reference man run | man -l -");
  manual->callback([options, &app, &code, version] { code = print_manual(app, *options, version); });
  Command* markdown =
      reference.add_subcommand("markdown", "Print one page of all commands and options in Markdown");
  markdown->callback([&app] { standard_output().content(markdown_page(whole(app))); });
}

}  // namespace

void add_reference_commands(Command& app, int& code, std::string_view version) {
  app.add_subcommand("completion", "Print the completion of commands and options for a shell",
                     [&app](Command& command) { build_completion_command(command, app); });
  app.add_subcommand(
      "reference", "Print the reference of all commands, for packages and sites",
      [&app, &code, version](Command& reference) { build_reference_command(reference, app, code, version); });
}

}  // namespace canopus::cli
