#include "canopus/network_project/network_load.hpp"

#include <algorithm>

#include "canopus/can/frame_bits.hpp"

namespace canopus::network_project {
namespace {

/// SYNC of the network: period in seconds, 0: no node produces it.
struct Sync {
  const ProjectNode* producer = nullptr;
  canopen::CobId cob_id{};
  double frequency = 0;
  bool has_counter = false;
};

Sync find_sync(const NetworkProject& project) {
  for (const ProjectNode& node : project.nodes()) {
    if (!node.listed.present) continue;
    const canopen::CobId cob_id{static_cast<std::uint32_t>(node.value(0x1005).value_or(0))};
    const auto period = node.value(0x1006).value_or(0);
    if (!cob_id.has_bit_30() || period == 0) continue;
    return {&node, cob_id, 1e6 / static_cast<double>(period), node.value(0x1019).value_or(0) != 0};
  }
  return {};
}

void add_rates(CyclicFrame& frame, const Pdo& pdo, double sync_frequency) {
  const std::uint8_t type = pdo.transmission_type;
  if (type <= 240) {
    frame.most = type == 0 ? sync_frequency : sync_frequency / type;
    frame.steady = type == 0 ? 0 : *frame.most;
    return;
  }
  if (type == 252 || type == 253) {  // asked for by remote frames
    frame.most = 0;
    return;
  }
  const unsigned timer = pdo.event_timer.value_or(0);
  const unsigned inhibit = pdo.inhibit_time.value_or(0);
  frame.steady = timer == 0 ? 0 : 1000.0 / timer;
  if (inhibit == 0) return;
  frame.most = 10'000.0 / inhibit;
  frame.steady = std::min(frame.steady, *frame.most);
}

}  // namespace

unsigned longest_frame_bits(unsigned length, bool is_extended) noexcept {
  const unsigned stuffed = (is_extended ? 54U : 34U) + 8 * length;  // SOF to the end of the CRC sequence
  const unsigned rest = 10;                                         // CRC delimiter to the end of EOF
  return stuffed + (stuffed - 1) / 4 + rest + can::intermission_bits;
}

NetworkLoad reckon_load(const NetworkProject& project) {
  NetworkLoad load{.bit_rate = project.bit_rate(), .frames = {}};
  const Sync sync = find_sync(project);
  if (sync.producer != nullptr) {
    load.frames.push_back({sync.producer->id(), "SYNC", sync.cob_id, sync.has_counter ? 1U : 0U,
                           sync.frequency, sync.frequency});
  }
  for (const ProjectNode& node : project.nodes()) {
    if (!node.listed.present) continue;
    for (const Pdo& pdo : node.pdos) {
      if (!pdo.transmit || !pdo.is_active()) continue;
      CyclicFrame frame{node.id(), pdo.name(), pdo.cob_id, pdo.length(), 0, std::nullopt};
      add_rates(frame, pdo, sync.frequency);
      load.frames.push_back(std::move(frame));
    }
    if (const auto time = node.value(0x1017).value_or(0); time != 0) {
      const double frequency = 1000.0 / static_cast<double>(time);
      load.frames.push_back(
          {node.id(), "heartbeat", canopen::CobId{0x700U + node.id()}, 1, frequency, frequency});
    }
  }
  for (const CyclicFrame& frame : load.frames) {
    if (!frame.most) ++load.unlimited;
    if (load.bit_rate == 0) continue;
    const double share =
        longest_frame_bits(frame.length, frame.cob_id.is_extended()) / static_cast<double>(load.bit_rate);
    load.steady += frame.steady * share;
    load.most += frame.most.value_or(frame.steady) * share;
  }
  return load;
}

}  // namespace canopus::network_project
