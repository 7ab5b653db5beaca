#include "canopus/app/run_loop.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "canopus/app/event_printer.hpp"
#include "canopus/app/file_text.hpp"
#include "canopus/app/live_table.hpp"
#include "canopus/app/melsec_server.hpp"
#include "canopus/app/plant.hpp"
#include "canopus/link/socketcand_server.hpp"
#include "canopus/link/trace_file.hpp"
#include "canopus/sim/waveform.hpp"

namespace canopus::app {
namespace {

namespace asio = boost::asio;
using WallClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

std::optional<PlantFile> read_plant_file(const std::string& path) {
  const auto text = read_file(path);
  if (!text) {
    fmt::print(stderr, "canopus: {}\n", text.error());
    return std::nullopt;
  }
  PlantReading reading = read_plant(*text, path);
  for (const PlantError& error : reading.errors) fmt::print(stderr, "{}\n", describe(error, path));
  if (!reading.errors.empty()) return std::nullopt;
  return std::move(reading.plant);
}

std::unique_ptr<Plant> build_plant(const PlantFile& file, PlantObserver& observer,
                                   std::optional<std::uint64_t> seed) {
  auto plant = Plant::build(file, observer, seed);
  if (!plant) {
    for (const PlantError& error : plant.error()) fmt::print(stderr, "{}\n", describe(error, file.path));
    return nullptr;
  }
  return std::move(*plant);
}

/// Every frame of a bus into the trace file.
class TraceWriter final : public sim::BusObserver {
 public:
  TraceWriter(link::TraceFile& file, const std::string& bus) : file_(file), bus_(bus) {}
  void frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) override {
    file_.write(bus_, frame, end);
  }

 private:
  link::TraceFile& file_;
  const std::string& bus_;
};

/// The wire of one bus as a VCD file. The first error is kept and told by close().
class VcdFile {
 public:
  VcdFile(std::string path, sim::Bus& bus) : path_(std::move(path)), file_(std::fopen(path_.c_str(), "w")) {
    if (file_ == nullptr) {
      error_ = errno;
      return;
    }
    waveform_.emplace(bus, can::Time{}, [this](std::string_view text) {
      if (std::fwrite(text.data(), 1, text.size(), file_) != text.size() && error_ == 0) error_ = errno;
    });
  }
  ~VcdFile() { (void)close({}); }
  VcdFile(const VcdFile&) = delete;
  VcdFile& operator=(const VcdFile&) = delete;

  [[nodiscard]] std::string error() const {
    return error_ == 0 ? std::string() : fmt::format("cannot write {}: {}", path_, std::strerror(error_));
  }
  /// Empty, or what went wrong since the start.
  std::string close(can::Time now) {
    if (waveform_) waveform_->flush(now);
    waveform_.reset();
    if (file_ != nullptr && std::fclose(file_) != 0 && error_ == 0) error_ = errno;
    file_ = nullptr;
    return error();
  }

 private:
  std::string path_;
  std::FILE* file_;
  int error_ = 0;
  std::optional<sim::Waveform> waveform_;
};

/// A socketcand client's own port on a simulated bus. A bus keeps its ports, so those of clients that left
/// are used again.
class SimulatedAttachment final : public link::BusAttachment {
 public:
  using Ports = std::vector<sim::Port*>;

  SimulatedAttachment(sim::Bus& bus, Ports& free_ports, can::Timeline& timeline, can::Participant& client)
      : free_ports_(free_ports), timeline_(timeline), handle_(timeline.add(client)) {
    if (free_ports_.empty()) free_ports_.push_back(&bus.add_port("socketcand"));
    port_ = free_ports_.back();
    free_ports_.pop_back();
    port_->set_transmit_queue(sim::TransmitOrder::fifo,
                              queued_frames);  // as sent, and nothing of an earlier client
    port_->connect(client, handle_);
    port_->plug(true);
  }
  ~SimulatedAttachment() override {
    port_->plug(false);
    port_->disconnect();
    timeline_.remove(handle_);
    free_ports_.push_back(port_);
  }
  SimulatedAttachment(const SimulatedAttachment&) = delete;
  SimulatedAttachment& operator=(const SimulatedAttachment&) = delete;

  bool send(const can::Frame& frame) override { return port_->send(frame); }
  void refresh() override { timeline_.refresh(handle_); }

 private:
  static constexpr std::size_t queued_frames = 128;
  Ports& free_ports_;
  can::Timeline& timeline_;
  can::Timeline::Handle handle_;
  sim::Port* port_ = nullptr;
};

/// Keeps a plant in step with the machine's clock.
class RealTime final : public link::LoopClock {
 public:
  RealTime(asio::io_context& io, Plant& plant, PlantObserver& observer, can::Time end)
      : timeline_(plant.timeline()), observer_(observer), timer_(io), io_(io), end_(end) {}

  void start() {
    started_ = WallClock::now();
    arm();
  }
  can::Time now() override {
    advance(clock());
    return timeline_.now();
  }
  void touched() override {
    if (std::min(timeline_.next(), end_) < armed_for_) arm();
  }
  [[nodiscard]] can::Duration largest_lag() const noexcept { return largest_lag_; }
  [[nodiscard]] can::Duration lag() const noexcept { return lag_; }

 private:
  [[nodiscard]] can::Time clock() const {
    return can::Time{} + std::chrono::duration_cast<can::Duration>(WallClock::now() - started_);
  }
  void arm() {
    armed_for_ = std::min(timeline_.next(), end_);
    timer_.expires_at(armed_for_ == can::never ? WallClock::time_point::max()
                                               : started_ + armed_for_.time_since_epoch());
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (!error) wake();
    });
  }
  void wake() {
    advance(clock());
    if (timeline_.now() >= end_) return io_.stop();
    arm();
  }
  /// Runs what is due. A plant that is behind catches up in slices, so that clients and Ctrl-C are heard.
  void advance(can::Time wall) {
    const can::Time due = std::min(timeline_.next(), end_);
    lag_ = std::max(can::Duration{}, wall - std::min(due, wall));
    largest_lag_ = std::max(largest_lag_, lag_);
    constexpr can::Duration worth_telling = 50ms;
    if (lag_ >= worth_telling && wall >= tell_again_) {
      observer_.error("real time",
                      fmt::format("the plant is {} late: this machine is too slow for it", describe(lag_)),
                      timeline_.now());
      tell_again_ = wall + 1s;
    }
    constexpr can::Duration slice = 20ms;
    timeline_.run_until(
        std::min({wall, end_, can::later(std::max(timeline_.now(), std::min(due, wall)), slice)}));
  }

  can::Timeline& timeline_;
  PlantObserver& observer_;
  asio::steady_timer timer_;
  asio::io_context& io_;
  can::Time end_;
  WallClock::time_point started_{};
  can::Time armed_for_ = can::never;
  can::Duration lag_{};
  can::Duration largest_lag_{};
  can::Time tell_again_{};
};

/// The terminal's part of the screen, redrawn in place.
class Screen {
 public:
  void show(const std::string& picture) {
    std::string out = shown_ ? "\x1b[H" : "\x1b[?1049h\x1b[?25l\x1b[2J\x1b[H";
    shown_ = true;
    out += picture + "\x1b[J";
    std::fwrite(out.data(), 1, out.size(), stdout);
    std::fflush(stdout);
  }
  void leave() {
    if (shown_) std::fputs("\x1b[?25h\x1b[?1049l", stdout);
    shown_ = false;
    std::fflush(stdout);
  }
  ~Screen() { leave(); }

  [[nodiscard]] static TableSize size() {
    winsize window{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_row == 0) return {};
    return {window.ws_row, window.ws_col};
  }

 private:
  bool shown_ = false;
};

/// One run from build to summary.
class Run {
 public:
  explicit Run(const RunOptions& options)
      : options_(options),
        json_(stdout),
        lines_(stdout, options.quiet),
        table_(raw_plant_, std::getenv("NO_COLOR") == nullptr),
        has_table_(!options.json && !options.quiet && !options.virtual_time && ::isatty(STDOUT_FILENO) == 1) {
  }

  int operator()();

 private:
  PlantObserver& observer() {
    if (options_.json) return json_;
    if (has_table_) return table_;
    return lines_;
  }
  bool open_trace();
  bool open_vcd();
  bool open_doors(RealTime& clock);
  bool run_in_real_time();
  void run_in_virtual_time();
  void redraw(RealTime& clock);
  void door(std::string_view protocol, std::string_view of, const std::string& address);
  void summarise(can::Duration wall);

  const RunOptions& options_;
  JsonPrinter json_;
  LinePrinter lines_;
  Plant* raw_plant_ = nullptr;
  LiveTable table_;
  bool has_table_;
  std::unique_ptr<Plant> plant_;
  std::optional<link::TraceFile> trace_;
  std::vector<std::unique_ptr<TraceWriter>> trace_writers_;
  std::vector<std::unique_ptr<VcdFile>> vcd_;
  asio::io_context io_{1};
  std::vector<SimulatedAttachment::Ports> free_ports_;  // by bus; outlive the servers
  std::vector<std::unique_ptr<link::SocketcandServer>> socketcand_;
  std::vector<std::unique_ptr<MelsecServer>> melsec_;
  std::optional<asio::steady_timer> redraw_timer_;
  Screen screen_;
  can::Duration largest_lag_{};
};

bool Run::open_trace() {
  if (options_.trace.empty()) return true;
  auto file = link::TraceFile::create(options_.trace, link::trace_format_of(options_.trace));
  if (!file) {
    fmt::print(stderr, "canopus: {}\n", file.error());
    return false;
  }
  trace_.emplace(std::move(*file));
  for (std::size_t i = 0; i < plant_->bus_count(); ++i) {
    trace_writers_.push_back(std::make_unique<TraceWriter>(*trace_, plant_->bus(i).name()));
    plant_->bus(i).add_observer(*trace_writers_.back());
  }
  return true;
}

bool Run::open_vcd() {
  if (options_.vcd.empty()) return true;
  const std::string_view suffix = options_.vcd.ends_with(".vcd") ? ".vcd" : "";
  const std::string stem = options_.vcd.substr(0, options_.vcd.size() - suffix.size());
  for (std::size_t i = 0; i < plant_->bus_count(); ++i) {
    sim::Bus& bus = plant_->bus(i);
    const std::string path =
        plant_->bus_count() == 1 ? options_.vcd : fmt::format("{}-{}{}", stem, bus.name(), suffix);
    vcd_.push_back(std::make_unique<VcdFile>(path, bus));
    if (const std::string problem = vcd_.back()->error(); !problem.empty()) {
      fmt::print(stderr, "canopus: {}\n", problem);
      return false;
    }
  }
  return true;
}

void Run::door(std::string_view protocol, std::string_view of, const std::string& address) {
  if (options_.json) {
    json_.listening(protocol, of, address);
  } else if (has_table_) {
    table_.add_door(fmt::format("{} {}", protocol, address));
  } else if (!options_.quiet) {
    fmt::print("{}{} on {}\n", protocol, of.empty() ? "" : fmt::format(" of {}", of), address);
  }
}

bool Run::open_doors(RealTime& clock) {
  const auto endpoint = [](const HostAndPort& place) -> std::optional<asio::ip::tcp::endpoint> {
    boost::system::error_code error;
    const auto address = asio::ip::make_address(place.host == "localhost" ? "127.0.0.1" : place.host, error);
    if (!error) return asio::ip::tcp::endpoint(address, place.port);
    fmt::print(stderr, "canopus: \"{}\" is not an address to listen on; expected numbers such as 127.0.0.1\n",
               place.host);
    return std::nullopt;
  };
  const auto opened = [&](const std::expected<void, std::string>& result, std::string_view protocol,
                          std::string_view of, const HostAndPort& place, std::uint16_t port) {
    if (result) {
      door(protocol, of, fmt::format("{}:{}", place.host, port));
    } else {
      fmt::print(stderr, "canopus: {}: {}\n", protocol, result.error());
    }
    return result.has_value();
  };
  for (std::size_t i = 0; i < plant_->plc_count(); ++i) {
    const PlcSection& section = plant_->plc_section(i);
    if (!section.listen) continue;
    MelsecServer& server = *melsec_.emplace_back(std::make_unique<MelsecServer>(io_, plant_->rack(i), clock));
    const auto result = server.listen(section.listen->host, section.listen->port);
    if (!opened(result, "MC protocol", section.name, *section.listen, server.port())) return false;
  }
  free_ports_.resize(plant_->bus_count());
  for (std::size_t i = 0; i < plant_->bus_count(); ++i) {
    const BusSection& section = plant_->bus_section(i);
    if (!section.socketcand) continue;
    const auto where = endpoint(*section.socketcand);
    if (!where) return false;
    const auto attach = [this, i](can::Participant& client) -> std::unique_ptr<link::BusAttachment> {
      return std::make_unique<SimulatedAttachment>(plant_->bus(i), free_ports_[i], plant_->timeline(),
                                                   client);
    };
    link::SocketcandServer& server = *socketcand_.emplace_back(
        std::make_unique<link::SocketcandServer>(io_, *where, section.name, attach, clock));
    const auto result = server.listen();
    if (!opened(result, "socketcand", section.name, *section.socketcand, server.port())) return false;
  }
  return true;
}

void Run::redraw(RealTime& clock) {
  screen_.show(table_.draw(clock.now(), clock.lag(), Screen::size()));
  redraw_timer_->expires_after(250ms);
  redraw_timer_->async_wait([this, &clock](const boost::system::error_code& error) {
    if (!error) redraw(clock);
  });
}

bool Run::run_in_real_time() {
  const can::Time end = options_.duration ? can::Time{} + *options_.duration : can::never;
  RealTime clock(io_, *plant_, observer(), end);
  if (!open_doors(clock)) return false;
  if (!options_.json && !options_.quiet && !has_table_) {
    for (const std::string& line : plant_->connections()) fmt::print("{}\n", line);
    std::fflush(stdout);
  }
  asio::signal_set stop(io_, SIGINT, SIGTERM, SIGHUP);
  stop.async_wait([this](const boost::system::error_code& error, int) {
    if (!error) io_.stop();
  });
  const auto wall_clock = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  for (std::size_t i = 0; i < plant_->plc_count(); ++i) {
    plant_->rack(i).set_clock(std::chrono::local_seconds(wall_clock.time_since_epoch()), can::Time{});
  }
  plant_->power_on();
  clock.start();
  if (has_table_) {
    redraw_timer_.emplace(io_);
    redraw(clock);
  }
  io_.run();
  (void)clock.now();  // up to the moment it was stopped
  for (const auto& server : socketcand_) server->close();
  for (const auto& server : melsec_) server->stop();
  screen_.leave();
  largest_lag_ = clock.largest_lag();
  return true;
}

void Run::run_in_virtual_time() {
  const can::Time end = options_.duration ? can::Time{} + *options_.duration : can::never;
  bool stopped = false;
  asio::signal_set stop(io_, SIGINT, SIGTERM, SIGHUP);
  stop.async_wait([&](const boost::system::error_code& error, int) { stopped = !error; });
  plant_->power_on();
  can::Timeline& timeline = plant_->timeline();
  while (timeline.now() < end && !stopped) {
    timeline.run_until(std::min(can::later(timeline.now(), 100ms), end));
    io_.poll();
  }
}

void Run::summarise(can::Duration wall) {
  RunSummary summary{.end = plant_->timeline().now(),
                     .wall = wall,
                     .virtual_time = options_.virtual_time,
                     .largest_lag = largest_lag_,
                     .nodes = plant_->nodes(),
                     .boots = plant_->boots()};
  for (std::size_t i = 0; i < plant_->bus_count(); ++i) {
    summary.buses.push_back({plant_->bus(i).name(), plant_->bus(i).load(summary.end)});
  }
  if (options_.json) {
    json_.summary(summary);
  } else {
    lines_.summary(summary);
  }
}

int Run::operator()() {
  const auto file = read_plant_file(options_.plant);
  if (!file) return 2;
  plant_ = build_plant(*file, observer(), options_.seed);
  if (!plant_) return 2;
  raw_plant_ = plant_.get();
  if (!open_trace() || !open_vcd()) return 1;
  const auto started = WallClock::now();
  if (options_.virtual_time) {
    run_in_virtual_time();
  } else if (!run_in_real_time()) {
    return 1;
  }
  summarise(WallClock::now() - started);
  bool written = true;
  for (const auto& vcd : vcd_) {
    const std::string problem = vcd->close(plant_->timeline().now());
    if (problem.empty()) continue;
    fmt::print(stderr, "canopus: {}\n", problem);
    written = false;
  }
  if (trace_) {
    if (const auto closed = trace_->close(); !closed) {
      fmt::print(stderr, "canopus: {}\n", closed.error());
      written = false;
    }
  }
  return written ? 0 : 1;
}

}  // namespace

int run_plant(const RunOptions& options) {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away ends the output, not the plant
  return Run(options)();
}

int check_plant(const std::string& path) {
  const auto file = read_plant_file(path);
  if (!file) return 2;
  class Nobody final : public PlantObserver {
  } nobody;
  const auto plant = build_plant(*file, nobody, std::nullopt);
  if (!plant) return 2;
  for (const std::string& line : plant->connections()) fmt::print("{}\n", line);
  fmt::print("{}: good: {} bus{}, {} device{}, {} PLC{}\n", path, file->buses.size(),
             file->buses.size() == 1 ? "" : "es", file->devices.size(), file->devices.size() == 1 ? "" : "s",
             file->plcs.size(), file->plcs.size() == 1 ? "" : "s");
  return 0;
}

}  // namespace canopus::app
