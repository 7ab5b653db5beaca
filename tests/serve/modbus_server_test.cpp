// Modbus TCP on real sockets of the loopback interface; the test turns the event loop itself. What any TCP server does
// with its clients is tested with the MC protocol's.

#include "canopus/serve/modbus_server.hpp"

#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::serve::modbus_server_test {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;
using plc::testing::bytes;
using plc::testing::shown;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class TestClock final : public link::LoopClock {
 public:
  can::Time now() override { return can::Time(10s); }
  void touched() override { ++touches; }
  int touches = 0;
};

class ModbusServerTest : public ::testing::Test {
 protected:
  ModbusServerTest() { plc_.word(plc::Device::d, 100, 0x1234); }

  void start(TcpServerOptions options = {},
             ModbusPort port = {.settings = {.map = plc::modbus::default_map(plc::r04cpu())}}) {
    server_ = std::make_unique<ModbusServer>(
        context_, plc_.rack, clock_, std::move(port), std::move(options),
        [this](std::string_view sentence) { reports_.emplace_back(sentence); });
    EXPECT_TRUE(server_->listen("127.0.0.1", 0));
  }
  tcp::socket connect() {
    tcp::socket socket(client_context_);
    socket.connect({boost::asio::ip::address_v4::loopback(), server_->port()});
    socket.non_blocking(true);
    context_.poll();
    return socket;
  }
  std::string request(tcp::socket& socket, const std::string& request) {
    boost::asio::write(socket, boost::asio::buffer(bytes(request)));
    return receive(socket);
  }
  std::string receive(tcp::socket& socket) {
    std::vector<char> memory(10000);
    for (int turn = 0; turn < 100; ++turn) {
      context_.run_one_for(10ms);
      context_.poll();
      error_code error;
      const std::size_t count = socket.read_some(boost::asio::buffer(memory), error);
      if (error == boost::asio::error::would_block) continue;
      if (error) return "closed";
      return shown(std::string_view(memory.data(), count));
    }
    return "nothing";
  }

  boost::asio::io_context context_;
  boost::asio::io_context client_context_;
  plc::testing::Plc plc_;
  TestClock clock_;
  std::vector<std::string> reports_;
  std::unique_ptr<ModbusServer> server_;
};

TEST_F(ModbusServerTest, SeveralClients_AreAnsweredEachItsOwn) {
  start();
  auto first = connect();
  auto second = connect();
  EXPECT_EQ(request(first, "00 01 00 00 00 06 ff 03 00 64 00 01"), "00 01 00 00 00 05 ff 03 02 12 34");
  EXPECT_EQ(request(second, "00 02 00 00 00 06 01 06 00 64 56 78"), "00 02 00 00 00 06 01 06 00 64 56 78");
  EXPECT_EQ(request(first, "00 03 00 00 00 06 ff 03 00 64 00 01"), "00 03 00 00 00 05 ff 03 02 56 78");
  EXPECT_EQ(clock_.touches, 3);
  EXPECT_EQ(server_->clients(), 2U);
}

TEST_F(ModbusServerTest, WhatIsNoModbus_ClosesTheConnection) {
  start();
  auto client = connect();
  EXPECT_EQ(request(client, "47 45 54 20 2f 20 48 54"), "closed");
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("sent what is no request of the Modbus protocol")));
}

TEST_F(ModbusServerTest, ClientOfRtu_IsClosedWithTheReason) {
  start();
  auto client = connect();
  EXPECT_EQ(request(client, "01 03 00 00 00 0a c5 cd"), "closed");
  EXPECT_THAT(
      reports_,
      ElementsAre(HasSubstr(
          "sent Modbus RTU, whose frames have no MBAP header: that takes a port with framing = \"rtu\"")));
}

TEST_F(ModbusServerTest, PortForRtu_AnswersIt) {
  start({},
        {.settings = {.map = plc::modbus::default_map(plc::r04cpu()), .framing = plc::modbus::Framing::rtu}});
  auto client = connect();
  EXPECT_EQ(request(client, "01 03 00 00 00 02 c4 0b"), "01 03 04 00 00 00 00 fa 33");
}

TEST_F(ModbusServerTest, HalfARequestThatStaysHalf_LosesItsConnection) {
  start({.half_request_timeout = 20ms});
  auto client = connect();
  EXPECT_EQ(request(client, "00 01 00 00 00 06 ff"), "closed");
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("left a request incomplete")));
}

}  // namespace
}  // namespace canopus::serve::modbus_server_test
