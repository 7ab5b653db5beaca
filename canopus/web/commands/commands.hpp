#pragma once
// What people do on the page: commands of `canopus`, one after the other, as a child process or, on a simulated bus of this process,
// by a client there (bus_commands.hpp); their answers as events
// (docs/web.md). Who may: by the role; what writes on a live bus only while it is armed.

#include <chrono>
#include <cstdint>
#include <deque>
#include <expected>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/can/time.hpp"
#include "canopus/text/json.hpp"
#include "canopus/web/commands/arguments.hpp"
#include "canopus/web/commands/child_process.hpp"
#include "canopus/web/server/server.hpp"

namespace canopus::web {

/// `code` of a reply: exit codes of the commands (docs/project.md), and these.
namespace web_code {
inline constexpr int usage = 2;        ///< the page sent something that is no command
inline constexpr int refused = 5;      ///< it cannot be as it was asked for
inline constexpr int not_allowed = 7;  ///< the role is too low
inline constexpr int not_armed = 8;    ///< a live bus, and writing is not armed
inline constexpr int busy = 9;         ///< too many commands wait
inline constexpr int stopped = 10;     ///< taken back by who asked for it
}  // namespace web_code

/// Rows of a command may come in several events, each with "more": true, before the one with its "code".
class WebCommands {
 public:
  static constexpr std::size_t most_waiting = 32;
  static constexpr std::size_t most_of_user = 16;       ///< of these
  static constexpr std::size_t most_of_role_look = 16;  ///< of all users with the role look together
  static constexpr std::size_t longest_noted =
      4096;  ///< bytes of a command line, or a reason, that are kept of it

  /// One that is done in this process: returns once its row, or a sentence; at once or later.
  struct Own {
    using Done = std::function<void(std::expected<text::Json, std::string>)>;
    WebRole role = WebRole::operate;
    bool is_noted = true;  ///< false: it is repeated all the time, and is nothing for the audit log
    std::vector<std::string_view> fields{};  ///< beside "command"; with another one it is refused
    std::function<void(const text::Json& wish, Done done)> run{};
    /// The live bus that it acts on, for which writing has to be armed; empty: none. Without the function it has none.
    std::function<std::string(const text::Json& wish)> live_bus{};
  };
  struct Use {
    std::vector<WebBus> buses{};
    std::vector<WebSettings> settings{};
    std::map<std::string, Own, std::less<>> own{};  ///< by name
    /// Carries out a command on a bus of this process; nullptr: it is none of those. Without the function there is none.
    std::function<std::shared_ptr<RunningCommand>(const WebCommandLine& line, RunningCommand::Use use)>
        on_bus{};
    std::string program = ChildProcess::itself;  ///< that runs the others
    std::function<can::Time()> now{};            ///< the plant's time, for `t` of events
    /// How long a command may take: with files alone, and on a bus. Then it is stopped, and `grace` later killed.
    std::chrono::milliseconds longest_with_files = std::chrono::minutes(2);
    std::chrono::milliseconds longest_on_bus = std::chrono::hours(1);
    std::chrono::milliseconds grace = std::chrono::seconds(10);
    std::chrono::nanoseconds armed_for =
        std::chrono::minutes(10);         ///< then writing on a live bus is not allowed any more
    std::size_t most_output = 64U << 20;  ///< bytes that a command may print
    /// What was done: who, the command line, its code, the reason (empty: none was given), the role that it needs. Both texts have
    /// `longest_noted`.
    std::function<void(const WebUser& user, const std::string& line, int code, const std::string& message,
                       WebRole role)>
        done{};
  };

  WebCommands(boost::asio::io_context& io, Use use)
      : io_(io), use_(std::move(use)), batch_(io), patience_(io) {
    ChildProcess::remove_left_folders();
  }
  ~WebCommands();
  WebCommands(const WebCommands&) = delete;
  WebCommands& operator=(const WebCommands&) = delete;

  /// A command, JSON. Beside those of web_arguments.hpp: {"command": "hello"} what there is to work on; {"command": "arm", "on": true};
  /// {"command": "stop", "id": N} ends one that runs or waits.
  void run(const WebUser& user, std::string_view command, std::uint32_t id, WebReply reply);
  /// Writing on a live bus is allowed now.
  [[nodiscard]] bool is_armed() const;

 private:
  using Json = text::Json;
  struct Job {
    WebUser user;
    WebCommandLine line;
    std::uint32_t id = 0;
    WebReply reply{};
    std::filesystem::path folder{};  ///< of its file; empty: it has none
    std::vector<std::string> rows{};
    bool is_stopped = false;
    bool is_late = false;
  };

  [[nodiscard]] std::int64_t armed_seconds() const;
  [[nodiscard]] Json event_of(std::uint32_t id) const;
  void send(const WebReply& reply, Json event) const;
  void refuse(const WebUser& user, const std::string& line, std::uint32_t id, const WebReply& reply, int code,
              const std::string& message) const;
  void hello(const WebUser& user, std::uint32_t id, const WebReply& reply) const;
  void arm(const WebUser& user, const text::Json& wish, std::uint32_t id, const WebReply& reply);
  void stop(const WebUser& user, const text::Json& wish, std::uint32_t id, const WebReply& reply);
  /// A command line, and whether it writes to real devices.
  struct Placed {
    WebCommandLine line{};
    bool is_live = false;
    std::string place{};  ///< "line1 is a live bus"
  };
  [[nodiscard]] std::expected<Placed, std::string> place(const std::string& name,
                                                         const text::Json& wish) const;
  void run_own(const WebUser& user, const std::string& name, const Own& own, const text::Json& wish,
               std::uint32_t id, const WebReply& reply);
  [[nodiscard]] bool has_room_for(const WebUser& user) const;
  void start_next();
  void choose_next();
  [[nodiscard]] std::expected<std::shared_ptr<RunningCommand>, std::string> start(const Job& job);
  void extend_timeouts(std::chrono::milliseconds time);
  [[nodiscard]] std::string make_file(Job& job) const;
  void ended(int code, const std::string& errors);
  void send_rows(bool at_once);
  void done(const WebUser& user, const std::string& line, int code, const std::string& message,
            WebRole role = WebRole::operate) const;

  boost::asio::io_context& io_;
  Use use_;
  boost::asio::steady_timer batch_;
  boost::asio::steady_timer patience_;          // with the one that runs
  std::map<std::string, std::uint64_t> turns_;  // of each user: when one of his was started last
  std::uint64_t turn_ = 0;
  std::deque<Job> jobs_;  // the first one runs
  std::shared_ptr<RunningCommand> running_;
  bool is_batched_ = false;
  std::chrono::steady_clock::time_point armed_until_{};
};

}  // namespace canopus::web
