#include "canopus/cli/commands/nmt_command.hpp"

#include <array>
#include <expected>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/commands/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/client/sdo_transfer_on_bus.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;

struct Service {
  const char* name;
  const char* help;
  NmtCommand command;
  NmtState state;        ///< that the node's heartbeat or boot-up message shows when it obeyed
  std::uint8_t request;  ///< the same as a value of 1F82H [CiA 302-2]
};

constexpr std::array<Service, 5> services{{
    {"start", "Start remote node: to Operational", NmtCommand::start, NmtState::operational, 0x05},
    {"stop", "Stop remote node: to Stopped", NmtCommand::stop, NmtState::stopped, 0x04},
    {"preop", "Enter Pre-operational", NmtCommand::enter_pre_operational, NmtState::pre_operational, 0x7F},
    {"reset", "Reset node: as after power-on", NmtCommand::reset_node, NmtState::initialising, 0x06},
    {"reset-comm", "Reset communication", NmtCommand::reset_communication, NmtState::initialising, 0x07},
}};

struct NmtArguments {
  BusOptions bus;
  std::string node;
  std::string
      master{};  ///< node-ID of the active NMT master that is to send the command; empty: this program does
  bool wait = false;
};

constexpr std::uint16_t request_nmt = 0x1F82;
constexpr std::uint8_t request_for_all = 0x80;  ///< sub-index for all nodes, the master with them

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

/// Sends the command, or has the master send it. The error is a sentence.
std::expected<void, std::string> send_command(BusLoop& bus, const Service& service, std::uint8_t node,
                                              std::uint8_t master, can::Duration time_out) {
  if (master == 0) {
    if (bus.send(can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(service.command), node})))
      return {};
    return std::unexpected("the bus takes no frame");
  }
  client::SdoOnBus sdo(bus, master, time_out, false);
  const std::uint8_t sub = node == 0 ? request_for_all : node;
  const auto written = sdo.write({.index = request_nmt, .sub = sub}, std::array{service.request});
  if (written) return {};
  return std::unexpected(fmt::format("master {} did not take {:02X}H for {} (request NMT): {}", master,
                                     service.request, canopen::object_text(request_nmt, sub),
                                     written.error().reason));
}

int command_node(const NmtArguments& arguments, const Service& service) {
  const bool all = arguments.node == "all";
  const auto node = static_cast<std::uint8_t>(parse_node(arguments.node));
  if (!all && node == 0) {
    return complain(exit_code::usage,
                    fmt::format("\"{}\" is not a node; expected a node-ID 1 to 127, or all", arguments.node));
  }
  const auto master = static_cast<std::uint8_t>(parse_node(arguments.master));
  if (!arguments.master.empty() && master == 0) {
    return complain(
        exit_code::usage,
        fmt::format("--master: \"{}\" is not a node; expected a node-ID 1 to 127", arguments.master));
  }
  if (all && arguments.wait) return complain(exit_code::usage, "--wait needs a single node");
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    bus.need({link::IdentifierFilter::only(canopen::cob_id::error_control + node),
              link::IdentifierFilter::only(canopen::cob_id::sdo_response + master)});
    StateWatch watch(node, service.state);
    bus.add_listener(watch);
    const auto sent = send_command(bus, service, node, master, time_out);
    auto end = BusLoop::End::done;
    if (sent && arguments.wait) end = bus.run([&] { return watch.seen(); }, bus.now() + time_out);
    bus.remove_listener(watch);
    if (!sent) return complain(exit_code::failed, sent.error());
    if (end != BusLoop::End::done) {
      const bool boots = service.state == NmtState::initialising;
      return complain_of(end, bus,
                         fmt::format("node {} does not show {} within {}", node,
                                     boots ? "its boot-up message" : canopen::name(service.state),
                                     text::describe_duration(time_out)));
    }
    const std::string whom = all ? "all nodes" : fmt::format("node {}", node);
    if (arguments.bus.json) {
      text::Json line;
      line["command"] = service.name;
      line["node"] = node;
      if (master != 0) line["master"] = master;
      if (arguments.wait) line["state"] = canopen::name(service.state);
      print_json(line);
    } else if (!arguments.wait && master != 0) {
      print_line("{} for {} requested of master {}", service.name, whom, master);
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

void build_nmt_command(Command& nmt, int& exit_code) {
  const auto arguments = std::make_shared<NmtArguments>();
  nmt.require_subcommand(1);
  nmt.footer(
      "NMT commands are not confirmed: without --wait, done means sent.\n"
      "An NMT master does not hear the command of somebody else: --master has the master send it (1F82H, "
      "request NMT), so\n"
      "that it knows. A slave that is reset so is booted anew; \"all\" then means the master, too. It has to "
      "be the active\n"
      "NMT master.\n"
      "Exit code: 0 done, 1 no bus, or the node did not do it, 2 wrong command line.");
  for (const Service& service : services) {
    Command* command = nmt.add_subcommand(service.name, service.help);
    command->add_option("NODE", arguments->node, "node-ID 1 to 127, or all")->required();
    command->add_flag("--wait", arguments->wait,
                      "wait until the node's heartbeat (after a reset: its boot-up message) shows it");
    command->add_option("--master", arguments->master,
                        "node-ID of the NMT master that is to send it, asked by SDO (1F82H, request NMT)");
    add_bus_options(*command, arguments->bus, "for --wait and --master");
    command->callback([arguments, &service, &exit_code] { exit_code = command_node(*arguments, service); });
  }
}

}  // namespace

void add_nmt_command(Command& app, int& exit_code) {
  app.add_subcommand("nmt", "Send NMT commands to the nodes of a bus",
                     [&exit_code](Command& nmt) { build_nmt_command(nmt, exit_code); });
}

}  // namespace canopus::cli
