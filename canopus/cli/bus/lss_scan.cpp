#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/bus/lss_device.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using lss::LssAddress;
using lss::LssResult;
using Json = text::Json;

/// Requests of a fastscan: presence of a slave, and for each part 32 bits and a confirmation.
constexpr unsigned fastscan_questions = 1 + 4 * 33;
/// Requests of a slow scan: presence of a slave, 32 bits of revision and serial number, six frames each; the
/// selection.
constexpr unsigned slow_scan_questions = (1 + 2 * 32) * 6 + 4;

/// Finds devices, assigns node-IDs if requested, and prints each.
class Scan {
 public:
  Scan(const LssArguments& arguments, BusLoop& bus, can::Duration time_out, unsigned first_node)
      : arguments_(arguments), bus_(bus), on_bus_(bus, time_out), next_node_(first_node) {
    if (!is_terminal(STDERR_FILENO)) return;
    on_bus_.set_progress([this](unsigned frames) {
      if (questions_ != 0) draw_bar(frames);
    });
  }

  int fast();
  /// Is there a device without a node-ID that fastscan did not find?
  bool someone_is_left();
  int slow(std::uint32_t vendor, std::uint32_t product);
  void end() { all_to_waiting(on_bus_); }
  [[nodiscard]] unsigned count() const noexcept { return count_; }

 private:
  int found(std::optional<std::uint8_t> has);
  bool once_more(std::optional<LssResult> result, std::string_view what);
  void draw_bar(unsigned frames) const {
    constexpr unsigned width = 30;
    const unsigned filled = std::min(width, frames * width / questions_);
    show_progress(Line("[{:#<{}}{:.<{}}] device {}: question {} of {}", "", filled, "", width - filled,
                       count_ + 1, frames, questions_));
  }
  template <typename Service>
  std::optional<LssResult> with_bar(unsigned questions, Service service) {
    questions_ = questions;
    const auto result = on_bus_.service(service);
    questions_ = 0;
    end_progress();
    return result;
  }

  const LssArguments& arguments_;
  BusLoop& bus_;
  LssOnBus on_bus_;
  unsigned next_node_;  // 0: they are not numbered
  unsigned count_ = 0;
  unsigned questions_ = 0;
  unsigned attempts_ = 1;
  std::vector<LssAddress> shown_;
};

/// An answer that came too late passes for silence, and then for the answer to the next question: the search
/// leads to a device that does not exist, or past one that does. All that still answer are searched again.
bool Scan::once_more(std::optional<LssResult> result, std::string_view what) {
  constexpr unsigned most_attempts = 3;
  if (result != LssResult::lost || attempts_ == most_attempts) return false;
  ++attempts_;
  on_bus_.set_time_out(2 * on_bus_.time_out());
  print_error("canopus: {}: an answer came too late; again from the start, with {:g} ms for each answer",
              what, std::chrono::duration<double, std::milli>(on_bus_.time_out()).count());
  all_to_waiting(on_bus_);
  return true;
}

/// The device that has just been found is in configuration state. `has`: its node-ID, FFH for none; nothing:
/// a fastscan found it, so it has none.
int Scan::found(std::optional<std::uint8_t> has) {
  const LssAddress address = on_bus_.master().address();
  if (std::ranges::find(shown_, address) != shown_.end()) return exit_code::done;  // by a search before
  shown_.push_back(address);
  const bool without = has.value_or(lss::unconfigured) == lss::unconfigured;
  const bool number = without && next_node_ != 0;
  if (number && next_node_ > 127) {
    return complain(exit_code::failed, "no node-ID is left for the next device");
  }
  if (number) {
    const int code = set_node_id(on_bus_, bus_, static_cast<std::uint8_t>(next_node_), arguments_.store);
    if (code != exit_code::done) return code;
    all_to_waiting(on_bus_);
  }
  ++count_;
  Json line = json(address);
  std::string text = describe(address);
  if (number) {
    line["node"] = next_node_;
    text += fmt::format("  is node {} now", next_node_++);
  } else if (!without) {
    line["node"] = *has;
    text += fmt::format("  is node {}", *has);
  }
  show(arguments_, line, text);
  return exit_code::done;
}

// Those that were found and not numbered stay in configuration state, where they do not answer again.
int Scan::fast() {
  all_to_waiting(on_bus_);
  while (true) {
    const auto result =
        with_bar(fastscan_questions, [](auto& master, can::Time now) { return master.fastscan(now); });
    if (result == LssResult::silence) return exit_code::done;
    if (once_more(result, "fastscan")) continue;
    int code = judge(on_bus_, bus_, result, "fastscan");
    if (code == exit_code::done) code = found(std::nullopt);
    if (code != exit_code::done) return code;
  }
}

bool Scan::someone_is_left() {
  const auto answer =
      on_bus_.service([](auto& master, can::Time now) { return master.identify_unconfigured(now); });
  return answer == LssResult::done;
}

// Excludes the found device from a range, which leaves two ranges.
int Scan::slow(std::uint32_t vendor, std::uint32_t product) {
  constexpr std::uint32_t most = 0xFFFF'FFFF;
  struct Ranges {
    LssAddress low, high;
  };
  const Ranges everything{{vendor, product, 0, 0}, {vendor, product, most, most}};
  std::vector<Ranges> left{everything};
  while (!left.empty()) {
    const Ranges ranges = left.back();
    left.pop_back();
    all_to_waiting(on_bus_);
    const auto result = with_bar(slow_scan_questions, [&](auto& master, can::Time now) {
      return master.slow_scan(ranges.low, ranges.high, now);
    });
    if (result == LssResult::silence) continue;
    if (once_more(result, "slow scan")) {
      left.assign(1, everything);
      continue;
    }
    if (const int code = judge(on_bus_, bus_, result, "slow scan"); code != exit_code::done) return code;
    const LssAddress address = on_bus_.master().address();
    const auto inquired =
        on_bus_.service_of_found([](auto& master, can::Time now) { return master.inquire_node_id(now); });
    int code = judge(on_bus_, bus_, inquired, "asking for the node-ID");
    if (code == exit_code::done) code = found(static_cast<std::uint8_t>(on_bus_.master().value()));
    if (code != exit_code::done) return code;
    if (address.revision != ranges.high.revision) {
      left.push_back({{vendor, product, address.revision + 1, 0}, ranges.high});
      left.back().high.serial = most;
    }
    if (address.serial != ranges.high.serial) {
      left.push_back({{vendor, product, address.revision, address.serial + 1},
                      {vendor, product, address.revision, ranges.high.serial}});
    }
  }
  return exit_code::done;
}

}  // namespace

int lss_scan(const LssArguments& arguments) {
  const unsigned first = arguments.assign.empty() ? 0 : parse_node(arguments.assign);
  if (first == 0 && !arguments.assign.empty()) {
    return complain(exit_code::usage,
                    fmt::format("--assign: \"{}\" is not a node-ID 1 to 127", arguments.assign));
  }
  if (first == 0 && arguments.store) return complain(exit_code::usage, "--store needs --assign");
  const auto vendor = u32(arguments.vendor, "vendor");
  if (!vendor) return complain(exit_code::usage, vendor.error());
  const auto product = u32(arguments.product, "product");
  if (!product) return complain(exit_code::usage, product.error());
  if (vendor->has_value() != product->has_value() || (arguments.slow && !*vendor)) {
    return complain(exit_code::usage, "a slow scan needs both --vendor and --product");
  }
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    Scan search(arguments, bus, time_out, first);
    int code = arguments.slow ? exit_code::done : search.fast();
    const bool incomplete = code == exit_code::done && !arguments.slow &&
                            (search.count() == 0 || first != 0) && search.someone_is_left();
    if (incomplete && !*vendor) {
      code = complain(exit_code::failed,
                      "a device without a node-ID answers, but not to fastscan: give its --vendor and "
                      "--product for a slow scan");
    } else if (code == exit_code::done && (incomplete || arguments.slow)) {
      code = search.slow(**vendor, **product);
    }
    search.end();
    if (code != exit_code::done) return code;
    if (search.count() == 0) {
      return complain(exit_code::failed, arguments.slow ? "no device of this vendor and product answers"
                                                        : "no device without a node-ID answers");
    }
    if (!arguments.bus.json) print_line("{} found", ascii::counted(search.count(), "device"));
    return exit_code::done;
  });
}

}  // namespace canopus::cli
