#include "canopus/cli/bus/bus_command.hpp"

#include "canopus/ascii/number.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

void add_bus_option(Command& command, std::string& bus) {
  command
      .add_option("--bus", bus,
                  "socketcand:HOST:PORT/BUS (the name is not needed with canopus run), socketcan:INTERFACE, "
                  "slcan:DEVICE@BITRATE, udp-multicast:GROUP:PORT or cannelloni:HOST:PORT")
      ->type_name("ADDRESS")
      ->capture_default_str();
}

void add_bus_options(Command& command, BusOptions& options, const char* time_out, bool with_json) {
  add_bus_option(command, options.bus);
  command.add_option("--timeout", options.time_out, time_out)->type_name("TIME")->capture_default_str();
  if (with_json) command.add_flag("--json", options.json, "Print JSON, one object per line");
}

int complain(int code, std::string_view message) {
  print_error("canopus: {}", message);
  return code;
}

int with_bus(const BusOptions& options, const std::function<int(BusLoop&, can::Duration)>& action,
             BusTime time) {
  const auto address = link::parse_bus_address(options.bus);
  if (!address) return complain(exit_code::usage, "--bus: " + address.error());
  const auto time_out = text::parse_duration(options.time_out);
  if (!time_out) return complain(exit_code::usage, "--timeout: " + time_out.error());
  if (*time_out < std::chrono::milliseconds(1)) {
    return complain(exit_code::usage, "--timeout: expected at least 1ms");
  }
  // Joining a server takes longer than the nodes' answers.
  auto bus = BusLoop::open(*address, std::max<can::Duration>(*time_out, std::chrono::seconds(3)));
  if (!bus) return complain(exit_code::failed, bus.error());
  if (time == BusTime::of_this_process) (*bus)->extend_timeouts();
  (*bus)->set_complaint([](std::string_view text) { print_error("canopus: the bus: {}", text); });
  return action(**bus, *time_out);
}

int complain_of(BusLoop::End end, const BusLoop& bus, std::string_view time_over) {
  switch (end) {
    case BusLoop::End::done: break;
    case BusLoop::End::time_over: return complain(exit_code::failed, time_over);
    case BusLoop::End::interrupted: return complain(exit_code::failed, "interrupted");
    case BusLoop::End::lost: return complain(exit_code::failed, bus.failure());
  }
  return exit_code::done;
}

}  // namespace canopus::cli
