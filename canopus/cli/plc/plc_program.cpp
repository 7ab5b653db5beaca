#include "canopus/cli/plc/plc_program.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/plc_access.hpp"
#include "canopus/client/control_client.hpp"
#include "canopus/text/json_fields.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

namespace {

using Json = text::Json;

constexpr const char* default_place = "127.0.0.1:29540";

/// Sends the request, and gives its answer to `then`.
int ask(const PlcArguments& arguments, Json request, const std::function<int(const Json&)>& then) {
  const std::string written = arguments.at.empty() ? default_place : arguments.at;
  const auto place = text::parse_host_and_port(written);
  if (!place) return plc_failed(usage, "--at: " + place.error());
  const auto timeout = text::parse_duration(arguments.timeout);
  if (!timeout) return plc_failed(usage, "--timeout: " + timeout.error());
  if (!arguments.plc.empty()) request["plc"] = arguments.plc;
  const auto answer =
      client::request_control({.host = place->host,
                               .port = place->port,
                               .timeout = std::chrono::ceil<std::chrono::milliseconds>(*timeout)},
                              request);
  if (!answer) return plc_failed(refused, answer.error());
  return then(*answer);
}

/// Prints the whole answer with --json, else what `print` does.
int ask_and_print(const PlcArguments& arguments, Json request,
                  const std::function<void(const Json&)>& print) {
  return ask(arguments, std::move(request), [&](const Json& answer) {
    if (arguments.json) {
      print_json(answer);
    } else {
      print(answer);
    }
    return done;
  });
}

bool is_set(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && *found == true;
}

std::string shown_variable(const Json& answer) {
  return fmt::format("{}  {}{}", field_text(answer, "value"), field_text(answer, "type"),
                     is_set(answer, "forced") ? "  [forced]" : "");
}

void print_variable(const Json& answer) {
  print_line("{}  {}", field_text(answer, "name"), shown_variable(answer));
}

int change_variable(const PlcArguments& arguments, const char* request) {
  if (arguments.values.size() != 1)
    return plc_failed(usage,
                      "VALUE: a variable has one value; expected it in quotes if there are blanks in it");
  return ask_and_print(
      arguments, Json{{"request", request}, {"name", arguments.address}, {"value", arguments.values.front()}},
      print_variable);
}

/// "main.st:12"
std::optional<Json> break_request(const PlcArguments& arguments, const char* request) {
  const std::string_view text = arguments.address;
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  const auto line = ascii::parse_number<std::uint32_t>(text.substr(colon + 1));
  if (!line || *line == 0) return std::nullopt;
  return Json{{"request", request}, {"file", text.substr(0, colon)}, {"line", *line}};
}

int bad_break(const PlcArguments& arguments) {
  return plc_failed(usage,
                    fmt::format("\"{}\": expected a file of the program and a line, such as main.st:12",
                                arguments.address));
}

/// "1 time", "3 times"
std::string counted_field(const Json& object, const char* key, std::string_view noun) {
  return ascii::counted(static_cast<std::uint64_t>(field_number(object, key)), noun);
}

std::string place_text(const Json& status, const Json& place) {
  const Json& files = field_list(status, "files");
  const auto number = static_cast<std::size_t>(field_number(place, "file"));
  const std::string name =
      number < files.size() && files[number].is_string() ? files[number].get<std::string>() : "?";
  return fmt::format("{}:{}", name, field_text(place, "line"));
}

void print_status(const Json& status) {
  print_line("PLC       {} ({})", field_text(status, "plc"), field_text(status, "cpu"));
  const bool is_at_break = field(status, "halted_at").is_object();
  print_line("State     {}{}", field_text(status, "state"),
             is_at_break ? " at " + place_text(status, field(status, "halted_at")) : "");
  if (const Json& error = field(status, "error"); error.is_object())
    print_line("Error     {}  {}, at {:.6f} s", field_text(error, "code_text"), field_text(error, "text"),
               field_number(error, "t"));
  const Json& scan = field(status, "scan");
  print_line("Scan      every {:.3f} ms, {} since RUN; program {:.3f} ms (least {:.3f}, most {:.3f})",
             field_number(scan, "period") * 1e3, field_text(scan, "count"), field_number(scan, "now") * 1e3,
             field_number(scan, "least") * 1e3, field_number(scan, "most") * 1e3);
  for (const Json& task : field_list(status, "tasks")) {
    std::string programs;
    for (const Json& program : field_list(task, "programs"))
      programs += (programs.empty() ? "" : ", ") + (program.is_string() ? program.get<std::string>() : "?");
    print_line("Task      {} ({}): {}; {}", field_text(task, "name"), field_text(task, "kind"), programs,
               counted_field(task, "runs", "time"));
  }
  for (const Json& one : field_list(status, "breaks")) print_line("Break     {}", place_text(status, one));
  for (const Json& one : field_list(status, "forced"))
    print_line("Forced    {} = {}", field_text(one, "name"), field_text(one, "value"));
}

int watch_until(const PlcArguments& arguments, const WatchTimes& times) {
  std::string last;
  const auto print_change = [&](const Json& answer) {
    const std::string shown = shown_variable(answer);
    if (shown == std::exchange(last, shown)) return done;
    if (arguments.json) {
      print_line("{}", answer.dump());
    } else {
      print_line("{:9.3f} s  {}  {}", field_number(answer, "t"), field_text(answer, "name"), shown);
    }
    return done;
  };
  return watch(times, [&](double /*seconds*/) {
    return ask(arguments, Json{{"request", "read variable"}, {"name", arguments.address}}, print_change);
  });
}

}  // namespace

bool is_variable(const PlcArguments& arguments) {
  if (!arguments.at.empty()) return true;
  const std::string_view text = arguments.address;
  if (plc_point(text, arguments)) return false;
  const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.empty() || !is_letter(text.front())) return false;
  if (!std::ranges::all_of(text, [&](char c) {
        return is_letter(c) || is_digit(c) || c == '.' || c == '[' || c == ']' || c == ',';
      }))
    return false;
  // A device whose number is wrong or missing: up to three letters, then digits.
  constexpr std::size_t most_letters = 3;
  const auto digit = static_cast<std::size_t>(std::ranges::find_if(text, is_digit) - text.begin());
  const auto dot = text.find_first_of(".[");
  return digit > most_letters || dot < digit;
}

int read_variable(const PlcArguments& arguments) {
  return ask_and_print(arguments, Json{{"request", "read variable"}, {"name", arguments.address}},
                       print_variable);
}

int write_variable(const PlcArguments& arguments) { return change_variable(arguments, "write variable"); }
int force_variable(const PlcArguments& arguments) { return change_variable(arguments, "force variable"); }

int release_variable(const PlcArguments& arguments) {
  if (arguments.address.empty()) {
    return ask_and_print(arguments, Json{{"request", "release all"}}, [](const Json& answer) {
      print_line("{} released", field_text(answer, "released"));
    });
  }
  return ask_and_print(arguments, Json{{"request", "release variable"}, {"name", arguments.address}},
                       print_variable);
}

int watch_variable(const PlcArguments& arguments) {
  const auto times = watch_times(arguments);
  return times ? watch_until(arguments, *times) : plc_failed(usage, times.error());
}

int control_program(const PlcArguments& arguments, std::string_view request) {
  return ask_and_print(arguments, Json{{"request", request}}, [&](const Json& answer) {
    print_line("{}", request == "single scan" ? "the next scan is executed" : field_text(answer, "state"));
  });
}

int set_break(const PlcArguments& arguments) {
  const auto request = break_request(arguments, "set break");
  if (!request) return bad_break(arguments);
  return ask_and_print(arguments, *request, [](const Json& answer) {
    print_line("{}:{}", field_text(answer, "file"), field_text(answer, "line"));
  });
}

int clear_break(const PlcArguments& arguments) {
  const auto print = [](const Json& answer) {
    print_line("{} left", counted_field(answer, "breaks", "break"));
  };
  if (arguments.address.empty()) return ask_and_print(arguments, Json{{"request", "clear breaks"}}, print);
  const auto request = break_request(arguments, "clear break");
  return request ? ask_and_print(arguments, *request, print) : bad_break(arguments);
}

int change_program(const PlcArguments& arguments) {
  return ask_and_print(arguments, Json{{"request", "change program"}}, [](const Json& answer) {
    print_line("changed; {} global variables and programs", field_list(answer, "variables").size());
  });
}

int show_program(const PlcArguments& arguments) {
  return ask_and_print(arguments, Json{{"request", "program"}}, print_status);
}

}  // namespace canopus::cli
