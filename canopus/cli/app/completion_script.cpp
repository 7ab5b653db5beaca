#include "canopus/cli/app/completion_script.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace canopus::cli {
namespace {

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

/// In single quotes for bash and zsh.
std::string quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

/// In single quotes for fish.
std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

/// The command and all commands in it, outermost first.
template <typename Each>
void walk(const Command& command, const Each& each) {
  each(command);
  for (const Command& inner : command.commands()) walk(inner, each);
}

std::vector<std::string> words_behind(const Command& command) {
  std::vector<std::string> words;
  for (const Command& inner : command.commands()) words.push_back(inner.name());
  for (const Option& option : command.options())
    words.insert(words.end(), option.names().begin(), option.names().end());
  return words;
}

/// A case for every command with subcommands: "canopus/trace) words;;"
std::string bash_script(const Command& program) {
  std::string commands, options, values, arguments;
  walk(program, [&](const Command& command) {
    const std::string key = replaced(command.full_name(), " ", "/");
    std::vector<std::string> inner;
    for (const Command& each : command.commands()) inner.push_back(each.name());
    if (!inner.empty())
      commands += fmt::format("    {}) echo {} ;;\n", key, quoted(fmt::format("{}", fmt::join(inner, " "))));
    options += fmt::format("    {}) echo {} ;;\n", key,
                           quoted(fmt::format("{}", fmt::join(words_behind(command), " "))));
    for (const Option& argument : command.arguments()) {
      if (argument.choices().empty()) continue;
      arguments += fmt::format("    {}) echo {} ;;\n", key,
                               quoted(fmt::format("{}", fmt::join(argument.choices(), " "))));
    }
    for (const Option& option : command.options()) {
      if (option.value().empty()) continue;
      for (const std::string& name : option.names()) {
        values += fmt::format("    {}:{}) echo {} ;;\n", key, name,
                              quoted(fmt::format("{}", fmt::join(option.choices(), " "))));
      }
    }
  });
  return R"sh(# Completion of canopus for bash
_canopus_commands() {
  case "$1" in
)sh" + commands +
         R"sh(  esac
}
_canopus_words() {
  case "$1" in
)sh" + options +
         R"sh(  esac
}
# The words an option takes: an empty line where it takes others, nothing where it takes none.
_canopus_values() {
  case "$1" in
)sh" + values +
         R"sh(  esac
}
_canopus() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} path=canopus word values i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    word=${COMP_WORDS[i]}
    case " $(_canopus_commands "$path") " in *" $word "*) path=$path/$word ;; esac
  done
  values=$(_canopus_values "$path:$before"; echo .)
  if [ "$values" != . ]; then
    values=${values%.}
    [ -n "${values//[[:space:]]/}" ] && mapfile -t COMPREPLY < <(compgen -W "$values" -- "$current")
  elif [[ $current == -* || -n $(_canopus_commands "$path") ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_canopus_words "$path")" -- "$current")
  else
    word=$(_canopus_arguments "$path")
    [ -n "$word" ] && mapfile -t COMPREPLY < <(compgen -W "$word" -- "$current")
  fi
}
# The words that an argument of a command is chosen from.
_canopus_arguments() {
  case "$1" in
)sh" + arguments +
         R"sh(  esac
}
complete -o bashdefault -o default -F _canopus canopus
)sh";
}

std::string zsh_function(const Command& command) {
  return "_" + replaced(replaced(command.full_name(), " ", "_"), "-", "_");
}

/// A description for _arguments: no brackets, no colons.
std::string zsh_text(const std::string& text) {
  return replaced(replaced(replaced(text, "[", "("), "]", ")"), ":", "\\:");
}

std::string zsh_value(const Option& option) {
  const std::string action =
      option.choices().empty() ? "_files" : fmt::format("({})", fmt::join(option.choices(), " "));
  return fmt::format(
      ":{}:{}", zsh_text(option.names().front().starts_with('-') ? option.value() : option.names().front()),
      action);
}

std::string zsh_script(const Command& program) {
  std::string script = "#compdef canopus\n";
  walk(program, [&](const Command& command) {
    script += fmt::format("{}() {{\n  _arguments -C", zsh_function(command));
    for (const Option& option : command.options()) {
      for (const std::string& name : option.names()) {
        const std::string repeat = option.is_several() ? "*" : "";
        script += " \\\n    " + quoted(repeat + name + "[" + zsh_text(option.description()) + "]" +
                                       (option.value().empty() ? "" : zsh_value(option)));
      }
    }
    if (command.commands().empty()) {
      for (const Option& argument : command.arguments()) {
        script += " \\\n    " + quoted((argument.is_several() ? "*" : "") + zsh_value(argument));
      }
      script += "\n}\n";
      return;
    }
    script +=
        " \\\n    '1:command:->command' \\\n    '*::arguments:->arguments'\n  case $state in\n  command)\n   "
        " local -a commands=(";
    for (const Command& inner : command.commands()) {
      script += "\n      " + quoted(inner.name() + ":" + inner.description());
    }
    script += ")\n    _describe command commands ;;\n  arguments)\n    case $words[1] in\n";
    for (const Command& inner : command.commands()) {
      script += fmt::format("    {}) {} ;;\n", inner.name(), zsh_function(inner));
    }
    script += "    esac ;;\n  esac\n}\n";
  });
  return script +
         "if [ \"$funcstack[1]\" = _canopus ]; then _canopus \"$@\"; else compdef _canopus canopus; fi\n";
}

/// The words behind "canopus" as the condition of a completion: the ones of this command, and no inner one yet.
std::string fish_condition(const Command& command) {
  return fish_quoted("__canopus_at " + command.full_name().substr(std::min(
                                           command.full_name().size(), std::string_view("canopus ").size())));
}

std::string fish_script(const Command& program) {
  std::string known;
  walk(program, [&](const Command& command) {
    if (!command.commands().empty() || command.full_name() != program.full_name())
      known += " " + fish_quoted(command.full_name());
  });
  std::string script = R"sh(# Completion of canopus for fish
set -g __canopus_commands)sh" +
                       known + R"sh(
# Whether the words so far name this command, and no command in it.
function __canopus_at
  set -l path canopus
  for word in (commandline -opc)[2..-1]
    contains -- "$path $word" $__canopus_commands; and set path "$path $word"
  end
  test "$path" = (string join ' ' canopus $argv)
end
)sh";
  walk(program, [&](const Command& command) {
    const std::string condition = fish_condition(command);
    for (const Command& inner : command.commands()) {
      script += fmt::format("complete -c canopus -f -n {} -a {} -d {}\n", condition,
                            fish_quoted(inner.name()), fish_quoted(inner.description()));
    }
    for (const Option& argument : command.arguments()) {
      if (argument.choices().empty()) continue;
      script += fmt::format("complete -c canopus -f -n {} -a {}\n", condition,
                            fish_quoted(fmt::format("{}", fmt::join(argument.choices(), " "))));
    }
    for (const Option& option : command.options()) {
      script += fmt::format("complete -c canopus -n {}", condition);
      for (const std::string& name : option.names()) {
        script += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      }
      if (!option.choices().empty()) {
        script += " -x -a " + fish_quoted(fmt::format("{}", fmt::join(option.choices(), " ")));
      } else if (!option.value().empty()) {
        script += " -r";
      }
      script += " -d " + fish_quoted(option.description()) + "\n";
    }
  });
  return script;
}

}  // namespace

std::optional<Shell> shell_of(std::string_view word) {
  if (word == "bash") return Shell::bash;
  if (word == "zsh") return Shell::zsh;
  if (word == "fish") return Shell::fish;
  return std::nullopt;
}

std::string completion_script(const Command& program, Shell shell) {
  switch (shell) {
    case Shell::bash: return bash_script(program);
    case Shell::zsh: return zsh_script(program);
    case Shell::fish: break;
  }
  return fish_script(program);
}

}  // namespace canopus::cli
