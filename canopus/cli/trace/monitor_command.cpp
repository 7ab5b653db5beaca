#include <chrono>
#include <memory>
#include <optional>

#include <unistd.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/option_checks.hpp"
#include "canopus/cli/output/same_file.hpp"
#include "canopus/cli/trace/filter_options.hpp"
#include "canopus/cli/trace/names_options.hpp"
#include "canopus/cli/trace/trace_analysis.hpp"
#include "canopus/link/bus_loop.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/file/trace_file.hpp"
#include "canopus/trace/filter/filter_expression.hpp"
#include "canopus/trace/print/message_printer.hpp"

namespace canopus::cli {
namespace {

using link::BusLoop;

struct MonitorOptions {
  std::string bus{};
  NamesOptions names{};
  trace::FilterOptions filter{};
  std::string time = "z";
  std::string write{};
  std::string duration{};
  bool frames = false;
  bool json = false;
};

/// Receives, prints and records the frames of a bus.
class Monitor final : public can::Listener {
 public:
  /// `bus`: its name, if it has one; a plant file's names are those of its bus of that name.
  Monitor(const MonitorOptions& options, std::string bus, trace::Names names, trace::MessageFilter filter,
          trace::FilterExpression expression, std::optional<trace::TraceFile> file)
      : bus_(std::move(bus)),
        decoder_(std::move(names), {.frames = options.frames, .transfers = !options.frames}),
        filter_(std::move(filter)),
        expression_(std::move(expression)),
        file_(std::move(file)),
        printer_({.time = static_cast<trace::TimeColumn>(options.time.front()),
                  .frames = options.frames,
                  .json = options.json,
                  .colour = wants_colour(STDOUT_FILENO)},
                 standard_output()),
        since_1970_(std::chrono::system_clock::now().time_since_epoch()),
        begin_(std::chrono::steady_clock::now()) {
    printer_.set_zero(can::Time(since_1970_));
  }

  void receive(const can::Frame& frame, can::Time) override {
    const can::Time now(since_1970_ + can::Duration(std::chrono::steady_clock::now() - begin_));
    if (file_) {
      file_->write(bus_.empty() ? "can0" : bus_, frame, now);
      file_->flush();
    }
    decoder_.receive({.time = now, .frame = frame}, bus_,
                     [this](const trace::Message& message) { print(message); });
  }
  /// Empty, or why the recording is not whole.
  std::string finish() {
    decoder_.finish([this](const trace::Message& message) { print(message); });
    if (!file_) return {};
    const auto closed = file_->close();
    return closed ? std::string() : closed.error();
  }

 private:
  void print(const trace::Message& message) {
    if (filter_.wants(message, {}) && expression_.wants(message, bus_, message.time.time_since_epoch(), [&] {
          return trace::searched_text(message, bus_);
        })) {
      printer_.print(message, "");
    }
  }

  std::string bus_;
  trace::Decoder decoder_;
  trace::MessageFilter filter_;
  trace::FilterExpression expression_;
  std::optional<trace::TraceFile> file_;
  trace::MessagePrinter printer_;
  can::Duration since_1970_;
  std::chrono::steady_clock::time_point begin_;
};

int fail(int code, std::string_view message) {
  print_error("canopus: {}", message);
  return code;
}

int monitor(const MonitorOptions& options) {
  const auto address = link::parse_bus_address(options.bus);
  if (!address) return fail(2, address.error());
  std::optional<can::Duration> duration;
  if (!options.duration.empty()) {
    const auto parsed = text::parse_duration(options.duration);
    if (!parsed) return fail(2, "--for: " + parsed.error());
    duration = *parsed;
  }
  auto names = load_names(options.names, standard_error());
  auto filter = trace::MessageFilter::make(options.filter, standard_error());
  auto expression = trace::FilterExpression::make(options.filter, standard_error());
  if (!names || !filter || !expression) return 2;
  std::optional<trace::TraceFile> file;
  if (!options.write.empty()) {
    const auto format = trace::trace_format_of(options.write);
    if (!format) return fail(2, "--write: " + format.error());
    for (const std::string& input : files_of(options.names)) {
      if (is_same_file(input, options.write)) {
        return fail(2, fmt::format("--write {}: this file is read", options.write));
      }
    }
    auto created = trace::TraceFile::create(options.write, *format);
    if (!created) return fail(1, created.error());
    file.emplace(std::move(*created));
  }
  auto loop = BusLoop::open(*address, std::chrono::seconds(5));
  if (!loop) return fail(1, loop.error());
  BusLoop& bus = **loop;
  bus.set_complaint([](std::string_view text) { print_error("canopus: the bus says: {}", text); });
  Monitor listener(options, address->bus, std::move(*names), std::move(*filter), std::move(*expression),
                   std::move(file));
  bus.add_listener(listener);
  const BusLoop::End end =
      bus.run([] { return false; }, duration ? can::later(bus.now(), *duration) : can::never);
  bus.remove_listener(listener);
  if (const std::string reason = listener.finish(); !reason.empty()) return fail(1, reason);
  return end == BusLoop::End::lost ? fail(1, bus.failure()) : 0;
}

void build_monitor_command(Command& command, int& exit_code) {
  const auto options = std::make_shared<MonitorOptions>();
  command
      .add_option("BUS", options->bus,
                  "The bus, as --bus of the other commands names it: socketcand:HOST:PORT/BUS, "
                  "socketcan:INTERFACE, ...")
      ->required();
  add_names_options(command, options->names);
  add_filter_options(command, options->filter, false);
  command
      .add_option("-t,--time", options->time,
                  "Time column: z since the start, a absolute, d since the line before, A date")
      ->type_name("z|a|d|A")
      ->check(one_of_words({"z", "a", "d", "A"}))
      ->capture_default_str();
  command.add_flag("--frames", options->frames, "Every frame with its bytes; SDO transfers are not folded");
  command.add_option("--write", options->write, "Record the frames, too: .pcap, or a candump log")
      ->type_name("FILE");
  command.add_option("--for", options->duration, "End after this time, as 10s; without it Ctrl-C does")
      ->type_name("TIME");
  command.add_flag("--json", options->json, "Print JSON, one object per line");
  command.footer(
      "It only hears. Exit codes: 0 ended, 1 no bus or the bus was lost, 2 wrong command line or file.");
  command.callback([options, &exit_code] { exit_code = monitor(*options); });
}

}  // namespace

void add_monitor_command(Command& app, int& exit_code) {
  app.add_subcommand("monitor", "Show what the frames on a bus mean, as they come",
                     [&exit_code](Command& command) { build_monitor_command(command, exit_code); });
}

}  // namespace canopus::cli
