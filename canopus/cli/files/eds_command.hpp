#pragma once
// `canopus eds check FILE...`: mistakes in device description files, in the form that compilers use. `canopus
// eds convert IN OUT`: EDS and DCF files [CiA 306] as XDD and XDC files [CiA 311], and back.

#include <string>
#include <vector>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

class Command;

struct EdsCheckOptions {
  std::vector<std::string> files;
  bool quiet = false;   ///< only errors and losses, no summary of files without them
  bool json = false;    ///< one JSON object per line instead of text
  bool colour = false;  ///< severities in colour
};

/// Checks the files, prints to `out` (what cannot be opened: to `err`). Returns the exit code: 0 all files
/// accepted, 1 at least one refused, 2 at least one could not be read, 3 none of these, but one with losses.
int eds_check(const EdsCheckOptions& options, Output& out, Output& err);

struct EdsConvertOptions {
  std::string from;  ///< - is the standard input
  std::string to;    ///< - is the standard output
  std::string kind;  ///< eds, dcf, xdd, xdc; empty: as `to` ends
};

/// Writes a device file in the other format, and to `err` what it cannot carry. Returns the exit code: 0 written, 1 no
/// device can be made of the file or it cannot be written, 2 wrong usage or a file that cannot be read.
int eds_convert(const EdsConvertOptions& options, Output& out, Output& err);

/// Adds the subcommand `eds` with its own subcommand `check` to the program. When the user asks for it,
/// parsing runs it and puts the exit code into `exit_code`.
void add_eds_command(Command& app, int& exit_code);

}  // namespace canopus::cli
