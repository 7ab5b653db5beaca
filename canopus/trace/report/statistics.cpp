#include "canopus/trace/report/statistics.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"

namespace canopus::trace {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t most_gaps = 1000;
/// A heartbeat is lost when a gap is longer than this many producer times.
constexpr double tolerance = 1.5;

/// Heartbeats that should have come in a gap.
std::uint64_t lost_in(can::Duration gap, can::Duration producer_time) noexcept {
  if (producer_time <= 0ns) return 0;
  const double times = static_cast<double>(gap.count()) / static_cast<double>(producer_time.count());
  return times <= tolerance ? 0 : static_cast<std::uint64_t>(std::llround(times)) - 1;
}

std::string who_sends(const Message& message) {
  std::string service;
  if (message.service == Service::pdo) {
    service = fmt::format("{}PDO{}", message.kind.starts_with('T') ? "T" : "R", message.pdo);
  } else if (message.service == Service::error_control) {
    service = "error control";
  } else if (message.service == Service::sdo || message.service == Service::nmt ||
             message.service == Service::emcy || message.service == Service::sync ||
             message.service == Service::time || message.service == Service::lss ||
             message.service == Service::mpdo) {
    service = name(message.service);
    std::ranges::transform(service, service.begin(),
                           [](char c) { return c >= 'a' && c <= 'z' ? char(c - 32) : c; });
  } else {
    service = name(message.service);
  }
  // The node that an NMT, LSS or MPDO frame addresses changes from frame to frame.
  if (message.node == 0 || message.service == Service::nmt || message.service == Service::mpdo)
    return service;
  return fmt::format("{} of {}", service, node_text(message));
}

std::string names_of(const std::vector<Signal>& signals) {
  std::string names;
  for (const Signal& signal : signals) {
    names += names.empty() ? "" : ", ";
    names += signal.name.empty() ? canopen::object_text(signal.index, signal.sub) : signal.name;
  }
  return names;
}

/// A question for the device type to which nothing was answered: the time-out of a client, or silence.
bool is_probe(const Message& message) {
  constexpr std::uint32_t timed_out = 0x05040000;
  const bool is_in_vain = message.end == TransferEnd::unanswered ||
                          (message.end == TransferEnd::aborted && message.abort_code == timed_out);
  return message.is_read && message.index == 0x1000 && message.sub == 0 && is_in_vain;
}

/// Nothing of it is in the trace.
bool is_silent(const NodeFigures& node) {
  return node.boot_ups + node.heartbeats + node.emergencies + node.reads + node.writes + node.malformed ==
         node.aborts;
}

}  // namespace

void TimeFigures::add(can::Duration value) noexcept {
  ++count_;
  min_ = std::min(min_, value);
  max_ = std::max(max_, value);
  const auto number = static_cast<double>(value.count());
  const double away = number - mean_;
  mean_ += away / static_cast<double>(count_);
  squares_ += away * (number - mean_);
}

can::Duration TimeFigures::mean() const noexcept { return can::Duration(std::llround(mean_)); }

can::Duration TimeFigures::deviation() const noexcept {
  if (count_ < 2) return {};
  return can::Duration(std::llround(std::sqrt(squares_ / static_cast<double>(count_))));
}

double load(std::uint64_t bits, can::Duration duration, std::uint32_t bit_rate) noexcept {
  if (duration <= 0ns || bit_rate == 0) return 0;
  return static_cast<double>(bits) * 1e9 /
         (static_cast<double>(bit_rate) * static_cast<double>(duration.count()));
}

void Statistics::record(const TraceRecord& record, std::string_view channel) {
  if (!begin_) begin_ = record.time;
  end_ = std::max(end_, record.time);
  ChannelFigures& figures = channels_[record.channel];
  if (figures.name.empty()) figures.name = channel;
  if (record.error_frame) ++figures.error_frames;
}

void Statistics::message(const Message& message, const Decoder& decoder) {
  ChannelFigures& channel = channels_[message.channel];
  if (message.is_transfer) return transfer(channel.nodes[message.node], message);
  if (message.is_copy || message.service == Service::error_frame) return;
  ++services_[static_cast<std::size_t>(message.service)];
  ++channel.frames;
  const std::uint64_t bits = can::frame_bits(message.frame) + can::intermission_bits;
  channel.bits += bits;
  const std::int64_t second = (message.time - begin()) / 1s;
  if (second != channel.second) {
    channel.busiest_bits = std::max(channel.busiest_bits, channel.second_bits);
    channel.second_bits = 0;
    channel.second = second;
  }
  channel.second_bits += bits;
  count_identifier(channel, message, bits);
  if (message.is_malformed) count_malformed(channel, message);
  if (message.node == 0 || message.service == Service::nmt) return;
  const bool speaks = message.service == Service::error_control || message.service == Service::emcy;
  if (!speaks) return;
  NodeFigures& node = channel.nodes[message.node];
  node.name = message.node_name;
  if (message.kind == "boot-up") ++node.boot_ups;
  if (message.kind == "boot-up" || message.kind == "heartbeat") heartbeat(node, message, decoder);
  if (message.service == Service::emcy) {
    ++node.emergencies;
    note(emergencies_, message, message.text);
  }
}

void Statistics::count_identifier(ChannelFigures& channel, const Message& message, std::uint64_t bits) {
  const FrameKey key = key_of(message.frame);
  if (channel.identifiers.size() >= most_identifiers && !channel.identifiers.contains(key)) return;
  IdentifierFigures& identifier = channel.identifiers[key];
  if (!message.frame.remote) {
    if (identifier.frames > 0 && message.time >= identifier.last)
      identifier.cycle.add(message.time - identifier.last);
    identifier.last = message.time;
    ++identifier.frames;
  }
  identifier.bits += bits;
  if (identifier.who.empty() || message.service == Service::pdo) identifier.who = who_sends(message);
  if (!message.signals.empty()) identifier.signals = names_of(message.signals);
}

void Statistics::heartbeat(NodeFigures& node, const Message& message, const Decoder& decoder) {
  // A boot-up restarts the supervision: the node's downtime is no lost heartbeat.
  const bool boots = message.kind == "boot-up";
  if (!boots) ++node.heartbeats;
  if (const BusKnowledge* const known = decoder.knowledge(message.channel)) {
    const auto time = known->setting(message.node, 0x1017, 0);
    if (time && *time != 0 && *time <= 0xFFFF) node.producer_time = std::chrono::milliseconds(*time);
  }
  const auto before = node.last_heartbeat;
  node.last_heartbeat = boots ? std::nullopt : std::optional(message.time);
  if (!before || boots || message.time < *before) return;
  const can::Duration gap = message.time - *before;
  node.heartbeat_cycle.add(gap);
  if (node.producer_time > 0ns) {
    node.lost_heartbeats += lost_in(gap, node.producer_time);
  } else if (node.gaps.size() < most_gaps) {
    node.gaps.push_back(gap);
  }
}

void Statistics::transfer(NodeFigures& node, const Message& message) {
  node.name = message.node_name;
  if (is_probe(message)) ++node.probes;
  if (message.end == TransferEnd::unanswered) {
    ++node.unanswered;
    return note(failures_, message, message.text);
  }
  ++(message.is_read ? node.reads : node.writes);
  if (message.end == TransferEnd::done) return node.sdo.add(message.duration);
  ++(message.end == TransferEnd::aborted ? node.aborts : node.unfinished);
  note(failures_, message, message.text);
}

void Statistics::count_malformed(ChannelFigures& channel, const Message& message) {
  ++malformed_services_[static_cast<std::size_t>(message.service)];
  if (message.node != 0 && message.service != Service::nmt) {
    NodeFigures& node = channel.nodes[message.node];
    node.name = message.node_name;
    ++node.malformed;
  }
  const std::string_view service = name(message.service);
  note(malformed_, message,
       fmt::format("{:0{}X} {}: {}", message.frame.identifier, message.frame.extended ? 8 : 3, service,
                   message.text));
}

void Statistics::note(std::vector<TraceEvent>& list, const Message& message, std::string text) {
  if (list.size() < most_events)
    list.push_back({message.time, message.channel, message.node, message.node_name, std::move(text),
                    message.is_transfer && is_probe(message)});
}

void Statistics::set_absent_nodes_apart() {
  for (auto& [number, channel] : channels_) {
    for (const auto& [node_id, node] : channel.nodes) {
      if (node.probes > 0 && node.probes == node.aborts + node.unanswered && node.unfinished == 0 &&
          is_silent(node))
        channel.absent.push_back(node_id);
    }
    for (const std::uint8_t node_id : channel.absent) channel.nodes.erase(node_id);
  }
  std::erase_if(failures_, [this](const TraceEvent& event) {
    return event.is_probe && std::ranges::binary_search(channels_.at(event.channel).absent, event.node);
  });
}

void Statistics::finish() {
  set_absent_nodes_apart();
  for (auto& [number, channel] : channels_) {
    channel.busiest_bits = std::max(channel.busiest_bits, channel.second_bits);
    for (auto& [node_id, node] : channel.nodes) {
      if (node.producer_time == 0ns && node.gaps.size() >= 3) {
        auto sorted = node.gaps;
        std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
        node.producer_time = sorted[sorted.size() / 2];
        node.producer_time_is_measured = true;
      }
      for (const can::Duration gap : node.gaps) node.lost_heartbeats += lost_in(gap, node.producer_time);
      // One that fell silent before the trace ended.
      if (node.last_heartbeat)
        node.lost_heartbeats += lost_in(end_ - *node.last_heartbeat, node.producer_time);
    }
  }
}

}  // namespace canopus::trace
