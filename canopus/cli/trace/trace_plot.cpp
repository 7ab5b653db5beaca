#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/trace/trace_options.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/print/node_names.hpp"
#include "canopus/trace/print/trace_walk.hpp"
#include "canopus/trace/report/trace_picture.hpp"

namespace canopus::cli {
namespace {

struct PlotOptions {
  std::string file{};
  std::string out{};
  NamesOptions names{};
  std::vector<std::string> channels{};
  std::vector<std::string> signals{};
  std::uint32_t bit_rate = 0;
};

/// Empty, or what went wrong.
std::string write_file(const std::string& path, const std::string& content) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return std::strerror(errno);
  const bool written = std::fwrite(content.data(), 1, content.size(), file) == content.size();
  const bool closed = std::fclose(file) == 0;
  return written && closed ? "" : std::strerror(errno);
}

int plot(const PlotOptions& options) {
  if (is_same_file(options.file, options.out)) {
    print_error("canopus: {}: this is the trace that is read", options.out);
    return 2;
  }
  auto names = load_names(options.names, standard_error());
  if (!names) return 2;
  trace::PictureOptions wanted{.bit_rate = options.bit_rate};
  for (const std::string& text : options.signals) {
    const auto signal = trace::parse_picture_signal(text, *names);
    if (!signal) {
      print_error(
          "canopus: --signal {}: expected a node's name or node-ID, a dot and an object, as 3.6000:01", text);
      return 2;
    }
    wanted.signals.push_back(*signal);
  }
  trace::Decoder decoder(std::move(*names), {.frames = true, .transfers = false});
  trace::TracePicture picture(std::move(wanted));
  const auto add_message = [&](const trace::Message& message) { picture.message(message); };
  ChannelChoice channels(options.channels);
  int code = trace::walk_trace(options.file, standard_error(),
                               [&](const trace::TraceRecord& record, std::string_view channel) {
                                 if (channels.wants(channel)) decoder.receive(record, channel, add_message);
                                 return true;
                               });
  if (code == 2) return code;
  if (!channels.report_missing(standard_error())) code = 1;
  for (const trace::PictureSignal& signal : picture.missing()) {
    print_error("canopus: no PDO of node {} with {} is in the trace", signal.node,
                canopen::object_text(signal.index, signal.sub));
  }
  const std::string title = std::filesystem::path(options.file).filename().string();
  if (const std::string reason = write_file(options.out, picture.svg(title)); !reason.empty()) {
    print_error("canopus: cannot write {}: {}", options.out, reason);
    return 1;
  }
  return code;
}

}  // namespace

void add_trace_plot(Command& trace, int& exit_code) {
  const auto options = std::make_shared<PlotOptions>();
  Command* command = trace.add_subcommand(
      "plot", "Draw load, values of PDOs and states of the nodes over time, as an SVG picture");
  command->add_option("FILE", options->file, "Trace in any format that is read; - is the standard input")
      ->required();
  command->add_option("-o,--output", options->out, "The picture that is written")
      ->type_name("FILE")
      ->required();
  command->add_old_spelling({.old = "--out", .now = "--output"});
  command
      ->add_option(
          "--signal", options->signals,
          "Value of a PDO, as encoder.6004 or 3.6004:00; may be given again; without it the first eight")
      ->type_name("NODE.OBJECT")
      ->allow_extra_args(false);
  add_names_options(*command, options->names);
  command->add_option("--channel", options->channels, "Only this channel of the file; may be given again")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command->add_option("--bit-rate", options->bit_rate, "Bit rate of the bus in bit/s: the load in per cent")
      ->type_name("RATE")
      ->check(number_from(1000, 1'000'000));
  command->footer(
      "Exit codes: 0 drawn, 1 the trace cannot be read to its end or has not the --channel, or the picture "
      "not be written, 2 wrong "
      "command line.");
  command->callback([options, &exit_code] { exit_code = plot(*options); });
}

}  // namespace canopus::cli
