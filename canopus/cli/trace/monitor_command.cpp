#include <chrono>
#include <memory>
#include <optional>

#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/trace/trace_options.hpp"
#include "canopus/link/bus_loop.hpp"
#include "canopus/text/repeated_lines.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/file/trace_file.hpp"
#include "canopus/trace/filter/filter_expression.hpp"
#include "canopus/trace/print/message_printer.hpp"

namespace canopus::cli {
namespace {

using link::BusLoop;

struct MonitorOptions {
  std::string bus = BusOptions().bus;
  NamesOptions names{};
  trace::FilterOptions filter{};
  std::string time = "z";
  std::string trace{};
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
        is_json_(options.json),
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
    print_counted(can::never);
    if (malformed_ > 0) print_error("canopus: {}", ascii::counted(malformed_, "malformed message"));
    if (!file_) return {};
    const auto closed = file_->close();
    return closed ? std::string() : closed.error();
  }

 private:
  void print(const trace::Message& message) {
    if (message.is_malformed && !message.is_copy) ++malformed_;
    if (filter_.wants(message, {}) && expression_.wants(message, bus_, message.time.time_since_epoch(), [&] {
          return trace::searched_text(message, bus_);
        })) {
      print_counted(message.time);
      if (message.service == trace::Service::error_frame && !is_json_ &&
          !repeated_.passes(message.text, message.time - since_1970_))
        return;
      printer_.print(message, "");
    }
  }

  /// Error frames that were counted: a bus with another bit rate has thousands a second.
  void print_counted(can::Time now) {
    for (const std::string& text : repeated_.ended(now == can::never ? now : now - since_1970_))
      print_line("{:>11}  {}", "...", text);
  }

  std::string bus_;
  bool is_json_;
  text::RepeatedLines repeated_;
  trace::Decoder decoder_;
  trace::MessageFilter filter_;
  trace::FilterExpression expression_;
  std::optional<trace::TraceFile> file_;
  trace::MessagePrinter printer_;
  std::uint64_t malformed_ = 0;
  can::Duration since_1970_;
  std::chrono::steady_clock::time_point begin_;
};

int fail(int code, std::string_view message) {
  print_error("canopus: {}", message);
  return code;
}

int monitor(const MonitorOptions& options) {
  const auto address = link::parse_bus_address(options.bus);
  if (!address) return fail(2, "--bus: " + address.error());
  std::optional<can::Duration> duration;
  if (!options.duration.empty()) {
    const auto parsed = text::parse_duration(options.duration);
    if (!parsed) return fail(2, "--for: " + parsed.error());
    duration = *parsed;
  }
  NamesOptions sources = options.names;
  sources.of = with_plant_of_bus(std::move(sources.of), options.bus);
  auto names = load_names(sources, standard_error());
  auto filter = trace::MessageFilter::make(options.filter, standard_error());
  auto expression = trace::FilterExpression::make(options.filter, standard_error());
  if (!names || !filter || !expression) return 2;
  std::optional<trace::TraceFile> file;
  if (!options.trace.empty()) {
    const auto format = trace::trace_format_of(options.trace);
    if (!format) return fail(2, "--trace: " + format.error());
    for (const std::string& input : files_of(sources)) {
      if (is_same_file(input, options.trace)) {
        return fail(2, fmt::format("--trace {}: this file is read", options.trace));
      }
    }
    auto created = trace::TraceFile::create(options.trace, *format);
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
  add_bus_option(command, options->bus);
  command.add_old_spelling({.old = "", .now = "--bus", .value = [](std::string_view word) {
                              return word.contains(':') ? std::optional(std::string(word)) : std::nullopt;
                            }});
  add_names_options(command, options->names);
  add_filter_options(command, options->filter, false);
  command
      .add_option("-t,--time", options->time,
                  "Time column: z since the start, a absolute, d since the line before, A date")
      ->type_name("z|a|d|A")
      ->check(one_of_words({"z", "a", "d", "A"}))
      ->capture_default_str();
  command.add_flag("--frames", options->frames, "Every frame with its bytes; SDO transfers are not folded");
  command.add_option("--trace", options->trace, "Record the frames, too: .pcap, or a candump log")
      ->type_name("FILE");
  command.add_old_spelling({.old = "--write", .now = "--trace"});
  command.add_option("--for", options->duration, "End after this time, as 10s; without it Ctrl-C does")
      ->type_name("TIME");
  command.add_flag("--json", options->json, "Print JSON, one object per line");
  command.footer(
      "Listen only: nothing is sent. Names come from the options, or from plant.toml of this folder if the "
      "bus is one of "
      "that "
      "plant.\n"
      "Exit codes: 0 ended, 1 no bus or the bus was lost, 2 wrong command line or file.");
  command.callback([options, &exit_code] { exit_code = monitor(*options); });
}

}  // namespace

void add_monitor_command(Command& app, int& exit_code) {
  app.add_subcommand("monitor", "Decode the frames of a bus live",
                     [&exit_code](Command& command) { build_monitor_command(command, exit_code); });
}

}  // namespace canopus::cli
