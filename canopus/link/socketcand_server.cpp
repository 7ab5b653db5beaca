#include "canopus/link/socketcand_server.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <netinet/tcp.h>

#include "canopus/link/socketcand_connection.hpp"
#include "canopus/link/tcp/connection_owner.hpp"

namespace canopus::link {
namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

/// Small socket buffers between a client and this server: TCP slows down a client that is faster than the
/// bus, and unsent frames of a disconnected client occupy the bus only shortly. Connections inherit both: the
/// window they offer to the client, and the segment size, by which the client's side measures what it
/// gathers. About 80 KiB instead of 4 MiB.
void set_small_buffer(tcp::acceptor& acceptor) {
  constexpr int window = 2 * 1024;
  constexpr int segment = 1400;
  error_code ignored;
  acceptor.set_option(asio::socket_base::receive_buffer_size(window), ignored);
  using MaximumSegment = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_MAXSEG>;
  acceptor.set_option(MaximumSegment(segment), ignored);
}

}  // namespace

void SocketcandServer::Shared::admit(tcp::socket socket) {
  ++statistics.connections;
  constexpr std::string_view not_allowed = "< error not allowed >";
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);  // a machine that vanished is noticed
  // Frames that wait in the kernel are as late as those in the queue, but are not counted.
  socket.set_option(asio::socket_base::send_buffer_size(64 * 1024), ignored);
  if (!clients.may_connect(socket, not_allowed)) return;
  if (limits.own_user_alone && !is_of_own_user(socket))
    return clients.refuse(socket, "is not allowed to connect", not_allowed);
  constexpr std::string_view too_many = "< error too many clients >";
  if (clients.is_full()) return clients.refuse(socket, "was refused: too many clients", too_many);
  const auto client = std::make_shared<Client>(*this, std::move(socket));
  (void)clock.now();  // it joins now, not at the bus's last event
  if (!client->attach())
    return clients.refuse(client->socket(), "was refused: the bus takes no more", too_many);
  clients.add(client);
  client->start();
  clock.touched();
}

SocketcandServer::SocketcandServer(asio::io_context& io, const tcp::endpoint& endpoint, std::string bus_name,
                                   AttachToBus attach, LoopClock& clock, SocketcandLimits limits,
                                   ClientReport report)
    : shared_(std::make_shared<Shared>(io, endpoint, std::move(bus_name), std::move(attach), clock, limits,
                                       std::move(report))) {}

SocketcandServer::~SocketcandServer() { close(); }

std::expected<void, std::string> SocketcandServer::listen() {
  const error_code failure = shared_->clients.listen(
      shared_->endpoint, set_small_buffer,
      [shared = shared_](tcp::socket socket) { shared->admit(std::move(socket)); },
      "< error too many open files >");
  if (!failure) return {};
  return std::unexpected("cannot listen on " + shared_->endpoint.address().to_string() + ':' +
                         std::to_string(shared_->endpoint.port()) + ": " + failure.message());
}

std::uint16_t SocketcandServer::port() const noexcept { return shared_->clients.port(); }

SocketcandStatistics SocketcandServer::statistics() const noexcept {
  SocketcandStatistics statistics = shared_->statistics;
  statistics.clients = shared_->clients.size();
  return statistics;
}

std::size_t SocketcandServer::waiting_messages() const noexcept {
  std::size_t most = 0;
  for (const auto& client : shared_->clients.all()) most = std::max(most, client->waiting_messages());
  return most;
}

void SocketcandServer::close() {
  shared_->clients.close_port();
  const auto clients = shared_->clients.all();  // leave() takes each off the list
  for (const auto& client : clients) client->leave();
}

}  // namespace canopus::link
