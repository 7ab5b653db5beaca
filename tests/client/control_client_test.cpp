// A client of a plant's control server, and what it takes for an answer. The other end is a socket of the loopback interface.

#include "canopus/client/control_client.hpp"

#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::client::control_client_test {
namespace {

using boost::asio::ip::tcp;
using ::testing::EndsWith;

/// What {"request": "list"} leads to when the server answers with this line.
std::expected<text::Json, std::string> answered(const std::string& line) {
  boost::asio::io_context context;
  tcp::acceptor acceptor(context, {boost::asio::ip::address_v4::loopback(), 0});
  const std::jthread server([&] {
    boost::system::error_code ignored;
    tcp::socket socket = acceptor.accept();
    std::string request;
    boost::asio::read_until(socket, boost::asio::dynamic_buffer(request), '\n', ignored);
    EXPECT_EQ(request, "{\"request\":\"list\"}\n");
    boost::asio::write(socket, boost::asio::buffer(line + "\n"), ignored);
  });
  return request_control(
      {.host = "127.0.0.1", .port = acceptor.local_endpoint().port(), .timeout = std::chrono::seconds(10)},
      {{"request", "list"}});
}

TEST(ControlClient, Answer_IsWhatTheServerSays) {
  const auto answer = answered(R"({"ok":true,"t":1.5,"b":1,"a":2})");
  ASSERT_TRUE(answer) << answer.error();
  EXPECT_EQ(answer->dump(), R"({"ok":true,"t":1.5,"b":1,"a":2})");
  EXPECT_EQ(answered(R"({"ok":false,"error":"no such device"})").error(), "no such device");
}

TEST(ControlClient, WhatIsNoAnswer_IsSaid) {
  const std::string nested = std::string(100'000, '[') + std::string(100'000, ']');
  for (const std::string& line : {std::string("x"), std::string("[]"), std::string(R"({"ok":1})"),
                                  std::string(R"({"ok":false})"), R"({"ok":true,"x":)" + nested + "}"}) {
    const auto answer = answered(line);
    ASSERT_FALSE(answer) << line.substr(0, 40);
    EXPECT_THAT(answer.error(), EndsWith(": the answer is none of a plant's control server"));
  }
}

}  // namespace
}  // namespace canopus::client::control_client_test
