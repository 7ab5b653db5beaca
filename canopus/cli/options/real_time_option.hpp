#pragma once
// --realtime[=PROCESSOR] of the commands that have to be punctual.

#include <optional>
#include <string>
#include <string_view>

#include "canopus/cli/options/command.hpp"
#include "canopus/serve/real_time_thread.hpp"

namespace canopus::cli {

struct RealTimeOption {
  std::string text{};  ///< empty: not asked for

  [[nodiscard]] std::optional<serve::RealTimeThread> wanted() const {
    if (text.empty()) return std::nullopt;
    serve::RealTimeThread thread;
    if (text != any) thread.processor = static_cast<unsigned>(std::stoul(text));
    return thread;
  }
  static constexpr std::string_view any = "true";  // what a flag without a value gets
};

inline void add_real_time_option(Command& command, RealTimeOption& option) {
  constexpr unsigned most_processors = 1023;
  command
      .add_flag(
          "--realtime", option.text,
          "Request SCHED_FIFO and locked memory of the system, =PROCESSOR: on that processor alone; what the "
          "system refuses is reported, and the run goes on without it")
      ->type_name("[PROCESSOR]")
      ->check([](const std::string& text) {
        return text == RealTimeOption::any ? std::string() : number_from(0, most_processors)(text);
      });
}

}  // namespace canopus::cli
