#include "canopus/link/stream_transport.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/write.hpp>
#include <sys/socket.h>
#include <unistd.h>

namespace canopus::link {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

StreamTransport::StreamTransport(asio::io_context& io, BusAddress address, BusClientOptions options)
    : Transport(io, options), address_(std::move(address)), resolver_(io), connecting_(io) {}

void StreamTransport::connect() {
  const auto connected = [self = self(this), generation = generation_](const error_code& failure,
                                                                       const tcp::endpoint&) {
    if (generation != self->generation_) return;
    if (failure) return self->failed(self->describe_failure(failure));
    error_code ignored;
    self->connecting_.set_option(tcp::no_delay(true), ignored);
    self->connecting_.set_option(asio::socket_base::keep_alive(true), ignored);
    error_code trouble;
    const int descriptor = self->connecting_.release(trouble);
    if (trouble) return self->failed(trouble.message());
    self->use_stream(descriptor);
  };
  resolver_.async_resolve(address_.host, std::to_string(address_.port),
                          [self = self(this), connected, generation = generation_](
                              const error_code& failure, const tcp::resolver::results_type& found) {
                            if (generation != self->generation_) return;
                            if (failure) return self->failed(failure.message());
                            asio::async_connect(self->connecting_, found, connected);
                          });
}

void StreamTransport::use_stream(int descriptor) {
  stream_ = std::make_unique<asio::posix::stream_descriptor>(io(), descriptor);
  read();
  stream_opened();
}

void StreamTransport::disconnect() {
  ++generation_;
  resolver_.cancel();
  error_code ignored;
  connecting_.close(ignored);
  stream_.reset();
  waiting_.clear();
  output_.clear();
  written_.clear();
  writing_ = false;
}

std::string StreamTransport::describe_failure(const error_code& failure) const {
  return failure == asio::error::eof ? "the other side ended the connection" : failure.message();
}

void StreamTransport::read() {
  stream_->async_read_some(asio::buffer(input_),
                           reading_place_([self = self(this), generation = generation_](
                                              const error_code& failure, std::size_t size) {
                             if (generation != self->generation_) return;
                             if (size > 0) self->bytes_received({self->input_.data(), size});
                             if (generation != self->generation_ || self->state() == State::ended) return;
                             if (failure) return self->failed(self->describe_failure(failure));
                             self->read();
                           }));
}

void StreamTransport::write_bytes(std::string_view bytes) {
  waiting_.append(bytes);
  write();
}

void StreamTransport::write() {
  if (writing_ || stream_ == nullptr) return;
  while (!queue().empty() && append(waiting_, queue().front())) {
    written_.push_back(queue().front());
    queue().pop_front();
  }
  if (waiting_.empty()) return;
  writing_ = true;
  std::swap(waiting_, output_);
  waiting_.clear();
  asio::async_write(
      *stream_, asio::buffer(output_),
      writing_place_([self = self(this), generation = generation_](const error_code& failure, std::size_t) {
        if (generation == self->generation_) self->on_written(failure);
      }));
}

void StreamTransport::on_written(const error_code& failure) {
  writing_ = false;
  reported_.clear();
  std::swap(written_, reported_);
  // The other side's last message, which is still read, is a better reason than this error.
  if (failure) return;
  const std::uint32_t generation = generation_;
  if (!reported_.empty()) frames_written(reported_);
  if (generation != generation_ || state() == State::ended) return;
  write();
  if (is_closing()) finish();
}

void StreamTransport::frames_written(std::span<const can::Frame> frames) {
  for (const can::Frame& frame : frames) sent(frame);
}

void StreamTransport::abort_transmissions() { queue().clear(); }

void StreamTransport::finish() { set_closing(); }

bool StreamTransport::finished() const {
  return !writing_ && waiting_.empty() && written_.empty() && Transport::finished();
}

void StreamTransport::write_last(std::string_view bytes) {
  if (stream_ != nullptr) (void)!::write(stream_->native_handle(), bytes.data(), bytes.size());
}

void StreamTransport::shut_down_writing() {
  if (stream_ != nullptr) (void)::shutdown(stream_->native_handle(), SHUT_WR);
}

}  // namespace canopus::link
