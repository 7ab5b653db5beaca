#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/client/gateway/gateway_server.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

struct GatewayArguments {
  BusOptions bus;
  std::string listen = "127.0.0.1:7600";
  std::string node;
  std::vector<std::string> allowed;
};

/// Reports a change of the controller's error state to the gateway's clients.
void report_state(client::Gateway& gateway, can::ErrorState& before, can::ErrorState now) {
  if (now == before) return;
  before = now;
  if (now == can::ErrorState::error_passive) gateway.controller_error(client::GatewayError::error_passive);
  if (now == can::ErrorState::bus_off) gateway.controller_error(client::GatewayError::bus_off);
}

/// An unread standard error must not block the clients: a line that does not fit is dropped.
void report_if_it_fits(std::string_view source, std::string_view sentence) {
  pollfd error{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
  const bool fits = ::poll(&error, 1, 0) == 1 && (error.revents & POLLOUT) != 0;
  if (fits) print_error("canopus: {}: {}", source, sentence);
}

int serve(const GatewayArguments& arguments, const char* version) {
  const unsigned node = arguments.node.empty() ? 0 : parse_node(arguments.node);
  if (!arguments.node.empty() && node == 0) {
    return complain(
        exit_code::usage,
        fmt::format("--node-id: \"{}\" is not a node; expected a node-ID 1 to 127", arguments.node));
  }
  const auto place = text::parse_host_and_port(arguments.listen);
  if (!place) return complain(exit_code::usage, "--listen: " + place.error());
  std::vector<link::Network> networks;
  for (const std::string& text : arguments.allowed) {
    const auto network = link::parse_network(text);
    if (!network) return complain(exit_code::usage, "--allow: " + network.error());
    networks.push_back(*network);
  }
  const auto host = link::parse_internet_address(place->host);
  if (host && !link::is_loopback(*host) && networks.empty()) {
    return complain(exit_code::usage,
                    fmt::format("--listen: other machines can reach {}; say which may connect: "
                                "--allow 192.168.1.0/24",
                                place->host));
  }
  return with_bus(
      arguments.bus,
      [&](BusLoop& bus, can::Duration) {
        client::Gateway gateway(bus, static_cast<std::uint8_t>(node), version);
        gateway.set_restart([&bus](std::uint32_t bit_rate) { return bus.restart(bit_rate); });
        bus.set_complaint([](std::string_view text) { report_if_it_fits("the bus", text); });
        client::GatewayServer server(
            bus.io(), gateway, [&bus] { return bus.now(); }, {.allowed = link::AllowList(networks)},
            [](std::string_view sentence) { report_if_it_fits("gateway", sentence); });
        if (const auto listening = server.listen(place->host, place->port); !listening) {
          return complain(exit_code::failed, "cannot listen on " + listening.error());
        }
        can::ErrorState state = can::ErrorState::error_active;
        bus.set_status_listener(
            [&](const link::ControllerStatus& status) { report_state(gateway, state, status.state); });
        bus.add(server);
        print_line("gateway on {}:{}", place->host, server.port());
        const auto end = bus.run([] { return false; });
        bus.remove(server);
        bus.set_status_listener({});
        return end == BusLoop::End::interrupted ? exit_code::done : complain_of(end, bus, "");
      },
      BusTime::real);
}

void build_gateway_command(Command& command, int& exit_code, const char* version) {
  const auto arguments = std::make_shared<GatewayArguments>();
  add_bus_options(command, arguments->bus, "for joining the bus", false);
  command.add_option("--listen", arguments->listen, "Address for clients; port 0 for a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  command.add_option("--node-id", arguments->node, "the gateway's own node-ID, for its heartbeat")
      ->type_name("1-127");
  command.add_old_spelling({.old = "--node", .now = "--node-id"});
  command.add_option("--allow", arguments->allowed, "an address or network that may connect, too")
      ->type_name("NETWORK");
  command.footer(
      "Commands and answers: docs/gateway.md. Exit code: 0 ended by Ctrl-C or SIGTERM, 1 no bus or no port,\n"
      "2 wrong command line.");
  command.callback([arguments, &exit_code, version] { exit_code = serve(*arguments, version); });
}

}  // namespace

void add_gateway_command(Command& app, int& exit_code, const char* version) {
  app.add_subcommand(
      "gateway", "Connect clients to a bus over TCP, in the ASCII of CiA 309-3",
      [&exit_code, version](Command& command) { build_gateway_command(command, exit_code, version); });
}

}  // namespace canopus::cli
