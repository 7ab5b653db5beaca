#include "canopus/cli/commands/nmt_command.hpp"

#include <array>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/commands/bus_command.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;

struct Service {
  const char* name;
  const char* help;
  NmtCommand command;
  NmtState state;  ///< that the node's heartbeat or boot-up message shows when it obeyed
};

constexpr std::array<Service, 5> services{{
    {"start", "Start remote node: to Operational", NmtCommand::start, NmtState::operational},
    {"stop", "Stop remote node: to Stopped", NmtCommand::stop, NmtState::stopped},
    {"preop", "Enter Pre-operational", NmtCommand::enter_pre_operational, NmtState::pre_operational},
    {"reset", "Reset node: as after power-on", NmtCommand::reset_node, NmtState::initialising},
    {"reset-comm", "Reset communication", NmtCommand::reset_communication, NmtState::initialising},
}};

struct NmtArguments {
  BusOptions bus;
  std::string node;
  bool wait = false;
};

/// Waits for a node to show its state.
class StateWatch final : public can::Listener {
 public:
  StateWatch(std::uint8_t node_id, NmtState wanted) : node_id_(node_id), wanted_(wanted) {}
  [[nodiscard]] bool seen() const noexcept { return seen_; }

  void receive(const can::Frame& frame, can::Time) override {
    if (frame.extended || frame.remote || frame.length() != 1) return;
    if (frame.identifier != canopen::cob_id::error_control + node_id_) return;
    if ((frame.data[0] & 0x7FU) == static_cast<unsigned>(wanted_)) seen_ = true;  // bit 7: guarding's toggle
  }

 private:
  std::uint8_t node_id_;
  NmtState wanted_;
  bool seen_ = false;
};

int command_node(const NmtArguments& arguments, const Service& service) {
  const bool all = arguments.node == "all";
  const auto node = static_cast<std::uint8_t>(parse_node(arguments.node));
  if (!all && node == 0) {
    return complain(exit_code::usage,
                    fmt::format("\"{}\" is not a node; expected a node-ID 1 to 127, or all", arguments.node));
  }
  if (all && arguments.wait) return complain(exit_code::usage, "--wait needs a single node");
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    bus.need({link::IdentifierFilter::only(canopen::cob_id::error_control + node)});
    StateWatch watch(node, service.state);
    bus.add_listener(watch);
    const bool sent =
        bus.send(can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(service.command), node}));
    auto end = BusLoop::End::done;
    if (sent && arguments.wait) end = bus.run([&] { return watch.seen(); }, bus.now() + time_out);
    bus.remove_listener(watch);
    if (!sent) return complain(exit_code::failed, "the bus takes no frame");
    if (end != BusLoop::End::done) {
      const bool boots = service.state == NmtState::initialising;
      return complain_of(end, bus,
                         fmt::format("node {} does not show {} within {}", node,
                                     boots ? "its boot-up message" : canopen::name(service.state),
                                     text::describe_duration(time_out)));
    }
    const std::string whom = all ? "all nodes" : fmt::format("node {}", node);
    if (arguments.bus.json) {
      nlohmann::ordered_json line;
      line["command"] = service.name;
      line["node"] = node;
      if (arguments.wait) line["state"] = canopen::name(service.state);
      print_json(line);
    } else if (!arguments.wait) {
      print_line("{} sent to {}", service.name, whom);
    } else if (service.state == NmtState::initialising) {
      print_line("{} has booted", whom);
    } else {
      print_line("{} is {}", whom, canopen::name(service.state));
    }
    return exit_code::done;
  });
}

}  // namespace

void add_nmt_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<NmtArguments>();
  CLI::App* nmt = app.add_subcommand("nmt", "Send NMT commands to the nodes of a bus");
  nmt->require_subcommand(1);
  nmt->footer(
      "NMT commands are not confirmed: without --wait, done means sent.\n"
      "Exit code: 0 done, 1 no bus, or the node did not do it, 2 wrong command line.");
  for (const Service& service : services) {
    CLI::App* command = nmt->add_subcommand(service.name, service.help);
    command->add_option("NODE", arguments->node, "node-ID 1 to 127, or all")->required();
    command->add_flag("--wait", arguments->wait,
                      "wait until the node's heartbeat (after a reset: its boot-up message) shows it");
    add_bus_options(*command, arguments->bus, "for --wait");
    command->callback([arguments, &service, &exit_code] { exit_code = command_node(*arguments, service); });
  }
}

}  // namespace canopus::cli
