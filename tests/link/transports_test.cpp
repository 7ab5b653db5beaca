// The transports over real sockets of this machine, with a scripted other side.

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "canopus/link/bus_client.hpp"

namespace canopus::link::transports_test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace std::chrono_literals;

struct Ear : BusClientListener {
  void frame_received(const can::Frame& frame) override { frames.push_back(frame); }
  void frame_sent(const can::Frame& frame) override { sent.push_back(frame); }
  void controller_changed(const ControllerStatus& status) override { statuses.push_back(status); }
  void bus_lost(const std::string& reason) override { lost.push_back(reason); }
  void bus_interrupted(const std::string& reason) override { interrupted.push_back(reason); }
  void bus_resumed() override { ++resumed; }
  void bus_complains(std::string_view text) override { complaints.emplace_back(text); }

  std::vector<can::Frame> frames, sent;
  std::vector<ControllerStatus> statuses;
  std::vector<std::string> lost, interrupted, complaints;
  int resumed = 0;
};

/// A TCP server of one client that answers by a function.
class Server {
 public:
  using Answer = std::function<std::string(Server&, const std::string& heard)>;
  Server(asio::io_context& io, Answer answer)
      : acceptor_(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0)),
        socket_(io),
        answer_(std::move(answer)) {
    accept();
  }
  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  void write(const std::string& text) { asio::write(socket_, asio::buffer(text)); }
  void hang_up() { socket_.close(); }
  std::string heard;

 private:
  void accept() {
    acceptor_.async_accept([this](boost::system::error_code failure, tcp::socket socket) {
      if (failure) return;
      socket_ = std::move(socket);
      read();
      accept();
    });
  }
  void read() {
    socket_.async_read_some(asio::buffer(input_),
                            [this](boost::system::error_code failure, std::size_t size) {
                              if (failure) return;
                              const std::string text(input_.data(), size);
                              heard += text;
                              if (const std::string answer = answer_(*this, text); !answer.empty())
                                write(answer);
                              read();
                            });
  }
  tcp::acceptor acceptor_;
  tcp::socket socket_;
  Answer answer_;
  std::array<char, 4096> input_;
};

/// Answers each command of a Lawicel adapter; `refuse` says which with BEL.
struct Adapter {
  std::string operator()(Server&, const std::string& text) {
    std::string answers;
    for (const char c : text) {
      if (c != '\r') {
        line += c;
        continue;
      }
      if (refuse && refuse(line)) {
        answers += '\a';
      } else if (line.starts_with('t') || line.starts_with('r')) {
        answers += "z\r";
      } else if (line.starts_with('T') || line.starts_with('R')) {
        answers += "Z\r";
      } else if (line == "F") {
        answers += flags;
      } else {
        answers += "\r";
      }
      line.clear();
    }
    return answers;
  }
  std::function<bool(const std::string&)> refuse;
  std::string line;
  std::string flags = "F00\r";
};

class TransportTest : public testing::Test {
 protected:
  void open(const BusAddress& address, BusClientOptions options = {}) {
    auto opened = open_bus(io, address, options);
    ASSERT_TRUE(opened) << opened.error();
    client = std::move(*opened);
    client->set_user(&ear);
  }
  void until(const std::function<bool()>& condition) {
    while (!condition()) io.run_one();
  }
  asio::io_context io;
  Ear ear;
  std::unique_ptr<BusClient> client;
};

TEST_F(TransportTest, OpeningEnds_WhereTheEventLoopIsNeverIdle) {
  Server mute(io, [](Server&, const std::string&) { return std::string(); });
  bool over = false;
  std::function<void()> again = [&] {
    if (!over) asio::post(io, again);
  };
  again();
  const auto opened = open_bus(
      io, {.kind = BusAddress::Kind::cannelloni, .host = "127.0.0.1", .port = mute.port(), .tcp = true},
      {.time_out = 20ms});
  over = true;
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error(), HasSubstr("no answer within 20 ms"));
}

class SlcanTest : public TransportTest {
 protected:
  BusAddress address_of(const Server& server) {
    return {.kind = BusAddress::Kind::slcan,
            .host = "127.0.0.1",
            .port = server.port(),
            .tcp = true,
            .bit_rate = 250'000};
  }
};

TEST_F(SlcanTest, Adapter_IsClosedSetAndOpened) {
  Server server(io, Adapter{});
  open(address_of(server));
  EXPECT_EQ(server.heard, "\r\rC\rS5\rO\r");
  EXPECT_EQ(client->status().bit_rate, 250'000U);
}

TEST_F(SlcanTest, FramesGoAndCome_ConfirmedInTheirOrder) {
  Server server(io, Adapter{});
  open(address_of(server));
  const can::Frame extended{.identifier = 0x1FFFFFFF, .extended = true, .dlc = 1, .data = {7}};
  for (int i = 0; i < 20; ++i) client->send(can::data_frame(0x181, {static_cast<std::uint8_t>(i)}));
  client->send(extended);
  EXPECT_THAT(ear.sent, IsEmpty());
  until([&] { return ear.sent.size() == 21; });
  EXPECT_EQ(ear.sent[19], can::data_frame(0x181, {19}));
  EXPECT_EQ(ear.sent[20], extended);
  EXPECT_THAT(server.heard, HasSubstr("t181100\rt181101\r"));
  server.write("T1FFFFFFF107\rr7051\r");
  until([&] { return ear.frames.size() == 2; });
  EXPECT_THAT(ear.frames, ElementsAre(extended, can::remote_frame(0x705, 1)));
}

TEST_F(SlcanTest, RefusedFrame_IsSentAgainUntilItIsTaken) {
  int refusals = 3;
  Adapter adapter;
  adapter.refuse = [&](const std::string& line) { return line == "t181105" && refusals-- > 0; };
  Server server(io, adapter);
  open(address_of(server));
  client->send(can::data_frame(0x181, {5}));
  until([&] { return ear.sent.size() == 1; });
  EXPECT_EQ(refusals, -1);
  EXPECT_THAT(ear.complaints, ElementsAre(HasSubstr("the adapter refuses a frame")));
}

TEST_F(SlcanTest, RefusedBitRate_IsSaid) {
  Adapter adapter;
  adapter.refuse = [](const std::string& line) { return line == "S5"; };
  Server server(io, adapter);
  const auto opened = open_bus(io, address_of(server));
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error(), HasSubstr("the adapter refuses the bit rate 250000 bit/s"));
}

TEST_F(SlcanTest, ImpossibleBitRate_IsSaidBeforeAnythingIsOpened) {
  BusAddress address{.kind = BusAddress::Kind::slcan, .bus = "/dev/null", .bit_rate = 333'333};
  const auto opened = open_bus(io, address);
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error(), HasSubstr("cannot be set to 333333 bit/s"));
}

TEST_F(SlcanTest, FileThatIsNoSerialDevice_IsSaid) {
  const BusAddress address{.kind = BusAddress::Kind::slcan, .bus = "/dev/null", .serial_speed = 115200};
  const auto opened = open_bus(io, address);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(), "slcan:/dev/null: this is not a serial device");
}

TEST_F(SlcanTest, UnpluggedAdapter_IsNoticedAndTriedAgain) {
  const int adapter = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(adapter, 0);
  ASSERT_EQ(::grantpt(adapter), 0);
  ASSERT_EQ(::unlockpt(adapter), 0);
  const BusAddress address{
      .kind = BusAddress::Kind::slcan, .bus = ::ptsname(adapter), .serial_speed = 115200};
  open(address, {.keep_trying = true, .retry = 1ms});
  ::close(adapter);
  until([&] { return !ear.interrupted.empty(); });
  EXPECT_THAT(ear.interrupted[0], testing::StartsWith("the adapter is gone"));
  EXPECT_FALSE(client->send(can::data_frame(0x080)));
  EXPECT_THAT(ear.lost, IsEmpty());
}

TEST_F(SlcanTest, StatusFlags_AreTheControllersState) {
  Adapter adapter;
  adapter.flags = "F24\r";
  Server server(io, adapter);
  open(address_of(server));
  until([&] { return !ear.statuses.empty(); });
  EXPECT_EQ(client->status().state, can::ErrorState::error_passive);
}

TEST_F(SlcanTest, SilentAdapter_IsUsedBlindly) {
  Server server(io, [](Server&, const std::string&) { return std::string(); });
  open(address_of(server));
  client->send(can::data_frame(0x080));
  until([&] { return ear.sent.size() == 1; });
  EXPECT_TRUE(server.heard.empty() || server.heard.ends_with("O\r") || server.heard.ends_with("t0800\r"));
}

TEST_F(SlcanTest, SilentAdapter_IsSaidOnceSomebodyListens) {
  Server server(io, [](Server&, const std::string&) { return std::string(); });
  open(address_of(server));
  until([&] { return !ear.complaints.empty(); });
  EXPECT_THAT(ear.complaints,
              ElementsAre("the adapter does not answer; what becomes of frames is not known"));
}

TEST_F(SlcanTest, AdapterThatFallsSilent_IsSaidOnce) {
  bool mute = false;
  Server server(io, [&, adapter = Adapter{}](Server& self, const std::string& text) mutable {
    return mute ? std::string() : adapter(self, text);
  });
  open(address_of(server));
  mute = true;
  for (std::size_t i = 1; i <= 2; ++i) {
    client->send(can::data_frame(0x080));
    until([&] { return ear.sent.size() == i; });
  }
  EXPECT_THAT(ear.complaints,
              ElementsAre("the adapter answers no more; what becomes of frames is not known"));
}

TEST_F(SlcanTest, LineWithoutAnEnd_IsNoAdapter) {
  Server server(io, Adapter{});
  open(address_of(server));
  server.write(std::string(5000, 't'));
  until([&] { return !ear.lost.empty(); });
  EXPECT_THAT(ear.lost, ElementsAre("this is no slcan adapter: what it says has no end of a line"));
}

TEST_F(SlcanTest, FloodOfLinesWithoutSense_IsSaidOnceAndSurvived) {
  Server server(io, Adapter{});
  open(address_of(server));
  std::string garbage;
  for (int i = 0; i < 5000; ++i) garbage += "what \x1b[31m is this\r";
  server.write(garbage + "t1811FF\r");
  until([&] { return !ear.frames.empty(); });
  EXPECT_TRUE(client->send(can::data_frame(0x123, {1})));
  until([&] { return !ear.sent.empty(); });
  ASSERT_THAT(ear.complaints, testing::SizeIs(testing::AllOf(testing::Ge(1), testing::Le(4))));
  EXPECT_THAT(ear.complaints.front(), HasSubstr("what the adapter says is not understood: \"what "));
  EXPECT_THAT(ear.complaints.front(), testing::Not(HasSubstr("\x1b")));
  EXPECT_THAT(ear.lost, IsEmpty());
}

TEST_F(SlcanTest, VersionNobodyAskedFor_IsNoReasonToComplain) {
  Server server(io, Adapter{});
  open(address_of(server));
  server.write("V1013\rN1234\rt1811FF\r");
  until([&] { return !ear.frames.empty(); });
  EXPECT_THAT(ear.complaints, IsEmpty());
}

TEST_F(SlcanTest, Restart_ClosesSetsAndOpens) {
  Server server(io, Adapter{});
  open(address_of(server));
  ASSERT_TRUE(client->restart(125'000));
  until([&] { return client->status().bit_rate == 125'000; });
  EXPECT_TRUE(server.heard.ends_with("C\rS4\rO\r")) << server.heard;
  EXPECT_FALSE(client->restart(333'333));
}

TEST_F(SlcanTest, LostConnection_IsTriedAgain) {
  Server server(io, Adapter{});
  open(address_of(server), {.keep_trying = true, .retry = 1ms});
  server.hang_up();
  until([&] { return ear.resumed == 1; });
  EXPECT_THAT(ear.interrupted, ElementsAre("the other side ended the connection"));
  client->send(can::data_frame(0x080));
  until([&] { return ear.sent.size() == 1; });
}

TEST_F(SlcanTest, Close_ClosesTheChannelBehindTheLastFrame) {
  Server server(io, Adapter{});
  open(address_of(server));
  for (int i = 0; i < 50; ++i) client->send(can::data_frame(0x080));
  EXPECT_TRUE(client->close(10s));
  until([&] { return server.heard.ends_with("t0800\rC\r"); });
}

class CannelloniTest : public TransportTest {};

TEST_F(CannelloniTest, Tcp_GreetsAndExchangesRecords) {
  bool greeted = false;
  Server server(io, [&](Server&, const std::string&) {
    return std::exchange(greeted, true) ? std::string() : std::string("CANNELLONIv1");
  });
  open({.kind = BusAddress::Kind::cannelloni, .host = "127.0.0.1", .port = server.port(), .tcp = true});
  client->send(can::data_frame(0x181, {1, 2}));
  until([&] { return ear.sent.size() == 1; });
  until([&] { return server.heard.size() == 12 + 7; });
  EXPECT_EQ(server.heard, std::string("CANNELLONIv1\0\0\x01\x81\x02\x01\x02", 19));
  server.write(std::string("\x92\x34", 2));
  io.poll();
  server.write(std::string("\x56\x78\x01\x09\0\0\0\x80\0", 9));
  until([&] { return ear.frames.size() == 2; });
  EXPECT_EQ(ear.frames[0], (can::Frame{.identifier = 0x12345678, .extended = true, .dlc = 1, .data = {9}}));
  EXPECT_EQ(ear.frames[1], can::data_frame(0x080));
}

TEST_F(CannelloniTest, TcpServerOfAnotherKind_IsRefused) {
  Server server(io, [&](Server&, const std::string&) { return std::string("HTTP/1.1 400 Bad Request\r\n"); });
  const auto opened = open_bus(
      io, {.kind = BusAddress::Kind::cannelloni, .host = "127.0.0.1", .port = server.port(), .tcp = true});
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error(), HasSubstr("this is no cannelloni"));
}

TEST_F(CannelloniTest, Udp_ExchangesDatagramsAndCountsTheLostOnes) {
  udp::socket peer(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  open({.kind = BusAddress::Kind::cannelloni, .host = "127.0.0.1", .port = peer.local_endpoint().port()});
  client->send(can::data_frame(0x181, {1, 2}));
  client->send(can::data_frame(0x080));
  until([&] { return ear.sent.size() == 2; });
  std::array<char, 256> input{};
  udp::endpoint ours;
  const std::size_t size = peer.receive_from(asio::buffer(input), ours);
  EXPECT_EQ(std::string(input.data(), size),
            std::string("\x02\0\0\0\x02\0\0\x01\x81\x02\x01\x02\0\0\0\x80\0", 17));
  for (const char sequence : {'\x01', '\x02', '\x05'}) {
    std::string datagram("\x02\0?\0\x01\0\0\x07\x01\x01\x05", 11);
    datagram[2] = sequence;
    peer.send_to(asio::buffer(datagram), ours);
  }
  until([&] { return ear.frames.size() == 3; });
  EXPECT_EQ(ear.frames[2], can::data_frame(0x701, {5}));
  EXPECT_THAT(ear.complaints, ElementsAre("2 datagrams of cannelloni are lost"));
}

TEST_F(CannelloniTest, Udp_GarbageIsSurvived) {
  udp::socket peer(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  open({.kind = BusAddress::Kind::cannelloni, .host = "127.0.0.1", .port = peer.local_endpoint().port()});
  client->send(can::data_frame(0x080));
  std::array<char, 256> input{};
  until([&] { return ear.sent.size() == 1; });
  udp::endpoint ours;
  peer.receive_from(asio::buffer(input), ours);
  for (const std::string& datagram :
       {std::string(), std::string(1400, 'x'), std::string("\x02\0\0\0\x05\0", 6),
        std::string("\x02\0\x01\0\x01\0\0\0\x80\0", 10)}) {
    peer.send_to(asio::buffer(datagram), ours);
  }
  until([&] { return ear.frames.size() == 1; });
  EXPECT_THAT(ear.frames, ElementsAre(can::data_frame(0x080)));
}

TEST_F(CannelloniTest, Udp_ManyMistakesAreSaidOnce) {
  udp::socket peer(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  open({.kind = BusAddress::Kind::cannelloni, .host = "127.0.0.1", .port = peer.local_endpoint().port()});
  client->send(can::data_frame(0x080));
  std::array<char, 256> input{};
  until([&] { return ear.sent.size() == 1; });
  udp::endpoint ours;
  peer.receive_from(asio::buffer(input), ours);
  for (int i = 0; i < 50; ++i) peer.send_to(asio::buffer("x", 1), ours);
  peer.send_to(asio::buffer("\x02\0\x01\0\x01\0\0\0\x80\0", 10), ours);
  until([&] { return ear.frames.size() == 1; });
  EXPECT_THAT(ear.complaints, ElementsAre("a datagram that is none of cannelloni"));
  until([&] { return ear.complaints.size() == 2; });
  EXPECT_EQ(ear.complaints[1], "a datagram that is none of cannelloni (and 48 more like it)");
}

}  // namespace
}  // namespace canopus::link::transports_test
