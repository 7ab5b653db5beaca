#pragma once
// Heartbeat consumer [CiA 301 7.2.8.3.2.2]: 1016H lists the nodes to watch, one sub-index each: bits 16-23
// node-ID, bits 0-15 consumer time in ms; an entry with time 0 or a node-ID outside 1..127 is unused.
// Watching begins with the first heartbeat (700H + node-ID, one byte, the state) and each one starts the time
// anew; when it ends, the heartbeat event has occurred: EMCY 8130H, 1029H, NodeListener::heartbeat_lost();
// the next heartbeat ends it. A boot-up message (state 00H) says that the node was reset: it is reported to the
// application, and watching begins again with the first heartbeat after it.
//
// Checks: a node-ID in two used entries 06040043H; bits 24-31 not 0 06090030H.

#include <vector>

#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class HeartbeatConsumer final : public ObjectHandler {
 public:
  explicit HeartbeatConsumer(NodeContext& node);

  /// Reads all of 1016H; no heartbeat has come yet.
  void start();
  void stop();
  /// The frame of entry `number` came.
  void receive(std::uint16_t number, const can::Frame& frame, can::Time now);
  void tick(std::uint16_t number, can::Time now);
  void list_identifiers(std::vector<IdentifierTable::Route>& routes) const;
  [[nodiscard]] TimerQueue::Number first_timer() const noexcept { return first_timer_; }

  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time) override;

 private:
  enum class State : std::uint8_t { unused, waiting, alive, lost };
  struct Watch {
    std::uint8_t node_id = 0;
    State state = State::unused;
    std::uint16_t milliseconds = 0;
  };
  void read(std::size_t number);

  NodeContext& node_;
  std::vector<Watch> watches_;  // by sub-index - 1
  TimerQueue::Number first_timer_ = 0;
};

}  // namespace canopus::canopen
