// canopus trace convert IN OUT

#include <algorithm>
#include <memory>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/trace/trace_input_file.hpp"
#include "canopus/cli/trace/trace_options.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/file/trace_encoder.hpp"
#include "canopus/trace/file/trace_file.hpp"

namespace canopus::cli {
namespace {

struct ConvertOptions {
  std::string in, out, in_format, out_format, from, to;
  std::string trc_version = "2.1";
  std::vector<std::string> channels;
  bool relative = false;
  bool quiet = false;
};

/// The destination of the converted records: a file, or the standard output in large pieces.
class Target {
 public:
  [[nodiscard]] static std::expected<Target, std::string> open(const std::string& path,
                                                               trace::FileFormat format,
                                                               trace::TrcVersion trc) {
    Target target;
    if (path == "-") {
      target.encoder_ = std::make_unique<trace::TraceEncoder>(format, trc);
      target.waiting_ = target.encoder_->begin();
      return target;
    }
    target.new_file_ = std::make_unique<NewFile>(path);
    auto file = trace::TraceFile::create(target.new_file_->path(), format, trc);
    if (!file) return std::unexpected(file.error());
    target.file_.emplace(std::move(*file));
    return target;
  }
  void write(std::string_view channel, const trace::TraceRecord& record) {
    if (file_) return file_->write(channel, record);
    waiting_ += encoder_->encode(channel, record);
    if (waiting_.size() >= 32'768) send();
  }
  [[nodiscard]] std::expected<void, std::string> close() {
    if (file_) {
      if (auto closed = file_->close(); !closed) return closed;
      return new_file_->commit();
    }
    waiting_ += encoder_->end();
    send();
    return {};
  }

 private:
  Target() = default;
  void send() {
    standard_output().content(waiting_);
    waiting_.clear();
  }
  std::unique_ptr<NewFile> new_file_;
  std::optional<trace::TraceFile> file_;
  std::unique_ptr<trace::TraceEncoder> encoder_;
  std::string waiting_;
};

/// The format has no times before 0.
bool begins_at_0(trace::FileFormat format) {
  return format == trace::FileFormat::candump || format == trace::FileFormat::pcap ||
         format == trace::FileFormat::pcapng;
}

int convert(const ConvertOptions& options) {
  std::expected<trace::FileFormat, std::string> format = trace::FileFormat::candump;
  if (!options.out_format.empty()) {
    format = *trace::format_of_name(options.out_format);
  } else if (options.out != "-") {
    format = trace::trace_format_of(options.out);
    if (!format) return complain(exit_code::usage, format.error() + "; --out-format says otherwise");
  }
  // a clock may have stepped back: without --from even what is before the first frame belongs to the trace
  can::Duration from = can::Duration::min();
  can::Duration to = can::Duration::max();
  for (const auto& [text, name, value] :
       {std::tuple{&options.from, "--from", &from}, std::tuple{&options.to, "--to", &to}}) {
    if (text->empty()) continue;
    const auto duration = text::parse_duration(*text);
    if (!duration) return complain(exit_code::usage, fmt::format("{}: {}", name, duration.error()));
    *value = *duration;
  }
  if (!options.from.empty() && from > to) {
    return complain(exit_code::usage, "--from is later than --to");
  }
  if (is_same_file(options.in, options.out)) {
    return complain(exit_code::usage, options.out + ": this is the trace that is read");
  }
  auto in = TraceInputFile::open(options.in, options.in_format, standard_error());
  if (!in) return exit_code::usage;
  auto out = Target::open(
      options.out, *format,
      std::ranges::find(trace::trc_version_names, options.trc_version, &trace::TrcVersionName::name)
          ->version);
  if (!out) return complain(exit_code::failed, out.error());
  std::optional<can::Time> first;
  std::uint64_t written = 0;
  std::uint64_t too_early = 0;
  ChannelChoice channels(options.channels);
  while (auto record = in->next()) {
    if (!first) first = record->time;
    const can::Duration since = record->time - *first;
    const std::string_view channel = in->reader().channel(record->channel);
    const bool is_of_channel = channels.wants(channel);
    // records need not be in the order of their times
    if (since < from || since > to || !is_of_channel) continue;
    if (options.relative) record->time = can::Time(options.from.empty() ? since : since - from);
    if (record->time < can::Time{} && begins_at_0(*format)) ++too_early;
    out->write(channel, *record);
    ++written;
  }
  if (!in->finish()) return exit_code::failed;
  const auto closed = out->close();
  if (!closed) return complain(exit_code::failed, closed.error());
  const bool all_channels = channels.report_missing(standard_error());
  if (too_early > 0) {
    print_error("canopus: {}: {} earlier than time 0, which {} cannot say, written at time 0", options.out,
                ascii::counted(too_early, "frame"), trace::name_of(*format));
  }
  if (!options.quiet && options.out != "-") {
    print_line("{}: {} as {}", options.out, ascii::counted(written, "frame"), trace::name_of(*format));
  }
  return in->mistakes() == 0 && all_channels && too_early == 0 ? exit_code::done : exit_code::failed;
}

}  // namespace

void add_trace_convert(Command& trace, int& exit_code) {
  const auto options = std::make_shared<ConvertOptions>();
  Command* command = trace.add_subcommand("convert", "Write a trace in another format");
  command->add_option("IN", options->in, "Trace in any format that is read; - is the standard input")
      ->required();
  command->add_option("OUT", options->out, "File to write; - is the standard output")->required();
  add_format_option(*command, "--in-format", options->in_format, "Format of IN (default: from its content)",
                    true);
  add_format_option(*command, "--out-format", options->out_format, "Format of OUT (default: from its name)",
                    false);
  command->add_option("--from", options->from, "Only from this time after the first frame on, as 1.5s")
      ->type_name("TIME");
  command->add_option("--to", options->to, "Only up to this time after the first frame")->type_name("TIME");
  const auto format_word = [](std::string_view value) {
    return trace::format_of_name(value) ? std::optional(std::string(value)) : std::nullopt;
  };
  command->add_old_spelling({.old = "--from", .now = "--in-format", .value = format_word});
  command->add_old_spelling({.old = "--to", .now = "--out-format", .value = format_word});
  command->add_old_spelling({.old = "--start", .now = "--from"});
  command->add_old_spelling({.old = "--end", .now = "--to"});
  command->add_option("--channel", options->channels, "Only this channel; may be given again")
      ->type_name("NAME");
  command
      ->add_option("--trc-version", options->trc_version,
                   "Version of a TRC that is written; 1.1 for PCAN-Explorer 4 and 5; only 2.1 has channels")
      ->type_name("1.0|1.1|2.0|2.1")
      ->check(one_of_words({"1.0", "1.1", "2.0", "2.1"}))
      ->capture_default_str();
  command->add_flag("--relative", options->relative, "Times count from the first frame, or from --from");
  command->add_flag("-q,--quiet", options->quiet, "Do not print the number of frames");
  command->footer(
      "What each format can carry: docs/traces.md.\n"
      "Exit codes: 0 converted, 1 parts of IN could not be read or nothing was, OUT not written, a --channel "
      "is "
      "not in IN, "
      "or "
      "OUT\n"
      "cannot say a time; 2 wrong command line or file. OUT is renamed from a temporary file when it is "
      "complete.\n"
      "\n"
      "Example: canopus trace convert drive.blf drive.pcapng");
  command->callback([options, &exit_code] {
    const auto work = [&] { return convert(*options); };
    exit_code = options->out == "-" ? work() : run_ignoring_sigpipe(work);
  });
}

}  // namespace canopus::cli
