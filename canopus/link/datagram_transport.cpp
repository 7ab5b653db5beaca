#include "canopus/link/datagram_transport.hpp"

#include <utility>

#include <boost/asio/buffer.hpp>

namespace canopus::link {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

DatagramTransport::DatagramTransport(asio::io_context& io, BusAddress address, BusClientOptions options)
    : Transport(io, options), address_(std::move(address)), socket_(io), pause_(io) {}

void DatagramTransport::use_socket(Socket socket) {
  socket_ = std::move(socket);
  error_code ignored;
  socket_.non_blocking(true, ignored);
  read();
}

void DatagramTransport::disconnect() {
  ++generation_;
  writing_ = false;
  pause_.cancel();
  error_code ignored;
  socket_.close(ignored);
}

void DatagramTransport::read() {
  socket_.async_receive_from(
      asio::buffer(input_), sender_,
      reading_place_([self = self(this), generation = generation_](const error_code& failure,
                                                                   std::size_t size) {
        if (generation != self->generation_) return;
        // ICMP port unreachable for a datagram of ours: no receiver there yet.
        if (failure && failure != asio::error::connection_refused && failure != asio::error::message_size) {
          return self->failed(failure.message());
        }
        if (!failure) self->datagram_received(std::span(self->input_).first(size), self->sender_);
        if (generation == self->generation_) self->read();
      }));
}

void DatagramTransport::write() {
  if (std::exchange(writing_, true)) return;
  pause_.expires_after(std::chrono::nanoseconds(0));
  pause_.async_wait(pause_place_([self = self(this), generation = generation_](const error_code& failure) {
    if (failure || generation != self->generation_) return;
    self->writing_ = false;
    self->write_frames();
  }));
}

bool DatagramTransport::write_datagram(Socket& socket, std::span<const std::uint8_t> bytes,
                                       const Endpoint& to) {
  error_code failure;
  socket.send_to(asio::buffer(bytes.data(), bytes.size()), to, 0, failure);
  if (failure == asio::error::connection_refused)
    socket.send_to(asio::buffer(bytes.data(), bytes.size()), to, 0, failure);
  if (!failure || failure == asio::error::connection_refused) return true;
  const bool is_full = failure == asio::error::would_block || failure == asio::error::no_buffer_space;
  if (!is_full) {
    failed(failure.message());
    return false;
  }
  writing_ = true;
  pause_.expires_after(std::chrono::milliseconds(1));
  pause_.async_wait([self = self(this), generation = generation_](const error_code& late) {
    if (late || generation != self->generation_) return;
    self->writing_ = false;
    self->write_frames();
  });
  return false;
}

}  // namespace canopus::link
