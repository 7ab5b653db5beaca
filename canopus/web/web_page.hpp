#pragma once
// The page in the browser of a run: what it shows of the plant, and what people do on it.

#include <chrono>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "canopus/link/loop_clock.hpp"
#include "canopus/link/peer.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/web/access/access_files.hpp"
#include "canopus/web/access/audit.hpp"
#include "canopus/web/commands/bus_commands.hpp"
#include "canopus/web/commands/commands.hpp"
#include "canopus/web/commands/faults.hpp"
#include "canopus/web/commands/frame_sending.hpp"
#include "canopus/web/commands/modules.hpp"
#include "canopus/web/commands/start_page.hpp"
#include "canopus/web/http/page_files.hpp"
#include "canopus/web/server/server.hpp"
#include "canopus/web/state/events.hpp"
#include "canopus/web/state/messages.hpp"
#include "canopus/web/state/views.hpp"
#include "canopus/web/trace/live_trace.hpp"
#include "canopus/web/trace/trace_files.hpp"

namespace canopus::web {

/// A project that the page edits, in place of those of the plant's buses.
struct WebProject {
  std::string project{};                    ///< folder or nodelist.cpj; empty: there is none
  unsigned network = 1;                     ///< of the list, from 1
  std::vector<std::string> device_files{};  ///< folders and files that devices are looked for in
  std::string start{};  ///< the folder whose plants and projects the page offers; empty: none
};

/// How fast plant time goes, for people to change it.
struct WebPace {
  std::function<double()> speed{};  ///< 0: it stands still
  std::function<void(double speed, can::Duration)>
      set_speed{};  ///< for so long, then it stands still; max(): for ever
};

/// What the page may open files of.
struct WebFolders {
  std::string start{};   ///< plants and projects that it offers; empty: it offers none
  std::string traces{};  ///< recorded traces; empty: none
};

class WebPage {
 public:
  static constexpr double slowest = 0.01;
  static constexpr double fastest = 100;

  /// All must outlive the page; `buses` and `settings` are those that its commands are for.
  /// `pace`: without functions plant time goes with the clock.
  WebPage(boost::asio::io_context& io, plant::Plant& plant, link::LoopClock& clock, WebEvents& events,
          std::vector<WebBus> buses, std::vector<WebSettings> settings, const WebFolders& folders,
          WebAccess access, WebPace pace, const link::ClientReport& report);

  /// Reads the users and opens the audit log, too. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> listen(const text::HostAndPort& place);
  [[nodiscard]] std::string url() const { return server_.url(); }
  void close();

 private:
  [[nodiscard]] std::expected<void, std::string> open_access();
  /// Somebody did something, or tried to: into the audit log and, if it is more than a look, to all who watch.
  /// `message`: why not, or what was said of it; empty: nothing.
  void note(const WebUser& user, const std::string& what, int code, const std::string& message, WebRole role);
  void write(const WebUser& user, const std::string& what, int code, const std::string& message,
             WebRole role);

  [[nodiscard]] std::map<std::string, WebCommands::Own, std::less<>> own_commands(const WebPace& pace,
                                                                                  link::LoopClock& clock);

  static constexpr std::uint64_t most_refused_a_second = 5;

  plant::Plant& plant_;
  WebAccess access_;
  std::expected<PageFiles, std::string> files_;
  std::chrono::steady_clock::time_point refused_since_{};
  std::uint64_t refused_ = 0;   // since then, of users who only look
  std::uint64_t left_out_ = 0;  // of these
  link::ClientReport report_;
  std::unique_ptr<WebAudit> audit_;
  WebEvents& events_;
  WebMessages messages_;
  WebViews views_;
  WebTrace trace_;
  TraceFiles trace_files_;
  std::optional<WebStart> start_;
  WebFaults faults_;
  WebModules modules_;
  BusCommands bus_commands_;
  FrameSending frame_sending_;
  WebCommands commands_;
  WebServer server_;
};

}  // namespace canopus::web
