#include "canopus/canopen/messages/emcy_consumer.hpp"

#include <algorithm>
#include <cstring>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {

EmcyConsumer::EmcyConsumer(NodeContext& node) : node_(node) { node.dictionary.attach(0x1028, 0x1028, *this); }

void EmcyConsumer::receive(std::uint8_t sub, const can::Frame& frame, can::Time now) {
  if (!node_.communicates() || frame.length() != 8 || node_.listener == nullptr) return;
  Emergency emergency;
  emergency.node_id = sub;
  emergency.code = can::load_as<std::uint16_t>(&frame.data[0]);
  emergency.error_register = frame.data[2];
  std::copy_n(frame.data.begin() + 3, 5, emergency.manufacturer.begin());
  node_.listener->emergency_received(emergency, now);
}

void EmcyConsumer::list_identifiers(std::vector<IdentifierTable::Route>& routes) const {
  const DictionaryDescription& description = node_.dictionary.description();
  const ObjectDescription* object = description.find(0x1028);
  if (object == nullptr && node_.options.predefined_emergency) {
    for (std::uint16_t sender = 1; sender <= 127; ++sender) {
      if (sender == node_.node_id) continue;
      routes.push_back(
          {IdentifierTable::key(cob_id::emcy + sender, false, false), ServiceKind::emcy, sender});
    }
  }
  if (object == nullptr) return;
  const unsigned highest = std::min<unsigned>(object->highest_sub, 127);
  for (unsigned sub = 1; sub <= highest; ++sub) {
    if (sub == node_.node_id) continue;  // its own
    const Entry entry = description.find(*object, static_cast<std::uint8_t>(sub));
    if (!entry) continue;
    const CobId cob_id = usable(CobId{node_.dictionary.get<std::uint32_t>(entry)});
    if (!cob_id.is_valid()) continue;
    routes.push_back({IdentifierTable::key(cob_id.identifier(), cob_id.is_extended(), false),
                      ServiceKind::emcy, static_cast<std::uint16_t>(sub)});
  }
}

AbortCode EmcyConsumer::before_write(ObjectDictionary& dictionary, const Entry& entry,
                                     std::span<const std::uint8_t> value, can::Time) {
  if (entry.sub == 0) return AbortCode::write_of_read_only;
  if (node_.options.reserved_bit_30_is_zero && CobId::from(value).has_bit_30())
    return AbortCode::invalid_value;
  return check_change(CobId{dictionary.get<std::uint32_t>(entry)}, CobId::from(value),
                      node_.options.extended_identifiers);
}

}  // namespace canopus::canopen
