#pragma once
// EMCY consumer [CiA 301 7.2.7]: 1028H lists the COB-IDs to listen to, sub-index = node-ID of the producer,
// bit 31 = not this one. Messages are reported to the application in Pre-operational and Operational; shorter
// ones than eight bytes are ignored.
//
// Checks of 1028H: identifier rules; the identifier cannot be changed while valid (06090030H).

#include <vector>

#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class EmcyConsumer final : public ObjectHandler {
 public:
  explicit EmcyConsumer(NodeContext& node);

  void receive(std::uint8_t sub, const can::Frame& frame, can::Time now);
  void list_identifiers(std::vector<IdentifierTable::Route>& routes) const;

  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time) override { node_.change_identifiers(); }

 private:
  NodeContext& node_;
};

}  // namespace canopus::canopen
