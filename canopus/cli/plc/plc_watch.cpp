// canopus plc watch: the first values, then every change with its time.

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

#include <fmt/format.h>

#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/plc_access.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

namespace {

using client::PlcPoint;
using Json = text::Json;

/// Prints one reading of a watch.
class WatchPrinter {
 public:
  WatchPrinter(const PlcPoint& point, const PlcArguments& arguments) : point_(point), arguments_(arguments) {
    for (std::uint32_t i = 0; i < arguments.count; ++i)
      addresses_.push_back(shown_address(point, arguments, i));
    for (const std::string& address : addresses_) width_ = std::max(width_, address.size());
    if (arguments.csv) print_line("{}", fmt::format("time,{}", fmt::join(addresses_, ",")));
  }

  /// `texts` are values as people read them.
  void text(double seconds, const std::vector<std::string>& texts) {
    texts_.resize(texts.size());
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (texts[i] == texts_[i]) continue;
      print_line("{:9.3f} s  {:<{}}  {}", seconds, addresses_[i], width_, texts[i]);
    }
    texts_ = texts;
  }
  void values(double seconds, const std::vector<std::uint16_t>& values) {
    if (values == values_) return;
    std::vector<int> shown;
    Json json{{"time", static_cast<double>(static_cast<std::int64_t>(seconds * 1000)) / 1000}};
    for (std::size_t i = 0; i < values.size(); ++i) {
      shown.push_back(arguments_.as_signed ? static_cast<std::int16_t>(values[i])
                                           : static_cast<int>(values[i]));
      if (!values_.empty() && values[i] == values_[i]) continue;
      json[addresses_[i]] = point_.is_bit() ? Json(values[i] != 0) : Json(shown.back());
    }
    if (arguments_.json) {
      print_line("{}", json.dump());
    } else {
      print_line("{}", fmt::format("{:.3f},{}", seconds, fmt::join(shown, ",")));
    }
    values_ = values;
  }

 private:
  const PlcPoint& point_;
  const PlcArguments& arguments_;
  std::vector<std::string> addresses_;
  std::size_t width_ = 0;
  std::vector<std::string> texts_;
  std::vector<std::uint16_t> values_;
};

}  // namespace

std::expected<WatchTimes, std::string> watch_times(const PlcArguments& arguments) {
  const auto interval = text::parse_duration(arguments.interval);
  if (!interval) return std::unexpected("--interval: " + interval.error());
  if (*interval < std::chrono::milliseconds(1)) return std::unexpected("--interval: expected at least 1ms");
  WatchTimes times{.interval = *interval, .start = WatchTimes::Clock::now()};
  if (!arguments.duration.empty()) {
    const auto duration = text::parse_duration(arguments.duration);
    if (!duration) return std::unexpected("--for: " + duration.error());
    times.end = times.start + *duration;
  }
  return times;
}

int watch(const WatchTimes& times, const std::function<int(double seconds)>& read) {
  WatchTimes::Clock::time_point next = times.start;
  while (true) {
    const int code = read(std::chrono::duration<double>(WatchTimes::Clock::now() - times.start).count());
    if (code != done) return code;
    // A slow PLC is asked again at once, not in a burst.
    next = std::max(next + times.interval, WatchTimes::Clock::now());
    if (next > times.end) return done;
    std::this_thread::sleep_until(next);
  }
}

int watch_plc(const PlcPoint& point, const PlcArguments& arguments) {
  const auto times = watch_times(arguments);
  if (!times) return plc_failed(usage, times.error());
  return with_client(arguments, [&](client::PlcClient& client) {
    WatchPrinter printer(point, arguments);
    return watch(*times, [&](double seconds) {
      if (arguments.csv || arguments.json) {
        const auto values = read_values(client, point, arguments.count);
        if (!values) return plc_failed(refused, values.error());
        printer.values(seconds, *values);
      } else {
        const auto texts = read_points(client, point, arguments);
        if (!texts) return plc_failed(refused, texts.error());
        printer.text(seconds, *texts);
      }
      return done;
    });
  });
}

}  // namespace canopus::cli
