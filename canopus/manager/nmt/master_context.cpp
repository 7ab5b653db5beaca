#include "canopus/manager/nmt/master_context.hpp"

#include <algorithm>

namespace canopus::manager {

namespace {

MasterListener& no_listener() {
  static class : public MasterListener {
  } listener;
  return listener;
}

}  // namespace

MasterContext::MasterContext(canopen::Node& the_node, const MasterOptions& the_options)
    : node(the_node), options(the_options), listener(&no_listener()) {
  for (std::uint8_t node_id = 1; node_id < slaves.size(); ++node_id)
    alarms[node_id].add_part(slaves[node_id].guarding.alarm());
}

void MasterContext::set_listener(MasterListener* to) noexcept {
  listener = to != nullptr ? to : &no_listener();
}

void MasterContext::set_state(std::uint8_t node_id, std::uint8_t state, can::Time now) {
  if (slaves[node_id].state == state) return;
  slaves[node_id].state = state;
  listener->node_state_changed(node_id, state, now);
}

void MasterContext::set_error_bits(std::uint8_t node_id, std::uint16_t set, std::uint16_t clear,
                                   can::Time now) {
  std::uint16_t& shown = slaves[node_id].error_bits;
  const auto bits = static_cast<std::uint16_t>((shown & ~clear) | set);
  if (bits == shown) return;
  shown = bits;
  listener->error_control_changed(node_id, bits, now);
}

std::uint32_t MasterContext::assignment(std::uint8_t node_id) const {
  return node_id == node.node_id() ? 0 : node.dictionary().get<std::uint32_t>(0x1F81, node_id);
}

can::Duration MasterContext::heartbeat_time(std::uint8_t node_id) const {
  const auto entries = node.dictionary().get<std::uint8_t>(0x1016, 0);
  for (unsigned sub = 1; sub <= entries; ++sub) {
    const auto entry = node.dictionary().get<std::uint32_t>(0x1016, static_cast<std::uint8_t>(sub));
    if ((entry >> 16 & 0xFF) == node_id && (entry & 0xFFFF) != 0) {
      return std::chrono::milliseconds(entry & 0xFFFF);
    }
  }
  return {};
}

std::span<const std::uint8_t> MasterContext::concise_dcf(std::uint8_t node_id) {
  return source != nullptr ? source->concise_dcf(node_id) : std::span<const std::uint8_t>{};
}

Program MasterContext::open_program(std::uint8_t node_id) {
  return source != nullptr ? source->open_program(node_id) : Program{};
}

unsigned MasterContext::blocks_running() const {
  return static_cast<unsigned>(std::ranges::count_if(
      slaves, [](const Slave& slave) { return slave.boot && slave.boot->downloads_block(); }));
}

}  // namespace canopus::manager
