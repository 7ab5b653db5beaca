#pragma once
// A bounded queue of lines in front of a descriptor that may be slow, or that nobody reads: a pipe, a stopped
// terminal. A thread of its own writes; who prints never waits for the reader, unless asked to. It is there from the first
// line on: system calls and locks of a process with one thread cost less.
//
//   print -> waiting lines (at most `capacity` octets) -> thread -> descriptor
//
// What does not fit is counted, and the count is said in a line of its own as soon as the reader goes on, at
// its place among the others. The descriptor stays as it is: it may be shared with others, O_NONBLOCK would
// be theirs, too.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

class OutputQueue final : public Output {
 public:
  struct Use {
    /// The line (with its end) that says how many were lost. Called by the thread.
    std::function<std::string(std::uint64_t lines)> lost_line{};
    /// The descriptor cannot be written any more, errno says why. Called by the thread, once.
    std::function<void(int error)> failed{};
    /// Octets that wait at most, in two buffers.
    std::size_t capacity = std::size_t{1} << 20;
  };
  /// Time since the reader took something -> whether to wait for it any longer.
  using Patience = std::function<bool(std::chrono::steady_clock::duration)>;

  OutputQueue(int descriptor, Use use);
  /// Does not wait for the reader: see finish().
  ~OutputQueue() override;

  /// From now on a line that does not fit waits, as long as the patience lasts; without one it is lost at once.
  void set_patience(Patience patience) { patience_ = std::move(patience); }
  /// From now on the thread is woken by pass_on(), not by each line: a wake costs more than a line.
  void gather() { gathers_ = true; }
  /// Lets the thread write what was gathered.
  void pass_on();
  /// From now on each line wakes the thread again.
  void end_gathering();
  /// Waits until everything is written, as long as the patience lasts, and ends the thread. What is printed
  /// later is lost. Returns how many lines never reached the reader without a word about it.
  std::uint64_t finish(const Patience& patience);
  /// Waits until everything is written. False: the patience ended first.
  bool flush(const Patience& patience);

  /// Nothing waits to be written.
  [[nodiscard]] bool is_idle() const;
  /// errno of the write that failed; 0: none did.
  [[nodiscard]] int error() const;
  /// Lines lost so far, said or not.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  struct Shared;
  void write(std::string_view text) override;
  void start_thread();

  std::shared_ptr<Shared> shared_;  // the thread's, too: it may be stuck in the kernel when this one goes
  std::thread thread_;
  Patience patience_;
  bool gathers_ = false;
  bool has_gathered_ = false;
};

}  // namespace canopus::cli
