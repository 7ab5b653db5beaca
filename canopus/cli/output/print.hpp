#pragma once
// Everything the program prints goes through here, line by line, and every text in a line is made printable:
// a name in a device file cannot clear the screen or forge a line. JSON lines likewise.
//
//   print_line("{}: {} objects", file, count);
//   print_error("canopus: {}", reason);
//
// Each line goes out whole, in one piece. A standard output that cannot be written throws OutputFailed, which
// ends the program with a sentence and an exit code; a standard error that cannot be written is ignored.

#include <functional>
#include <stdexcept>

#include <fmt/format.h>

#include "canopus/text/json.hpp"
#include "canopus/text/output.hpp"

namespace canopus::cli {

using text::Line;
using text::Output;
using text::paint;
using text::print_errors;
using text::TextOutput;

/// Whether a stream gets colour and progress: a terminal, TERM not dumb; colour also NO_COLOR not set.
[[nodiscard]] bool is_terminal(int descriptor);
[[nodiscard]] bool wants_colour(int descriptor);

/// The standard output could not be written.
class OutputFailed : public std::runtime_error {
 public:
  /// `error`: errno. EINTR: a signal ended the wait for the reader.
  explicit OutputFailed(int error);
};

/// Where the program was started without a standard stream (`>&-`), no file it opens becomes that stream.
void reserve_standard_descriptors();

[[nodiscard]] Output& standard_output();
[[nodiscard]] Output& standard_error();

/// Redirects standard output and standard error there for its lifetime.
class Diversion {
 public:
  Diversion(Output& out, Output& error);
  ~Diversion();
  Diversion(const Diversion&) = delete;
  Diversion& operator=(const Diversion&) = delete;
};

/// One line on the standard output.
template <typename... T>
void print_line(fmt::format_string<const T&...> format, const T&... arguments) {
  standard_output().line(Line(format, arguments...));
}
/// One line on the standard error.
template <typename... T>
void print_error(fmt::format_string<const T&...> format, const T&... arguments) {
  standard_error().line(Line(format, arguments...));
}
/// One JSON object on the standard output, in a line.
void print_json(const text::Json& object);

/// The last line of the terminal of the standard error shows the progress, redrawn in place; the next line
/// printed takes its place. Nothing unless is_terminal(STDERR_FILENO).
void show_progress(const Line& line);
void end_progress();

// For commands that do more than print: a closed output (SIGPIPE, `| head -1`) must not abort writing a file,
// a change or a transfer halfway.

/// Runs `work` to its end even if its output and errors cannot be written: SIGPIPE is ignored meanwhile.
/// Returns the exit code of the work, also when the reader of the standard output has gone; another write
/// error is thrown as OutputFailed at the end. A signal that ends the wait for a slow reader is thrown at
/// once.
[[nodiscard]] int run_ignoring_sigpipe(const std::function<int()>& work);

}  // namespace canopus::cli
