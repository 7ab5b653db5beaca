// A bus of a network: all members of a multicast group, as in python-can's udp_multicast. Datagrams do not
// pass a router (TTL 1). We send from a socket of our own, whose address distinguishes our datagrams from
// those of other programs of this machine.

#include <chrono>
#include <utility>

#include <boost/asio/ip/multicast.hpp>

#include "canopus/link/controller_status.hpp"
#include "canopus/link/datagram_transport.hpp"
#include "canopus/link/peer.hpp"
#include "canopus/link/udp_multicast/multicast_datagram.hpp"

namespace canopus::link {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

class MulticastTransport final : public DatagramTransport {
 public:
  MulticastTransport(asio::io_context& io, const BusAddress& address, const BusClientOptions& options)
      : DatagramTransport(io, address, options), sender_(io) {}

 private:
  void connect() override {
    error_code failure;
    const auto group = asio::ip::make_address(address().host, failure);
    if (failure) return failed(failure.message());
    group_ = udp::endpoint(group, address().port);
    const udp protocol = group_.protocol();

    udp::socket socket(io());
    socket.open(protocol, failure);
    if (!failure) socket.set_option(asio::socket_base::reuse_address(true), failure);
    error_code ignored;
    socket.set_option(asio::socket_base::receive_buffer_size(1 << 20), ignored);
    // Bound to the group, it receives no other datagrams of this port.
    if (!failure) socket.bind(group_, failure);
    if (failure) return failed("port " + std::to_string(address().port) + ": " + failure.message());
    socket.set_option(asio::ip::multicast::join_group(group), failure);

    if (!failure) sender_.open(protocol, failure);
    if (!failure) sender_.set_option(asio::ip::multicast::hops(1), failure);
    if (!failure) sender_.set_option(asio::ip::multicast::enable_loopback(true), failure);
    // After connect() its local address is the source address of our datagrams.
    if (!failure) sender_.connect(group_, failure);
    if (!failure) ours_ = sender_.local_endpoint(failure);
    if (!failure) sender_.non_blocking(true, failure);
    if (failure)
      return failed("the group cannot be joined: " + failure.message() + " (a route to it? see `ip route`)");
    use_socket(std::move(socket));
    opened();
  }
  void disconnect() override {
    error_code ignored;
    sender_.close(ignored);
    DatagramTransport::disconnect();
  }

  void write_frames() override {
    std::array<std::uint8_t, multicast_max_datagram> bytes;
    while (!queue().empty()) {
      const can::Frame frame = queue().front();
      const auto now = std::chrono::system_clock::now().time_since_epoch();
      const std::size_t size = write_multicast_datagram(bytes, frame, now);
      if (!write_datagram(sender_, std::span(bytes).first(size), group_)) return;
      if (!queue().empty()) queue().pop_front();
      sent(frame);
    }
  }
  void datagram_received(std::span<const std::uint8_t> bytes, const Endpoint& sender) override {
    if (is_ours(sender)) return;
    const auto message = read_multicast_datagram(bytes);
    if (!message) {
      if (!std::exchange(complained_, true)) {
        complain("a datagram of " + sender.address().to_string() +
                 " is no CAN message: " + std::string(message.error()));
      }
      return;
    }
    switch (message->kind) {
      case MulticastMessage::Kind::frame: return received(message->frame, message->time);
      case MulticastMessage::Kind::error_frame: return;  // of another program's controller; ours has none
      case MulticastMessage::Kind::fd_frame:
        if (!std::exchange(received_fd_, true)) complain("CAN FD frames of this bus are left out");
        return;
    }
  }

  /// A link-local sender has its interface's number with its address, the address of a socket need not.
  [[nodiscard]] bool is_ours(const Endpoint& sender) const {
    if (sender.port() != ours_.port()) return false;
    return link::internet_address(sender.address()) == link::internet_address(ours_.address());
  }

  udp::socket sender_;
  Endpoint group_;
  Endpoint ours_;
  bool complained_ = false;
  bool received_fd_ = false;
};

}  // namespace

std::shared_ptr<Transport> make_multicast(asio::io_context& io, const BusAddress& address,
                                          const BusClientOptions& options) {
  return std::make_shared<MulticastTransport>(io, address, options);
}

}  // namespace canopus::link
