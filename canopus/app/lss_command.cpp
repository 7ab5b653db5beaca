#include "canopus/app/lss_command.hpp"

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "canopus/app/lss_on_bus.hpp"
#include "canopus/app/option_checks.hpp"
#include "canopus/app/sdo_value.hpp"
#include "canopus/app/text_values.hpp"
#include "canopus/can/little_endian.hpp"

namespace canopus::app {
namespace {

using manager::LssAddress;
using manager::LssMaster;
using manager::LssResult;
using Json = nlohmann::ordered_json;
namespace lss = manager::lss;

struct Arguments {
  BusOptions bus;
  std::string node, rate, state, delay;
  std::string vendor, product, revision, serial;
  std::string assign, activate;
  bool slow = false;
  bool store = false;
};

/// Of a fastscan: is anybody there, and for each part 32 bits and a confirmation.
constexpr unsigned fastscan_questions = 1 + 4 * 33;
/// Of a slow scan: is anybody there, 32 bits of revision and serial number, six frames each; the selection.
constexpr unsigned slow_scan_questions = (1 + 2 * 32) * 6 + 4;
constexpr std::string_view selecting = "selecting the device";

/// A line of people's, or the JSON.
void tell(const Arguments& arguments, const Json& line, const std::string& text) {
  if (arguments.bus.json) return print_json(line);
  print_line("{}", text);
}

Json json(const LssAddress& address) {
  return {{"vendor", address.vendor},
          {"product", address.product},
          {"revision", address.revision},
          {"serial", address.serial}};
}

std::string describe(const LssAddress& address) {
  return fmt::format("vendor {:08X}  product {:08X}  revision {:08X}  serial {:08X}", address.vendor,
                     address.product, address.revision, address.serial);
}

/// What a service that had to succeed ended with, as an exit code.
int judge(const LssOnBus& on_bus, const BusLoop& bus, std::optional<LssResult> result,
          std::string_view what) {
  if (!result) return complain_of(on_bus.end(), bus, "");
  const unsigned error = on_bus.master().error();
  switch (*result) {
    case LssResult::done: return exit_code::done;
    case LssResult::silence: return complain(exit_code::failed, fmt::format("{}: no answer", what));
    case LssResult::lost:
      return complain(exit_code::failed, fmt::format("{}: the device stopped answering in the middle", what));
    case LssResult::refused: break;
  }
  constexpr unsigned specific = 0xFF;
  return complain(exit_code::failed, error == specific
                                         ? fmt::format("{}: refused with the device's own error {}", what,
                                                       on_bus.master().specific_error())
                                         : fmt::format("{}: refused with error {}", what, error));
}

void all_to_waiting(LssOnBus& on_bus) {
  (void)on_bus.service([](auto& master, can::Time now) { return master.switch_global(false, now); });
}

int store(LssOnBus& on_bus, const BusLoop& bus) {
  const auto stored = on_bus.service([](auto& master, can::Time now) { return master.store(now); });
  return judge(on_bus, bus, stored, "storing");
}

/// The selected device gets its node-ID and keeps it if asked to.
int set_node_id(LssOnBus& on_bus, const BusLoop& bus, std::uint8_t node, bool stored) {
  const auto set =
      on_bus.service([&](auto& master, can::Time now) { return master.configure_node_id(node, now); });
  const int code = judge(on_bus, bus, set, fmt::format("setting node-ID {}", node));
  return code == exit_code::done && stored ? store(on_bus, bus) : code;
}

// --- which device

std::expected<std::optional<std::uint32_t>, std::string> u32(const std::string& word, std::string_view name) {
  if (word.empty()) return std::nullopt;
  const auto bytes = encode_value(word, canopen::DataType::unsigned32);
  if (!bytes) return std::unexpected(fmt::format("--{}: {}", name, bytes.error()));
  return can::load_u32(*bytes);
}

std::expected<std::optional<LssAddress>, std::string> address_of(const Arguments& arguments) {
  const std::pair<const std::string*, std::string_view> words[] = {{&arguments.vendor, "vendor"},
                                                                   {&arguments.product, "product"},
                                                                   {&arguments.revision, "revision"},
                                                                   {&arguments.serial, "serial"}};
  LssAddress address;
  unsigned given = 0;
  for (unsigned part = 0; part < 4; ++part) {
    const auto value = u32(*words[part].first, words[part].second);
    if (!value) return std::unexpected(value.error());
    if (!*value) continue;
    ++given;
    address.set_part(part, **value);
  }
  if (given == 0) return std::nullopt;
  if (given == 4) return address;
  return std::unexpected("an LSS address has four parts: --vendor, --product, --revision and --serial");
}

/// Selects the device with the address given, or without one all there are, for `action`; brings all back to
/// waiting state unless `stay`.
int with_device(const Arguments& arguments, const std::function<int(LssOnBus&, BusLoop&)>& action,
                bool stay = false) {
  const auto address = address_of(arguments);
  if (!address) return complain(exit_code::usage, address.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    LssOnBus on_bus(bus, time_out);
    all_to_waiting(on_bus);
    const auto switched = on_bus.service([&](auto& master, can::Time now) {
      return *address ? master.select(**address, now) : master.switch_global(true, now);
    });
    int code = judge(on_bus, bus, switched, selecting);
    if (code == exit_code::done) code = action(on_bus, bus);
    if (!stay || code != exit_code::done) all_to_waiting(on_bus);
    return code;
  });
}

// --- scan

/// Looks for devices, numbers them if asked to, and tells of each.
class Scan {
 public:
  Scan(const Arguments& arguments, BusLoop& bus, can::Duration time_out, unsigned first_node)
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

  const Arguments& arguments_;
  BusLoop& bus_;
  LssOnBus on_bus_;
  unsigned next_node_;  // 0: they are not numbered
  unsigned count_ = 0;
  unsigned questions_ = 0;
};

/// The device that has just been found is in configuration state. `has`: its node-ID, FFH for none; nothing
/// if it is known to have none.
int Scan::found(std::optional<std::uint8_t> has) {
  const LssAddress address = on_bus_.master().address();
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
  tell(arguments_, line, text);
  return exit_code::done;
}

// Those that were found and not numbered stay in configuration state, where they do not answer again.
int Scan::fast() {
  all_to_waiting(on_bus_);
  while (true) {
    const auto result =
        with_bar(fastscan_questions, [](auto& master, can::Time now) { return master.fastscan(now); });
    if (result == LssResult::silence) return exit_code::done;
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

// What was found is cut out of the ranges; what is left of them are two.
int Scan::slow(std::uint32_t vendor, std::uint32_t product) {
  constexpr std::uint32_t most = 0xFFFF'FFFF;
  struct Ranges {
    LssAddress low, high;
  };
  std::vector<Ranges> left{{{vendor, product, 0, 0}, {vendor, product, most, most}}};
  while (!left.empty()) {
    const Ranges ranges = left.back();
    left.pop_back();
    all_to_waiting(on_bus_);
    const auto result = with_bar(slow_scan_questions, [&](auto& master, can::Time now) {
      return master.slow_scan(ranges.low, ranges.high, now);
    });
    if (result == LssResult::silence) continue;
    if (const int code = judge(on_bus_, bus_, result, "slow scan"); code != exit_code::done) return code;
    const LssAddress address = on_bus_.master().address();
    const auto inquired =
        on_bus_.service([](auto& master, can::Time now) { return master.inquire_node_id(now); });
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

int scan(const Arguments& arguments) {
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
    if (!arguments.bus.json) print_line("{} device{} found", search.count(), search.count() == 1 ? "" : "s");
    return exit_code::done;
  });
}

// --- one device

int identify(const Arguments& arguments) {
  const auto address = address_of(arguments);
  if (!address) return complain(exit_code::usage, address.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    LssOnBus on_bus(bus, time_out);
    const auto result = on_bus.service([&](auto& master, can::Time now) {
      return *address ? master.identify(**address, **address, now) : master.identify_unconfigured(now);
    });
    if (!result) return complain_of(on_bus.end(), bus, "");
    const bool answered = result == LssResult::done;
    const std::string_view who = *address ? "the device" : "a device without a node-ID";
    tell(arguments, {{"answered", answered}},
         answered ? fmt::format("{} answers", who) : fmt::format("{}: no answer", who));
    return answered ? exit_code::done : exit_code::failed;
  });
}

int inquire(const Arguments& arguments) {
  return with_device(arguments, [&](LssOnBus& on_bus, BusLoop& bus) {
    LssAddress address;
    for (unsigned part = 0; part < 4; ++part) {
      const auto asked =
          on_bus.service([&](auto& master, can::Time now) { return master.inquire(part, now); });
      if (const int code = judge(on_bus, bus, asked, "asking for the identity"); code != exit_code::done)
        return code;
      address.set_part(part, on_bus.master().value());
    }
    const auto asked =
        on_bus.service([](auto& master, can::Time now) { return master.inquire_node_id(now); });
    if (const int code = judge(on_bus, bus, asked, "asking for the node-ID"); code != exit_code::done)
      return code;
    const auto node = static_cast<std::uint8_t>(on_bus.master().value());
    Json line = json(address);
    std::string text = describe(address);
    if (node == lss::unconfigured) {
      text += "  has no node-ID";
    } else {
      line["node"] = node;
      text += fmt::format("  is node {}", node);
    }
    tell(arguments, line, text);
    return exit_code::done;
  });
}

int set_node(const Arguments& arguments) {
  const bool none = arguments.node == "none";
  const auto node = none ? lss::unconfigured : static_cast<std::uint8_t>(parse_node(arguments.node));
  if (node == 0) {
    return complain(exit_code::usage,
                    fmt::format("\"{}\" is not a node-ID; expected 1 to 127, or none", arguments.node));
  }
  return with_device(arguments, [&](LssOnBus& on_bus, BusLoop& bus) {
    const int code = set_node_id(on_bus, bus, node, arguments.store);
    if (code == exit_code::done) {
      tell(arguments, {{"node", node}, {"stored", arguments.store}},
           fmt::format("node-ID {} set{}", none ? "none" : arguments.node,
                       arguments.store ? " and stored" : ""));
    }
    return code;
  });
}

/// "250k", "1M", "250000", in bit/s.
std::expected<std::uint32_t, std::string> parse_bit_rate(std::string_view text) {
  std::string_view digits = text;
  std::uint32_t factor = 1;
  if (digits.ends_with('k') || digits.ends_with('M')) {
    factor = digits.back() == 'k' ? 1000 : 1'000'000;
    digits.remove_suffix(1);
  }
  std::uint32_t value = 0;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (failure == std::errc{} && end == digits.data() + digits.size() && value <= 1'000'000 / factor &&
      lss::bit_rate_index(value * factor)) {
    return value * factor;
  }
  return std::unexpected(fmt::format(
      "\"{}\" is not a bit rate of LSS; expected 1M, 800k, 500k, 250k, 125k, 50k, 20k or 10k", text));
}

std::expected<std::chrono::milliseconds, std::string> parse_delay(std::string_view text) {
  const auto delay = parse_duration(text);
  if (!delay) return std::unexpected(delay.error());
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(*delay);
  if (milliseconds != *delay || milliseconds.count() > 0xFFFF) {
    return std::unexpected(fmt::format("{}: a switch delay is a whole number of ms up to 65535ms", text));
  }
  return milliseconds;
}

/// All in configuration state change over; nothing more may be sent to them here.
int activate(LssOnBus& on_bus, BusLoop& bus, std::chrono::milliseconds delay) {
  const auto sent =
      on_bus.service([&](auto& master, can::Time now) { return master.activate_bit_timing(delay, now); });
  return judge(on_bus, bus, sent, "activating");
}

int set_rate(const Arguments& arguments) {
  const auto rate = parse_bit_rate(arguments.rate);
  if (!rate) return complain(exit_code::usage, rate.error());
  std::optional<std::chrono::milliseconds> delay;
  if (!arguments.activate.empty()) {
    const auto parsed = parse_delay(arguments.activate);
    if (!parsed) return complain(exit_code::usage, "--activate: " + parsed.error());
    delay = *parsed;
  }
  const auto action = [&](LssOnBus& on_bus, BusLoop& bus) {
    const auto set = on_bus.service([&](auto& master, can::Time now) {
      return master.configure_bit_timing(*lss::bit_rate_index(*rate), now);
    });
    int code = judge(on_bus, bus, set, fmt::format("setting {:g} kbit/s", *rate / 1000.0));
    if (code == exit_code::done && arguments.store) code = store(on_bus, bus);
    if (code == exit_code::done && delay) code = activate(on_bus, bus, *delay);
    if (code != exit_code::done) return code;
    Json line{{"bit_rate", *rate}, {"stored", arguments.store}};
    std::string text = fmt::format("{:g} kbit/s set{}", *rate / 1000.0, arguments.store ? " and stored" : "");
    if (delay) {
      line["delay_ms"] = delay->count();
      text += fmt::format(", in force in {} ms; at that rate `canopus lss switch waiting` ends configuration",
                          delay->count());
    } else {
      text += ", in force after a reset";
    }
    tell(arguments, line, text);
    return exit_code::done;
  };
  return with_device(arguments, action, delay.has_value());
}

int activate(const Arguments& arguments) {
  const auto delay = parse_delay(arguments.delay);
  if (!delay) return complain(exit_code::usage, delay.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    LssOnBus on_bus(bus, time_out);
    const int code = activate(on_bus, bus, *delay);
    if (code == exit_code::done) {
      tell(arguments, {{"delay_ms", delay->count()}},
           fmt::format("every device in configuration state changes over in {} ms", delay->count()));
    }
    return code;
  });
}

int store(const Arguments& arguments) {
  return with_device(arguments, [&](LssOnBus& on_bus, BusLoop& bus) {
    const int code = store(on_bus, bus);
    if (code == exit_code::done) tell(arguments, {{"stored", true}}, "stored");
    return code;
  });
}

int switch_state(const Arguments& arguments) {
  const bool configuration = arguments.state == "configuration";
  const auto address = address_of(arguments);
  if (!address) return complain(exit_code::usage, address.error());
  if (*address && !configuration) {
    return complain(exit_code::usage, "only all devices together can be switched to waiting state");
  }
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    LssOnBus on_bus(bus, time_out);
    const auto switched = on_bus.service([&](auto& master, can::Time now) {
      return *address ? master.select(**address, now) : master.switch_global(configuration, now);
    });
    const int code = judge(on_bus, bus, switched, selecting);
    if (code == exit_code::done) {
      tell(arguments, {{"state", arguments.state}},
           fmt::format("{} in {} state", *address ? "the device is" : "all devices are", arguments.state));
    }
    return code;
  });
}

void add_address_options(CLI::App& command, Arguments& arguments) {
  command.add_option("--vendor", arguments.vendor, "vendor-ID: 405, 0x195 or 195H")->type_name("U32");
  command.add_option("--product", arguments.product, "product code")->type_name("U32");
  command.add_option("--revision", arguments.revision, "revision number")->type_name("U32");
  command.add_option("--serial", arguments.serial, "serial number")->type_name("U32");
}

}  // namespace

void add_lss_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  arguments->bus.time_out = "100ms";
  CLI::App* command = app.add_subcommand("lss", "Find devices and set their node-IDs and bit rates (LSS)");
  command->require_subcommand(1);
  command->footer(
      "Only one LSS master at a time may be on a bus.\n"
      "Exit code: 0 done, 1 no answer, refused, or no bus, 2 wrong command line.");
  const auto add = [&](const char* name, const char* what, int (*run)(const Arguments&),
                       const char* time_out = "for each answer") {
    CLI::App* sub = command->add_subcommand(name, what);
    add_bus_options(*sub, arguments->bus, time_out);
    sub->callback([arguments, &exit_code, run] { exit_code = run(*arguments); });
    return sub;
  };
  const char* const one_device =
      "Without an address the device must be the only one on the bus that knows LSS.";

  CLI::App* sub = add("scan", "Find all devices without a node-ID (fastscan)", scan,
                      "for each answer; a device takes 133 of them, in a slow scan 65");
  sub->add_option("--assign", arguments->assign, "give them node-IDs from this one on, as they are found")
      ->type_name("NODE");
  sub->add_flag("--store", arguments->store, "and have them keep it");
  sub->add_option("--vendor", arguments->vendor, "slow scan: vendor-ID, 405, 0x195 or 195H")
      ->type_name("U32");
  sub->add_option("--product", arguments->product, "slow scan: product code")->type_name("U32");
  sub->add_flag("--slow", arguments->slow, "slow scan at once: finds devices that have a node-ID as well");
  sub->footer(
      "A device without a node-ID that does not know fastscan is looked for by a slow scan, if --vendor and\n"
      "--product say whose it is.");

  sub = add("identify", "Does a device without a node-ID answer? Or the one with this address?", identify);
  add_address_options(*sub, *arguments);

  sub = add("inquire", "Show a device's identity and node-ID", inquire);
  add_address_options(*sub, *arguments);
  sub->footer(one_device);

  sub = add("set-node", "Give one device its node-ID", set_node);
  sub->add_option("NODE", arguments->node, "node-ID, 1 to 127; none takes it away (at the next reset)")
      ->required();
  add_address_options(*sub, *arguments);
  sub->add_flag("--store", arguments->store, "have the device keep it");
  sub->footer(one_device);

  sub = add("set-rate", "Set the bit rate of one device, or of all", set_rate);
  sub->add_option("RATE", arguments->rate, "bit/s: 1M, 800k, 500k, 250k, 125k, 50k, 20k or 10k")->required();
  add_address_options(*sub, *arguments);
  sub->add_flag("--store", arguments->store, "have it kept");
  sub->add_option("--activate", arguments->activate, "change over: silence for this long before and after")
      ->type_name("TIME");
  sub->footer(
      "Without an address all devices are set. Without --activate the rate is in force after the next "
      "reset.\n"
      "After a change the bus itself has to have the new rate.");

  sub = add("activate", "Have all devices in configuration state change over to the rate set", activate);
  sub->add_option("DELAY", arguments->delay, "silence before and after the change, for example 1s")
      ->required();

  sub = add("store", "Have one device keep its node-ID and bit rate", store);
  add_address_options(*sub, *arguments);
  sub->footer(one_device);

  sub = add("switch", "Switch all devices, or the one with this address, to a state of LSS", switch_state);
  sub->add_option("STATE", arguments->state, "waiting or configuration")
      ->required()
      ->check(one_of_words({"waiting", "configuration"}));
  add_address_options(*sub, *arguments);
}

}  // namespace canopus::app
