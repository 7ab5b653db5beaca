#include "canopus/cli/app/manual_page.hpp"

#include <sstream>

#include <fmt/format.h>

namespace canopus::cli {
namespace {

/// Text as roff prints it unchanged: a backslash, a minus sign that can be copied, no control line.
std::string roff(std::string_view text) {
  std::string safe;
  for (const char character : text) {
    switch (character) {
      case '\\': safe += "\\e"; break;
      case '-': safe += "\\-"; break;
      case '\'': safe += "\\(aq"; break;
      case '`': safe += "\\(ga"; break;
      case '^': safe += "\\(ha"; break;
      case '~': safe += "\\(ti"; break;
      default: safe += character;
    }
  }
  return safe.starts_with('.') ? "\\&" + safe : safe;
}

/// "-q, --quiet", each name printed as `print` makes it.
template <typename Print>
std::string names_of(const Option& option, Print print) {
  std::string names;
  for (const std::string& name : option.names()) names += (names.empty() ? "" : ", ") + print(name);
  return names;
}

std::string sentence_of(const Option& option) {
  std::string sentence = option.description();
  if (!option.choices().empty()) sentence += fmt::format("; one of: {}", fmt::join(option.choices(), ", "));
  return sentence;
}

void add_options(std::string& page, const Command::Options& options) {
  for (const Option& option : options) {
    page += ".TP\n" + names_of(option, [](const std::string& name) { return "\\fB" + roff(name) + "\\fR"; });
    if (!option.value().empty() && option.names().front().starts_with('-'))
      page += " \\fI" + roff(option.value()) + "\\fR";
    page += "\n" + roff(sentence_of(option)) + "\n";
  }
}

/// Lines that stay as they are.
void add_lines(std::string& page, const std::string& text) {
  if (text.empty()) return;
  page += ".nf\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) page += line.empty() ? ".sp\n" : roff(line) + "\n";
  page += ".fi\n";
}

/// A command with a page of its own, or one described on its parent's page.
void add_inner(std::string& page, const Command& command) {
  for (const Command& inner : command.commands()) {
    page += ".SS " + roff(inner.usage()) + "\n" + roff(inner.description()) + ".\n";
    add_options(page, inner.arguments());
    add_options(page, inner.options());
    if (!inner.footer().empty()) page += ".PP\n";
    add_lines(page, inner.footer());
    add_inner(page, inner);
  }
}

std::string page_name(std::string name) {
  for (char& character : name) {
    if (character == ' ') character = '-';
  }
  return name;
}

std::string markdown(std::string_view text) {
  std::string safe;
  for (const char character : text) {
    if (std::string_view("|\\<>*_`[]").find(character) != std::string_view::npos) safe += '\\';
    safe += character;
  }
  return safe;
}

void add_markdown(std::string& page, const Command& command, int level) {
  page += fmt::format("\n{} {}\n\n{}.\n\n```\n{}\n```\n", std::string(static_cast<std::size_t>(level), '#'),
                      command.full_name(), markdown(command.description()), command.usage());
  if (!command.arguments().empty() || !command.options().empty()) page += "\n| | |\n|---|---|\n";
  for (const Command::Options& options : {command.arguments(), command.options()}) {
    for (const Option& option : options) {
      const bool with_value = !option.value().empty() && option.names().front().starts_with('-');
      page += fmt::format("| `{}{}` | {} |\n", names_of(option, [](const std::string& name) { return name; }),
                          with_value ? " " + option.value() : "", markdown(sentence_of(option)));
    }
  }
  if (!command.footer().empty()) page += "\n```\n" + command.footer() + "\n```\n";
  for (const Command& inner : command.commands()) add_markdown(page, inner, level + 1);
}

}  // namespace

std::string manual_page(const Command& command, std::string_view version) {
  const std::string name = page_name(command.full_name());
  const bool whole_program = command.full_name().find(' ') == std::string::npos;
  std::string page = fmt::format(".TH {} 1 \"\" \"canopus {}\" \"Canopus manual\"\n.SH NAME\n{} \\- {}\n",
                                 roff(name), version, roff(name), roff(command.description()));
  page += ".SH SYNOPSIS\n\\fB" + roff(command.usage()) + "\\fR\n";
  if (!command.arguments().empty()) {
    page += ".SH ARGUMENTS\n";
    add_options(page, command.arguments());
  }
  if (!command.options().empty()) {
    page += ".SH OPTIONS\n";
    add_options(page, command.options());
  }
  if (!command.commands().empty()) page += ".SH COMMANDS\n";
  if (whole_program) {
    for (const Command& inner : command.commands()) {
      page +=
          ".TP\n\\fB" + roff(page_name(inner.full_name())) + "\\fR(1)\n" + roff(inner.description()) + "\n";
    }
  } else {
    add_inner(page, command);
  }
  if (!command.footer().empty()) {
    page += ".SH NOTES\n";
    add_lines(page, command.footer());
  }
  if (!whole_program) page += ".SH SEE ALSO\n\\fBcanopus\\fR(1)\n";
  return page;
}

std::string markdown_page(const Command& program) {
  std::string page =
      "# All commands\n\nMade from the program's own descriptions: `canopus reference markdown`.\n";
  for (const Command& command : program.commands()) add_markdown(page, command, 2);
  return page;
}

}  // namespace canopus::cli
