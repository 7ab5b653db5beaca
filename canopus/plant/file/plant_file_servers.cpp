// The addresses, permitted clients and settings of a plant's servers.

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/link/allow_list.hpp"
#include "canopus/plant/file/plant_references.hpp"
#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/plc/modbus/as300_map.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

namespace {

/// Two servers cannot have one port of one address.
class Ports {
 public:
  Ports(const PlantFile& plant, std::vector<text::FileError>& errors) : plant_(plant), errors_(errors) {}

  void check() {
    if (plant_.control) {
      reserve_port(*plant_.control, Transport::tcp, plant_.control_place, "control", "the control server");
    }
    for (const PlcSection& plc : plant_.plcs) {
      const std::string owner =
          plc.name.empty() ? "a PLC without a name" : fmt::format("PLC \"{}\"", plc.name);
      for (const MelsecPortSection& port : plc.ports) {
        reserve_port(port.listen, port.udp ? Transport::udp : Transport::tcp, port.place, "listen", owner);
      }
      for (const ModbusPortSection& port : plc.modbus_ports) {
        reserve_port(port.listen, Transport::tcp, port.place, "listen", owner);
      }
    }
    for (const BusSection& bus : plant_.buses) {
      if (!bus.socketcand) continue;
      reserve_port(*bus.socketcand, Transport::tcp, bus.serve_place, "serve",
                   fmt::format("bus \"{}\"", bus.name));
    }
  }

 private:
  struct Server {
    std::string owner;
    std::uint32_t line = 0;
  };
  using Addresses = std::map<link::InternetAddress, Server>;
  enum class Transport : std::uint8_t { tcp, udp };  // each has ports of its own

  void reserve_port(const text::HostAndPort& where, Transport transport, text::Place place,
                    std::string_view key, std::string owner) {
    const auto address = link::parse_internet_address(where.host);
    if (!address || where.port == 0) return;  // no address: reported already; port 0: a free one
    Addresses& servers = ports_[{transport, where.port}];
    if (const auto other = same_address(servers, *address); other != servers.end()) {
      errors_.push_back(
          {place, fmt::format("{}: port {} is taken already, by {} in line {}; give each server its own", key,
                              where.port, other->second.owner, other->second.line)});
      return;
    }
    servers.emplace(*address, Server{std::move(owner), place.line});
  }

  /// A server that would get the same connections: 0.0.0.0 is every IPv4 address, :: every address of both kinds.
  static Addresses::const_iterator same_address(const Addresses& servers,
                                                const link::InternetAddress& address) {
    static const link::InternetAddress any_ipv4 = *link::parse_internet_address("0.0.0.0");
    static const link::InternetAddress last_ipv4 = *link::parse_internet_address("255.255.255.255");
    static constexpr link::InternetAddress any{};
    if (address == any) return servers.begin();
    if (const auto everywhere = servers.find(any); everywhere != servers.end()) return everywhere;
    const bool is_ipv4 = address >= any_ipv4 && address <= last_ipv4;
    if (!is_ipv4) return servers.find(address);
    const auto first = servers.lower_bound(any_ipv4);
    if (first == servers.end() || first->first > last_ipv4) return servers.end();
    return address == any_ipv4 || first->first == any_ipv4 ? first : servers.find(address);
  }

  const PlantFile& plant_;
  std::vector<text::FileError>& errors_;
  std::map<std::pair<Transport, std::uint16_t>, Addresses> ports_;
};

using plc::melsec::DataCode;

constexpr std::uint16_t default_port = 5007;

/// One of the words, or the default when the key is not there or wrong.
template <typename Value, std::size_t count>
Value read_word(text::TableReader& table, std::string_view key, std::string_view expected,
                const std::pair<std::string_view, Value> (&words)[count]) {
  const auto text = table.text(key);
  if (!text) return words[0].second;
  for (const auto& [word, value] : words)
    if (*text == word) return value;
  table.error(key, expected);
  return words[0].second;
}

struct Frames {
  bool takes_3e;
  bool takes_1e;
};

bool is_printable(std::string_view text) {
  return std::ranges::all_of(text, [](char character) { return character >= ' ' && character <= '~'; });
}

std::string read_password(text::TableReader& table, const plc::CpuModel& model) {
  const std::string password = table.text("remote_password").value_or("");
  if (table.find("remote_password") == nullptr) return {};
  const std::size_t least = model.iqr ? 6 : 4;
  const std::size_t most = model.iqr ? 32 : 4;
  if (!table.is_wrong("remote_password") &&
      (password.size() < least || password.size() > most || !is_printable(password))) {
    // The password itself stays out of the message.
    table.error(table.place("remote_password"),
                least == most
                    ? fmt::format("remote_password: expected {} characters of ASCII ({})", least, model.name)
                    : fmt::format("remote_password: expected {} to {} characters of ASCII ({})", least, most,
                                  model.name));
  }
  return password;
}

MelsecPortSection read_port(text::TableReader& table, const plc::CpuModel& model) {
  MelsecPortSection port{.place = table.place("listen")};
  const auto listen = table.parsed("listen", text::parse_host_and_port, true);
  port.udp =
      read_word<bool>(table, "transport", "expected \"tcp\" or \"udp\"", {{"tcp", false}, {"udp", true}});
  const Frames frames = read_word<Frames>(
      table, "frame", "expected \"3E/4E\", \"1E\" or \"any\"",
      {{"3E/4E", Frames{true, false}}, {"1E", Frames{false, true}}, {"any", Frames{true, true}}});
  port.settings.takes_3e = frames.takes_3e;
  port.settings.takes_1e = frames.takes_1e;
  port.settings.code = read_word<std::optional<DataCode>>(
      table, "code", "expected \"binary\", \"ascii\" or \"any\"",
      {{"any", std::nullopt}, {"binary", DataCode::binary}, {"ascii", DataCode::ascii}});
  port.settings.remote_password = read_password(table, model);
  if (frames.takes_1e && table.find("remote_password") != nullptr) {
    table.error("frame", "1E frames cannot bring a remote password; expected \"3E/4E\"");
  }
  if (!table.boolean("write_in_run").value_or(true)) port.settings.write = plc::WritePermission::in_stop;
  const bool has_password = table.find("remote_password") != nullptr;
  port.allowed = read_allowed(table, "listen", "MC protocol", listen, has_password);
  port.writers = read_networks(table, "allow_write");
  port.listen = listen.value_or(text::HostAndPort{});
  return port;
}

/// `{ at = 0, count = 100, device = "D0" }`.
void read_range(text::TableReader& table, plc::modbus::Table which, const plc::CpuModel& model,
                ModbusPortSection& port) {
  const auto at = table.integer("at", 0, 0xFFFF, "an address is 0 to 65535", true);
  const auto count = table.integer("count", 1, 0x10000, "expected 1 to 65536 addresses", true);
  const unsigned io_base = model.number_base(plc::Device::x);
  const auto device = table.parsed(
      "device", [io_base](std::string_view text) { return plc::parse_rack_address(text, io_base); }, true);
  const bool read_only = table.boolean("read_only").value_or(false);
  if (!at || !count || !device) return;
  plc::modbus::Range range{.first = static_cast<std::uint16_t>(*at),
                           .count = static_cast<std::uint32_t>(*count),
                           .at = *device,
                           .read_only = read_only};
  if (device->is_buffer) {
    port.buffer_ranges.push_back({table.place("device"), device->head_address});
  } else {
    const bool bits = plc::modbus::is_bit_table(which);
    const bool is_bit = plc::device_info(device->device).is_bit;
    const std::uint64_t points = bits == is_bit ? range.count
                                 : is_bit       ? 16ULL * range.count
                                                : (range.count + 15ULL) / 16;
    const std::uint32_t there = model.points_of(device->device);
    if (points > there || !model.has(device->device, device->number, static_cast<std::uint32_t>(points))) {
      return table.error(table.place("device"),
                         fmt::format("device: {} addresses from {} on end at {}; the {} has {} of it",
                                     range.count, plc::to_text(*device, 0, io_base),
                                     plc::to_text(*device, static_cast<std::uint32_t>(points - 1), io_base),
                                     model.name, there));
    }
  }
  if (const auto added = port.settings.map.add(which, range); !added) {
    table.error(table.place("at"), fmt::format("at: {}", added.error()));
  }
}

ModbusPortSection read_modbus_port(text::TableReader& table, const plc::CpuModel& model) {
  using plc::modbus::Table;
  ModbusPortSection port{.place = table.place("listen")};
  const auto listen = table.parsed("listen", text::parse_host_and_port, true);
  port.allowed = read_allowed(table, "listen", "Modbus protocol", listen);
  port.writers = read_networks(table, "allow_write");
  if (!table.boolean("write_in_run").value_or(true)) port.settings.write = plc::WritePermission::in_stop;
  if (const auto framing = table.text("framing")) {
    if (*framing != "tcp" && *framing != "rtu") table.error("framing", "expected \"tcp\" or \"rtu\"");
    if (*framing == "rtu") port.settings.framing = plc::modbus::Framing::rtu;
  }
  if (const auto unit = table.integer("unit", 1, 247, "a unit identifier is 1 to 247")) {
    port.settings.unit = static_cast<std::uint8_t>(*unit);
  }
  bool has_map = false;
  const auto read_ranges = [&](std::string_view key, Table which) {
    has_map = has_map || table.find(key) != nullptr;
    table.tables(key, std::string(key),
                 [&](text::TableReader& inner) { read_range(inner, which, model, port); });
  };
  read_ranges("coils", Table::coils);
  read_ranges("discrete_inputs", Table::discrete_inputs);
  read_ranges("holding_registers", Table::holding_registers);
  read_ranges("input_registers", Table::input_registers);
  if (model.family == plc::CpuFamily::as300) port.settings.limits = plc::modbus::as300_limits();
  if (!has_map) {
    port.settings.map = model.family == plc::CpuFamily::as300 ? plc::modbus::as300_map(model)
                                                              : plc::modbus::default_map(model);
  }
  port.listen = listen.value_or(text::HostAndPort{});
  return port;
}

}  // namespace

std::optional<link::AllowList> read_networks(text::TableReader& table, std::string_view key) {
  std::vector<link::Network> networks;
  table.elements(key, [&](const toml::node& element) {
    const auto* text = element.as_string();
    const auto network = text == nullptr
                             ? std::unexpected(fmt::format("{}: expected networks such as \"192.168.1.0/24\"",
                                                           text::describe_found(element)))
                             : link::parse_network(text->get());
    if (!network)
      return table.error(text::place_of(element.source()), fmt::format("{}: {}", key, network.error()));
    networks.push_back(*network);
  });
  if (table.find(key) == nullptr) return std::nullopt;
  return link::AllowList(std::move(networks));
}

link::AllowList read_allowed(text::TableReader& table, std::string_view key, std::string_view protocol,
                             const std::optional<text::HostAndPort>& place, bool has_password) {
  auto list = read_networks(table, "allow");
  if (!place) {
    if (list)
      table.error("allow",
                  fmt::format("no client can connect: {} is missing, the address where it listens", key));
    return {};
  }
  const auto address = link::parse_internet_address(place->host);
  if (!address) {
    table.error(table.place(key), fmt::format("{}: {}, or localhost", key, address.error()));
  } else if (!list && !has_password && !link::is_loopback(*address)) {
    table.error(table.place(key),
                fmt::format("{}: other machines can reach {}, and the {} has no password here; say which may "
                            "connect, for example allow = [\"192.168.1.0/24\"], or listen on 127.0.0.1",
                            key, place->host, protocol));
  }
  if (list) return *std::move(list);
  // The password keeps strangers out.
  if (has_password) return link::AllowList({{.address = {}, .prefix = 0}});
  return {};
}

std::vector<MelsecPortSection> read_melsec_ports(text::TableReader& table, const plc::CpuModel& model) {
  std::vector<MelsecPortSection> ports;
  std::optional<text::HostAndPort> listen;
  const toml::node* const found = table.find("listen");
  if (found == nullptr) {
    // A file that lists its ports means these.
    if (table.find("port") == nullptr) listen = text::HostAndPort{.port = default_port};
  } else if (found->value_or(std::string_view()) != "off") {
    listen = table.parsed("listen", text::parse_host_and_port);
  }
  const link::AllowList allowed = read_allowed(table, "listen", "MC protocol", listen);
  if (listen) {
    ports.push_back({.place = table.place("listen"), .listen = *listen, .allowed = allowed});
  }
  table.tables("port", "plc.port",
               [&](text::TableReader& inner) { ports.push_back(read_port(inner, model)); });
  return ports;
}

std::vector<ModbusPortSection> read_modbus_ports(text::TableReader& table, const plc::CpuModel& model) {
  std::vector<ModbusPortSection> ports;
  table.tables("modbus", "plc.modbus",
               [&](text::TableReader& inner) { ports.push_back(read_modbus_port(inner, model)); });
  return ports;
}

void check_modbus_modules(const PlcSection& plc, std::vector<text::FileError>& errors) {
  for (const ModbusPortSection& port : plc.modbus_ports) {
    for (const ModbusPortSection::BufferRange& range : port.buffer_ranges) {
      if (std::ranges::find(plc.modules, range.head, &ModuleSection::head) != plc.modules.end()) continue;
      errors.push_back(
          {range.place, fmt::format("device: the PLC has no module at head = 0x{:X}", range.head)});
    }
  }
}

std::string protocol_name(const MelsecPortSection& port) {
  return fmt::format("MC protocol{}{}", port.settings.takes_3e ? "" : " 1E", port.udp ? " UDP" : "");
}

void check_servers(const PlantFile& plant, std::vector<text::FileError>& errors) {
  Ports(plant, errors).check();
}

}  // namespace canopus::plant
