#include "canopus/client/plc_link.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include "canopus/text/text_values.hpp"

namespace canopus::client {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;
using Frame = PlcConnection::Frame;

struct PlcLink::Parts {
  asio::io_context context;
  tcp::socket stream{context};
  udp::socket datagrams{context};
  std::array<std::uint8_t, 65536> datagram{};
  std::size_t size = 0;   // of the datagram
  std::size_t taken = 0;  // of them by receive()
};

PlcLink::PlcLink(PlcConnection connection)
    : connection_(std::move(connection)), parts_(std::make_unique<Parts>()) {}
PlcLink::~PlcLink() = default;

std::string PlcLink::failed(std::string_view what) const {
  return fmt::format("{}:{}: {}", connection_.host, connection_.port, what);
}

std::string PlcLink::not_a_reply() const {
  return failed(connection_.frame == Frame::modbus ? "the answer is no reply of Modbus TCP"
                                                   : "the answer is no reply of the MELSEC protocol");
}

std::string PlcLink::nobody_there(std::string_view error) const {
  std::string_view where = R"(listen = "127.0.0.1:5007")";
  std::string_view real = "A real CPU needs an open setting for the MC protocol";
  if (connection_.frame == Frame::modbus) {
    where = "listen of [[plc.modbus]]";
    real = "A real PLC needs its Modbus TCP server enabled";
  } else if (connection_.frame == Frame::frame_1e || connection_.udp) {
    where = "listen of [[plc.port]]";
  }
  const std::string_view transport = connection_.frame == Frame::modbus ? ""
                                     : connection_.udp                  ? ", UDP"
                                                                        : ", TCP";
  return failed(fmt::format(
      "{}. Is `canopus run` running, without --virtual? Its plant file says where the PLC listens: "
      "{}. {}{}",
      error, where, real, transport));
}

std::string PlcLink::no_answer() const {
  const std::string within = "no answer within " + text::describe_duration(connection_.timeout);
  return failed(connection_.udp ? within + ": no answer from this address, or a datagram was lost" : within);
}

/// Runs the operation that was started, at most for the time-out.
bool PlcLink::finish() {
  parts_->context.restart();
  parts_->context.run_for(connection_.timeout);
  if (parts_->context.stopped()) return true;
  error_code ignored;
  parts_->stream.close(ignored);
  parts_->datagrams.close(ignored);
  parts_->context.run();
  return false;
}

PlcLink::Result<void> PlcLink::open() {
  error_code error;
  const std::string port = std::to_string(connection_.port);
  if (connection_.udp) {
    udp::resolver resolver(parts_->context);
    const auto found = resolver.resolve(connection_.host, port, error);
    if (error) return std::unexpected(failed(error.message()));
    asio::connect(parts_->datagrams, found, error);
    if (error) return std::unexpected(failed(error.message()));
    return {};
  }
  tcp::resolver resolver(parts_->context);
  const auto found = resolver.resolve(connection_.host, port, error);
  if (error) return std::unexpected(failed(error.message()));
  error = asio::error::would_block;
  asio::async_connect(parts_->stream, found,
                      [&error](error_code result, const tcp::endpoint& /*endpoint*/) { error = result; });
  if (!finish())
    return std::unexpected(failed("no connection within " + text::describe_duration(connection_.timeout)));
  if (error == asio::error::connection_refused) return std::unexpected(nobody_there(error.message()));
  if (error) return std::unexpected(failed(error.message()));
  parts_->stream.set_option(tcp::no_delay(true), error);
  return {};
}

PlcLink::Result<void> PlcLink::send(std::span<const std::uint8_t> request) {
  error_code error;
  if (connection_.udp) {
    parts_->size = 0;
    parts_->taken = 0;
    parts_->datagrams.send(asio::buffer(request.data(), request.size()), 0, error);
  } else {
    asio::write(parts_->stream, asio::buffer(request.data(), request.size()), error);
  }
  if (error == asio::error::connection_refused) return std::unexpected(nobody_there(error.message()));
  if (error) return std::unexpected(failed(error.message()));
  return {};
}

PlcLink::Result<void> PlcLink::receive(std::span<std::uint8_t> into) {
  error_code error = asio::error::would_block;
  if (!connection_.udp) {
    asio::async_read(parts_->stream, asio::buffer(into.data(), into.size()),
                     [&error](error_code result, std::size_t /*count*/) { error = result; });
    silent_ = !finish();
    if (silent_) return std::unexpected(no_answer());
    silent_ = error == asio::error::eof || error == asio::error::connection_reset;
    if (error == asio::error::eof) return std::unexpected(failed("the PLC closed the connection"));
    if (error) return std::unexpected(failed(error.message()));
    return {};
  }
  if (parts_->size == 0) {
    parts_->datagrams.async_receive(asio::buffer(parts_->datagram),
                                    [this, &error](error_code result, std::size_t count) {
                                      error = result;
                                      parts_->size = count;
                                    });
    silent_ = !finish();
    if (silent_) return std::unexpected(no_answer());
    if (error == asio::error::connection_refused) return std::unexpected(nobody_there(error.message()));
    if (error) return std::unexpected(failed(error.message()));
  }
  if (parts_->size - parts_->taken < into.size()) return std::unexpected(not_a_reply());
  std::copy_n(parts_->datagram.begin() + static_cast<std::ptrdiff_t>(parts_->taken), into.size(),
              into.begin());
  parts_->taken += into.size();
  return {};
}

bool PlcLink::is_taken() const noexcept { return parts_->taken == parts_->size; }

}  // namespace canopus::client
