// Commands that reach the module through its PLC.

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/cli/module_settings/configure_command.hpp"
#include "canopus/cli/module_settings/module_access.hpp"
#include "canopus/cli/module_settings/settings_file.hpp"
#include "canopus/cli/module_settings/shown_data.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/plc_module.hpp"
#include "canopus/plant/catalogue/error_history.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

using client::PlcModule;
using module_settings::ModuleProject;
using Json = text::Json;

constexpr unsigned most_nodes = 127;

void print_step(const module_settings::TransferStep& step, bool json) {
  if (json) {
    print_json(Json{{"step", step.text}, {"good", step.good}});
  } else if (step.good) {
    print_line("{}: done", step.text);
  } else {
    print_error("canopus configure: {}", step.text);
  }
}

void print_differences(const std::vector<module_settings::Difference>& differences, bool json) {
  for (const module_settings::Difference& each : differences) {
    if (json) {
      print_json(Json{{"field", each.where}, {"device", each.device}, {"project", each.project}});
    } else {
      print_line("{}: device {}, project {}", each.where, each.device, each.project);
    }
  }
}

/// "1018", "1018:02", "0x1018:0x02"
std::expected<module_settings::ObjectNumber, std::string> object_of(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '0' && i + 1 < text.size() && (text[i + 1] == 'x' || text[i + 1] == 'X')) {
      ++i;
    } else {
      plain += text[i];
    }
  }
  const auto object = text::parse_object(plain);
  if (!object) return std::unexpected(object.error());
  return module_settings::ObjectNumber{object->index, object->sub};
}

struct DataLength {
  std::string_view name;
  std::size_t bytes;  ///< 0: as many as the text has
};
constexpr std::array lengths{DataLength{"STRING", 0},        DataLength{"BYTE_LENGTH_1", 1},
                             DataLength{"BYTE_LENGTH_2", 2}, DataLength{"BYTE_LENGTH_4", 4},
                             DataLength{"BYTE_LENGTH_6", 6}, DataLength{"BYTE_LENGTH_8", 8}};

std::expected<std::vector<std::uint8_t>, std::string> data_of(const std::string& text,
                                                              std::string_view length) {
  const auto found = std::ranges::find(lengths, length, &DataLength::name);
  if (found->bytes == 0) return std::vector<std::uint8_t>(text.begin(), text.end());
  const auto negative = text.starts_with('-') ? ascii::parse_number<std::int64_t>(text) : std::nullopt;
  const auto value = negative ? std::optional(static_cast<std::uint64_t>(*negative))
                              : ascii::parse_number_with_prefix<std::uint64_t>(text);
  const unsigned unused = 64 - 8 * static_cast<unsigned>(found->bytes);
  const bool fits = negative ? (*negative << unused >> unused) == *negative
                             : value && (*value << unused >> unused) == *value;
  if (!fits) {
    return std::unexpected(fmt::format("\"{}\" is no number of {}; hexadecimal ones begin with 0x", text,
                                       ascii::counted(found->bytes, "byte")));
  }
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < found->bytes; ++i) bytes.push_back(static_cast<std::uint8_t>(*value >> 8 * i));
  return bytes;
}

/// A line of an answer: its name and its value, or both as a JSON object.
void print_named(std::string_view name, const std::string& value, int width, bool json,
                 std::string_view indent = "") {
  if (json) {
    print_json(Json{{"name", name}, {"value", value}});
  } else {
    print_line("{}{:<{}} {}", indent, name, width, value);
  }
}

void print_result(std::string_view result, bool json) {
  if (json) {
    print_json(Json{{"result", result}});
  } else {
    print_line("{}", result);
  }
}

constexpr std::array<std::string_view, 4> states{"Stopped", "Pre-operational", "Operational", "?"};

/// Prints the errors outside the error status: failures of nodes, of the last command, of message slots.
int print_other_errors(PlcModule& module, const module::ErrorTables& tables, std::uint16_t function_mode,
                       bool json) {
  module::ErrorTables others = tables;
  std::vector<module::ErrorWords> rows;
  for (const module::ErrorWords& row : tables.words) {
    using enum module::ErrorWords::Kind;
    if (row.kind != bits && row.kind != address) rows.push_back(row);
  }
  others.words = rows;
  std::string failure;
  std::uint32_t first = 0;
  std::vector<std::uint16_t> words;
  const auto read = [&](std::uint32_t address) -> std::uint16_t {
    if (address < first || address - first >= words.size()) {
      const auto row = std::ranges::find_if(rows, [address](const module::ErrorWords& one) {
        return one.first <= address && address <= one.last;
      });
      constexpr std::uint32_t of_command = 5;
      first = address;
      const std::uint32_t count = row == rows.end() ? 1 : std::max(row->last - address + 1, of_command);
      auto found = failure.empty() ? module.read_words(address, count) : decltype(module.read_words(0, 0)){};
      if (failure.empty() && !found) failure = found.error();
      words = failure.empty() ? std::move(*found) : std::vector<std::uint16_t>{};
    }
    return words.empty() ? std::uint16_t{0} : words[address - first];
  };
  for (const plant::ErrorLine& line : plant::errors_in_words(others, function_mode, read)) {
    print_named(line.where, (line.code.empty() ? "" : line.code + " ") + line.meaning, 27, json);
  }
  return failure.empty() ? configure_code::done : configure_failed(configure_code::failed, failure);
}

}  // namespace

int read_from_module(const ConfigureArguments& arguments) {
  auto file = ChangingProject::open(arguments.file);
  if (!file) return configure_failed(configure_code::usage, file.error());
  return with_project(arguments, [&](ModuleProject& project, client::PlcClient&, PlcModule& module,
                                     module_settings::PdoRange area) {
    const auto read = module_settings::read_module(project, arguments.part, area,
                                                   static_cast<std::uint8_t>(arguments.node), module);
    if (!read) return configure_failed(configure_code::failed, read.error());
    const std::string wrong = file->save(project, fmt::format("read {} of the module", arguments.part));
    return wrong.empty() ? configure_code::done : configure_failed(configure_code::failed, wrong);
  });
}

int compare_with_module(const ConfigureArguments& arguments) {
  return with_project(arguments, [&](ModuleProject& project, client::PlcClient&, PlcModule& module,
                                     module_settings::PdoRange area) {
    const auto found = module_settings::differences(project, arguments.part, area,
                                                    static_cast<std::uint8_t>(arguments.node), module);
    if (!found) return configure_failed(configure_code::failed, found.error());
    print_differences(*found, arguments.json);
    return found->empty() ? configure_code::done : configure_code::different;
  });
}

int write_to_module(const ConfigureArguments& arguments) {
  const auto node = static_cast<std::uint8_t>(arguments.node);
  return with_project(arguments, [&](ModuleProject& project, client::PlcClient& client, PlcModule& module,
                                     module_settings::PdoRange area) {
    const auto findings = project.check();
    for (const module_settings::ProjectFinding& finding : findings) {
      if (finding.is_error)
        return configure_failed(configure_code::different,
                                fmt::format("{}: {}", arguments.file, finding.text));
    }
    const auto stands = module.cpu_stands_still();
    if (!stands) return configure_failed(configure_code::failed, stands.error());
    if (!*stands && !arguments.stop && arguments.yes) {
      return configure_failed(configure_code::in_run,
                              "the CPU module is in RUN: parameters can be written when it is in STOP "
                              "(--stop, or canopus plc stop)");
    }
    const auto before = module_settings::differences(project, arguments.part, area, node, module);
    if (!before) return configure_failed(configure_code::failed, before.error());
    print_differences(*before, arguments.json);
    if (before->empty()) {
      if (!arguments.json) print_line("nothing to write: the module has it all");
      return configure_code::done;
    }
    if (!arguments.yes) {
      if (!arguments.json)
        print_line("{}; nothing is written without --yes", ascii::counted(before->size(), "difference"));
      return configure_code::done;
    }
    if (!*stands) {
      if (const auto stopped = client.operate(client::PlcOperation::stop); !stopped) {
        return configure_failed(configure_code::failed, stopped.error());
      }
    }
    const auto written = module_settings::write_module(
        project, arguments.part, area, node, module,
        [&](const module_settings::TransferStep& step) { print_step(step, arguments.json); });
    if (!*stands) {
      if (const auto run = client.operate(client::PlcOperation::run); !run) {
        return configure_failed(configure_code::failed, "the CPU module stays in STOP: " + run.error());
      }
    }
    if (!written)
      return configure_failed(configure_code::failed,
                              "ended here; what stands above is written, the rest is not");
    const auto after = module_settings::differences(project, arguments.part, area, node, module);
    if (!after)
      return configure_failed(configure_code::failed,
                              "written, but it cannot be read back: " + after.error());
    print_differences(*after, arguments.json);
    if (!after->empty())
      return configure_failed(configure_code::failed,
                              "written, and the module has the values above all the same");
    if (!arguments.json)
      print_line(
          "read back: the same. What the module takes over at its start counts after `canopus configure "
          "reset`");
    return configure_code::done;
  });
}

int scan_through_module(const ConfigureArguments& arguments) {
  const auto area = parse_area(arguments.nodes, most_nodes);
  if (!area) return configure_failed(configure_code::usage, "--nodes: " + area.error());
  return with_selected_module(arguments, [&](client::PlcClient&, PlcModule& module) {
    unsigned found = 0;
    const bool bar = is_terminal(STDERR_FILENO);
    for (std::uint32_t node = area->first; node <= std::min(area->last, most_nodes); ++node) {
      if (bar) show_progress(Line("Current Node ID {}", node));
      if (arguments.progress) print_json(Json{{"current", node}});
      const auto type = module.read_bytes(static_cast<std::uint8_t>(node), {0x1000, 0});
      if (!type) {
        if (type.error().find("abort 0504") == std::string::npos &&
            type.error().find("abort") == std::string::npos) {
          end_progress();
          return configure_failed(configure_code::failed, type.error());
        }
        continue;
      }
      const auto name = module.read_bytes(static_cast<std::uint8_t>(node), {0x1008, 0});
      const std::string text = name ? std::string(name->begin(), name->end()) : std::string();
      ++found;
      if (arguments.json) {
        print_json(Json{{"node", node}, {"name", text}});
      } else {
        print_line("{:>4}  {}", node, text);
      }
    }
    end_progress();
    if (!arguments.json) print_line("{} found", ascii::counted(found, "CANopen node"));
    return configure_code::done;
  });
}

int read_object(const ConfigureArguments& arguments) {
  const auto object = object_of(arguments.object);
  if (!object) return configure_failed(configure_code::usage, object.error());
  return with_selected_module(arguments, [&](client::PlcClient&, PlcModule& module) {
    const auto bytes = module.read_bytes(static_cast<std::uint8_t>(arguments.node), *object);
    if (!bytes) return configure_failed(configure_code::failed, bytes.error());
    print_result("SDO_READ_SUCCESS", arguments.json);
    for (const auto& [name, value] : shown_data(*bytes)) print_named(name, value, 14, arguments.json, "  ");
    return configure_code::done;
  });
}

int write_object(const ConfigureArguments& arguments) {
  const auto object = object_of(arguments.object);
  if (!object) return configure_failed(configure_code::usage, object.error());
  const auto data = data_of(arguments.data, arguments.length);
  if (!data) return configure_failed(configure_code::usage, data.error());
  return with_selected_module(arguments, [&](client::PlcClient&, PlcModule& module) {
    const auto written = module.write_bytes(static_cast<std::uint8_t>(arguments.node), *object, *data);
    if (!written) return configure_failed(configure_code::failed, written.error());
    print_result("SDO_WRITE_SUCCESS", arguments.json);
    return configure_code::done;
  });
}

int show_module_status(const ConfigureArguments& arguments) {
  return with_selected_module(arguments, [&](client::PlcClient&, PlcModule& module) {
    if (arguments.clear) {
      if (const auto cleared = module.clear_errors(); !cleared)
        return configure_failed(configure_code::failed, cleared.error());
    }
    const auto words = module.read_words(20, 21);  // #20 to #40
    if (!words) return configure_failed(configure_code::failed, words.error());
    const auto word = [&](std::size_t address) { return (*words)[address - 20]; };
    const auto print_value = [&](std::string_view name, const std::string& value) {
      print_named(name, value, 27, arguments.json);
    };
    print_value("Function mode", fmt::format("{}", word(21)));
    print_value("Node ID", fmt::format("{}", word(27)));
    print_value("Baud-Rate", fmt::format("{} kbps", word(37) / 10.0));
    print_value("Sampling point", fmt::format("{} %", word(38) / 10.0));
    print_value("NMT state", fmt::format("{}{}", states[word(25) >> 8 & 3],
                                         (word(25) & 0x8000) != 0 ? ", active NMT master" : ""));
    print_value("CAN transmission errors", fmt::format("{}", word(35)));
    print_value("CAN reception errors", fmt::format("{}", word(36)));
    print_value("Error status", fmt::format("{:04X}H", word(29)));
    const auto tool = std::ranges::find(plant::configuration_tools(), module.request_method(),
                                        [](const auto* each) { return each->request_method; });
    const module::ErrorTables& tables = *plant::find_module((*tool)->model)->errors;
    for (const module::ErrorWords& row : tables.words) {
      if (row.kind != module::ErrorWords::Kind::bits) continue;
      for (const module::ErrorText& text : row.texts) {
        if ((word(row.first) >> text.code & 1) != 0)
          print_named(fmt::format("bit {}", text.code), std::string(text.meaning), 6, arguments.json, "  ");
      }
    }
    if (word(39) != 0) print_value("First refused setting", fmt::format("G{}", word(39)));
    return print_other_errors(module, tables, word(21), arguments.json);
  });
}

int reset_module(const ConfigureArguments& arguments) {
  if (!arguments.yes) {
    return configure_failed(configure_code::usage,
                            "the NMT master is reset and started again, and with it the network: --yes");
  }
  return with_selected_module(arguments, [&](client::PlcClient&, PlcModule& module) {
    const auto restarted = module.restart();
    if (!restarted) return configure_failed(configure_code::failed, restarted.error());
    print_line("the NMT master was reset and has started again");
    return configure_code::done;
  });
}

}  // namespace canopus::cli
