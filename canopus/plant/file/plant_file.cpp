#include "canopus/plant/file/plant_file.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/can/controller.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/file/plant_references.hpp"
#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/plc/rack/scan.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {
namespace {

/// Every table of an array of tables in which there is no mistake; unknown keys do not count.
template <typename Section>
std::vector<Section> read_good(text::TableReader& table, std::string_view key, const std::string& what,
                               Section (*read)(text::TableReader&)) {
  std::vector<Section> sections;
  table.tables(key, what, [&](text::TableReader& inner) {
    const std::size_t before = inner.errors().size();
    Section section = read(inner);
    if (inner.errors().size() == before) sections.push_back(std::move(section));
  });
  return sections;
}

constexpr std::string_view node_id_expected = "a node-ID is 1 to 127";

BehaviourSection read_behaviour(text::TableReader& table) {
  static constexpr std::string_view kinds[] = {"sine", "ramp", "counter", "echo", "noise"};
  BehaviourSection behaviour{.place = table.place()};
  behaviour.object = table.parsed("object", text::parse_object, true).value_or(text::ObjectName{});
  behaviour.kind = table.text("kind", true).value_or("");
  if (!behaviour.kind.empty() && std::ranges::find(kinds, behaviour.kind) == std::end(kinds)) {
    table.error("kind", fmt::format("expected one of {}", fmt::join(kinds, ", ")));
  }
  behaviour.low = table.number("low");
  behaviour.high = table.number("high");
  if (behaviour.low && behaviour.high && *behaviour.low > *behaviour.high) {
    table.error("high", fmt::format("must not be below low = {}", *behaviour.low));
  }
  behaviour.step = table.number("step");
  behaviour.period = table.parsed("period", text::parse_duration);
  if (behaviour.period && *behaviour.period < std::chrono::milliseconds(1)) {
    table.error("period", "expected at least 1ms");
  }
  behaviour.source = table.parsed("source", text::parse_object, behaviour.kind == "echo");
  if (const auto seed = table.integer("seed", 0, INT64_MAX, "a seed is 0 or more")) {
    behaviour.seed = static_cast<std::uint64_t>(*seed);
  }
  return behaviour;
}

std::uint32_t read_bit_rate(text::TableReader& table, bool required) {
  constexpr std::string_view expected = "expected a bit rate in bit/s, for example 250_000";
  std::vector<text::TableSchema::Range> known;
  for (const std::uint32_t rate : can::bit_rates) known.push_back({rate, rate});
  const auto rate =
      table.integer_of("bit_rate", std::move(known), expected,
                       fmt::format("expected one of {} bit/s", fmt::join(can::bit_rates, ", ")), required);
  return static_cast<std::uint32_t>(rate.value_or(0));
}

BusSection read_bus(text::TableReader& table) {
  BusSection bus{.place = table.place(), .serve_place = table.place("serve")};
  bus.name = table.text("name", true).value_or("");
  bus.bit_rate = read_bit_rate(table, true);
  if (bus.bit_rate == 0) bus.bit_rate = 250'000;  // so that the nodes on it can be checked
  bus.socketcand =
      table.parsed("serve", [](std::string_view text) -> std::expected<text::HostAndPort, std::string> {
        constexpr std::string_view protocol = "socketcand:";
        if (!text.starts_with(protocol)) {
          return std::unexpected(fmt::format(
              "\"{}\" is not a way to serve a bus; expected \"socketcand:127.0.0.1:29536\"", text));
        }
        return text::parse_host_and_port(text.substr(protocol.size()));
      });
  bus.allowed = read_allowed(table, "serve", "socketcand protocol", bus.socketcand);
  bus.announced = table.boolean("announce").value_or(false);
  if (bus.announced && !bus.socketcand)
    table.error("announce", "nothing to announce: the bus has no serve = \"socketcand:...\"");
  bus.faults = read_good<FaultSection>(table, "fault", "bus.fault", read_fault);
  read_line(table, bus);
  read_link(table, bus);
  bus.project_place = table.place("project");
  bus.project = table.text("project").value_or("");
  constexpr std::size_t most_networks = 1000;
  bus.project_network = static_cast<std::size_t>(
      table.integer("project_network", 1, most_networks, "networks of a project are counted from 1")
          .value_or(1));
  return bus;
}

/// 1 to 127, "unconfigured", or 0 when there is none.
std::uint8_t read_device_node(text::TableReader& table) {
  constexpr std::string_view expected =
      "a node-ID is 1 to 127, or \"unconfigured\" for a device that gets it by LSS";
  const toml::node* node = table.find("node");
  if (node != nullptr && node->as_integer() == nullptr) {
    const auto* word = node->as_string();
    if (word != nullptr && word->get() == "unconfigured") return no_node_id;
    table.error("node", expected);
    return 0;
  }
  return static_cast<std::uint8_t>(table.integer("node", 1, 127, node_id_expected).value_or(0));
}

DeviceSection read_device(text::TableReader& table) {
  DeviceSection device{
      .place = table.place(), .eds_place = table.place("eds"), .store_place = table.place("store")};
  device.bus = table.text("bus").value_or("");
  device.name = table.text("name").value_or("");
  device.eds = table.text("eds").value_or("");  // or that of the bus's project
  device.node = read_device_node(table);
  device.lss = table.boolean("lss");
  if (device.node == no_node_id && device.lss == false) {
    table.error("lss", "a device without a node-ID gets one by LSS: true, or left out");
  }
  device.start = table.parsed("start", text::parse_duration).value_or(can::Duration{});
  device.store = table.text("store").value_or("");
  device.bit_rate = read_bit_rate(table, false);
  device.listen_only = table.boolean("listen_only").value_or(false);
  if (const auto order = table.text("transmit_order")) {
    if (*order != "identifier" && *order != "fifo")
      table.error("transmit_order", "expected \"identifier\" or \"fifo\"");
    device.transmit_fifo = *order == "fifo";
  }
  device.transmit_queue = static_cast<std::size_t>(
      table.integer("transmit_queue", 1, 65535, "a transmit queue holds 1 to 65535 frames").value_or(128));
  device.short_sdo_requests = table.boolean("short_sdo_requests").value_or(false);
  device.objects = read_objects(table, "objects");
  device.behaviours = read_good<BehaviourSection>(table, "behaviour", "device.behaviour", read_behaviour);
  device.scripts = read_good<ScriptSection>(table, "script", "device.script", read_script);
  device.playbacks = read_good<PlaybackSection>(table, "playback", "device.playback", read_playback);
  table.table("drive", "device.drive", "expected a table, written as [device.drive]",
              [&](text::TableReader& inner) { device.drive = read_drive(inner); });
  device.usable = !table.is_wrong("eds") && !table.is_wrong("node") && !table.is_wrong("bus");
  return device;
}

/// receive = [1, 2], or [{ pdo = 1, at = "G10000" }, ...]
std::vector<SlaveSection::Link> read_links(text::TableReader& table, std::string_view key) {
  std::vector<SlaveSection::Link> links;
  table.elements(key, [&](const toml::node& element) {
    SlaveSection::Link link{.place = text::place_of(element.source())};
    const auto valid_number = [](std::int64_t number) { return number >= 1 && number <= 512; };
    constexpr std::string_view expected = "expected a PDO number 1 to 512, or { pdo = 1, at = \"G10000\" }";
    if (const auto* number = element.as_integer(); number != nullptr && valid_number(number->get())) {
      link.pdo = static_cast<std::uint16_t>(number->get());
    } else if (const auto* inner_table = element.as_table()) {
      text::TableReader inner(*inner_table, std::string(key), table.errors());
      link.pdo = static_cast<std::uint16_t>(
          inner.integer("pdo", 1, 512, "a PDO number is 1 to 512", true).value_or(1));
      link.address = inner.parsed("at", text::parse_buffer_address);
      inner.finish();
    } else {
      return table.error(link.place,
                         fmt::format("{} = {}: {}", key, text::describe_found(element), expected));
    }
    links.push_back(link);
  });
  return links;
}

SlaveSection read_slave(text::TableReader& table) {
  const bool by_name = table.find("name") != nullptr;
  SlaveSection slave{.place = table.place(by_name ? "name" : "node"), .eds_place = table.place("eds")};
  slave.name = table.text("name").value_or("");
  constexpr std::string_view expected = "a node-ID is 1 to 127; or name = the name of a device or module";
  slave.node = static_cast<std::uint8_t>(table.integer("node", 1, 127, expected, !by_name).value_or(0));
  if (by_name && slave.node != 0) table.error("name", "expected node or name, not both");
  slave.eds = table.text("eds").value_or("");
  slave.mandatory = table.boolean("mandatory").value_or(true);
  slave.receive = read_links(table, "receive");
  slave.send = read_links(table, "send");
  return slave;
}

/// A module configured by CANopen Builder has no other configuration.
void check_download(text::TableReader& table, const ModuleSection& module) {
  const CatalogueEntry* entry = find_module(module.model);
  if (entry == nullptr) return;
  if (entry->download == nullptr) {
    if (module.download) table.error("download", fmt::format("the {} takes none", module.model));
    return;
  }
  if (module.master || module.all_slaves || !module.slaves.empty()) {
    table.error(module.master       ? "master"
                : module.all_slaves ? "slaves"
                                    : "slave",
                fmt::format("the {} has its node list in [plc.module.download]", module.model));
  }
  if (module.exchange) {
    table.error("exchange", fmt::format("the {} exchanges process data by itself", module.model));
  }
}

ModuleSection read_module(text::TableReader& table, const plc::CpuModel& cpu) {
  ModuleSection module{
      .place = table.place(), .name_place = table.place("name"), .slaves_place = table.place("slaves")};
  module.name = table.text("name").value_or("");
  module.model = table.text("model", true).value_or("");
  if (const CatalogueEntry* entry = find_module(module.model)) {
    module.model = entry->data_sheet->model;  // as its maker writes it
  } else if (!module.model.empty()) {
    const std::string_view one_of = module_catalogue().size() > 1 ? "one of " : "";
    table.error("model", fmt::format("expected {}{}", one_of, quoted_models()));
  }
  read_place(table, cpu, module);
  module.bus = table.text("bus").value_or("");
  module.node = static_cast<std::uint8_t>(table.integer("node", 1, 127, node_id_expected).value_or(0));
  module.master = table.boolean("master").value_or(false);
  if (const toml::node* all = table.find("slaves")) {
    if (all->as_string() == nullptr || all->as_string()->get() != "all") {
      table.error("slaves", "expected \"all\"; single slaves are written as [[plc.module.slave]]");
    }
    module.all_slaves = true;
  }
  module.slaves = read_good<SlaveSection>(table, "slave", "plc.module.slave", read_slave);
  module.exchange = table.parsed("exchange", text::parse_duration);
  if (module.exchange && *module.exchange < std::chrono::milliseconds(1)) {
    table.error("exchange", "expected at least 1ms");
  }
  const auto recover = table.boolean("recover");
  module.recover = recover.value_or(true);
  if (recover && !module.exchange) {
    table.error("recover",
                "is about the built-in PLC program, which runs with exchange = \"20ms\" or the like");
  }
  module.restart_time = table.parsed("restart_time", text::parse_duration);
  if (const auto fault = table.text("fault")) {
    if (*fault == "watchdog error") module.fault = module::ModuleFault::watchdog_error;
    if (*fault == "power error") module.fault = module::ModuleFault::power_error;
    if (*fault != "watchdog error" && *fault != "hardware error" && *fault != "power error") {
      table.error("fault", "expected \"hardware error\", \"watchdog error\" or \"power error\"");
    }
    module.fault_at = table.parsed("fault_at", text::parse_duration).value_or(can::Duration{});
  } else if (table.find("fault_at") != nullptr) {
    table.error("fault_at", "expected a fault, too");
  }
  module.objects = read_objects(table, "objects");
  module.buffer = read_words(table, "buffer");
  module.online = table.boolean("online").value_or(false);
  module.writes = read_words(table, "write");
  table.table("parameters", "plc.module.parameters", "expected a table, written as [plc.module.parameters]",
              [&](text::TableReader& inner) { module.parameters = read_parameters(inner, cpu); });
  table.table("download", "plc.module.download", "expected a table, written as [plc.module.download]",
              [&](text::TableReader& inner) { module.download = read_download(inner); });
  check_download(table, module);
  table.elements("watch", [&](const toml::node& element) {
    const auto* text = element.as_string();
    const auto address = text == nullptr ? std::unexpected(std::string("expected words such as \"G10000\""))
                                         : text::parse_buffer_address(text->get());
    if (!address)
      return table.error(text::place_of(element.source()), fmt::format("watch: {}", address.error()));
    module.watch.push_back(*address);
  });
  for (const std::string_view key : {"model", "bus", "node"}) {
    module.usable = module.usable && !table.is_wrong(key);
  }
  return module;
}

constexpr can::Duration shortest_watchdog = std::chrono::milliseconds(1);

PlcSection read_plc(text::TableReader& table) {
  PlcSection plc{.place = table.place(), .store_place = table.place("store")};
  plc.name = table.text("name").value_or("");
  plc.cpu_model = read_cpu_model(table);
  plc.ports = read_melsec_ports(table, plc.cpu_model);
  plc.modbus_ports = read_modbus_ports(table, plc.cpu_model);
  const bool remote_reset = table.boolean("remote_reset").value_or(false);
  for (MelsecPortSection& port : plc.ports) port.settings.remote_reset = remote_reset;
  plc.scan = table.parsed("scan", text::parse_duration);
  if (plc.scan && (*plc.scan < plc::Scan::shortest_period || *plc.scan > plc::Scan::longest_period)) {
    table.error("scan", "a scan takes 100us to 2s");
    plc.scan.reset();
  }
  if (const auto cpu = table.text("cpu")) {
    if (*cpu != "run" && *cpu != "stop") table.error("cpu", "expected \"run\" or \"stop\"");
    plc.run = *cpu != "stop";
  }
  plc.store = table.text("store").value_or("");
  plc.cpu_error = table.parsed("cpu_error", text::parse_duration);
  if (has_program_files(table)) {
    plc.program_files = read_program_files(table);
    plc.label_files = read_label_files(table);
    plc.tasks = read_tasks(table, plc.cpu_model);
    plc.watchdog = table.parsed("watchdog", text::parse_duration);
    if (plc.watchdog && (*plc.watchdog < shortest_watchdog || *plc.watchdog > plc::Scan::longest_period)) {
      table.error("watchdog", "the watchdog timer is 1ms to 2s");
      plc.watchdog.reset();
    }
  } else {
    plc.programs = read_programs(table, plc.cpu_model);
  }
  table.tables("module", "plc.module",
               [&](text::TableReader& inner) { plc.modules.push_back(read_module(inner, plc.cpu_model)); });
  check_modbus_modules(plc, table.errors());
  return plc;
}

/// Most buses and most PLCs of a plant; node-IDs and head addresses limit the nodes and modules on them.
constexpr std::size_t most_buses = 256;
constexpr std::size_t most_plcs = 256;

/// Reports the number of sections at the first one beyond the limit.
void check_number(const toml::table& root, std::string_view key, std::string_view what, std::size_t most,
                  std::vector<text::FileError>& errors) {
  const auto* const list = root[key].as_array();
  if (list == nullptr || list->size() <= most) return;
  errors.push_back({text::place_of(list->get(most)->source()),
                    fmt::format("the plant has {} {}; expected at most {}", list->size(), what, most)});
}

/// Tables that belong below another one, and stand alone at the top.
void report_misplaced(text::TableReader& top, const toml::table& root) {
  struct Inner {
    std::string_view key;
    std::string_view written;
  };
  constexpr Inner inner[] = {
      {"behaviour", "[[device.behaviour]]"},
      {"drive", "[device.drive]"},
      {"fault", "[[bus.fault]]"},
      {"line", "[bus.line]"},
      {"modbus", "[[plc.modbus]]"},
      {"module", "[[plc.module]]"},
      {"playback", "[[device.playback]]"},
      {"port", "[[plc.port]]"},
      {"program", "[[plc.program]]"},
      {"script", "[[device.script]]"},
      {"slave", "[[plc.module.slave]]"},
      {"task", "[[plc.task]]"},
  };
  for (const auto& [key, written] : inner) {
    const toml::node* node = root.get(key);
    if (node == nullptr || !(node->is_table() || node->is_array_of_tables())) continue;
    top.find(key);  // not reported again as unknown
    top.error(text::place_of(node->source()),
              fmt::format("{} must be written {}, below its own table", key, written));
  }
}

}  // namespace

PlantReading read_plant(std::string_view text, std::string path) {
  PlantReading reading;
  reading.plant.path = std::move(path);
  const auto root = text::parse_toml(text);
  if (!root) {
    reading.errors.push_back(root.error());
    return reading;
  }
  check_number(*root, "bus", "buses", most_buses, reading.errors);
  check_number(*root, "plc", "PLCs", most_plcs, reading.errors);
  if (!reading.errors.empty()) return reading;
  PlantFile& plant = reading.plant;
  text::TableReader top(*root, "plant file", reading.errors);
  top.table("plant", "plant", "expected a table, written as [plant]", [&](text::TableReader& head) {
    plant.name = head.text("name").value_or("");
    plant.seed =
        static_cast<std::uint64_t>(head.integer("seed", 0, INT64_MAX, "a seed is 0 or more").value_or(1));
    plant.control_place = head.place("control");
    plant.control = head.parsed("control", text::parse_host_and_port);
    plant.control_allowed = read_allowed(head, "control", "control server", plant.control);
  });
  top.tables("bus", "bus", [&](text::TableReader& table) { plant.buses.push_back(read_bus(table)); });
  top.tables("bridge", "bridge",
             [&](text::TableReader& table) { plant.bridges.push_back(read_bridge(table)); });
  top.tables("device", "device",
             [&](text::TableReader& table) { plant.devices.push_back(read_device(table)); });
  top.tables("lift", "lift", [&](text::TableReader& table) {
    const std::size_t before = reading.errors.size();
    LiftSection lift = read_lift(table);
    if (reading.errors.size() == before) add_lift(plant, std::move(lift));
  });
  top.tables("plc", "plc", [&](text::TableReader& table) { plant.plcs.push_back(read_plc(table)); });
  report_misplaced(top, *root);
  top.finish();
  add_projects(plant, reading.errors);
  check_references(plant, reading.errors);
  std::ranges::stable_sort(reading.errors, {}, &text::FileError::place);
  return reading;
}

std::string shown_name(const ModuleSection& module) {
  return !module.name.empty() ? module.name : fmt::format("{} U{:X}", module.model, module.head / 16);
}

}  // namespace canopus::plant
