#include <memory>
#include <string>

#include <fmt/format.h>

#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/options/real_time_option.hpp"
#include "canopus/serve/jitter.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using serve::Histogram;
using std::chrono::nanoseconds;
using namespace std::chrono_literals;

struct BenchArguments {
  std::string bus;
  std::uint32_t bit_rate = 250'000;
  std::string period = "10ms";
  std::string length = "10s";
  RealTimeOption real_time;
  bool json = false;
};

std::string microseconds(nanoseconds duration) {
  return fmt::format("{:.1f}", static_cast<double>(duration.count()) / 1000);
}

struct Column {
  std::string_view name;
  std::string_view key;
  const Histogram* values;
};

std::vector<Column> columns_of(const serve::JitterResult& result) {
  return {{"sleep", "sleep", &result.sleep},
          {"SYNC", "sync", &result.sync},
          {"response", "response", &result.response}};
}

struct Row {
  std::string_view name;
  std::string_view key;
  unsigned per_mille;
};
constexpr Row rows[] = {{"least", "least", 0},
                        {"half", "p50", 500},
                        {"99 %", "p99", 990},
                        {"99.9 %", "p999", 999},
                        {"most", "most", 1000}};

void print_table(const serve::JitterResult& result, const BenchArguments& arguments) {
  const auto columns = columns_of(result);
  print_line(
      "{:<12}{:>10}{:>10}{:>10}   us later than the most punctual one (response: us from request to answer)",
      "", "sleep", "SYNC", "response");
  print_line("{:<12}{:>10}{:>10}{:>10}", "count", result.sleep.count(), result.sync.count(),
             result.response.count());
  for (const Row& row : rows) {
    print_line("{:<12}{:>10}{:>10}{:>10}", row.name, microseconds(columns[0].values->quantile(row.per_mille)),
               microseconds(columns[1].values->quantile(row.per_mille)),
               microseconds(columns[2].values->quantile(row.per_mille)));
  }
  print_line("{:<12}{:>10}{:>10}{:>10}", "mean", microseconds(result.sleep.mean()),
             microseconds(result.sync.mean()), microseconds(result.response.mean()));
  print_line("");
  for (std::size_t i = 0; i <= Histogram::ends.size(); ++i) {
    const std::string name =
        i < Histogram::ends.size() ? "< " + text::describe_duration(Histogram::ends[i]) : "more";
    if (columns[0].values->in_class(i) + columns[1].values->in_class(i) + columns[2].values->in_class(i) == 0)
      continue;
    print_line("{:<12}{:>10}{:>10}{:>10}", name, columns[0].values->in_class(i),
               columns[1].values->in_class(i), columns[2].values->in_class(i));
  }
  print_line("");
  print_line(
      "sleep: a thread of this machine that does nothing else; SYNC every {} and SDO answers of a plant, as "
      "another {} sees "
      "them",
      arguments.period, arguments.bus.empty() ? "thread" : "client of " + arguments.bus);
}

void print_object(const serve::JitterResult& result) {
  text::Json object;
  for (const Column& column : columns_of(result)) {
    text::Json values;
    values["count"] = column.values->count();
    for (const Row& row : rows)
      values[std::string(row.key) + "_ns"] = column.values->quantile(row.per_mille).count();
    values["mean_ns"] = column.values->mean().count();
    for (std::size_t i = 0; i <= Histogram::ends.size(); ++i) {
      const std::string end =
          i < Histogram::ends.size() ? std::to_string(Histogram::ends[i].count()) : "more";
      values["below_ns"][end] = column.values->in_class(i);
    }
    object[std::string(column.key)] = std::move(values);
  }
  object["refused"] = result.refused;
  print_json(object);
}

int jitter(const BenchArguments& arguments) {
  serve::JitterOptions options{.bit_rate = arguments.bit_rate, .real_time = arguments.real_time.wanted()};
  if (!arguments.bus.empty()) {
    const auto address = link::parse_bus_address(arguments.bus);
    if (!address) return complain(exit_code::usage, "--bus: " + address.error());
    options.bus = *address;
  }
  options.period = *text::parse_duration(arguments.period);
  if (options.period % 1ms != 0ms)
    return complain(exit_code::usage, "--period: expected whole milliseconds, as SYNC has them");
  options.length = *text::parse_duration(arguments.length);
  const auto result = serve::measure_jitter(options);
  if (!result) return complain(exit_code::failed, result.error());
  for (const std::string& sentence : result->refused) print_error("canopus: --realtime: {}", sentence);
  if (arguments.json) {
    print_object(*result);
  } else {
    print_table(*result, arguments);
  }
  return exit_code::done;
}

/// A duration in these limits.
OptionCheck duration_from(can::Duration least, can::Duration most) {
  return [least, most](const std::string& text) {
    const auto duration = text::parse_duration(text);
    if (!duration) return duration.error();
    if (*duration >= least && *duration <= most) return std::string();
    return fmt::format("\"{}\" is not from {} to {}", text, text::describe_duration(least),
                       text::describe_duration(most));
  };
}

void build_bench_command(Command& bench, int& exit_code) {
  bench.require_subcommand(1);
  auto* command =
      bench.add_subcommand("jitter", "How punctual a plant is here: SYNC and answers, beside a mere sleep");
  const auto arguments = std::make_shared<BenchArguments>();
  command
      ->add_option("--bus", arguments->bus,
                   "Over this bus; an NMT master with node-ID 1 resets its nodes and sends SYNC: not the bus "
                   "of a running "
                   "machine. Without it over a "
                   "pair of sockets")
      ->type_name("ADDRESS");
  command->add_option("--bit-rate", arguments->bit_rate, "Of that bus, in bit/s")
      ->type_name("BIT/S")
      ->capture_default_str();
  command->add_option("--period", arguments->period, "Of SYNC and of the sleep")
      ->type_name("TIME")
      ->capture_default_str()
      ->check(duration_from(1ms, 1s));
  command->add_option("--for", arguments->length, "Length of each of the two parts")
      ->type_name("TIME")
      ->capture_default_str()
      ->check(duration_from(100ms, 24h));
  add_real_time_option(*command, arguments->real_time);
  command->add_flag("--json", arguments->json, "Print one JSON object, in nanoseconds");
  command->footer(
      "First a thread sleeps for each period, as cyclictest does; then a plant runs as long in real time.\n"
      "Exit codes: 0 measured, 1 the bus could not be joined or carries nothing, 2 wrong command line.");
  command->callback([arguments, &exit_code] { exit_code = jitter(*arguments); });
}

}  // namespace

void add_bench_command(Command& app, int& exit_code) {
  app.add_subcommand("bench", "Measure the real-time accuracy of this PC",
                     [&exit_code](Command& bench) { build_bench_command(bench, exit_code); });
}

}  // namespace canopus::cli
