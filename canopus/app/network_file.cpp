#include "canopus/app/network_file.hpp"

#include <chrono>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "canopus/app/table_reader.hpp"

namespace canopus::app {
namespace {

/// A time that an object of 16 bits holds in milliseconds.
can::Duration milliseconds_16(TableReader& table, std::string_view key) {
  const auto time = table.parsed(key, parse_duration);
  if (!time) return {};
  if (*time % std::chrono::milliseconds(1) != can::Duration{} || *time > std::chrono::milliseconds(65535)) {
    table.error(key, "expected whole milliseconds, at most 65535ms");
    return {};
  }
  return *time;
}

std::optional<std::uint32_t> unsigned32(TableReader& table, std::string_view key) {
  const auto value = table.integer(key, 0, 0xFFFF'FFFF, "expected 0 to 0xFFFF_FFFF");
  return value ? std::optional(static_cast<std::uint32_t>(*value)) : std::nullopt;
}

std::uint8_t node_id(TableReader& table, bool required, std::uint8_t otherwise) {
  return static_cast<std::uint8_t>(
      table.integer("node", 1, 127, "a node-ID is 1 to 127", required).value_or(otherwise));
}

std::vector<ObjectSetting> objects(TableReader& table) {
  std::vector<ObjectSetting> settings;
  table.entries("objects", [&](std::string_view name, const toml::node& node, Place place) {
    const auto object = parse_object(name);
    if (!object) return table.error(place, object.error());
    ObjectSetting setting{.place = place, .object = *object, .value = false};
    if (const auto* flag = node.as_boolean()) {
      setting.value = flag->get();
    } else if (const auto* whole = node.as_integer()) {
      setting.value = whole->get();
    } else if (const auto* real = node.as_floating_point()) {
      setting.value = real->get();
    } else if (const auto* words = node.as_string()) {
      setting.value = words->get();
    } else {
      return table.error(
          place_of(node.source()),
          fmt::format("{} = {}: expected a number, a string, true or false", name, describe_found(node)));
    }
    settings.push_back(std::move(setting));
  });
  return settings;
}

NetworkSlave read_slave(TableReader& table) {
  NetworkSlave slave{.place = table.place(), .eds_place = table.place("eds")};
  slave.node = node_id(table, true, 0);
  slave.name = table.text("name").value_or("");
  slave.mandatory = table.boolean("mandatory").value_or(true);
  slave.keep_alive = table.boolean("keep_alive").value_or(false);
  slave.eds = table.text("eds").value_or("");
  slave.device_type = unsigned32(table, "device_type");
  slave.vendor = unsigned32(table, "vendor");
  slave.product = unsigned32(table, "product");
  slave.revision = unsigned32(table, "revision");
  slave.serial = unsigned32(table, "serial");
  slave.consumer_heartbeat_time = milliseconds_16(table, "consumer_heartbeat_time");
  slave.guard_time = milliseconds_16(table, "guard_time");
  slave.retry_factor =
      static_cast<std::uint8_t>(table.integer("retry_factor", 1, 255, "expected 1 to 255").value_or(3));
  slave.objects = objects(table);
  if (!slave.objects.empty() && slave.eds.empty()) {
    table.error("objects", "needs the device's eds, which says the objects' types");
  }
  if (slave.guard_time != can::Duration{} && slave.consumer_heartbeat_time != can::Duration{}) {
    table.error("guard_time", "a slave is watched by heartbeat or by guarding, not both");
  }
  return slave;
}

void check(NetworkReading& reading) {
  const auto& slaves = reading.network.slaves;
  if (slaves.empty() && reading.errors.empty()) {
    reading.errors.push_back({{1, 1}, "there is no slave; expected at least one [[slave]]"});
  }
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    const auto refuse = [&](std::string_view who) {
      reading.errors.push_back({slaves[i].place, fmt::format("node {} is {}", slaves[i].node, who)});
    };
    if (slaves[i].node == 0) continue;
    if (slaves[i].node == reading.network.node) refuse("the master's own ([master] node)");
    for (std::size_t k = 0; k < i; ++k) {
      if (slaves[k].node == slaves[i].node)
        refuse(fmt::format("the slave of line {}, too", slaves[k].place.line));
    }
  }
}

}  // namespace

NetworkReading read_network(std::string_view text, std::string path) {
  NetworkReading reading;
  NetworkFile& network = reading.network;
  network.path = std::move(path);
  toml::table root;
  try {
    root = toml::parse(text, network.path);
  } catch (const toml::parse_error& error) {
    reading.errors.push_back({place_of(error.source()), std::string(error.description())});
    return reading;
  }
  TableReader table(root, "the network file", reading.errors);
  network.name = table.text("name").value_or("");
  if (const toml::node* node = table.find("master")) {
    if (const auto* inner = node->as_table()) {
      TableReader master(*inner, "[master]", reading.errors);
      network.node = node_id(master, false, network.node);
      network.heartbeat = milliseconds_16(master, "heartbeat");
      network.boot_time = master.parsed("boot_time", parse_duration);
      network.start_slaves = master.boolean("start_slaves").value_or(true);
      master.finish();
    } else {
      table.error("master", "expected a table, [master]");
    }
  }
  table.tables("slave", "slave", [&](TableReader& inner) { network.slaves.push_back(read_slave(inner)); });
  table.finish();
  check(reading);
  return reading;
}

}  // namespace canopus::app
