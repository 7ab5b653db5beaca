#pragma once
// Error behaviour [CiA 301 7.5.2.32]: 1029:01 says what a communication error (bus-off, heartbeat event,
// life guarding event) does to the NMT state: 00H Operational becomes Pre-operational (also when there is no
// 1029H), 01H nothing, 02H Stopped. Other values are refused with 06090030H.

#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class ErrorBehaviour final : public ObjectHandler {
 public:
  explicit ErrorBehaviour(NodeContext& node) : node_(node) { node.dictionary.attach(0x1029, 0x1029, *this); }

  /// The state that a communication error in `state` leads to.
  [[nodiscard]] NmtState after_error(NmtState state) const noexcept {
    if (state == NmtState::initialising) return state;
    switch (node_.dictionary.get<std::uint8_t>(0x1029, 1, node_.options.error_behaviour)) {
      case 0: return state == NmtState::operational ? NmtState::pre_operational : state;
      case 2: return NmtState::stopped;
      default: return state;
    }
  }

  AbortCode before_write(ObjectDictionary&, const Entry& entry, std::span<const std::uint8_t> value,
                         can::Time) override {
    return entry.sub == 1 && !value.empty() && value[0] > 2 ? AbortCode::invalid_value : AbortCode::none;
  }

 private:
  NodeContext& node_;
};

}  // namespace canopus::canopen
