#include "canopus/master/network_file.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "canopus/network_project/project_members.hpp"
#include "canopus/store/inner_path.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/table_reader.hpp"
#include "canopus/trace/print/node_names.hpp"

namespace canopus::master {
namespace {

/// A time that an object of 16 bits holds in milliseconds.
can::Duration milliseconds_16(text::TableReader& table, std::string_view key) {
  const auto time = table.parsed(key, text::parse_duration);
  if (!time) return {};
  if (*time % std::chrono::milliseconds(1) != can::Duration{} || *time > std::chrono::milliseconds(65535)) {
    table.error(key, "expected whole milliseconds, at most 65535ms");
    return {};
  }
  return *time;
}

struct OptionTime {
  std::string_view key;
  can::Duration manager::MasterOptions::*time;
};
constexpr OptionTime option_times[] = {
    {"start_all_delay", &manager::MasterOptions::start_all_delay},
    {"wait_after_reset", &manager::MasterOptions::wait_after_reset},
    {"presence_retry", &manager::MasterOptions::presence_retry},
    {"guarding_probe", &manager::MasterOptions::guarding_probe},
    {"boot_up_timeout", &manager::MasterOptions::boot_up_time_out},
    {"late_boot_up", &manager::MasterOptions::late_boot_up},
    {"state_change_grace", &manager::MasterOptions::state_change_grace},
    {"flying_heartbeat", &manager::MasterOptions::flying_heartbeat},
    {"flying_consumer_time", &manager::MasterOptions::flying_consumer_time},
    {"program_timeout", &manager::MasterOptions::program_time_out},
    {"program_poll", &manager::MasterOptions::program_poll},
    {"program_flash_limit", &manager::MasterOptions::program_flash_limit},
    {"program_start_limit", &manager::MasterOptions::program_start_limit},
};

/// [master.times]: those of the start-up that CiA 302 and the manuals leave to the product.
void read_times(text::TableReader& table, manager::MasterOptions& options) {
  for (const OptionTime& option : option_times) {
    options.*option.time = table.parsed(option.key, text::parse_duration).value_or(options.*option.time);
  }
}

/// [master.flying]
manager::FlyingMasterTiming read_flying(text::TableReader& table, std::uint8_t node) {
  manager::FlyingMasterTiming timing;
  timing.detect_cycle += std::chrono::milliseconds(10) * node;  // so that no two masters share one
  const auto time = [&table](std::string_view key, can::Duration& duration) {
    if (table.find(key) != nullptr) duration = milliseconds_16(table, key);
  };
  timing.level = static_cast<std::uint8_t>(
      table.integer("priority", 0, 2, "expected 0 (high), 1 or 2 (low)").value_or(timing.level));
  time("timeout", timing.time_out);
  time("negotiation_delay", timing.negotiation_delay);
  time("priority_slot", timing.priority_slot);
  time("device_slot", timing.device_slot);
  time("detect_cycle", timing.detect_cycle);
  if (!manager::slots_fit(timing)) {
    table.error("priority_slot", "expected more than 127 times device_slot, or priorities overlap");
  }
  return timing;
}

std::optional<std::uint32_t> unsigned32(text::TableReader& table, std::string_view key) {
  const auto value = table.integer(key, 0, 0xFFFF'FFFF, "expected 0 to 0xFFFF_FFFF");
  return value ? std::optional(static_cast<std::uint32_t>(*value)) : std::nullopt;
}

std::uint8_t node_id(text::TableReader& table, bool required, std::uint8_t otherwise) {
  return static_cast<std::uint8_t>(
      table.integer("node", 1, 127, "a node-ID is 1 to 127", required).value_or(otherwise));
}

std::vector<text::ObjectSetting> objects(text::TableReader& table) {
  std::vector<text::ObjectSetting> settings;
  table.entries("objects", [&](std::string_view name, const toml::node& node, text::Place place) {
    const auto object = text::parse_object(name);
    if (!object) return table.error(place, object.error());
    text::ObjectSetting setting{.place = place, .object = *object, .value = false};
    if (const auto* flag = node.as_boolean()) {
      setting.value = flag->get();
    } else if (const auto* whole = node.as_integer()) {
      setting.value = whole->get();
    } else if (const auto* real = node.as_floating_point()) {
      setting.value = real->get();
    } else if (const auto* words = node.as_string()) {
      setting.value = words->get();
    } else {
      return table.error(text::place_of(node.source()),
                         fmt::format("{} = {}: expected a number, a string, true or false", name,
                                     text::describe_found(node)));
    }
    settings.push_back(std::move(setting));
  });
  return settings;
}

NetworkSlave read_slave(text::TableReader& table) {
  NetworkSlave slave{
      .place = table.place(), .eds_place = table.place("eds"), .objects_place = table.place("objects")};
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
  slave.software_version = unsigned32(table, "software_version");
  slave.program = table.text("program").value_or("");
  slave.program_place = table.place("program");
  slave.restore = static_cast<std::uint8_t>(
      table.integer("restore", 1, 127, "expected a sub-index of 1011H, 1 to 127").value_or(0));
  if (!slave.program.empty() && slave.software_version.value_or(0) == 0) {
    table.error("program", "needs software_version, other than 0: what the new program's 1F56H reads");
  }
  if (slave.guard_time != can::Duration{} && slave.consumer_heartbeat_time != can::Duration{}) {
    table.error("guard_time", "a slave is watched by heartbeat or by guarding, not both");
  }
  return slave;
}

void read_master(text::TableReader& table, NetworkFile& network) {
  network.node = node_id(table, false, network.node);
  network.heartbeat = milliseconds_16(table, "heartbeat");
  network.boot_time = table.parsed("boot_time", text::parse_duration);
  network.start_slaves = table.boolean("start_slaves").value_or(true);
  network.start_together = table.boolean("start_together").value_or(false);
  network.nmt_inhibit_time = table.parsed("nmt_inhibit_time", text::parse_duration).value_or(can::Duration{});
  constexpr can::Duration unit = std::chrono::microseconds(100);
  if (network.nmt_inhibit_time % unit != can::Duration{} || network.nmt_inhibit_time > 65535 * unit) {
    table.error("nmt_inhibit_time", "expected whole 100us, at most 6553500us");
  }
  if (const auto reaction = table.text("on_error")) {
    if (*reaction == "reset slave") {
      network.on_error = ErrorReaction::reset_slave;
    } else if (*reaction == "reset all") {
      network.on_error = ErrorReaction::reset_all;
    } else if (*reaction == "stop all") {
      network.on_error = ErrorReaction::stop_all;
    } else {
      table.error("on_error", "expected \"reset slave\", \"reset all\" or \"stop all\"");
    }
  }
  const auto number = [&table](std::string_view key, unsigned otherwise) {
    return static_cast<unsigned>(table.integer(key, 1, 100, "expected 1 to 100").value_or(otherwise));
  };
  manager::MasterOptions& options = network.options;
  options.program_attempts = number("program_attempts", options.program_attempts);
  options.program_clear_attempts = number("program_clear_attempts", options.program_clear_attempts);
  options.blocks_at_once = number("blocks_at_once", options.blocks_at_once);
  const auto block_from = table.integer("block_from", 0, 0xFFFF, "expected 0 (never) to 65535 bytes");
  if (block_from) options.block_from = static_cast<std::size_t>(*block_from);
  table.table("times", "[master.times]", "expected a table, [master.times]",
              [&](text::TableReader& times) { read_times(times, options); });
  table.table("flying", "[master.flying]", "expected a table, [master.flying]",
              [&](text::TableReader& flying) { network.flying = read_flying(flying, network.node); });
}

/// Slaves of the project, behind those of the file; these get their DCF and name from it where they have none.
void add_project(NetworkReading& reading, text::Place place, bool names_master) {
  NetworkFile& network = reading.network;
  const std::filesystem::path folder = std::filesystem::path(network.path).parent_path();
  const auto list = text::read_file((folder / network.project).string());
  const auto read_dcf = [&](const std::string& below, const std::string& name) {
    return store::read_inner_file(folder / below, name);
  };
  const auto find_dcf = [&](const std::string& below, const std::string& name) {
    return store::find_inner_file(folder / below, name);
  };
  const network_project::ProjectMembers project =
      network_project::read_members(network.project, list, network.project_network - 1, read_dcf, find_dcf);
  for (const std::string& error : project.errors) reading.errors.push_back({place, error});
  for (const network_project::ProjectMember& member : project.members) {
    if (member.is_manager && !names_master) network.node = member.node_id;
  }
  for (const network_project::ProjectMember& member : project.members) {
    const auto own = std::ranges::find(network.slaves, member.node_id, &NetworkSlave::node);
    if (own != network.slaves.end()) {
      if (own->eds.empty()) own->eds = member.path;
      if (own->name.empty()) own->name = member.name;
      continue;
    }
    if (member.node_id == network.node) continue;
    network.slaves.push_back({.place = place,
                              .eds_place = place,
                              .node = member.node_id,
                              .name = member.name,
                              .eds = member.path});
  }
}

void check(NetworkReading& reading) {
  const auto& slaves = reading.network.slaves;
  if (slaves.empty() && reading.errors.empty()) {
    reading.errors.push_back({{1, 1}, "there is no slave; expected at least one [[slave]], or a project"});
  }
  for (const NetworkSlave& slave : slaves) {
    if (slave.objects.empty() || !slave.eds.empty()) continue;
    reading.errors.push_back(
        {slave.objects_place, "objects = a table: needs the device's eds, which says the objects' types"});
  }
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    const auto refuse = [&](std::string_view owner) {
      reading.errors.push_back({slaves[i].place, fmt::format("node {} is {}", slaves[i].node, owner)});
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
  const auto root = text::parse_toml(text);
  if (!root) {
    reading.errors.push_back(root.error());
    return reading;
  }
  text::TableReader table(*root, "the network file", reading.errors);
  network.name = table.text("name").value_or("");
  table.table("master", "[master]", "expected a table, [master]",
              [&](text::TableReader& master) { read_master(master, network); });
  table.tables("slave", "slave",
               [&](text::TableReader& inner) { network.slaves.push_back(read_slave(inner)); });
  const text::Place project_place = table.place("project");
  network.project = table.text("project").value_or("");
  network.project_network = static_cast<std::size_t>(
      table.integer("project_network", 1, 1000, "networks of a project are counted from 1").value_or(1));
  table.finish();
  const auto* master = (*root)["master"].as_table();
  if (!network.project.empty())
    add_project(reading, project_place, master != nullptr && master->contains("node"));
  check(reading);
  return reading;
}

NetworkReading read_project(std::string path) {
  NetworkReading reading;
  reading.network.project = std::filesystem::path(path).filename().string();
  reading.network.path = std::move(path);
  add_project(reading, {}, false);
  check(reading);
  return reading;
}

bool add_network_names(const std::string& path, trace::Names& names, text::Output& err) {
  const auto text = text::read_file(path);
  if (!text) {
    err.line("canopus: {}", text.error());
    return false;
  }
  NetworkReading reading = read_network(*text, path);
  if (!reading.errors.empty()) {
    text::print_errors(std::move(reading.errors), path, err);
    return false;
  }
  names.add({.node_id = reading.network.node, .name = "master"});
  for (const NetworkSlave& slave : reading.network.slaves) {
    std::shared_ptr<const canopen::DictionaryDescription> dictionary;
    std::string name = slave.name;
    if (!slave.eds.empty()) {
      const auto file =
          trace::load_device_file((std::filesystem::path(path).parent_path() / slave.eds).string(), err);
      if (!file) return false;
      dictionary = file->dictionary;
      if (name.empty()) name = trace::node_name_of(*file);
    }
    names.add(trace::describe_node("", slave.node, std::move(name), std::move(dictionary)));
  }
  return true;
}

}  // namespace canopus::master
