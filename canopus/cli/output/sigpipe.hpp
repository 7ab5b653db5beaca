#pragma once
// For commands that do more than print: a closed output (SIGPIPE, `| head -1`) must not abort writing a file,
// a change or a transfer halfway.

#include <functional>

namespace canopus::cli {

/// Runs `work` to its end even if its output and errors cannot be written: SIGPIPE is ignored meanwhile.
/// Returns the exit code of the work, also when the reader of the standard output has gone; another write
/// error is thrown as OutputFailed at the end. A signal that ends the wait for a slow reader is thrown at
/// once.
[[nodiscard]] int run_ignoring_sigpipe(const std::function<int()>& work);

}  // namespace canopus::cli
