#pragma once
// Commands that do more than print: a reader who goes (`| head -1`) must not take a file, a change or half a transfer with him.

#include <functional>

namespace canopus::cli {

/// Does it to its end, whether its output and its errors can be written or not: SIGPIPE does not end the program meanwhile. The
/// exit code of the work when the reader of the standard output has gone; another reason why that could not be written is thrown
/// as OutputFailed once all is done. A signal that ends the wait for a reader who does not read is thrown at once.
[[nodiscard]] int run_ignoring_sigpipe(const std::function<int()>& work);

}  // namespace canopus::cli
