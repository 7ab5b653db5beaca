#pragma once
// The SDO channels of a node [CiA 301 7.2.4.2]: its default server on 600H/580H + node-ID, additional servers
// on the COB-IDs of 1201H-127FH (01H client to server, 02H server to client), and the parameters of SDO
// clients 1280H-12FFH (01H client to server, 02H server to client, 03H node-ID of the server), which the
// application runs. A channel exists while bit 31 of both COB-IDs is 0.
//
// Checks: COB-ID rules; the identifier cannot be changed while valid (06090030H). A client may use the
// default channel of a server, whose identifiers are restricted otherwise.

#include <memory>
#include <optional>
#include <vector>

#include "canopus/canopen/sdo/sdo_channel.hpp"
#include "canopus/canopen/sdo/sdo_server.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class SdoChannels final : public ObjectHandler {
 public:
  /// Only the additional servers that the dictionary has exist.
  explicit SdoChannels(NodeContext& node);

  void start();
  /// Gives all transfers up in silence.
  void stop();
  /// `number`: 0 is the default server.
  void receive(std::uint16_t number, const can::Frame& frame, can::Time now) {
    server_of(number).receive(frame, now);
  }
  void tick(std::uint16_t number, can::Time now) { server_of(number).tick(now); }
  void list_identifiers(std::vector<IdentifierTable::Route>& routes) const;
  [[nodiscard]] std::size_t size() const noexcept { return servers_.size() + 1; }
  [[nodiscard]] TimerQueue::Number first_timer() const noexcept { return default_server_.timer(); }

  /// Channel 1280H + `number`, if it exists and is valid.
  [[nodiscard]] std::optional<SdoClientChannel> client(std::uint8_t number) const;

  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time) override;

 private:
  struct Server {
    Server(std::uint16_t object, NodeContext& node)
        : index(object), server(node.dictionary, node.sink, node.timers) {}
    std::uint16_t index;  // 1201H..
    CobId request;
    CobId response;
    SdoServer server;
    [[nodiscard]] bool is_valid() const noexcept { return request.is_valid() && response.is_valid(); }
  };
  void configure(SdoServer& server) const;
  void read(Server& server) const;
  [[nodiscard]] SdoServer& server_of(std::uint16_t number) noexcept {
    return number == 0 ? default_server_ : servers_[number - 1U]->server;
  }

  NodeContext& node_;
  SdoServer default_server_;
  std::vector<std::unique_ptr<Server>> servers_;  // their timers follow that of the default server
};

}  // namespace canopus::canopen
