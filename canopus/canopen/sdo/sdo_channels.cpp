#include "canopus/canopen/sdo/sdo_channels.hpp"

namespace canopus::canopen {
namespace {

constexpr std::uint16_t first_client = 0x1280;

bool is_usable_by_client(CobId id) { return id.is_valid() && !is_refused(CobIdUse::sdo_client, id); }

}  // namespace

SdoChannels::SdoChannels(NodeContext& node)
    : node_(node), default_server_(node.dictionary, node.sink, node.timers) {
  configure(default_server_);
  for (const ObjectDescription& object : node.dictionary.description().objects()) {
    if (object.index <= 0x1200 || object.index >= first_client) continue;
    servers_.push_back(std::make_unique<Server>(object.index, node));
    configure(servers_.back()->server);
  }
  node.dictionary.attach(0x1200, 0x12FF, *this);
}

void SdoChannels::configure(SdoServer& server) const {
  server.set_time_out(node_.options.sdo_server_time_out);
  server.set_maximum_size(node_.options.sdo_maximum_download);
  server.set_accepts_short_requests(node_.options.accepts_short_sdo_requests);
}

void SdoChannels::read(Server& server) const {
  const ObjectDictionary& d = node_.dictionary;
  server.request = usable(CobId{d.get<std::uint32_t>(server.index, 1, CobId::invalid_bit)});
  server.response = usable(CobId{d.get<std::uint32_t>(server.index, 2, CobId::invalid_bit)});
  server.server.set_response_identifier(server.response.key());
  node_.change_identifiers();
}

void SdoChannels::start() {
  default_server_.set_response_identifier(cob_id::sdo_response + node_.node_id);
  for (const auto& server : servers_) read(*server);
  node_.change_identifiers();
}

void SdoChannels::stop() {
  default_server_.stop();
  for (const auto& server : servers_) server->server.stop();
}

void SdoChannels::list_identifiers(std::vector<IdentifierTable::Route>& routes) const {
  routes.push_back({cob_id::sdo_request + node_.node_id, ServiceKind::sdo_server, 0});
  for (std::size_t i = 0; i < servers_.size(); ++i) {
    if (!servers_[i]->is_valid()) continue;
    routes.push_back(
        {servers_[i]->request.key(), ServiceKind::sdo_server, static_cast<std::uint16_t>(i + 1)});
  }
}

std::optional<SdoClientChannel> SdoChannels::client(std::uint8_t number) const {
  const auto index = static_cast<std::uint16_t>(first_client + number);
  const ObjectDictionary& d = node_.dictionary;
  const CobId request{d.get<std::uint32_t>(index, 1, CobId::invalid_bit)};
  const CobId response{d.get<std::uint32_t>(index, 2, CobId::invalid_bit)};
  if (number > 0x7F || !is_usable_by_client(request) || !is_usable_by_client(response)) return std::nullopt;
  return SdoClientChannel{request.key(), response.key(), d.get<std::uint8_t>(index, 3)};
}

AbortCode SdoChannels::before_write(ObjectDictionary& dictionary, const Entry& entry,
                                    std::span<const std::uint8_t> value, can::Time) {
  if (entry.sub == 0) return AbortCode::write_of_read_only;
  if (entry.sub > 2) return AbortCode::none;
  if (entry.index == 0x1200) return AbortCode::write_of_read_only;  // the default channel stays
  const CobId old_value{dictionary.get<std::uint32_t>(entry)};
  const CobId new_value = CobId::from(value);
  const AbortCode code = check_change(old_value, new_value, node_.options.extended_identifiers);
  // The default channel of a server is restricted to all but clients.
  const bool is_default_channel = is_restricted(new_value) && is_usable_by_client(new_value);
  if (code == AbortCode::none || entry.index < first_client || !is_default_channel) return code;
  return is_usable_by_client(old_value) && old_value.raw != new_value.raw ? code : AbortCode::none;
}

void SdoChannels::after_write(ObjectDictionary&, const Entry& entry, can::Time) {
  if (node_.state == NmtState::initialising || entry.index >= first_client) return;
  for (const auto& server : servers_) {
    // One that was switched off through itself still answers on its old identifier.
    if (server->index == entry.index) {
      const ObjectDictionary& d = node_.dictionary;
      server->request = usable(CobId{d.get<std::uint32_t>(entry.index, 1, CobId::invalid_bit)});
      server->response = usable(CobId{d.get<std::uint32_t>(entry.index, 2, CobId::invalid_bit)});
      if (server->is_valid() && !server->server.busy()) {
        server->server.set_response_identifier(server->response.key());
      }
      node_.change_identifiers();
    }
  }
}

}  // namespace canopus::canopen
