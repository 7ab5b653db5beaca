#pragma once
// A foreign client of the socketcand server, and a server on a bus that a test moves.

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/link/socketcand_server.hpp"

#include "link/toy_bus.hpp"

namespace canopus::link {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using can::Frame;
using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::chrono_literals;

inline const tcp::endpoint any_local_port(asio::ip::address_v4::loopback(), 0);

/// A foreign client: keeps what each receive call returned.
class Client {
 public:
  Client(asio::io_context& io, std::uint16_t server_port) : socket_(io) {
    socket_.connect({asio::ip::address_v4::loopback(), server_port});
    port = socket_.local_endpoint().port();
    read();
  }
  std::uint16_t port = 0;  // its own
  void send(std::string_view text) { asio::write(socket_, asio::buffer(text)); }
  /// Sends the text again and again until the connection takes no more for now; how often it was sent.
  std::size_t flood(std::string_view text) {
    socket_.non_blocking(true);
    std::size_t size = 0;
    error_code failure;
    while (!failure) size += socket_.write_some(asio::buffer(text.substr(size % text.size())), failure);
    return size / text.size();
  }
  void close() { socket_.close(); }
  void reset() {
    socket_.set_option(asio::socket_base::linger(true, 0));
    socket_.close();
  }

  std::vector<std::string> received;  // one entry per segment that arrived
  bool closed_by_server = false;
  [[nodiscard]] std::string all() const {
    std::string text;
    for (const std::string& segment : received) text += segment;
    return text;
  }

 private:
  void read() {
    socket_.async_read_some(asio::buffer(input_), [this](const error_code& failure, std::size_t size) {
      if (failure == asio::error::operation_aborted) return;
      if (failure) {
        closed_by_server = true;
        return;
      }
      received.emplace_back(input_.data(), size);
      read();
    });
  }

  tcp::socket socket_;
  std::array<char, 256> input_{};
};

class SocketcandServerTest : public testing::Test {
 protected:
  void SetUp() override { start({}); }

  void start(SocketcandLimits limits) {
    server.reset();
    server = std::make_unique<SocketcandServer>(
        io, any_local_port, "line1", bus.attach(), bus, limits,
        [this](std::string_view sentence) { reports.emplace_back(sentence); });
    const auto listening = server->listen();
    ASSERT_TRUE(listening) << listening.error();
  }

  /// Runs the loop until the condition holds; a test that waits in vain is stopped by its time limit.
  void until(const std::function<bool()>& condition) {
    while (!condition()) io.run_one();
  }

  std::unique_ptr<Client> connect() {
    auto client = std::make_unique<Client>(io, server->port());
    until([&] { return !client->received.empty() || client->closed_by_server; });
    return client;
  }

  /// A client in raw mode whose settling time is over.
  std::unique_ptr<Client> connect_raw() {
    auto client = connect();
    client->send("< open line1 >");
    until([&] { return client->all() == "< hi >< ok >"; });
    client->send("< rawmode >");
    until([&] { return client->all() == "< hi >< ok >< ok >"; });
    bus.advance(20ms);
    client->received.clear();
    return client;
  }

  /// A bus that takes 100 frames a second, until the condition holds.
  void run_slow_bus_until(const std::function<bool()>& condition) {
    while (!condition()) {
      while (io.poll() > 0) {
      }
      if (bus.waiting() == 0) io.run_one_for(1ms);  // the system has not brought everything yet
      bus.advance(bus.waiting() == 0 ? 1ms : 10ms);
      bus.run_one();
    }
  }
  /// A bus where no node acknowledges, until the condition holds.
  void run_dead_bus_until(const std::function<bool()>& condition) {
    while (!condition()) {
      while (io.poll() > 0) {
      }
      bus.advance(10ms);
    }
  }

  asio::io_context io;
  ToyBus bus;
  std::vector<std::string> reports;
  std::unique_ptr<SocketcandServer> server;
};

}  // namespace canopus::link
