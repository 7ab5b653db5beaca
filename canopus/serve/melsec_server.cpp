#include "canopus/serve/melsec_server.hpp"

#include <memory>
#include <utility>

#include "canopus/plc/melsec/session.hpp"

namespace canopus::serve {

namespace {

using plc::melsec::Session;

class MelsecDatagrams final : public DatagramConversation {
 public:
  MelsecDatagrams(plc::Rack& rack, plc::melsec::PortSettings settings, plc::melsec::PasswordGuard& guard)
      : session_(rack, std::move(settings), &guard) {}

  std::span<const std::uint8_t> answer(std::span<const std::uint8_t> request, can::Time now) override {
    session_.datagram(request, now);
    return session_.output();
  }

 private:
  Session session_;
};

}  // namespace

MelsecServer::MelsecServer(boost::asio::io_context& context, plc::Rack& rack, link::LoopClock& clock,
                           MelsecServerOptions options, link::ClientReport report, MelsecPort port)
    : rack_(rack), port_(std::move(port)) {
  if (port_.udp) {
    udp_.emplace(
        context, rack, clock,
        [this](const link::InternetAddress& client) {
          return std::make_unique<MelsecDatagrams>(rack_, settings_for(client), guard_);
        },
        UdpServerOptions{.allowed = std::move(options.allowed), .maximum_clients = options.maximum_clients},
        std::move(report));
    return;
  }
  tcp_.emplace(
      context, rack, clock, "MC protocol",
      [this](const link::InternetAddress& client) {
        return std::make_unique<ConversationOf<Session>>(rack_, settings_for(client), &guard_);
      },
      std::move(options), std::move(report));
}

plc::melsec::PortSettings MelsecServer::settings_for(const link::InternetAddress& client) const {
  plc::melsec::PortSettings settings = port_.settings;
  if (port_.writers && !port_.writers->allows(client)) settings.write = plc::WritePermission::never;
  return settings;
}

std::expected<void, std::string> MelsecServer::listen(const std::string& host, std::uint16_t port) {
  return tcp_ ? tcp_->listen(host, port) : udp_->listen(host, port);
}

std::uint16_t MelsecServer::port() const noexcept { return tcp_ ? tcp_->port() : udp_->port(); }

std::size_t MelsecServer::clients() const noexcept { return tcp_ ? tcp_->clients() : udp_->clients(); }

std::uint64_t MelsecServer::requests() const noexcept { return tcp_ ? tcp_->requests() : udp_->requests(); }

void MelsecServer::stop() noexcept {
  if (tcp_) tcp_->stop();
  if (udp_) udp_->stop();
}

}  // namespace canopus::serve
