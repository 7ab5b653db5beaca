#include "canopus/serve/modbus_server.hpp"

#include <memory>
#include <utility>

#include "canopus/plc/modbus/session.hpp"

namespace canopus::serve {

ModbusServer::ModbusServer(boost::asio::io_context& context, plc::Rack& rack, link::LoopClock& clock,
                           ModbusPort port, TcpServerOptions options, link::ClientReport report)
    : port_(std::move(port)),
      server_(
          context, rack, clock, "Modbus protocol",
          [this, &rack](const link::InternetAddress& client) {
            const bool may_write = !port_.writers || port_.writers->allows(client);
            return std::make_unique<ConversationOf<plc::modbus::Session>>(
                rack, port_.settings, may_write ? port_.settings.write : plc::WritePermission::never);
          },
          std::move(options), std::move(report)) {}

}  // namespace canopus::serve
