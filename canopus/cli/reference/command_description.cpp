#include "canopus/cli/reference/command_description.hpp"

#include <CLI/CLI.hpp>

#include "canopus/cli/terminal/option_checks.hpp"

namespace canopus::cli {
namespace {

/// A validator's list of words, where it has one.
std::vector<std::string> choices_of(CLI::Option& option) {
  try {
    return words_of(option.get_validator("")->get_name());
  } catch (const CLI::OptionNotFound&) {
    return {};
  }
}

OptionDescription describe_option(CLI::Option& option) {
  OptionDescription said;
  for (const std::string& name : option.get_snames()) said.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) said.names.push_back("--" + name);
  if (said.names.empty()) said.names.push_back(option.get_name());
  if (option.get_items_expected_max() > 0 && option.get_expected_min() > 0) {
    said.value = option.get_type_name().empty() ? "VALUE" : option.get_type_name();
  }
  said.description = option.get_description();
  said.choices = choices_of(option);
  said.required = option.get_required();
  said.several = option.get_items_expected_max() > 1;
  return said;
}

}  // namespace

std::string CommandDescription::word() const { return name.substr(name.rfind(' ') + 1); }

std::string CommandDescription::usage() const {
  std::string line = name;
  if (!options.empty()) line += " [OPTIONS]";
  for (const OptionDescription& argument : arguments) {
    const std::string word = argument.names.front() + (argument.several ? "..." : "");
    line += argument.required ? " " + word : " [" + word + "]";
  }
  if (!commands.empty()) line += " COMMAND";
  return line;
}

CommandDescription describe(CLI::App& command, const std::string& outer) {
  CommandDescription said;
  said.name = outer.empty() ? command.get_name() : outer + " " + command.get_name();
  said.description = command.get_description();
  said.footer = command.get_footer();
  for (CLI::Option* option : command.get_options()) {
    auto description = describe_option(*option);
    (option->get_positional() ? said.arguments : said.options).push_back(std::move(description));
  }
  for (CLI::App* inner : command.get_subcommands([](const CLI::App*) { return true; })) {
    said.commands.push_back(describe(*inner, said.name));
  }
  return said;
}

}  // namespace canopus::cli
