// The MC protocol over UDP, on real sockets of the loopback interface; the test turns the event loop itself.

#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/serve/melsec_server.hpp"

#include "plc/conversation.hpp"

namespace canopus::serve::melsec_udp_test {
namespace {

using boost::asio::ip::udp;
using boost::system::error_code;
using plc::testing::bytes;
using plc::testing::shown;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

const std::string read_d100 = bytes("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00");
const std::string d100 = "d0 00 00 ff ff 03 00 04 00 00 00 34 12";
const std::string unlock = bytes("50 00 00 ff ff 03 00 0e 00 10 00 30 16 00 00 06 00 73 65 63 72 65 74");

class TestClock final : public link::LoopClock {
 public:
  can::Time now() override {
    if (stop_when_asked != nullptr) stop_when_asked->stop();
    return can::Time(10s);
  }
  void touched() override { ++touches; }
  int touches = 0;
  MelsecServer* stop_when_asked = nullptr;
};

class MelsecUdpTest : public ::testing::Test {
 protected:
  MelsecUdpTest() { plc_.word(plc::Device::d, 100, 0x1234); }

  MelsecServer& start(MelsecServerOptions options = {}, MelsecPort port = {}) {
    port.udp = true;
    server_ = std::make_unique<MelsecServer>(
        context_, plc_.rack, clock_, std::move(options),
        [this](std::string_view sentence) { reports_.emplace_back(sentence); }, std::move(port));
    EXPECT_TRUE(server_->listen("127.0.0.1", 0));
    return *server_;
  }
  udp::socket client() {
    udp::socket socket(client_context_, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
    socket.connect({boost::asio::ip::address_v4::loopback(), server_->port()});
    socket.non_blocking(true);
    return socket;
  }
  static void send(udp::socket& socket, const std::string& data) { socket.send(boost::asio::buffer(data)); }
  std::string receive(udp::socket& socket, int turns = 100) {
    std::vector<char> memory(70000);
    for (int turn = 0; turn < turns; ++turn) {
      context_.run_one_for(10ms);
      context_.poll();
      error_code error;
      const std::size_t count = socket.receive(boost::asio::buffer(memory), 0, error);
      if (!error) return shown(std::string_view(memory.data(), count));
    }
    return "nothing";
  }
  std::string request(udp::socket& socket, const std::string& request) {
    send(socket, request);
    return receive(socket);
  }

  boost::asio::io_context context_;
  boost::asio::io_context client_context_;
  plc::testing::Plc plc_;
  TestClock clock_;
  std::vector<std::string> reports_;
  std::unique_ptr<MelsecServer> server_;
};

TEST_F(MelsecUdpTest, Request_IsAnsweredToWhereItCameFrom) {
  start();
  auto first = client();
  auto second = client();
  EXPECT_EQ(request(first, read_d100), d100);
  EXPECT_EQ(request(second, read_d100), d100);
  EXPECT_EQ(server_->clients(), 2U);
  EXPECT_EQ(server_->requests(), 2U);
  EXPECT_EQ(clock_.touches, 2);
}

TEST_F(MelsecUdpTest, Garbage_GetsNoAnswerAndHarmsNobody) {
  start();
  auto stranger = client();
  auto other = client();
  for (const std::string& garbage :
       {std::string("GET / HTTP/1.1"), std::string(1, '\x50'), std::string(), std::string(60000, '\xFF')})
    send(stranger, garbage);
  EXPECT_EQ(request(other, read_d100), d100);
  EXPECT_EQ(receive(stranger, 3), "nothing");
  EXPECT_EQ(request(stranger, read_d100), d100);
}

TEST_F(MelsecUdpTest, DatagramsThatWait_AreAllAnsweredInOrder) {
  start();
  auto socket = client();
  for (char serial = 0; serial < 100; ++serial) {
    std::string request = bytes("54 00 00 00 00 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00");
    request[2] = serial;
    send(socket, request);
  }
  for (unsigned serial = 0; serial < 100; ++serial) {
    const std::string reply = receive(socket);
    ASSERT_EQ(reply.substr(0, 5), "d4 00");
    EXPECT_EQ(std::stoul(reply.substr(6, 2), nullptr, 16), serial);
  }
}

TEST_F(MelsecUdpTest, LargestReply_IsOneDatagram) {
  start();
  auto socket = client();
  const std::string reply = request(socket, "500000FF03FF000018001004010000D*00000003C0");
  EXPECT_EQ((reply.size() + 1) / 3, 22U + 4U * 960U);
}

TEST_F(MelsecUdpTest, Password_UnlocksTheClientThatBroughtIt) {
  start({}, {.settings = {.remote_password = "secret"}});
  auto known = client();
  auto stranger = client();
  EXPECT_THAT(request(known, read_d100), HasSubstr("01 c2"));
  EXPECT_EQ(request(known, unlock), "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(request(known, read_d100), d100);
  EXPECT_THAT(request(stranger, read_d100), HasSubstr("01 c2"));
}

TEST_F(MelsecUdpTest, MoreClientsThanAreRemembered_TheOneThatIsSilentLongestIsForgotten) {
  start({.maximum_clients = 2}, {.settings = {.remote_password = "secret"}});
  auto first = client();
  auto second = client();
  auto third = client();
  (void)request(first, unlock);
  (void)request(second, unlock);
  EXPECT_EQ(request(first, read_d100), d100);
  (void)request(third, unlock);
  EXPECT_EQ(server_->clients(), 2U);
  EXPECT_EQ(request(first, read_d100), d100);
  EXPECT_THAT(request(second, read_d100), HasSubstr("01 c2"));
}

TEST_F(MelsecUdpTest, Frame1e_IsAnsweredOnItsPort) {
  start({}, {.settings = {.takes_3e = false, .takes_1e = true}});
  auto socket = client();
  EXPECT_EQ(request(socket, bytes("01 ff 0a 00 64 00 00 00 20 44 01 00")), "81 00 34 12");
  send(socket, read_d100);
  EXPECT_EQ(receive(socket, 3), "nothing");
}

TEST_F(MelsecUdpTest, EveryCommandOf1e_IsADatagramEachWay) {
  start({}, {.settings = {.takes_3e = false, .takes_1e = true}});
  auto socket = client();
  const auto answer = [&](const std::string& text) { return request(socket, bytes(text)); };
  EXPECT_EQ(answer("02 ff 0a 00 32 00 00 00 20 4d 04 00 10 10"), "82 00") << "M50 to M53 = 1, 0, 1, 0";
  EXPECT_EQ(answer("00 ff 0a 00 32 00 00 00 20 4d 04 00"), "80 00 10 10");
  EXPECT_EQ(answer("03 ff 0a 00 64 00 00 00 20 44 02 00 01 02 03 04"), "83 00");
  EXPECT_EQ(answer("01 ff 0a 00 64 00 00 00 20 44 02 00"), "81 00 01 02 03 04");
  EXPECT_EQ(answer("04 ff 0a 00 02 00 32 00 00 00 20 4d 00 33 00 00 00 20 4d 01"), "84 00");
  EXPECT_EQ(answer("00 ff 0a 00 32 00 00 00 20 4d 02 00"), "80 00 01");
  EXPECT_EQ(answer("05 ff 0a 00 01 00 64 00 00 00 20 44 78 56"), "85 00");
  EXPECT_EQ(answer("07 ff 0a 00 01 00 64 00 00 00 20 44"), "87 00");
  EXPECT_EQ(answer("09 ff 0a 00"), "89 00 78 56") << "the list of this address";
  auto other = client();
  EXPECT_EQ(request(other, bytes("09 ff 0a 00")), "89 57") << "another address has none";
  EXPECT_EQ(answer("16 ff 0a 00 02 41 42"), "96 00 02 41 42");
  EXPECT_EQ(answer("14 ff 0a 00"), "94 00");
  EXPECT_EQ(answer("13 ff 0a 00"), "93 00");
  EXPECT_THAT(answer("15 ff 0a 00"), HasSubstr("95 00"));
}

TEST_F(MelsecUdpTest, DatagramOf1eWithAnotherLength_Is57H) {
  start({}, {.settings = {.takes_3e = false, .takes_1e = true}});
  auto socket = client();
  EXPECT_EQ(request(socket, bytes("01 ff 0a 00 64 00 00 00 20 44")), "81 57");
  EXPECT_EQ(request(socket, bytes("01 ff 0a 00 64 00 00 00 20 44 01 00 77")), "81 57");
  EXPECT_EQ(request(socket, bytes("01 ff 0a 00 64 00 00 00 20 44 01 00")), "81 00 34 12");
}

TEST_F(MelsecUdpTest, Ascii1e_IsAnsweredInAscii) {
  start({}, {.settings = {.takes_3e = false, .takes_1e = true}});
  auto socket = client();
  send(socket, "01FF000A4420000000640100");
  EXPECT_EQ(receive(socket), shown("81001234"));
}

TEST_F(MelsecUdpTest, RunThatEndsWhileTheTimeIsAsked_LeavesTheRequestUnanswered) {
  clock_.stop_when_asked = &start();
  auto socket = client();
  send(socket, read_d100);
  EXPECT_EQ(receive(socket, 3), "nothing");
  EXPECT_EQ(clock_.touches, 0);
}

TEST_F(MelsecUdpTest, ServerDestroyed_BeforeItsHandlersRan_IsNotTouchedByThem) {
  start();
  auto socket = client();
  send(socket, read_d100);
  server_.reset();
  context_.run();
  EXPECT_EQ(clock_.touches, 0);
}

TEST_F(MelsecUdpTest, Listen_OnATakenPort_SaysSo_AndTcpOfTheSameNumberIsFree) {
  start();
  MelsecServer second(context_, plc_.rack, clock_, {}, {}, {.udp = true});
  const auto result = second.listen("127.0.0.1", server_->port());
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error(), HasSubstr(": Address already in use"));
  // Another program of this machine may have the TCP port of a number that the system gave: then the next number.
  for (int attempt = 0; attempt < 20; ++attempt) {
    MelsecServer udp(context_, plc_.rack, clock_, {}, {}, {.udp = true});
    ASSERT_TRUE(udp.listen("127.0.0.1", 0));
    MelsecServer tcp(context_, plc_.rack, clock_);
    if (tcp.listen("127.0.0.1", udp.port())) return;
  }
  FAIL() << "no number whose TCP port is free";
}

// The list of who may write needs another address than this machine's, which may always: here the list decides alone.
TEST(MelsecPortWriters, AnAddressThatIsNotOnTheList_MayOnlyLook) {
  const link::AllowList writers({*link::parse_network("192.168.1.20")});
  EXPECT_TRUE(writers.allows(*link::parse_internet_address("192.168.1.20")));
  EXPECT_FALSE(writers.allows(*link::parse_internet_address("192.168.1.21")));
}

}  // namespace
}  // namespace canopus::serve::melsec_udp_test
