#include "canopus/link/socketcand_beacon.hpp"

#include <string_view>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/host_name.hpp>

namespace canopus::link {
namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

namespace {

/// As the value of an attribute in XML.
std::string attribute(std::string_view text) {
  std::string value;
  for (const char c : text) {
    switch (c) {
      case '&': value += "&amp;"; break;
      case '<': value += "&lt;"; break;
      case '>': value += "&gt;"; break;
      case '"': value += "&quot;"; break;
      default: value += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return value;
}

}  // namespace

std::string socketcand_beacon(const std::string& name, const std::string& bus,
                              const asio::ip::tcp::endpoint& server) {
  // All addresses of this machine: its name.
  const std::string host = server.address().is_unspecified() ? asio::ip::host_name()
                           : server.address().is_v6()        ? "[" + server.address().to_string() + "]"
                                                             : server.address().to_string();
  return "<CANBeacon name=\"" + attribute(name) + "\" type=\"SocketCAN\" description=\"Canopus\">" +
         "<URL>can://" + host + ":" + std::to_string(server.port()) + "</URL>" + "<Bus name=\"" +
         attribute(bus) + "\"/></CANBeacon>";
}

udp::endpoint beacon_destination(const asio::ip::address& server) {
  if (server.is_v6()) return {asio::ip::address_v6::loopback(), socketcand_beacon_port};
  if (server.is_loopback()) return {asio::ip::make_address_v4("127.255.255.255"), socketcand_beacon_port};
  return {asio::ip::address_v4::broadcast(), socketcand_beacon_port};
}

struct SocketcandBeacon::Sender : std::enable_shared_from_this<Sender> {
  Sender(asio::io_context& context, const udp::endpoint& destination, std::string message)
      : socket(context), timer(context), to(destination), text(std::move(message)) {
    error_code ignored;
    socket.open(to.protocol(), ignored);
    if (to.address().is_v4()) socket.set_option(asio::socket_base::broadcast(true), ignored);
    socket.non_blocking(true, ignored);
  }
  void send() {
    error_code ignored;
    socket.send_to(asio::buffer(text), to, 0, ignored);
    timer.expires_after(period);
    timer.async_wait([self = shared_from_this()](const error_code& ended) {
      if (!ended && self->socket.is_open()) self->send();
    });
  }
  void stop() {
    error_code ignored;
    socket.close(ignored);
    timer.cancel();
  }

  udp::socket socket;
  asio::steady_timer timer;
  udp::endpoint to;
  std::string text;
};

SocketcandBeacon::SocketcandBeacon(asio::io_context& context, const udp::endpoint& to, std::string text)
    : sender_(std::make_shared<Sender>(context, to, std::move(text))) {
  sender_->send();
}

SocketcandBeacon::~SocketcandBeacon() { sender_->stop(); }

}  // namespace canopus::link
