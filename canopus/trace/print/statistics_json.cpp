#include "canopus/trace/print/statistics_json.hpp"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "canopus/text/json.hpp"

namespace canopus::trace {

std::string identifier_of_key(std::uint32_t key) {
  return (key >> 29 & 1U) != 0 ? fmt::format("{:08X}", key & can::max_extended_identifier)
                               : fmt::format("{:03X}", key);
}

namespace {

using Json = text::Json;

/// Whole microseconds are enough for people and programs.
double rounded(can::Duration duration) { return static_cast<double>((duration.count() + 500) / 1000) / 1e3; }

Json figures_json(const TimeFigures& figures) {
  Json json;
  json["count"] = figures.count();
  if (figures.count() == 0) return json;
  json["min_ms"] = rounded(figures.min());
  json["mean_ms"] = rounded(figures.mean());
  json["max_ms"] = rounded(figures.max());
  json["jitter_ms"] = rounded(figures.max() - figures.min());
  json["deviation_ms"] = rounded(figures.deviation());
  return json;
}

Json node_json(std::uint8_t node_id, const NodeFigures& node) {
  Json json;
  json["node"] = node_id;
  if (!node.name.empty()) json["name"] = node.name;
  json["boot_ups"] = node.boot_ups;
  json["emergencies"] = node.emergencies;
  json["malformed"] = node.malformed;
  json["heartbeats"] = node.heartbeats;
  json["lost_heartbeats"] = node.lost_heartbeats;
  if (node.producer_time > can::Duration::zero()) {
    json["producer_time_ms"] = rounded(node.producer_time);
    json["producer_time_is_measured"] = node.producer_time_is_measured;
  }
  json["heartbeat_cycle"] = figures_json(node.heartbeat_cycle);
  json["sdo"] = figures_json(node.sdo);
  json["sdo"]["reads"] = node.reads;
  json["sdo"]["writes"] = node.writes;
  json["sdo"]["aborts"] = node.aborts;
  json["sdo"]["unanswered"] = node.unanswered;
  json["sdo"]["unfinished"] = node.unfinished;
  return json;
}

Json channel_json(const ChannelFigures& channel, can::Duration duration, std::uint32_t bit_rate) {
  Json json;
  json["name"] = channel.name;
  json["frames"] = channel.frames;
  json["error_frames"] = channel.error_frames;
  json["bits"] = channel.bits;
  if (bit_rate != 0) {
    json["load"] = load(channel.bits, duration, bit_rate);
    json["busiest_second_load"] = load(channel.busiest_bits, std::chrono::seconds(1), bit_rate);
  }
  json["identifiers"] = Json::array();
  for (const auto& [key, one] : channel.identifiers) {
    Json entry;
    entry["id"] = identifier_of_key(key);
    entry["who"] = one.who;
    if (!one.signals.empty()) entry["signals"] = one.signals;
    entry["frames"] = one.frames;
    entry["bits"] = one.bits;
    entry["cycle"] = figures_json(one.cycle);
    json["identifiers"].push_back(std::move(entry));
  }
  json["nodes"] = Json::array();
  for (const auto& [node_id, node] : channel.nodes) json["nodes"].push_back(node_json(node_id, node));
  for (const std::uint8_t node_id : channel.absent) json["absent"].push_back(node_id);
  return json;
}

Json events_json(const std::vector<TraceEvent>& events, can::Time begin) {
  Json list = Json::array();
  for (const TraceEvent& event : events) {
    Json one;
    one["time"] = std::chrono::duration<double>(event.time - begin).count();
    one["node"] = event.node;
    if (!event.node_name.empty()) one["name"] = event.node_name;
    one["text"] = event.text;
    list.push_back(std::move(one));
  }
  return list;
}

}  // namespace

text::Json to_json(const Statistics& statistics, std::uint32_t bit_rate) {
  Json json;
  json["duration"] = std::chrono::duration<double>(statistics.duration()).count();
  if (bit_rate != 0) json["bit_rate"] = bit_rate;
  for (unsigned i = 0; i < service_count; ++i) {
    json["services"][std::string(name(static_cast<Service>(i)))] = statistics.services()[i];
  }
  json["malformed_services"] = Json::object();
  for (unsigned i = 0; i < service_count; ++i) {
    const std::uint64_t count = statistics.malformed_services()[i];
    if (count != 0) json["malformed_services"][std::string(name(static_cast<Service>(i)))] = count;
  }
  json["malformed"] = events_json(statistics.malformed(), statistics.begin());
  json["channels"] = Json::array();
  for (const auto& [number, channel] : statistics.channels()) {
    json["channels"].push_back(channel_json(channel, statistics.duration(), bit_rate));
  }
  json["emcy"] = events_json(statistics.emergencies(), statistics.begin());
  json["failed_sdo"] = events_json(statistics.failures(), statistics.begin());
  return json;
}

}  // namespace canopus::trace
