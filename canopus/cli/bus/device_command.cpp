#include <functional>
#include <memory>

#include <fmt/format.h>

#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/control_client.hpp"
#include "canopus/text/json_fields.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using Json = text::Json;

struct DeviceArguments {
  std::string device, object, value, hold;
  std::string at = "127.0.0.1:29540";
  std::string timeout = "3s";
  bool json = false;
};

/// "3 (03H)" for what may be a pattern of bits.
std::string shown_value(const Json& object) {
  const std::string value = field_text(object, "value");
  const std::string type = field_text(object, "type");
  const auto found = object.find("value");
  if (!type.starts_with("UNSIGNED") || found == object.end() || !found->is_number_unsigned()) return value;
  const int digits = type == "UNSIGNED8" ? 2 : type == "UNSIGNED16" ? 4 : 8;
  return fmt::format("{} ({:0{}X}H)", value, found->get<std::uint64_t>(), digits);
}

std::string state_of(const Json& object) {
  const auto forced = object.find("forced");
  if (forced == object.end() || *forced != true) return "";
  std::string state = "forced";
  if (object.contains("until")) state += " until " + field_text(object, "until") + " s";
  if (object.contains("beneath")) state += ", beneath it " + field_text(object, "beneath");
  return state;
}

void print_objects(const Json& answer) {
  for (const Json& object : field_list(answer, "objects")) {
    const std::string state = state_of(object);
    print_line("{}  {:<16}  {:<10}  {}{}", field_text(object, "object"), shown_value(object),
               field_text(object, "type"), field_text(object, "name"),
               state.empty() ? "" : "  [" + state + "]");
  }
}

void print_devices(const Json& answer) {
  print_line("{:<12} {:>4}  {:<16} {:<16} {}", "bus", "node", "state", "name", "forced");
  for (const Json& device : field_list(answer, "devices")) {
    std::string forced;
    for (const Json& object : field_list(device, "forced")) {
      forced +=
          (forced.empty() ? "" : ", ") + field_text(object, "object") + " = " + field_text(object, "value");
    }
    print_line("{:<12} {:>4}  {:<16} {:<16} {}", field_text(device, "bus"), field_text(device, "node"),
               field_text(device, "state"), field_text(device, "name"), forced.empty() ? "-" : forced);
  }
}

int request_and_print(const DeviceArguments& arguments, const Json& request) {
  const auto complain = [](int code, const std::string& what) {
    print_error("canopus: {}", what);
    return code;
  };
  const auto place = text::parse_host_and_port(arguments.at);
  if (!place) return complain(exit_code::usage, "--at: " + place.error());
  const auto timeout = text::parse_duration(arguments.timeout);
  if (!timeout) return complain(exit_code::usage, "--timeout: " + timeout.error());
  if (!arguments.hold.empty()) {
    if (const auto hold = text::parse_duration(arguments.hold); !hold)
      return complain(exit_code::usage, "--for: " + hold.error());
  }
  const auto answer =
      client::request_control({.host = place->host,
                               .port = place->port,
                               .timeout = std::chrono::ceil<std::chrono::milliseconds>(*timeout)},
                              request);
  if (!answer) return complain(exit_code::failed, answer.error());
  if (arguments.json) {
    print_json(*answer);
  } else if (answer->contains("devices")) {
    print_devices(*answer);
  } else {
    print_objects(*answer);
  }
  return exit_code::done;
}

void build_device_command(Command& device, int& exit_code) {
  const auto arguments = std::make_shared<DeviceArguments>();
  device.require_subcommand(1);
  device.footer(
      "The plant file opens a plant to this command: [plant] control = \"127.0.0.1:29540\".\n"
      "NAME is a device's name, its node-ID, or bus and node-ID (line1:3). OBJECT is INDEX[:SUB] in "
      "hexadecimal\n"
      "or the parameter's name in the device file. A forced value stays, whatever the device, its master or "
      "an\n"
      "SDO puts there, until it is released.\n"
      "Exit code: 0 done, 1 the plant refused or could not be reached, 2 wrong command line.\n"
      "\n"
      "Example: canopus device set io-block 6000:01 3 --for 200ms");
  const auto add = [&](const char* name, const char* help,
                       std::function<Json(const DeviceArguments&)> request) {
    Command& command = *device.add_subcommand(name, help);
    command.add_option("--at", arguments->at, "control server of the plant")
        ->type_name("HOST:PORT")
        ->capture_default_str();
    command.add_option("--timeout", arguments->timeout, "to connect, and for the answer")
        ->capture_default_str();
    command.add_flag("--json", arguments->json, "The answer as one JSON object");
    // The shared pointer keeps the arguments as long as the command.
    command.callback([arguments, &exit_code, request = std::move(request)] {
      exit_code = request_and_print(*arguments, request(*arguments));
    });
    return &command;
  };
  const auto add_name = [&](Command& command) {
    command.add_option("NAME", arguments->device, "the device")->required();
  };
  const auto add_object = [&](Command& command, bool required) {
    command.add_option("OBJECT", arguments->object, "6000:01, or a parameter's name")->required(required);
  };
  const auto with_object = [](Json request, const DeviceArguments& all) {
    request["device"] = all.device;
    if (!all.object.empty()) request["object"] = all.object;
    return request;
  };

  auto* setting = add("set", "Force a value", [with_object](const DeviceArguments& all) {
    Json request = with_object({{"request", "set"}}, all);
    request["value"] = all.value;
    if (!all.hold.empty()) request["for"] = all.hold;
    return request;
  });
  add_name(*setting);
  add_object(*setting, true);
  setting->add_option("VALUE", arguments->value, "1234, -5, 0x4D2, 1.5, true")->required();
  setting->add_option("--for", arguments->hold, "release it after this time of the plant");

  auto* getting = add("get", "Show one value, or all of a device", [with_object](const DeviceArguments& all) {
    return with_object({{"request", "get"}}, all);
  });
  add_name(*getting);
  add_object(*getting, false);

  auto* releasing =
      add("release", "Release one value, or all of a device", [with_object](const DeviceArguments& all) {
        return with_object({{"request", "release"}}, all);
      });
  add_name(*releasing);
  add_object(*releasing, false);

  add("list", "List the devices and their forced values", [](const DeviceArguments&) {
    return Json{{"request", "list"}};
  });
}

}  // namespace

void add_device_command(Command& app, int& exit_code) {
  app.add_subcommand("device", "Show and force the values of the devices of a running plant",
                     [&exit_code](Command& device) { build_device_command(device, exit_code); });
}

}  // namespace canopus::cli
