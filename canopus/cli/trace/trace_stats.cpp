#include <memory>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/trace/trace_options.hpp"
#include "canopus/text/json.hpp"
#include "canopus/trace/print/statistics_json.hpp"
#include "canopus/trace/print/trace_walk.hpp"
#include "canopus/trace/report/statistics.hpp"

namespace canopus::cli {
namespace {

using trace::ChannelFigures;
using trace::IdentifierFigures;
using trace::NodeFigures;
using trace::Statistics;
using trace::TimeFigures;

struct StatsOptions {
  std::string file{};
  NamesOptions names{};
  std::vector<std::string> channels{};
  std::uint32_t bit_rate = 0;
  bool json = false;
};

double milliseconds(can::Duration duration) { return static_cast<double>(duration.count()) / 1e6; }

std::string node_name(std::uint8_t node_id, const NodeFigures& node) {
  return node.name.empty() ? fmt::format("{}", node_id) : fmt::format("{} ({})", node_id, node.name);
}

void print_identifiers(const ChannelFigures& channel, Output& out) {
  out.line("  {:<8}  {:<30}  {:>8}  {:>10} {:>10} {:>10} {:>10}", "COB-ID", "what", "frames", "min ms",
           "mean ms", "max ms", "jitter ms");
  for (const auto& [key, one] : channel.identifiers) {
    Line line("  {:<8}  {:<30}  {:>8}", trace::identifier_of_key(key), one.who, one.frames);
    if (const TimeFigures& cycle = one.cycle; cycle.count() > 0) {
      line.add("  {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f}", milliseconds(cycle.min()),
               milliseconds(cycle.mean()), milliseconds(cycle.max()),
               milliseconds(cycle.max() - cycle.min()));
    }
    if (!one.signals.empty()) line.add("{:{}}  {}", "", one.cycle.count() > 0 ? 0 : 45, one.signals);
    out.line(line);
  }
}

/// "1, 6-127"
std::string ranges_text(const std::vector<std::uint8_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[i]);
    if (last > i) text += fmt::format("-{}", numbers[last]);
    i = last + 1;
  }
  return text;
}

void print_node(std::uint8_t node_id, const NodeFigures& node, Output& out) {
  Line line("  node {}:", node_name(node_id, node));
  if (node.boot_ups > 0) line.add(" {},", ascii::counted(node.boot_ups, "boot-up"));
  if (node.heartbeats > 0) {
    line.add(" {}", ascii::counted(node.heartbeats, "heartbeat"));
    if (node.producer_time > can::Duration::zero())
      line.add(" every {:.6g} ms{}", milliseconds(node.producer_time),
               node.producer_time_is_measured ? " (measured)" : "");
    line.add(", {} lost,", node.lost_heartbeats);
  }
  if (node.emergencies > 0) line.add(" {} EMCY,", node.emergencies);
  if (node.malformed > 0) line.add(" {} malformed,", node.malformed);
  const std::uint64_t transfers = node.reads + node.writes + node.unanswered;
  if (transfers > 0) {
    line.add(" {}, {}, {} aborted, {} unanswered", ascii::counted(node.reads, "SDO read"),
             ascii::counted(node.writes, "write"), node.aborts, node.unanswered);
    if (node.unfinished > 0) line.add(", {} unfinished", node.unfinished);
    if (node.sdo.count() > 0)
      line.add(", took {:.3f} / {:.3f} / {:.3f} ms (min / mean / max)", milliseconds(node.sdo.min()),
               milliseconds(node.sdo.mean()), milliseconds(node.sdo.max()));
  }
  std::string text = line.text();
  if (text.ends_with(',')) text.pop_back();
  out.line("{}", text);
}

void print_events(std::string_view title, const std::vector<trace::TraceEvent>& events, can::Time begin,
                  Output& out) {
  if (events.empty()) return;
  out.line("{}:", title);
  for (const trace::TraceEvent& event : events) {
    const std::string who = event.node == 0 ? ""
                            : event.node_name.empty()
                                ? fmt::format("node {}  ", event.node)
                                : fmt::format("node {} ({})  ", event.node, event.node_name);
    out.line("  {:11.6f}  {}{}", std::chrono::duration<double>(event.time - begin).count(), who, event.text);
  }
  if (events.size() == Statistics::most_events) out.line("  and perhaps more: only so many are kept");
}

/// "sdo 2, emcy 1"; empty: all are 0.
std::string counts_text(const std::array<std::uint64_t, trace::service_count>& counts) {
  std::string text;
  for (unsigned i = 0; i < trace::service_count; ++i) {
    if (counts[i] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name(static_cast<trace::Service>(i)), counts[i]);
  }
  return text;
}

void print_text(const Statistics& statistics, std::uint32_t bit_rate, Output& out) {
  print_events(fmt::format("malformed messages ({})", counts_text(statistics.malformed_services())),
               statistics.malformed(), statistics.begin(), out);
  out.line("duration: {:.6f} s", std::chrono::duration<double>(statistics.duration()).count());
  const std::string services = counts_text(statistics.services());
  out.line("frames by service: {}", services.empty() ? "none" : services);
  for (const auto& [number, channel] : statistics.channels()) {
    Line line("channel {}: {}, {}, {}", channel.name.empty() ? fmt::format("{}", number) : channel.name,
              ascii::counted(channel.frames, "frame"), ascii::counted(channel.error_frames, "error frame"),
              ascii::counted(channel.bits, "bit"));
    if (bit_rate != 0) {
      line.add("; load {:.1f} % at {} bit/s, busiest second {:.1f} %",
               100 * trace::load(channel.bits, statistics.duration(), bit_rate), bit_rate,
               100 * trace::load(channel.busiest_bits, std::chrono::seconds(1), bit_rate));
    }
    out.line(line);
    print_identifiers(channel, out);
    for (const auto& [node_id, node] : channel.nodes) print_node(node_id, node, out);
    if (!channel.absent.empty())
      out.line("  asked for 1000:00 without an answer, as by a scan: {} ({})",
               ascii::counted(channel.absent.size(), "node"), ranges_text(channel.absent));
  }
  print_events("EMCY", statistics.emergencies(), statistics.begin(), out);
  print_events("SDO transfers that failed", statistics.failures(), statistics.begin(), out);
}

int show_statistics(const StatsOptions& options) {
  auto names = load_names(options.names, standard_error());
  if (!names) return 2;
  trace::Decoder decoder(std::move(*names), {.frames = true, .transfers = true});
  Statistics statistics;
  const auto add_message = [&](const trace::Message& message) { statistics.message(message, decoder); };
  ChannelChoice channels(options.channels);
  int code = trace::walk_trace(options.file, standard_error(),
                               [&](const trace::TraceRecord& record, std::string_view channel) {
                                 if (!channels.wants(channel)) return true;
                                 statistics.record(record, channel);
                                 decoder.receive(record, channel, add_message);
                                 return true;
                               });
  if (code == 2) return code;
  if (!channels.report_missing(standard_error())) code = 1;
  decoder.finish(add_message);
  statistics.finish();
  if (!options.json) {
    print_text(statistics, options.bit_rate, standard_output());
    return code;
  }
  print_json(trace::to_json(statistics, options.bit_rate));
  return code;
}

}  // namespace

void add_trace_stats(Command& trace, int& exit_code) {
  const auto options = std::make_shared<StatsOptions>();
  Command* command =
      trace.add_subcommand("stats", "Figures of a trace: load, cycle times, heartbeats, SDO latencies");
  command->add_option("FILE", options->file, "Trace in any format that is read; - is the standard input")
      ->required();
  add_names_options(*command, options->names);
  command->add_option("--channel", options->channels, "Only this channel of the file; may be given again")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command->add_option("--bit-rate", options->bit_rate, "Bit rate of the bus in bit/s, for its load")
      ->type_name("RATE")
      ->check(number_from(1000, 1'000'000));
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "Exit codes: 0 shown, 1 the trace cannot be read to its end or has not the --channel, 2 wrong command "
      "line or file.");
  command->callback([options, &exit_code] { exit_code = show_statistics(*options); });
}

}  // namespace canopus::cli
