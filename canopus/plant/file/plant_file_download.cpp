// [plc.module.download] of a plant file: what CANopen Builder has downloaded.

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/text/table_reader.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::plant {

namespace {

/// A time in whole units, up to 65535 of them.
std::optional<std::uint16_t> read_time(text::TableReader& table, std::string_view key, can::Duration unit,
                                       std::string_view expected) {
  const auto time = table.parsed(key, text::parse_duration);
  if (!time) return std::nullopt;
  if (*time < can::Duration{} || *time % unit != can::Duration{} || *time / unit > 65535) {
    table.error(key, expected);
    return std::nullopt;
  }
  return static_cast<std::uint16_t>(*time / unit);
}

std::optional<std::uint16_t> read_milliseconds(text::TableReader& table, std::string_view key) {
  return read_time(table, key, std::chrono::milliseconds(1), "expected whole milliseconds, up to 65535ms");
}

std::vector<DownloadSection::Object> read_mapped(text::TableReader& table) {
  std::vector<DownloadSection::Object> objects;
  const toml::node* list = table.find("objects");
  if (list == nullptr || (list->is_array() && list->as_array()->empty()))
    table.error("objects", "expected a list such as [\"2000:01\"]");
  table.elements("objects", [&](const toml::node& element) {
    const text::Place place = text::place_of(element.source());
    const auto* name = element.as_string();
    const auto object = name == nullptr
                            ? std::unexpected(fmt::format("{}: expected an object such as \"2000:01\"",
                                                          text::describe_found(element)))
                            : text::parse_object(name->get());
    if (!object) return table.error(place, object.error());
    objects.push_back({place, *object});
  });
  return objects;
}

DownloadSection::Pdo read_pdo(text::TableReader& table, bool transmit) {
  DownloadSection::Pdo pdo{.place = table.place()};
  pdo.number = static_cast<std::uint16_t>(
      table.integer("number", 1, 512, "a PDO's number is 1 to 512", true).value_or(1));
  const auto type =
      table.integer_of("type", {{0, 240}, {254, 255}}, "a transmission type is 0 to 240, 254 or 255");
  pdo.type = static_cast<std::uint8_t>(type.value_or(255));
  if (const auto id = table.integer("cob_id", 0x181, 0x57F, "a PDO's COB-ID is 0x181 to 0x57F"))
    pdo.cob_id = static_cast<std::uint16_t>(*id);
  if (transmit) {
    pdo.inhibit_time = read_time(table, "inhibit_time", std::chrono::microseconds(100),
                                 "expected multiples of 100us, up to 6553500us");
    pdo.event_timer = read_milliseconds(table, "event_timer");
  }
  pdo.objects = read_mapped(table);
  return pdo;
}

std::optional<text::Scalar> scalar_of(const toml::node* node) {
  if (node == nullptr) return std::nullopt;
  if (const auto* value = node->as_boolean()) return value->get();
  if (const auto* value = node->as_integer()) return value->get();
  if (const auto* value = node->as_floating_point()) return value->get();
  if (const auto* value = node->as_string()) return value->get();
  return std::nullopt;
}

DownloadSection::Slave read_download_slave(text::TableReader& table) {
  DownloadSection::Slave slave{.place = table.place("node"), .eds_place = table.place("eds")};
  slave.node = static_cast<std::uint8_t>(
      table.integer("node", 1, 64, "the nodes of slaves are 1 to 64", true).value_or(0));
  slave.eds = table.text("eds").value_or("");
  slave.heartbeat = read_milliseconds(table, "heartbeat");
  slave.heartbeat_time_out = read_milliseconds(table, "heartbeat_time_out");
  table.tables("rx_pdo", "plc.module.download.slave.rx_pdo",
               [&](text::TableReader& inner) { slave.rx_pdos.push_back(read_pdo(inner, false)); });
  table.tables("tx_pdo", "plc.module.download.slave.tx_pdo",
               [&](text::TableReader& inner) { slave.tx_pdos.push_back(read_pdo(inner, true)); });
  table.tables("auto_sdo", "plc.module.download.slave.auto_sdo", [&](text::TableReader& inner) {
    const auto object = inner.parsed("object", text::parse_object, true);
    const auto value = scalar_of(inner.find("value"));
    if (!value) inner.error("value", "expected a number, a string, true or false");
    if (object && value) slave.auto_sdos.push_back({inner.place(), *object, *value});
  });
  return slave;
}

}  // namespace

DownloadSection read_download(text::TableReader& table) {
  DownloadSection download{.place = table.place()};
  if (const auto mode = table.text("work_mode")) {
    if (*mode != "master" && *mode != "slave") table.error("work_mode", "expected \"master\" or \"slave\"");
    download.is_slave = *mode == "slave";
  }
  constexpr std::string_view wrong_ids =
      "expected 0 or 128 to 255, which are no node-IDs; the card's own node-ID is the key node";
  if (const auto id = table.integer_of("node_id", {{0, 0}, {128, 255}}, wrong_ids))
    download.wrong_node_id = static_cast<std::uint8_t>(*id);
  download.again_at = table.parsed("again_at", text::parse_duration);
  download.cycle_period = read_milliseconds(table, "cycle_period");
  download.master_heartbeat = read_milliseconds(table, "master_heartbeat");
  table.tables("slave", "plc.module.download.slave", [&](text::TableReader& inner) {
    auto slave = read_download_slave(inner);
    if (slave.node != 0) download.slaves.push_back(std::move(slave));
  });
  return download;
}

}  // namespace canopus::plant
