#pragma once

#include <functional>
#include <string>

namespace canopus::web {

/// A command of the page that runs: a child process, or a client on a simulated bus.
class RunningCommand {
 public:
  /// Called from the loop's thread.
  struct Use {
    std::function<void(std::string line)> line{};  ///< of its output, without its end
    /// Its exit code, and what went wrong, in lines. Comes once, unless it is stopped.
    std::function<void(int code, std::string errors)> ended{};
  };

  virtual ~RunningCommand() = default;
  /// As Ctrl-C does; `ended` comes.
  virtual void interrupt() = 0;
  /// Ends it at once, whatever it does; `ended` comes.
  virtual void kill() = 0;
  /// Ends it; `ended` does not come.
  virtual void stop() noexcept = 0;
};

}  // namespace canopus::web
