#include <functional>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "canopus/cli/bus/lss_device.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using lss::LssAddress;
using lss::LssResult;
using Json = text::Json;

constexpr std::string_view selecting = "selecting the device";

/// Selects the device with the address given, or without one all there are, for `action`; brings all back to
/// waiting state unless `stay`.
int with_device(const LssArguments& arguments, const std::function<int(LssOnBus&, BusLoop&)>& action,
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

// --- the commands

int identify(const LssArguments& arguments) {
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
    show(arguments, {{"answered", answered}},
         answered ? fmt::format("{} answers", who) : fmt::format("{}: no answer", who));
    return answered ? exit_code::done : exit_code::failed;
  });
}

int inquire(const LssArguments& arguments) {
  return with_device(arguments, [&](LssOnBus& on_bus, BusLoop& bus) {
    LssAddress address;
    for (unsigned part = 0; part < 4; ++part) {
      const auto asked =
          on_bus.service_of_found([&](auto& master, can::Time now) { return master.inquire(part, now); });
      if (const int code = judge(on_bus, bus, asked, "asking for the identity"); code != exit_code::done)
        return code;
      address.set_part(part, on_bus.master().value());
    }
    const auto asked =
        on_bus.service_of_found([](auto& master, can::Time now) { return master.inquire_node_id(now); });
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
    show(arguments, line, text);
    return exit_code::done;
  });
}

/// Selects the only device without a node-ID, as far as fastscan finds one: several would get the same node-ID.
/// An exit code.
int select_unconfigured(LssOnBus& on_bus, const BusLoop& bus, const std::string& node) {
  const auto found = [&] {
    return on_bus.service([](auto& master, can::Time now) { return master.fastscan(now); });
  };
  const auto first = found();
  if (!first) return complain_of(on_bus.end(), bus, "");
  if (first == LssResult::silence) {  // it has a node-ID, or does not know fastscan
    return judge(on_bus, bus,
                 on_bus.service([](auto& master, can::Time now) { return master.switch_global(true, now); }),
                 selecting);
  }
  if (*first != LssResult::done) return judge(on_bus, bus, first, selecting);
  const auto second = found();
  if (!second) return complain_of(on_bus.end(), bus, "");
  if (second == LssResult::silence) return exit_code::done;
  return complain(
      exit_code::failed,
      fmt::format(
          "more than one device without a node-ID: `canopus lss scan --assign {}` gives each its own; or "
          "name one by --vendor, --product, --revision and --serial",
          node));
}

int set_node(const LssArguments& arguments) {
  const bool none = arguments.node == "none";
  const auto node = none ? lss::unconfigured : static_cast<std::uint8_t>(parse_node(arguments.node));
  if (node == 0) {
    return complain(exit_code::usage,
                    fmt::format("\"{}\" is not a node-ID; expected 1 to 127, or none", arguments.node));
  }
  const auto set = [&](LssOnBus& on_bus, BusLoop& bus) {
    const int code = set_node_id(on_bus, bus, node, arguments.store);
    if (code == exit_code::done) {
      show(
          arguments, {{"node", node}, {"stored", arguments.store}},
          fmt::format(
              "node-ID {} set{}; a device that had another one has it after a reset (`canopus nmt reset-comm "
              "NODE` with the old node-ID)",
              none ? "none" : arguments.node, arguments.store ? " and stored" : ""));
    }
    return code;
  };
  const auto address = address_of(arguments);
  if (none || (address && *address)) return with_device(arguments, set);
  if (!address) return complain(exit_code::usage, address.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    LssOnBus on_bus(bus, time_out);
    all_to_waiting(on_bus);
    int code = select_unconfigured(on_bus, bus, arguments.node);
    if (code == exit_code::done) code = set(on_bus, bus);
    all_to_waiting(on_bus);
    return code;
  });
}

std::expected<std::chrono::milliseconds, std::string> parse_delay(std::string_view text) {
  const auto delay = text::parse_duration(text);
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

int set_rate(const LssArguments& arguments) {
  const auto rate = parse_lss_bit_rate(arguments.rate);
  if (!rate) return complain(exit_code::usage, rate.error());
  std::optional<std::chrono::milliseconds> delay;
  if (!arguments.activate.empty()) {
    const auto parsed = parse_delay(arguments.activate);
    if (!parsed) return complain(exit_code::usage, "--activate: " + parsed.error());
    delay = *parsed;
  }
  const auto action = [&](LssOnBus& on_bus, BusLoop& bus) {
    const auto set = on_bus.service_of_found([&](auto& master, can::Time now) {
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
    show(arguments, line, text);
    return exit_code::done;
  };
  return with_device(arguments, action, delay.has_value());
}

int activate(const LssArguments& arguments) {
  const auto delay = parse_delay(arguments.delay);
  if (!delay) return complain(exit_code::usage, delay.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    LssOnBus on_bus(bus, time_out);
    const int code = activate(on_bus, bus, *delay);
    if (code == exit_code::done) {
      show(arguments, {{"delay_ms", delay->count()}},
           fmt::format("every device in configuration state changes over in {} ms", delay->count()));
    }
    return code;
  });
}

int store(const LssArguments& arguments) {
  return with_device(arguments, [&](LssOnBus& on_bus, BusLoop& bus) {
    const int code = store(on_bus, bus);
    if (code == exit_code::done) show(arguments, {{"stored", true}}, "stored");
    return code;
  });
}

int switch_state(const LssArguments& arguments) {
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
      show(arguments, {{"state", arguments.state}},
           fmt::format("{} in {} state", *address ? "the device is" : "all devices are", arguments.state));
    }
    return code;
  });
}

void add_address_options(Command& command, LssArguments& arguments) {
  command.add_option("--vendor", arguments.vendor, "vendor-ID: 405, 0x195 or 195H")->type_name("U32");
  command.add_option("--product", arguments.product, "product code")->type_name("U32");
  command.add_option("--revision", arguments.revision, "revision number")->type_name("U32");
  command.add_option("--serial", arguments.serial, "serial number")->type_name("U32");
}

constexpr const char* one_device =
    "Without an address the device must be the only one on the bus that knows LSS.";

/// Adds commands of `canopus lss`.
struct Adder {
  Command& group;
  std::shared_ptr<LssArguments> arguments;  ///< each command keeps them
  int& exit_code;

  Command* operator()(const char* name, const char* what, int (*run)(const LssArguments&),
                      const char* time_out = "for each answer") const {
    Command* sub = group.add_subcommand(name, what);
    add_bus_options(*sub, arguments->bus, time_out);
    sub->callback([kept = arguments, &code = exit_code, run] { code = run(*kept); });
    return sub;
  }
};

void add_finding_commands(const Adder& add) {
  const auto& arguments = add.arguments;
  Command* sub = add("scan", "Find all devices without a node-ID (fastscan)", lss_scan,
                     "for each answer; a device takes 133 of them, in a slow scan 65");
  sub->add_option("--assign", arguments->assign, "assign node-IDs from this one on")->type_name("1-127");
  sub->add_flag("--store", arguments->store, "and store them in the devices");
  sub->add_option("--vendor", arguments->vendor, "slow scan: vendor-ID, 405, 0x195 or 195H")
      ->type_name("U32");
  sub->add_option("--product", arguments->product, "slow scan: product code")->type_name("U32");
  sub->add_flag("--slow", arguments->slow, "slow scan at once: finds devices that have a node-ID as well");
  sub->footer(
      "A device without a node-ID that does not know fastscan is looked for by a slow scan, if --vendor and\n"
      "--product say whose it is.");

  sub = add("identify", "Does a device without a node-ID answer? Or the one with this address?", identify);
  add_address_options(*sub, *arguments);

  sub = add("search",
            "Find a device at an unknown bit rate, and assign a node-ID and the bit rate of this network",
            lss_rate_search);
  sub->add_option("NODE-ID", arguments->node, "for it, 1 to 127")->required();
  add_address_options(*sub, *arguments);
  sub->add_option("--bit-rate", arguments->rate, "of this network, if the bus does not report it: 125k")
      ->type_name("RATE");
  sub->footer(
      "Without an address the first device without a node-ID is taken. It keeps both.\n"
      "Meanwhile our controller is at other bit rates: other nodes of the network detect errors, and may go "
      "bus-off. Stop its master\n"
      "and its traffic before. SocketCAN wants the right to set up the interface, socketcand a server that "
      "can do it: canopus run.");

  sub = add("inquire", "Show a device's identity and node-ID", inquire);
  add_address_options(*sub, *arguments);
  sub->footer(one_device);
}

void add_setting_commands(const Adder& add) {
  const auto& arguments = add.arguments;
  Command* sub = add("set-node", "Give one device its node-ID", set_node);
  sub->add_option("NODE-ID", arguments->node, "1 to 127; none removes it (at the next reset)")->required();
  add_address_options(*sub, *arguments);
  sub->add_flag("--store", arguments->store, "store it in the device");
  sub->footer(
      "Without an address the device must be the only one on the bus without a node-ID (two fastscans check "
      "that),\n"
      "or the only one that knows LSS.");

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

void build_lss_command(Command& command, int& exit_code) {
  const auto arguments = std::make_shared<LssArguments>();
  arguments->bus.time_out = "100ms";
  command.require_subcommand(1);
  command.footer(
      "Only one LSS master at a time may be on a bus.\n"
      "Exit code: 0 done, 1 no answer, refused, or no bus, 2 wrong command line.");
  const Adder add{command, arguments, exit_code};
  add_finding_commands(add);
  add_setting_commands(add);
}

}  // namespace

void add_lss_command(Command& app, int& exit_code) {
  app.add_subcommand("lss", "Find devices and set their node-IDs and bit rates (LSS)",
                     [&exit_code](Command& command) { build_lss_command(command, exit_code); });
}

}  // namespace canopus::cli
