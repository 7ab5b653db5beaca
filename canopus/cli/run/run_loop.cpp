#include "canopus/cli/run/run_loop.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/output/stop_signals.hpp"
#include "canopus/cli/run/live_table.hpp"
#include "canopus/cli/run/operational_check.hpp"
#include "canopus/cli/run/plant_servers.hpp"
#include "canopus/cli/run/run_output.hpp"
#include "canopus/cli/run/run_recording.hpp"
#include "canopus/cli/run/run_screen.hpp"
#include "canopus/link/bounded_poll.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/lift_on_bus.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/serve/client_reports.hpp"
#include "canopus/serve/linked_buses.hpp"
#include "canopus/serve/real_time.hpp"
#include "canopus/serve/service_manager.hpp"
#include "canopus/serve/slices/plant_slices.hpp"
#include "canopus/text/local_time.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/print/trace_walk.hpp"
#include "canopus/web/state/events.hpp"

namespace canopus::cli {
namespace {

namespace asio = boost::asio;
using WallClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Whether a plant in virtual time waits for the clients of its buses to read. It runs a thousand times
/// faster than they can, and they would lose frames. A client that reads nothing for `patience` loses frames
/// as in real time.
class ClientBackpressure {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t enough_waiting = 512;  ///< messages; a quarter of what a client's queue holds
  static constexpr Clock::duration patience = std::chrono::seconds(2);

  /// `waiting`: messages that wait for the slowest client.
  [[nodiscard]] bool are_behind(std::size_t waiting, Clock::time_point now) noexcept {
    if (waiting < waiting_ || waiting < enough_waiting) progress_at_ = now;
    waiting_ = waiting;
    return waiting >= enough_waiting && now - progress_at_ < patience;
  }

 private:
  std::size_t waiting_ = 0;
  Clock::time_point progress_at_{};
};

/// How long the end of a run waits for the reader of its output. Another signal ends the waiting.
class DrainTimeout {
 public:
  /// `limited`: no longer than a second for a reader that takes nothing.
  explicit DrainTimeout(bool limited) : limited_(limited) {}
  bool operator()(std::chrono::steady_clock::duration since_reader_took_something) {
    io_.poll();
    if (again_.came()) return false;
    return !limited_ || std::min(since_reader_took_something, std::chrono::steady_clock::now() - start_) <
                            std::chrono::seconds(1);
  }

 private:
  boost::asio::io_context io_{1};  // its own: that of the run would serve clients in the middle of a tick
  StopSignals again_{io_, {}};
  bool limited_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// All figures of the plant itself at the end of its run; the run adds those of the wall clock. Views into `plant`.
plant::RunSummary summary_of(plant::Plant& plant) {
  plant::RunSummary summary{.end = plant.timeline().now(),
                            .nodes = plant.nodes(),
                            .boots = plant.boots(),
                            .troubles = plant.troubles(),
                            .forced = plant.forced()};
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    summary.buses.push_back({plant.bus(i).name(), plant.bus(i).load(summary.end)});
  }
  for (std::size_t i = 0; i < plant.lift_count(); ++i) {
    summary.lifts.push_back({plant.lift(i).bus(), plant.lift(i).building().report()});
  }
  return summary;
}

/// The time of a plant that is driven in step: it is stopped while clients access the plant.
class StepClock final : public link::LoopClock {
 public:
  explicit StepClock(const can::Timeline& timeline) : timeline_(timeline) {}

  can::Time now() override { return timeline_.now(); }
  void touched() override {}

 private:
  const can::Timeline& timeline_;
};

/// One run from build to summary.
class Run {
 public:
  explicit Run(const RunOptions& options)
      : options_(options),
        json_(standard_output()),
        lines_(standard_output(), standard_error(), options.quiet),
        // If standard error is not the terminal, errors are printed at once.
        table_(raw_plant_, ::isatty(STDERR_FILENO) != 0 ? nullptr : &standard_error()),
        has_table_(!options.json && !options.quiet && !options.virtual_time && is_terminal(STDOUT_FILENO)),
        linked_buses_(
            io_, options.plant, options.virtual_time,
            trace::wait_in_words(standard_error(), [this] { return !stop_watch_ || !stop_watch_->came(); })) {
    if (options.web) web_events_.emplace(printer());
  }

  int operator()();

 private:
  plant::PlantObserver& observer() { return web_events_ ? web_events_->observer() : printer(); }
  plant::PlantObserver& printer() {
    if (options_.json) return json_;
    if (has_table_) return table_;
    return lines_;
  }
  void warn();
  bool open_recordings();
  [[nodiscard]] PlantServers::Use server_use(serve::PlantRuns::Order order, web::WebPace pace = {});
  link::ClientReport report_of(std::string source);
  void show_connections();
  bool run_in_real_time();
  bool run_in_step();
  void run_in_virtual_time();
  void start_output();
  [[nodiscard]] bool is_to_end() const { return stop_signals_->came() || output_failed_; }
  bool close_recordings(const OutputQueue::Patience& patience);
  void start_table(serve::RealTime& clock);
  void end_table();
  void show_server(std::string_view protocol, std::string_view of, const std::string& address);
  bool expectation_over();
  bool came_up();
  void check_end();
  void summarise(can::Duration wall);

  const RunOptions& options_;
  plant::JsonPrinter json_;
  plant::LinePrinter lines_;
  plant::Plant* raw_plant_ = nullptr;
  LiveTable table_;
  bool has_table_;
  std::optional<web::WebEvents> web_events_;
  // Other threads only post to it and never use its descriptors: no lock for each descriptor.
  asio::io_context io_{BOOST_ASIO_CONCURRENCY_HINT_UNSAFE_IO};
  serve::LinkedBuses linked_buses_;
  std::unique_ptr<plant::Plant> plant_;
  RunRecording recording_;
  std::optional<StopSignals> stop_signals_;
  std::optional<StopWatch> stop_watch_;  // while nothing of io_ may run
  std::atomic<bool> output_failed_{false};
  std::optional<RunOutput> output_;
  std::optional<OperationalCheck> expected_;
  std::optional<asio::steady_timer> end_timer_;
  std::optional<RunScreen> screen_;
  can::Duration largest_lag_{};
};

bool Run::open_recordings() {
  auto opened = recording_.open_trace(options_.trace, *plant_);
  // In real time clients act at any moment.
  const can::Duration grid = options_.virtual_time ? can::Duration(1us) : can::Duration(1ns);
  if (opened) opened = recording_.open_vcd(options_.vcd, *plant_, grid);
  if (opened) opened = recording_.open_svg(options_.svg, *plant_);
  if (!opened) print_error("canopus: {}", opened.error());
  return opened.has_value();
}

void Run::show_server(std::string_view protocol, std::string_view of, const std::string& address) {
  if (options_.json) {
    json_.listening(protocol, of, address);
  } else if (has_table_) {
    table_.add_server(fmt::format("{} {}", protocol, address));
  } else if (!options_.quiet) {
    print_line("{}{} on {}", protocol, of.empty() ? "" : fmt::format(" of {}", of), address);
  }
}

/// Where a file lies.
std::string folder_of(const std::string& file) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  return folder.empty() ? "." : folder.string();
}

PlantServers::Use Run::server_use(serve::PlantRuns::Order order, web::WebPace pace) {
  return {.opened = [this](std::string_view protocol, std::string_view of,
                           const std::string& address) { show_server(protocol, of, address); },
          .report = [this](std::string source) { return report_of(std::move(source)); },
          .free_ports = options_.free_ports,
          .control = options_.step,
          .web = options_.web.value_or(text::HostAndPort{}),
          .web_events = web_events_ ? &*web_events_ : nullptr,
          .web_project = options_.web_project,
          .web_settings = options_.web_settings,
          .web_access = options_.web_access,
          .web_traces = folder_of(options_.plant),
          .web_pace = std::move(pace),
          .order = order};
}

/// Reports of a server about its clients, as errors of this source.
link::ClientReport Run::report_of(std::string source) {
  return serve::ClientReports(observer(), plant_->timeline(), std::move(source));
}

void Run::start_table(serve::RealTime& clock) {
  screen_.emplace(io_, output_->out(),
                  RunScreen::Use{.state = [this, &clock] { return table_.state(clock.now(), clock.lag()); },
                                 .quit = [this] { io_.stop(); },
                                 .continuations = [&clock] { return clock.continuations(); },
                                 .colour = wants_colour(STDOUT_FILENO)});
  screen_->start();
}

/// Messages for the user stay on the terminal after the table has gone.
void Run::end_table() {
  screen_.reset();
  table_.messages().print(standard_error());
}

void Run::show_connections() {
  if (options_.json || options_.quiet) return;
  for (const std::string& line : plant_->connections()) print_line("{}", line);
}

bool Run::run_in_real_time() {
  const can::Time end = options_.duration ? can::Time{} + *options_.duration : can::never;
  serve::RealTime clock(io_, *plant_, observer(), end);
  // An external bus, and a real-time process, need each frame at its moment.
  const bool is_alone = linked_buses_.empty() && !options_.real_time;
  PlantServers servers(
      io_, *plant_, clock,
      server_use(serve::PlantRuns::Order::side_by_side, is_alone ? pace_of(clock) : web::WebPace{}));
  if (!servers.open()) return false;
  if (!has_table_) show_connections();
  set_cpu_clocks(*plant_);
  clock.set_resumed_handler([this] { set_cpu_clocks(*plant_); });
  linked_buses_.start(&clock, *plant_);
  if (options_.real_time) {
    for (const std::string& sentence : serve::request_real_time(*options_.real_time)) {
      observer().on({{}, plant::Warning{"--realtime", sentence}});
    }
  }
  if (is_alone) clock.wake_together(1ms);
  plant_->power_on();
  clock.start();
  if (has_table_) start_table(clock);
  if (options_.operational_within) {
    end_timer_.emplace(io_);
    check_end();
  }
  serve::ServiceManager manager(io_);
  manager.ready(fmt::format("{}: {}", options_.plant, ascii::counted(plant_->nodes().size(), "node")));
  output_->gather();
  while (io_.run_one() != 0) output_->pass_on();
  output_->end_gathering();
  manager.stopping();
  (void)clock.now();  // up to the moment it was stopped
  servers.close();
  linked_buses_.close(1s);
  if (has_table_) end_table();
  largest_lag_ = clock.largest_lag();
  return true;
}

/// Plant time moves only as long as a client of the control server waits for it.
bool Run::run_in_step() {
  constexpr auto turn = 10ms;  // of the machine's time, until clients are served again
  constexpr auto step = 5ms;   // of plant time: its frames fit into the queues of clients
  const can::Time end = options_.duration ? can::Time{} + *options_.duration : can::never;
  can::Timeline& timeline = plant_->timeline();
  StepClock clock(timeline);
  PlantServers servers(io_, *plant_, clock, server_use(serve::PlantRuns::Order::in_turn));
  if (!servers.open()) return false;
  show_connections();
  // While the plant waits for the reader of its output, no client may access it: another thread handles
  // signals.
  const auto goes_on = [this](auto) { return !stop_watch_->came() && !output_failed_; };
  output_->set_patience(goes_on);
  recording_.set_patience(goes_on);
  linked_buses_.start(nullptr, *plant_);
  plant_->power_on();
  ClientBackpressure readers;
  while (!is_to_end() && timeline.now() < end && !expectation_over()) {
    if (!servers.runs().wants_time()) {
      servers.set_standing_still(true);
      if (io_.run_one() == 0) break;
      continue;
    }
    link::poll_portion(io_, [this] { return is_to_end(); });  // what clients have sent before comes first
    if (readers.are_behind(servers.waiting_messages(), WallClock::now())) {
      io_.run_one_for(1ms);
      continue;
    }
    servers.set_standing_still(false);
    const bool reads =
        servers.waiting_messages() < ClientBackpressure::enough_waiting;  // or no client waits for it
    const auto turn_ends = WallClock::now() + turn;
    while (servers.runs().wants_time() && timeline.now() < end && WallClock::now() < turn_ends &&
           (!reads || servers.waiting_messages() < ClientBackpressure::enough_waiting)) {
      timeline.run_until(std::min({servers.runs().next(), can::later(timeline.now(), step), end}));
    }
  }
  servers.close();
  return true;
}

void Run::run_in_virtual_time() {
  const can::Time end = options_.duration ? can::Time{} + *options_.duration : can::never;
  const auto goes_on = [this](auto) {
    link::poll_portion(io_, [this] { return is_to_end(); });
    return !is_to_end();
  };
  output_->set_patience(goes_on);
  recording_.set_patience(goes_on);
  linked_buses_.start(nullptr, *plant_);
  plant_->power_on();
  const can::Timeline& timeline = plant_->timeline();
  const std::size_t threads = options_.threads != 0 ? options_.threads : std::thread::hardware_concurrency();
  // When the run ends because all has come up is a matter of plant time alone.
  constexpr can::Duration look = 100ms;
  serve::PlantSlices slices(*plant_, {.threads = std::max<std::size_t>(1, threads),
                                      .least = look,
                                      .most = expected_ ? look : serve::PlantSlices::Use{}.most,
                                      .met = [this] { recording_.parts_met(); }});
  while (timeline.now() < end && goes_on(0) && !expectation_over()) slices.run_slice(end);
}

/// The nodes are all operational, or it is too late for them.
bool Run::expectation_over() {
  return expected_ && expected_->over(plant_->nodes(), plant_->timeline().now());
}

/// In real time the expectation is checked periodically.
void Run::check_end() {
  if (expectation_over()) return io_.stop();
  end_timer_->expires_after(20ms);
  end_timer_->async_wait([this](const boost::system::error_code& error) {
    if (!error) check_end();
  });
}

/// Whether the nodes are operational as expected; prints those that are not, and why.
bool Run::came_up() {
  const can::Time now = plant_->timeline().now();
  if (!expected_ || expected_->met(plant_->nodes(), now)) return true;
  const auto lines = not_operational(plant_->nodes(), plant_->boots(), now);
  for (const std::string& line : lines) print_error("canopus: {}", line);
  if (lines.empty()) {
    print_error("canopus: all nodes are operational, but not within {}",
                text::describe_duration(*options_.operational_within));
  }
  return false;
}

/// From now on nothing that is printed makes the plant wait, and a signal ends the run.
void Run::start_output() {
  stop_signals_.emplace(io_, [this] { io_.stop(); });
  stop_watch_.emplace(HangUp::is_seen);
  output_.emplace(
      RunOutput::Use{.lost_line =
                         [this](std::uint64_t lines) {
                           return options_.json ? json_.lost_line(lines) : lines_.lost_line(lines);
                         },
                     .lost_error_line = [this](std::uint64_t lines) { return lines_.lost_line(lines); },
                     .failed =
                         [this] {
                           output_failed_ = true;
                           io_.stop();
                         }});
}

bool Run::close_recordings(const OutputQueue::Patience& patience) {
  const std::vector<std::string> problems = recording_.close(plant_->timeline().now(), patience);
  for (const std::string& problem : problems) print_error("canopus: {}", problem);
  return problems.empty();
}

void Run::summarise(can::Duration wall) {
  plant::RunSummary summary = summary_of(*plant_);
  summary.wall = wall;
  summary.virtual_time = options_.virtual_time;
  summary.largest_lag = largest_lag_;
  options_.json ? json_.summary(summary) : lines_.summary(summary);
}

/// A table leaves no room for warnings: they are printed before it and remain after it.
void Run::warn() {
  for (text::FileWarning warning : plant_->warnings()) {
    if (options_.plant_text) warning.place = {};  // generated text: a line means nothing to the user
    if (has_table_) print_error("{}", describe(warning, options_.plant));
    observer().on({{}, plant::Warning{describe(warning.place, options_.plant), warning.message}});
  }
}

int Run::operator()() {
  plant_ = plant::load_plant(options_.plant, observer(), standard_error(),
                             {.seed = options_.seed,
                              .links = options_.links,
                              .opener = &linked_buses_,
                              .text = options_.plant_text,
                              .allows_native_code = options_.allows_native_code});
  if (!plant_) return 2;
  raw_plant_ = plant_.get();
  if (auto errors = plant_->open_stores(); !errors.empty()) {
    print_errors(std::move(errors), options_.plant, standard_error());
    return 1;
  }
  warn();
  if (!open_recordings()) return 1;
  start_output();
  if (options_.expect_operational) {
    expected_.emplace(options_.operational_within, options_.duration.has_value());
  }
  const auto started = WallClock::now();
  bool good = true;
  if (options_.step) {
    good = run_in_step();
  } else if (options_.virtual_time) {
    run_in_virtual_time();
  } else {
    good = run_in_real_time();
  }
  const can::Duration wall = WallClock::now() - started;
  // In virtual time the reader of the output has unlimited time.
  DrainTimeout patience(!options_.virtual_time || is_to_end());
  const auto waits = [&patience](WallClock::duration since) { return patience(since); };
  output_->set_patience(waits);
  if (good) {
    good = close_recordings(waits) && !plant_->has_stalled();
    summarise(wall);
  }
  const bool came = !good || came_up();
  const int printed = output_->finish(waits);
  if (printed != RunOutput::written) return printed;
  constexpr int not_as_expected = 3;
  return !good ? 1 : came ? 0 : not_as_expected;
}

}  // namespace

int run_plant(const RunOptions& options) {
  // A reader that goes away ends the run in good order, and then the program as it ends every other one.
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  const int code = Run(options)();
  (void)std::signal(SIGPIPE, before);
  if (code == RunOutput::reader_gone && before == SIG_DFL) (void)std::raise(SIGPIPE);
  return code;
}

}  // namespace canopus::cli
