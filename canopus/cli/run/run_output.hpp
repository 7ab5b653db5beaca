#pragma once
// The output of a run, by queues, so that a plant in real time never waits for its reader.
//
//                    real time                        virtual time
//   not read         lines are lost, and counted      the plant waits, as long as it is not interrupted
//   at the end       waits while the reader goes on   the same; without an interruption as long as it takes
//   reader gone      the run ends, quietly, by SIGPIPE
//   cannot write     the run ends with a sentence and exit code 1

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "canopus/cli/output/output_queue.hpp"
#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

class RunOutput {
 public:
  struct Use {
    /// As OutputQueue::Use, for the standard output and the standard error.
    std::function<std::string(std::uint64_t)> lost_line{};
    std::function<std::string(std::uint64_t)> lost_error_line{};
    /// The output has failed: end the run. Called by another thread.
    std::function<void()> failed{};
  };
  /// From now on the standard streams are queues.
  explicit RunOutput(const Use& use);
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  [[nodiscard]] OutputQueue& out() noexcept { return out_; }
  /// Virtual time: lines wait for the reader, as long as `goes_on`.
  void wait_for_reader(const std::function<bool()>& goes_on);
  /// The last lines come: they wait for the reader as long as the patience lasts.
  void set_patience(const OutputQueue::Patience& patience);

  /// As OutputQueue's, of both streams.
  void gather();
  void pass_on();
  void end_gathering();

  /// Exit codes of finish().
  static constexpr int written = 0;
  static constexpr int failed = 1;
  static constexpr int reader_gone = 128 + 13;  ///< as shells show a process that SIGPIPE ended
  /// Writes what is left until the patience ends, prints the number of lost lines, and restores the standard
  /// streams.
  int finish(const OutputQueue::Patience& patience);

 private:
  [[nodiscard]] Output& error_output() { return error_ ? static_cast<Output&>(*error_) : out_; }

  OutputQueue out_;
  std::optional<OutputQueue> error_;  // none: standard error is where standard output is, in one order
  std::optional<Diversion> diversion_;
};

}  // namespace canopus::cli
