#pragma once
// This program run beside itself, for a command that takes its time or waits for a bus: the plant goes on meanwhile, and nothing
// that happens there can end it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <sys/types.h>

#include "canopus/web/commands/running_command.hpp"

namespace canopus::web {

class ChildProcess final : public RunningCommand, public std::enable_shared_from_this<ChildProcess> {
 public:
  static constexpr std::size_t longest_line = 4U << 20;     ///< a longer one ends the process
  static constexpr std::size_t longest_errors = 64U << 10;  ///< of its standard error; the rest is left out

  struct Use {
    std::function<void(std::string line)> line{};  ///< of its standard output, without its end
    /// Its exit code, 128 + N of one that signal N ended, and its standard error. Comes once, unless it is stopped.
    std::function<void(int code, std::string errors)> ended{};
    std::size_t most_output = SIZE_MAX;  ///< bytes of its standard output; one that prints more is ended
    /// Of make_folder(), for this process alone. Who starts it removes it when it has ended; if that one ends before, it is removed
    /// all the same.
    std::filesystem::path folder{};
  };

  /// A folder for files of a process, that only this user can look into; empty: there is none to be had.
  [[nodiscard]] static std::filesystem::path make_folder();
  /// Removes those that make_folder() made in processes of this user that have ended: killed at the moment before they started one
  /// that would have removed it.
  static void remove_left_folders();
  /// The program that runs now.
  static constexpr const char* itself = "/proc/self/exe";
  /// The process ends with this one (parent_process.hpp). Calls `use` from the loop's thread. `program`: a path; `arguments`: those behind its name. The error is a sentence.
  [[nodiscard]] static std::expected<std::shared_ptr<ChildProcess>, std::string> start(
      boost::asio::io_context& io, const std::string& program, const std::vector<std::string>& arguments,
      Use use);
  ~ChildProcess() override;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void interrupt() noexcept override;
  void kill() noexcept override;
  /// Waits until it has gone, too.
  void stop() noexcept override;

 private:
  using Descriptor = boost::asio::posix::stream_descriptor;
  ChildProcess(boost::asio::io_context& io, pid_t process, int output, int errors, Use use);
  void read_output();
  void read_errors();
  void take_lines();
  void closed();

  pid_t process_;
  Descriptor output_;
  Descriptor errors_;
  Use use_;
  std::array<char, 16384> output_bytes_{};
  std::array<char, 4096> error_bytes_{};
  std::string line_;
  std::string said_;
  std::size_t read_ = 0;
  int open_ = 2;
};

/// Environment variables by which ChildProcess passes on that it is the parent: its process ID, and the folder that it made for this
/// process alone (empty: none).
inline constexpr const char* parent_variable = "CANOPUS_PARENT";
inline constexpr const char* parent_folder_variable = "CANOPUS_PARENT_FOLDER";
/// Of the name of such a folder; others are left alone.
inline constexpr const char* child_folder_prefix = "canopus-";

/// To be called first of all in main(), while there is one thread. Where ChildProcess has started this process, it gets SIGTERM when
/// its parent ends. With a folder the process becomes two: the call returns in the second one; the first one passes signals on to it,
/// ends as it has ended, and removes the folder if the parent, which would do that, is there no more.
void end_with_parent();

}  // namespace canopus::web
