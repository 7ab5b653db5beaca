#pragma once
// TIME, consumer and producer [CiA 301 7.2.6]: six bytes with the identifier of 1012H (default 100H): bytes
// 0-3 milliseconds after midnight (28 bits), bytes 4-5 days since 1984-01-01. Bit 31 of 1012H: this node
// consumes TIME; bit 30: it may produce it. Shorter frames are ignored. It is the application that says when
// to send.
//
// Checks of 1012H: identifier rules; changing bits 0-29 while bit 30 or bit 31 stays 1 06090030H.

#include <vector>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

struct TimeOfDay;

class TimeStamp final : public ObjectHandler {
 public:
  explicit TimeStamp(NodeContext& node);

  void start();
  void stop();
  void receive(const can::Frame& frame, can::Time now);
  /// False when bit 30 is 0, the state does not allow it or the frame could not be queued.
  bool send(const TimeOfDay& time);
  void list_identifiers(std::vector<IdentifierTable::Route>& routes) const;

  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time) override { start(); }

 private:
  NodeContext& node_;
  CobId cob_id_{0};
};

}  // namespace canopus::canopen
