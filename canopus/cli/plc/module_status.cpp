#include <memory>
#include <utility>

#include <fmt/format.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/plc/module_command.hpp"
#include "canopus/client/control_client.hpp"
#include "canopus/text/json_fields.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using Json = text::Json;

struct ModuleStatusArguments {
  std::string module;
  std::string at = "127.0.0.1:29540";
  std::string timeout = "3s";
  bool json = false;
};

std::string or_dash(std::string value) { return value.empty() ? "-" : std::move(value); }

std::string bit_rate_of(const Json& module) {
  const auto rate = module.is_object() ? module.find("bit_rate") : module.end();
  if (!module.is_object() || rate == module.end() || !rate->is_number_unsigned()) return "-";
  return fmt::format("{} kbit/s", rate->get<std::uint64_t>() / 1000);
}

std::string details_of(const Json& error) {
  std::string shown;
  const auto details = error.is_object() ? error.find("details") : error.end();
  if (!error.is_object() || details == error.end() || !details->is_object()) return shown;
  for (const auto& [name, value] : details->items()) {
    shown += fmt::format(
        "{}{} {}", shown.empty() ? "; " : ", ", name,
        value.is_number_unsigned() ? fmt::format("{0} ({0:X}H)", value.get<std::uint64_t>()) : value.dump());
  }
  return shown;
}

/// Prints the present errors and the error history; module diagnostics are printed above.
void print_history(const Json& module, Output& out) {
  constexpr std::size_t most_shown = 20;
  for (const Json& group : field_list(module, "history")) {
    std::size_t count = 0;
    for (const Json& line : field_list(group, "lines")) {
      const std::string where = field_text(line, "where");
      if (where == "module diagnostics") continue;
      if (count == 0) out.line("  {}", field_text(group, "title"));
      if (++count > most_shown) continue;
      const bool has_time = line.is_object() && line.contains("t") && line["t"].is_number();
      const std::string time = has_time ? fmt::format("{:.3f} s", line["t"].get<double>()) : "";
      std::string shown;
      for (const std::string& part : {time, where, field_text(line, "code"), field_text(line, "meaning")}) {
        if (!part.empty()) shown += (shown.empty() ? "" : "  ") + part;
      }
      out.line("    {}", shown);
    }
    if (count > most_shown) out.line("    and {} before them (--json)", count - most_shown);
  }
}

int request_and_print(const ModuleStatusArguments& arguments) {
  const auto complain = [](int code, const std::string& what) {
    print_error("canopus: {}", what);
    return code;
  };
  const auto place = text::parse_host_and_port(arguments.at);
  if (!place) return complain(2, "--at: " + place.error());
  const auto timeout = text::parse_duration(arguments.timeout);
  if (!timeout) return complain(2, "--timeout: " + timeout.error());
  Json request{{"request", "modules"}};
  if (!arguments.module.empty()) request["module"] = arguments.module;
  const auto answer =
      client::request_control({.host = place->host,
                               .port = place->port,
                               .timeout = std::chrono::ceil<std::chrono::milliseconds>(*timeout)},
                              request);
  if (!answer) return complain(1, answer.error());
  if (arguments.json) {
    print_json(*answer);
  } else {
    print_modules(*answer, standard_output());
  }
  return 0;
}

}  // namespace

void print_modules(const Json& answer, Output& out) {
  bool is_first = true;
  for (const Json& module : field_list(answer, "modules")) {
    if (!std::exchange(is_first, false)) out.line("");
    const std::string plc = field_text(module, "plc");
    out.line("{}{}{}", field_text(module, "module"), plc.empty() ? "" : ", PLC " + plc,
             field_text(module, "on") == "true" ? "" : ": off");
    std::string leds;
    for (const Json& led : field_list(module, "leds")) {
      leds += fmt::format("{}{} {}", leds.empty() ? "" : ", ", field_text(led, "name"),
                          field_text(led, "pattern"));
    }
    out.line("  LED information  {}", or_dash(leds));
    const std::string mode = field_text(module, "function_mode");
    const std::string name = field_text(module, "function_mode_name");
    out.line("  Function mode    {}{}", or_dash(mode), name.empty() ? "" : " (" + name + ")");
    out.line("  Baud rate        {}", bit_rate_of(module));
    out.line("  Node ID          {}", or_dash(field_text(module, "node")));
    for (const Json& error : field_list(module, "errors")) {
      out.line("  Error            {}H {}: {}{}", field_text(error, "code"), field_text(error, "class"),
               field_text(error, "overview"), details_of(error));
    }
    print_history(module, out);
  }
  if (is_first) out.line("the plant has no module");
}

void add_module_status(Command& module_command, int& exit_code) {
  const auto arguments = std::make_shared<ModuleStatusArguments>();
  Command* status = module_command.add_subcommand(
      "status", "The modules of a running plant: LEDs, function mode, baud rate, node-ID, errors in words");
  status->add_option("NAME", arguments->module, "one module, as the plant file calls it, or \"RJ71CN91 U0\"");
  status->add_option("--at", arguments->at, "control server of the plant")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  status->add_option("--timeout", arguments->timeout, "to connect, and for the answer")
      ->capture_default_str();
  status->add_flag("--json", arguments->json, "The answer as one JSON object");
  status->footer(
      "The plant file opens a plant to this command: [plant] control = \"127.0.0.1:29540\".\n"
      "A module that is offline in a Layer 2 mode has no baud rate, and in a Layer 2 mode none has a "
      "node-ID.\n"
      "Exit code: 0 done, 1 the plant refused or could not be reached, 2 wrong command line.");
  // The shared pointer keeps the arguments as long as the command.
  status->callback([arguments, &exit_code] { exit_code = request_and_print(*arguments); });
}

}  // namespace canopus::cli
