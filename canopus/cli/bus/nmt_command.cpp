#include <array>
#include <expected>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/bus/node_names.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/client/nmt_request.hpp"
#include "canopus/client/sdo_transfer_on_bus.hpp"

namespace canopus::cli {
namespace {

using canopen::NmtState;
using client::NmtRequest;
using client::NmtService;

struct NmtArguments {
  BusOptions bus;
  NodeNamesOptions names;
  std::string node;
  std::string
      master{};  ///< node-ID of the active NMT master that is to send the command; empty: this program does
  bool wait = false;
};

/// Sends the command, or has the master send it. The error is a sentence.
std::expected<void, std::string> send_command(BusLoop& bus, const NmtRequest& request,
                                              can::Duration time_out) {
  if (request.master == 0) {
    if (bus.send(request.frame())) return {};
    return std::unexpected(std::string(client::bus_takes_no_frame));
  }
  client::SdoOnBus sdo(bus, request.master, time_out, false);
  const auto written = sdo.write(request.object(), std::array{request.service->request});
  if (written) return {};
  return std::unexpected(request.refused(written.error().reason));
}

/// The node-ID in place of a node's name. Nothing after the mistake was printed, with the option before it.
std::optional<std::string> number_of(const NmtArguments& arguments, const std::string& node,
                                     std::string_view option = "") {
  if (node.empty() || node == "all") return node;
  const auto found = find_node_id(arguments.names, node);
  if (found) return std::to_string(*found);
  if (!found.error().empty()) (void)complain(exit_code::usage, std::string(option) + found.error());
  return std::nullopt;
}

int command_node(const NmtArguments& arguments, const NmtService& service) {
  const auto node = number_of(arguments, arguments.node);
  const auto master = number_of(arguments, arguments.master, "--master: ");
  if (!node || !master) return exit_code::usage;
  const auto request = NmtRequest::parse(service, *node, *master, arguments.wait);
  if (!request) return complain(exit_code::usage, request.error());
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    bus.need({link::IdentifierFilter::only(canopen::cob_id::error_control + request->node),
              link::IdentifierFilter::only(canopen::cob_id::sdo_response + request->master)});
    client::NmtStateWatch watch(*request);
    bus.add_listener(watch);
    const auto sent = send_command(bus, *request, time_out);
    auto end = BusLoop::End::done;
    if (sent && request->waits) end = bus.run([&] { return watch.seen(); }, bus.now() + time_out);
    bus.remove_listener(watch);
    if (!sent) return complain(exit_code::failed, sent.error());
    if (end != BusLoop::End::done) return complain_of(end, bus, request->not_shown(time_out));
    const std::string whom = request->addressee();
    if (arguments.bus.json) {
      print_json(request->row());
    } else if (!request->waits && request->master != 0) {
      print_line("{} for {} requested of master {}", service.name, whom, request->master);
    } else if (!request->waits) {
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
      "An NMT master does not receive commands of other nodes: with --master the master sends it (1F82H, "
      "request NMT), so\n"
      "that it knows. A slave that is reset so is booted anew; \"all\" then means the master, too. It has to "
      "be the active\n"
      "NMT master.\n"
      "Exit code: 0 done, 1 no bus, or the node did not do it, 2 wrong command line.");
  for (const NmtService& service : client::nmt_services()) {
    Command* command = nmt.add_subcommand(service.name, service.help);
    command->add_option("NODE", arguments->node, "node-ID 1 to 127, or name, or all")->required();
    command->add_flag("--wait", arguments->wait,
                      "wait until the node's heartbeat (after a reset: its boot-up message) shows it");
    command
        ->add_option("--master", arguments->master,
                     "the NMT master that is to send it, asked by SDO (1F82:00, request NMT)")
        ->type_name("NODE");
    add_node_names_options(*command, arguments->names, "names of nodes");
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
