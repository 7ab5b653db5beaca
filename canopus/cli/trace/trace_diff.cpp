// canopus trace diff A B

#include <memory>

#include <unistd.h>

#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/trace/trace_comparison.hpp"
#include "canopus/cli/trace/trace_input_file.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

struct DiffOptions {
  std::string a, b;
  std::string tolerance = "1ms";
  bool absolute = false;
  bool ignore_channels = false;
  bool quiet = false;
  bool json = false;
};

TraceComparison::Source source_of(TraceInputFile& in, bool absolute) {
  return [&in, absolute, first = std::optional<can::Time>()]() mutable -> std::optional<ComparedRecord> {
    const auto record = in.next();
    if (!record) return std::nullopt;
    if (!first) first = record->time;
    return ComparedRecord{*record, std::string(in.reader().channel(record->channel)),
                          absolute ? record->time.time_since_epoch() : record->time - *first};
  };
}

std::string text_of(const ComparedRecord& compared) {
  return seconds_text(compared.time) + ' ' + frame_text(compared.channel, compared.record);
}

void print_difference(Difference difference, const ComparedRecord* a, const ComparedRecord* b, bool colour) {
  switch (difference) {
    case Difference::only_in_a: print_line("{}", paint("- " + text_of(*a), "31", colour)); break;
    case Difference::only_in_b: print_line("{}", paint("+ " + text_of(*b), "32", colour)); break;
    case Difference::other_order:
      print_line("{}",
                 paint(fmt::format("~ {}; in B at {}", text_of(*a), seconds_text(b->time)), "33", colour));
      break;
    case Difference::other_time:
      print_line("{}",
                 paint(fmt::format("! {}; in B {} s {}", text_of(*a),
                                   seconds_text(a->time > b->time ? a->time - b->time : b->time - a->time),
                                   a->time > b->time ? "earlier" : "later"),
                       "36", colour));
      break;
  }
}

void print_difference_as_json(Difference difference, const ComparedRecord* a, const ComparedRecord* b) {
  constexpr std::array names{"only in A", "only in B", "order", "time"};
  text::Json line;
  line["difference"] = names[static_cast<std::size_t>(difference)];
  if (a != nullptr) line["a"] = seconds_text(a->time);
  if (b != nullptr) line["b"] = seconds_text(b->time);
  const ComparedRecord& one = a != nullptr ? *a : *b;
  line["frame"] = frame_text(one.channel, one.record);
  print_json(line);
}

int diff(const DiffOptions& options) {
  const auto tolerance = text::parse_duration(options.tolerance);
  if (!tolerance) return complain(exit_code::usage, "--tolerance: " + tolerance.error());
  if (options.a == "-" && options.b == "-")
    return complain(exit_code::usage, "only one trace can be the standard input");
  auto a = TraceInputFile::open(options.a, {}, standard_error());
  auto b = TraceInputFile::open(options.b, {}, standard_error());
  if (!a || !b) return exit_code::usage;
  const bool colour = !options.json && wants_colour(STDOUT_FILENO);
  TraceComparison comparison(
      source_of(*a, options.absolute), source_of(*b, options.absolute),
      {.tolerance = *tolerance, .channels = !options.ignore_channels},
      [&](Difference difference, const ComparedRecord* of_a, const ComparedRecord* of_b) {
        if (options.quiet) return;
        if (options.json) {
          print_difference_as_json(difference, of_a, of_b);
        } else {
          print_difference(difference, of_a, of_b, colour);
        }
      });
  const ComparisonCounts counts = comparison.compare();
  const bool is_read_a = a->finish();
  const bool is_read_b = b->finish();
  if (options.json && !options.quiet) {
    print_json({{"same", counts.same},
                {"only_in_a", counts.only_in_a},
                {"only_in_b", counts.only_in_b},
                {"other_order", counts.other_order},
                {"other_time", counts.other_time},
                {"largest_difference", seconds_text(counts.largest)}});
  } else if (!options.quiet) {
    print_line(
        "{} the same, {} only in {}, {} only in {}, {} in another order, {} at another time; times differ by "
        "up to {} s",
        counts.same, counts.only_in_a, options.a, counts.only_in_b, options.b, counts.other_order,
        counts.other_time, seconds_text(counts.largest));
  }
  if (!is_read_a || !is_read_b || a->mistakes() != 0 || b->mistakes() != 0) return exit_code::usage;
  return counts.are_same() ? exit_code::done : exit_code::failed;
}

}  // namespace

void add_trace_diff(Command& trace, int& exit_code) {
  const auto options = std::make_shared<DiffOptions>();
  Command* command = trace.add_subcommand("diff", "Compare two traces of any formats frame by frame");
  command->add_option("A", options->a, "Trace; - is the standard input")->required();
  command->add_option("B", options->b, "The other trace")->required();
  command->add_option("--tolerance", options->tolerance, "Times may differ by this much")
      ->type_name("TIME")
      ->capture_default_str();
  command->add_flag("--absolute", options->absolute,
                    "Compare the times as they stand there, not since the first frame of each trace");
  command->add_flag("--ignore-channels", options->ignore_channels, "Names of channels may differ");
  command->add_flag("-q,--quiet", options->quiet, "Print nothing; use the exit code");
  command->add_flag("--json", options->json, "Print JSON, one object per difference and one at the end");
  command->footer(
      "- only in A, + only in B, ~ in another order, ! at another time.\n"
      "Exit codes: 0 the same, 1 different, 2 wrong command line, or a trace that cannot be read.\n"
      "\n"
      "Example: canopus trace diff yesterday.pcapng today.asc --tolerance 5ms");
  command->callback([options, &exit_code] { exit_code = diff(*options); });
}

}  // namespace canopus::cli
