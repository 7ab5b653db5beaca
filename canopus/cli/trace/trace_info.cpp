// canopus trace info FILE: statistics of a trace, like capinfos.

#include <map>
#include <memory>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/trace/trace_input_file.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

/// A trace made to fill the memory has more.
constexpr std::size_t most_identifiers = 65536;

struct Figures {
  std::uint64_t frames = 0, extended = 0, remote = 0, error_frames = 0, transmitted = 0, back_in_time = 0;
  std::optional<can::Time> first, last;  ///< the earliest and the latest
  std::map<std::uint16_t, std::uint64_t> channels;
  std::map<std::uint32_t, std::uint64_t> identifiers;  ///< extended ones have bit 31
};

Figures count(TraceInputFile& in) {
  Figures figures;
  std::optional<can::Time> before;
  while (const auto record = in.next()) {
    ++figures.channels[record->channel];
    if (!figures.first || record->time < *figures.first) figures.first = record->time;
    if (!figures.last || record->time > *figures.last) figures.last = record->time;
    if (before && record->time < *before) ++figures.back_in_time;
    before = record->time;
    if (record->transmitted) ++figures.transmitted;
    if (record->error_frame) {
      ++figures.error_frames;
      continue;
    }
    ++figures.frames;
    if (record->frame.extended) ++figures.extended;
    if (record->frame.remote) ++figures.remote;
    const std::uint32_t key = record->frame.identifier | (record->frame.extended ? 0x8000'0000U : 0U);
    const auto known = figures.identifiers.find(key);
    if (known != figures.identifiers.end()) {
      ++known->second;
    } else if (figures.identifiers.size() < most_identifiers) {
      figures.identifiers.emplace(key, 1);
    }
  }
  return figures;
}

std::string identifier_text(std::uint32_t key) {
  return (key & 0x8000'0000U) != 0 ? fmt::format("{:08X}", key & 0x7FFF'FFFFU) : fmt::format("{:03X}", key);
}

/// The time as the file has it, and as a date if it counts from 1970.
std::string moment_text(can::Time time) {
  const std::string seconds = seconds_text(time.time_since_epoch());
  constexpr can::Time a_date(std::chrono::sys_days(std::chrono::year(1980) / 1 / 1).time_since_epoch());
  if (time < a_date) return seconds + " s";
  const auto since = std::chrono::floor<std::chrono::seconds>(time.time_since_epoch());
  const auto days = std::chrono::floor<std::chrono::days>(since);
  const std::chrono::year_month_day date{std::chrono::sys_days(days)};
  const auto of_day = (since - days).count();
  return fmt::format("{} s ({:04}-{:02}-{:02} {:02}:{:02}:{:02} UTC)", seconds, static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), of_day / 3600,
                     of_day / 60 % 60, of_day % 60);
}

void print_text(const std::string& file, const TraceInputFile& in, const Figures& figures, bool all) {
  print_line("{}: {}", file, trace::name_of(in.reader().format()));
  print_line("  frames       {} ({} extended, {} remote, {} sent by the recorder)", figures.frames,
             figures.extended, figures.remote, figures.transmitted);
  print_line("  error frames {}", figures.error_frames);
  const trace::LeftOut& left_out = in.reader().left_out();
  print_line("  left out     {}", left_out.total() == 0 ? "0" : left_out.text());
  if (left_out.lost() != 0) print_line("  lost         {} by the recorder", left_out.lost());
  if (in.mistakes() != 0) print_line("  unreadable   {}", in.mistakes());
  if (figures.first) {
    print_line("  first        {}", moment_text(*figures.first));
    print_line("  last         {}", moment_text(*figures.last));
    print_line("  duration     {} s", seconds_text(*figures.last - *figures.first));
  }
  if (figures.back_in_time != 0)
    print_line("  back in time {}", ascii::counted(figures.back_in_time, "time"));
  for (const auto& [channel, count] : figures.channels) {
    print_line("  channel      {}: {}", in.reader().channel(channel), count);
  }
  print_line("  identifiers  {}{}", figures.identifiers.size() == most_identifiers ? "at least " : "",
             figures.identifiers.size());
  if (!all) return;
  for (const auto& [key, count] : figures.identifiers)
    print_line("    {:>8} {}", identifier_text(key), count);
}

void print_as_json(const std::string& file, const TraceInputFile& in, const Figures& figures) {
  text::Json line;
  line["file"] = file;
  line["format"] = trace::name_of(in.reader().format());
  line["frames"] = figures.frames;
  line["extended"] = figures.extended;
  line["remote"] = figures.remote;
  line["transmitted"] = figures.transmitted;
  line["error_frames"] = figures.error_frames;
  const trace::LeftOut& left_out = in.reader().left_out();
  line["left_out"] = left_out.total();
  line["left_out_by_kind"] = text::Json::object();
  for (const trace::LeftOutName& name : trace::left_out_names) {
    if (left_out.of(name.kind) != 0) line["left_out_by_kind"][std::string(name.key)] = left_out.of(name.kind);
  }
  line["lost"] = left_out.lost();
  line["unreadable"] = in.mistakes();
  line["back_in_time"] = figures.back_in_time;
  if (figures.first) {
    // text: a double does not hold the nanoseconds of a date
    line["first"] = seconds_text(figures.first->time_since_epoch());
    line["last"] = seconds_text(figures.last->time_since_epoch());
    line["duration"] = seconds_text(*figures.last - *figures.first);
  }
  line["channels"] = text::Json::array();
  for (const auto& [channel, count] : figures.channels) {
    line["channels"].push_back({{"name", in.reader().channel(channel)}, {"frames", count}});
  }
  line["identifiers"] = text::Json::array();
  for (const auto& [key, count] : figures.identifiers) {
    line["identifiers"].push_back({{"id", identifier_text(key)}, {"frames", count}});
  }
  print_json(line);
}

}  // namespace

void add_trace_info(Command& trace, int& exit_code) {
  struct Options {
    std::string file, format;
    bool identifiers = false;
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  Command* command = trace.add_subcommand("info", "Summarise a trace: format, frames, times, channels");
  command->add_option("FILE", options->file, "Trace in any format that is read; - is the standard input")
      ->required();
  add_format_option(*command, "--in-format", options->format, "Format (default: from the content)", true);
  command->add_old_spelling({.old = "--from", .now = "--in-format"});
  command->add_flag("--identifiers", options->identifiers, "List the identifiers, too");
  command->add_flag("--json", options->json, "Print one JSON object instead");
  command->footer(
      "Exit codes: 0 read, 1 parts of it could not be read or nothing was, 2 wrong command line or file.\n"
      "\n"
      "Example: canopus trace info drive.asc");
  command->callback([options, &exit_code] {
    auto in = TraceInputFile::open(options->file, options->format, standard_error());
    exit_code = exit_code::usage;
    if (!in) return;
    const Figures figures = count(*in);
    const bool is_read = in->finish();
    if (options->json) {
      print_as_json(options->file, *in, figures);
    } else {
      print_text(options->file, *in, figures, options->identifiers);
    }
    exit_code = in->mistakes() == 0 && is_read ? exit_code::done : exit_code::failed;
  });
}

}  // namespace canopus::cli
