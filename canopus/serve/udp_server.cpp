#include "canopus/serve/udp_server.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/udp.hpp>

namespace canopus::serve {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

struct UdpServer::Parts : std::enable_shared_from_this<Parts>, plc::EndProcessing::Requests {
  struct Client {
    udp::endpoint endpoint;
    std::uint64_t heard_number = 0;  // later is higher
    std::unique_ptr<DatagramConversation> conversation;
  };

  Parts(asio::io_context& io, plc::Rack& the_rack, link::LoopClock& the_clock,
        MakeDatagramConversation the_make, UdpServerOptions the_options, link::ClientReport the_report)
      : rack(the_rack),
        clock(the_clock),
        make(std::move(the_make)),
        options(std::move(the_options)),
        report(std::move(the_report)),
        socket(io) {}

  void wait();
  void receive();
  /// The next datagram is in memory. Empty: there is none.
  [[nodiscard]] std::optional<std::size_t> receive_request(udp::endpoint& from);
  [[nodiscard]] bool is_allowed(const udp::endpoint& from) const;
  bool answer(std::span<const std::uint8_t> request, const udp::endpoint& from, can::Time now);
  // plc::EndProcessing::Requests
  void answer_requests(can::Time now) override;
  [[nodiscard]] DatagramConversation& conversation_of(const udp::endpoint& from);

  plc::Rack& rack;
  link::LoopClock& clock;
  MakeDatagramConversation make;
  UdpServerOptions options;
  link::ClientReport report;
  udp::socket socket;
  std::vector<Client> clients;
  std::uint64_t heard = 0;
  std::uint64_t requests = 0;
  std::array<std::uint8_t, 65536> memory{};  // no datagram is longer
};

void UdpServer::Parts::wait() {
  socket.async_wait(udp::socket::wait_read, [self = shared_from_this()](error_code error) {
    if (error || !self->socket.is_open()) return;
    // Datagrams that wait for the END of the scan stay in the socket buffer.
    if (self->rack.answers_at_end()) return self->rack.end_processing().wait(*self);
    self->receive();
    if (self->socket.is_open()) self->wait();
  });
}

void UdpServer::Parts::receive() {
  for (std::size_t i = 0; i < options.turn; ++i) {
    udp::endpoint from;
    const auto size = receive_request(from);
    if (!size) return;
    if (!is_allowed(from)) continue;
    const can::Time now = clock.now();
    if (!socket.is_open()) return;  // the run ended on the way there
    if (!answer(std::span(memory).first(*size), from, now)) continue;
    clock.accessed();
    if (!socket.is_open()) return;
  }
}

void UdpServer::Parts::answer_requests(can::Time now) {
  for (std::size_t i = 0; i < options.turn_at_end; ++i) {
    udp::endpoint from;
    const auto size = receive_request(from);
    if (!size) break;
    if (is_allowed(from)) (void)answer(std::span(memory).first(*size), from, now);
  }
  wait();
}

std::optional<std::size_t> UdpServer::Parts::receive_request(udp::endpoint& from) {
  constexpr int most_errors = 32;  // what became of earlier replies
  for (int errors = 0; errors < most_errors && socket.is_open(); ++errors) {
    error_code error;
    const std::size_t size = socket.receive_from(asio::buffer(memory), from, 0, error);
    if (!error) return size;
    if (error == asio::error::would_block) break;
  }
  return std::nullopt;
}

bool UdpServer::Parts::is_allowed(const udp::endpoint& from) const {
  if (options.allowed.allows(link::internet_address(from.address()))) return true;
  if (report) report(link::name_of(from.address(), from.port()) + " is not allowed to connect");
  return false;
}

bool UdpServer::Parts::answer(std::span<const std::uint8_t> request, const udp::endpoint& from,
                              can::Time now) {
  const auto reply = conversation_of(from).answer(request, now);
  if (reply.empty()) return false;
  ++requests;
  error_code lost;  // as a datagram may be
  socket.send_to(asio::buffer(reply.data(), reply.size()), from, 0, lost);
  return true;
}

DatagramConversation& UdpServer::Parts::conversation_of(const udp::endpoint& from) {
  auto client = std::ranges::find(clients, from, &Client::endpoint);
  if (client == clients.end()) {
    if (clients.size() >= options.maximum_clients)
      clients.erase(std::ranges::min_element(clients, {}, &Client::heard_number));
    clients.push_back({from, 0, make(link::internet_address(from.address()))});
    client = clients.end() - 1;
  }
  client->heard_number = ++heard;
  return *client->conversation;
}

UdpServer::UdpServer(asio::io_context& context, plc::Rack& rack, link::LoopClock& clock,
                     MakeDatagramConversation make, UdpServerOptions options, link::ClientReport report)
    : parts_(std::make_shared<Parts>(context, rack, clock, std::move(make), std::move(options),
                                     std::move(report))) {}

UdpServer::~UdpServer() { stop(); }

std::expected<void, std::string> UdpServer::listen(const std::string& host, std::uint16_t port) {
  const auto failed = [&](const error_code& error) {
    error_code ignored;
    parts_->socket.close(ignored);
    return std::unexpected(host + ":" + std::to_string(port) + ": " + error.message());
  };
  error_code error;
  udp::socket& socket = parts_->socket;
  udp::resolver resolver(socket.get_executor());
  const auto found = resolver.resolve(host, std::to_string(port),
                                      udp::resolver::passive | udp::resolver::numeric_service, error);
  if (error) return failed(error);
  const udp::endpoint endpoint = found.begin()->endpoint();
  socket.open(endpoint.protocol(), error);
  if (error) return failed(error);
  socket.bind(endpoint, error);
  if (error) return failed(error);
  socket.non_blocking(true, error);
  if (error) return failed(error);
  parts_->wait();
  return {};
}

std::uint16_t UdpServer::port() const noexcept {
  error_code error;
  const udp::endpoint endpoint = parts_->socket.local_endpoint(error);
  return error ? std::uint16_t{0} : endpoint.port();
}

std::size_t UdpServer::clients() const noexcept { return parts_->clients.size(); }

std::uint64_t UdpServer::requests() const noexcept { return parts_->requests; }

void UdpServer::stop() noexcept {
  error_code ignored;
  parts_->rack.end_processing().leave(*parts_);
  parts_->socket.close(ignored);
  parts_->clients.clear();
}

}  // namespace canopus::serve
