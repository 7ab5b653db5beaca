#pragma once
// Pages about the commands, made from the table of commands: manual pages, and one page of all in Markdown.

#include <string>
#include <string_view>

#include "canopus/cli/options/command.hpp"

namespace canopus::cli {

/// A manual page of section 1, in roff as man-pages(7) has it. A command of the program has its own commands on its
/// page; the program's page names each command with its page. `version`: "1.0.0".
[[nodiscard]] std::string manual_page(const Command& command, std::string_view version);

/// All commands with their options, as a page in Markdown.
[[nodiscard]] std::string markdown_page(const Command& program);

}  // namespace canopus::cli
