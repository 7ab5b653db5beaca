#include "canopus/link/socketcand_server.hpp"

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

#include "link/toy_bus.hpp"

namespace canopus::link {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using can::Frame;
using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::chrono_literals;

const tcp::endpoint any_local_port(asio::ip::address_v4::loopback(), 0);

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
  /// A bus where nobody acknowledges, until the condition holds.
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

TEST_F(SocketcandServerTest, MissingAcknowledgement_IsAnErrorFrameToTheClient) {
  const auto client = connect_raw();
  bus.newest->unacknowledged(can::Time(12s + 345us));
  until([&] { return client->all().ends_with("< error 020 12.000345 >"); });
}

TEST_F(SocketcandServerTest, Connect_IsGreetedInASegmentOfItsOwn) {
  const auto client = connect();
  EXPECT_THAT(client->received, ElementsAre("< hi >"));
}

TEST_F(SocketcandServerTest, CommandsInOneSegment_AreAnsweredInSegmentsOfTheirOwn) {
  const auto client = connect();
  client->send("< open line1 >< rawmode >");
  until([&] { return client->all() == "< hi >< ok >< ok >"; });
  EXPECT_EQ(bus.participants(), 1U);
}

TEST_F(SocketcandServerTest, FramesOfTheBus_ReachTheClientWithTheirTime) {
  const auto client = connect_raw();
  bus.time = can::Time(12s + 345us);
  bus.inject(can::data_frame(0x581, {0x43, 0x18, 0x10, 0x01, 0xEF, 0xBE, 0xAD, 0xDE}));
  until([&] { return !client->received.empty(); });
  EXPECT_THAT(client->received, ElementsAre("< frame 581 12.000345 43181001EFBEADDE >"));
}

TEST_F(SocketcandServerTest, RemoteFramesOfTheBus_AreNotPassedOn) {
  const auto client = connect_raw();
  bus.inject(can::remote_frame(0x705, 1));
  bus.inject(can::data_frame(0x705, {0x05}));
  until([&] { return !client->received.empty(); });
  EXPECT_THAT(client->received, ElementsAre("< frame 705 0.020000 05 >"));
}

TEST_F(SocketcandServerTest, FramesBeforeRawmode_AreNotForTheClient) {
  const auto client = connect();
  client->send("< open line1 >");
  until([&] { return client->all() == "< hi >< ok >"; });
  bus.inject(can::data_frame(0x701, {0x05}));
  client->send("< echo >");
  until([&] { return client->all().ends_with("< echo >"); });
  EXPECT_EQ(client->all(), "< hi >< ok >< echo >");
}

TEST_F(SocketcandServerTest, FramesSoonAfterRawmode_WaitForTheSettlingTime) {
  const auto client = connect();
  client->send("< open line1 >< rawmode >");
  until([&] { return client->all() == "< hi >< ok >< ok >"; });
  bus.inject(can::data_frame(0x701, {0x05}));
  bus.advance(19'999us);
  io.poll();
  EXPECT_EQ(client->all(), "< hi >< ok >< ok >");
  bus.advance(1us);
  until([&] { return client->all() == "< hi >< ok >< ok >< frame 701 0.000000 05 >"; });
}

TEST_F(SocketcandServerTest, FramesOfTheClient_GoOnTheBusAndTheLoopIsTold) {
  const auto client = connect_raw();
  const int before = bus.touches;
  client->send("< send 0 2 1 5 >");
  until([&] { return bus.waiting() == 1; });
  until([&] { return bus.touches > before; });
  bus.run();
  EXPECT_THAT(bus.delivered, ElementsAre(can::data_frame(0x000, {0x01, 0x05})));
}

TEST_F(SocketcandServerTest, FrameOfOneClient_ReachesTheOtherAndNotItself) {
  const auto one = connect_raw();
  const auto other = connect_raw();
  one->send("< send 123 1 1 >");
  until([&] { return bus.waiting() == 1; });
  bus.run();
  one->send("< echo >");
  until([&] { return !one->received.empty() && !other->received.empty(); });
  EXPECT_THAT(other->received, ElementsAre("< frame 123 0.040000 01 >"));
  EXPECT_THAT(one->received, ElementsAre("< echo >"));
}

TEST_F(SocketcandServerTest, ClientFasterThanTheBus_LosesNothing) {
  bus.room = 4;
  const auto client = connect_raw();
  std::string text;
  for (int i = 0; i < 500; ++i) text += "< send 123 2 " + std::to_string(i % 100) + " 0 >";
  client->send(text);
  until([&] {
    if (bus.waiting() == 4) bus.run();
    return bus.delivered.size() + bus.waiting() == 500;
  });
  EXPECT_EQ(server->statistics().frames_from_clients, 500U);
}

TEST_F(SocketcandServerTest, WrongBusName_IsToldAndTheConnectionEnds) {
  const auto client = connect();
  client->send("< open can0 >");
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(client->all(), "< hi >< error could not open bus >");
  client->close();
  until([&] { return bus.participants() == 0; });
}

TEST_F(SocketcandServerTest, WrongBusNameWithCommandsBehindIt_IsStillTold) {
  const auto client = connect();
  client->send("< open can0 >< rawmode >< send 1 0 >" + std::string(10'000, 'x'));
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(client->all(), "< hi >< error could not open bus >");
}

TEST_F(SocketcandServerTest, ClientThatStaysAfterTheEnd_IsClosedAfterASecond) {
  const auto client = connect();
  client->send("< open can0 >");
  until([&] { return client->closed_by_server; });
  bus.advance(999'999us);
  io.poll();
  EXPECT_EQ(bus.participants(), 1U);
  bus.advance(1us);
  until([&] { return bus.participants() == 0; });
}

TEST_F(SocketcandServerTest, ClientThatCloses_LeavesTheBus) {
  const auto client = connect_raw();
  ASSERT_EQ(bus.participants(), 1U);
  client->close();
  until([&] { return bus.participants() == 0; });
  EXPECT_EQ(server->statistics().clients, 0U);
}

TEST_F(SocketcandServerTest, ClientThatSendsAndCloses_StaysUntilItsFramesAreOut) {
  const auto client = connect_raw();
  client->send("< send 0 2 1 5 >");
  client->close();
  until([&] { return bus.waiting() == 1; });
  io.poll();
  bus.run();
  until([&] { return bus.participants() == 0; });
  EXPECT_THAT(bus.delivered, ElementsAre(can::data_frame(0x000, {0x01, 0x05})));
}

TEST_F(SocketcandServerTest, ClosedClientOnADeadBus_IsTakenOffAfterASecond) {
  const auto client = connect_raw();
  client->send("< send 0 2 1 5 >");
  until([&] { return bus.waiting() == 1; });
  const int before = bus.touches;
  client->close();
  until([&] { return bus.touches > before; });
  bus.advance(1s);
  until([&] { return bus.participants() == 0; });
  EXPECT_EQ(bus.waiting(), 0U);
  EXPECT_THAT(reports, ElementsAre(HasSubstr(" left: 1 frame that it had sent was dropped")));
}

TEST_F(SocketcandServerTest, ClientThatComesAndGoes_JoinsAndLeavesAtThePresent) {
  bus.wall = can::Time(5s);
  const auto client = connect();
  EXPECT_EQ(bus.joined, can::Time(5s));
  EXPECT_EQ(bus.touches, 1);
  bus.wall = can::Time(7s);
  client->close();
  until([&] { return bus.participants() == 0; });
  EXPECT_EQ(bus.left, can::Time(7s));
}

TEST_F(SocketcandServerTest, ClientThatIsGone_HasASecondForWhatItLeft) {
  bus.room = 4;
  const auto client = connect_raw();
  std::string text;
  for (int i = 0; i < 90; ++i) text += "< send 123 1 5 >";
  client->send(text);
  client->close();
  run_slow_bus_until([&] { return bus.participants() == 0; });
  EXPECT_EQ(bus.delivered.size(), 90U);
  EXPECT_EQ(server->statistics().frames_dropped, 0U);
  EXPECT_THAT(reports, ElementsAre());
}

TEST_F(SocketcandServerTest, ClientThatFloodsAndCloses_DoesNotKeepTheBusBusy) {
  bus.room = 4;
  const auto client = connect_raw();
  const std::size_t sent = client->flood("< send 123 8 1 2 3 4 5 6 7 8 >");
  const can::Time closed = bus.time;
  client->close();
  run_slow_bus_until([&] { return bus.participants() == 0; });
  EXPECT_LT(bus.time - closed, 60s);
  EXPECT_EQ(bus.delivered.size() + server->statistics().frames_dropped, sent);
}

TEST_F(SocketcandServerTest, ClientThatFloodsAndResets_IsOffAfterASecond) {
  bus.room = 4;
  const auto client = connect_raw();
  (void)client->flood("< send 123 8 1 2 3 4 5 6 7 8 >");
  until([&] { return bus.waiting() == 4; });
  const can::Time reset = bus.time;
  client->reset();
  run_dead_bus_until([&] { return bus.participants() == 0; });
  EXPECT_LE(bus.time - reset, 1100ms);
  EXPECT_GT(server->statistics().frames_dropped, 4U);
  EXPECT_THAT(reports, ElementsAre("127.0.0.1:" + std::to_string(client->port) +
                                   " left: " + std::to_string(server->statistics().frames_dropped) +
                                   " frames that it had sent were dropped"));
}

TEST_F(SocketcandServerTest, ClientThatSendsAndResets_HasItsFramesSentNevertheless) {
  const auto client = connect_raw();
  client->send("< send 1 0 >< send 2 0 >< send 3 0 >");
  client->reset();
  run_slow_bus_until([&] { return bus.participants() == 0; });
  EXPECT_EQ(bus.delivered.size(), 3U);
}

TEST_F(SocketcandServerTest, BusThatTakesNothingForASecond_HoldsNobodyUp) {
  bus.room = 4;
  const auto client = connect_raw();
  std::string text;
  for (int i = 0; i < 30; ++i) text += "< send 123 0 >";
  client->send(text + "< echo >");
  run_dead_bus_until([&] { return client->all().ends_with("< echo >"); });
  EXPECT_EQ(client->all(), "< error the bus takes no frames, they are dropped >< echo >");
  EXPECT_GE(bus.time, can::Time(1s));
  EXPECT_EQ(bus.waiting(), 4U);
  bus.run();
  client->send("< send 7 0 >");
  until([&] { return bus.waiting() == 1; });
}

TEST_F(SocketcandServerTest, ClientThatFloodsADeadBusAndCloses_IsTakenOffIt) {
  bus.room = 4;
  const auto client = connect_raw();
  (void)client->flood("< send 123 8 1 2 3 4 5 6 7 8 >");
  client->close();
  run_dead_bus_until([&] { return bus.participants() == 0; });
  EXPECT_GT(server->statistics().frames_dropped, 4U);
}

TEST_F(SocketcandServerTest, MoreClientsThanAllowed_AreToldSoAndClosed) {
  start({.clients = 1});
  const auto first = connect();
  const auto second = connect();
  until([&] { return second->closed_by_server; });
  EXPECT_EQ(second->all(), "< error too many clients >");
  EXPECT_EQ(server->statistics().clients, 1U);
}

TEST_F(SocketcandServerTest, BusThatTakesNoMore_IsToldTheSameWay) {
  bus.places = 0;
  const auto client = connect();
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(client->all(), "< error too many clients >");
}

TEST_F(SocketcandServerTest, Close_EndsEveryConnectionAndStopsListening) {
  const auto client = connect_raw();
  const std::uint16_t port = server->port();
  server->close();
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(bus.participants(), 0U);
  tcp::socket late(io);
  error_code failure;
  late.connect({asio::ip::address_v4::loopback(), port}, failure);
  EXPECT_EQ(failure, asio::error::connection_refused);
}

TEST_F(SocketcandServerTest, DestroyedWithMessagesUnderWay_LeavesNothingBehind) {
  const auto client = connect_raw();
  bus.inject(can::data_frame(0x701, {0x05}));
  server.reset();
  until([&] { return client->closed_by_server; });
  EXPECT_EQ(bus.participants(), 0U);
}

TEST_F(SocketcandServerTest, PortInUse_IsAnErrorThatNamesIt) {
  SocketcandServer second(io, {asio::ip::address_v4::loopback(), server->port()}, "line1", bus.attach(), bus);
  const auto listening = second.listen();
  ASSERT_FALSE(listening);
  EXPECT_EQ(listening.error(),
            "cannot listen on 127.0.0.1:" + std::to_string(server->port()) + ": Address already in use");
  EXPECT_EQ(second.port(), 0U);
}

/// A client that connects and never reads.
class DeafClient {
 public:
  DeafClient(asio::io_context& io, std::uint16_t port) : socket_(io) {
    socket_.open(tcp::v4());
    socket_.set_option(asio::socket_base::receive_buffer_size(4096));
    socket_.connect({asio::ip::address_v4::loopback(), port});
    asio::write(socket_, asio::buffer(std::string_view("< open line1 >< rawmode >")));
  }
  tcp::socket& socket() { return socket_; }

 private:
  tcp::socket socket_;
};

class SlowSocketcandClient : public SocketcandServerTest {
 protected:
  /// Puts frames on the bus, the loop taking part, until the condition holds.
  void flood_until(const std::function<bool()>& condition) {
    while (!condition()) {
      bus.advance(1ms);
      bus.inject(can::data_frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8}));
      io.poll();
    }
  }
};

TEST_F(SlowSocketcandClient, LosesFramesWhileOthersGetThem) {
  const auto reader = connect_raw();
  DeafClient deaf(io, server->port());
  flood_until([&] { return server->statistics().frames_lost > 0; });
  const std::size_t on_the_bus = bus.delivered.size();
  const std::size_t frame_size = std::string("< frame 181 0.000000 0102030405060708 >").size();
  until([&] { return reader->all().size() >= on_the_bus * frame_size; });
  EXPECT_EQ(server->statistics().clients, 2U);
}

TEST_F(SlowSocketcandClient, ThatReadsAgain_IsToldHowMuchItMissed) {
  start({.queue = 1024});
  DeafClient slow(io, server->port());
  flood_until([&] { return server->statistics().frames_lost >= 100; });
  slow.socket().non_blocking(true);
  std::string text;
  std::array<char, 4096> input;
  flood_until([&] {
    error_code failure;
    const std::size_t size = slow.socket().read_some(asio::buffer(input), failure);
    text.append(input.data(), size);
    if (text.size() > 100'000) text.erase(0, text.size() - 10'000);
    return text.find("frames, read faster >") != std::string::npos;
  });
  EXPECT_THAT(text, HasSubstr("< error lost "));
}

TEST_F(SlowSocketcandClient, ThatLosesTooMuch_IsClosed) {
  start({.queue = 1024, .lost_frames = 1000, .stall = 0ms});
  DeafClient deaf(io, server->port());
  flood_until([&] { return server->statistics().clients_too_slow > 0; });
  until([&] { return bus.participants() == 0; });
  EXPECT_GE(server->statistics().frames_lost, 1000U);
  EXPECT_EQ(server->statistics().clients_too_slow, 1U);
}

// A plant that was late brings all frames of that time at once.
TEST_F(SlowSocketcandClient, ThatLosesTooMuchAtOnceButReads_StaysAndIsTold) {
  start({.queue = 1024, .lost_frames = 1000, .stall = 0ms});
  const auto reader = connect_raw();
  bus.advance(30ms);
  for (int i = 0; i < 20'000; ++i) bus.inject(can::data_frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_GE(server->statistics().frames_lost, 18'000U);
  flood_until([&] { return reader->all().find("frames, read faster >") != std::string::npos; });
  EXPECT_EQ(server->statistics().clients, 1U);
  EXPECT_EQ(server->statistics().clients_too_slow, 0U);
}

TEST_F(SlowSocketcandClient, ThatOnlyAsks_IsNotReadAnyFurtherAndOthersAreServed) {
  const auto reader = connect_raw();
  DeafClient deaf(io, server->port());
  std::string echoes;
  for (int i = 0; i < 1000; ++i) echoes += "< echo >";
  deaf.socket().non_blocking(true);
  // Every buffer between the two is full when the loop has nothing to do and no byte can be written.
  for (int idle = 0; idle < 100;) {
    error_code failure;
    deaf.socket().write_some(asio::buffer(echoes), failure);
    idle = io.poll() == 0 && failure == asio::error::would_block ? idle + 1 : 0;
  }
  bus.inject(can::data_frame(0x701, {0x05}));
  until([&] { return !reader->received.empty(); });
  EXPECT_THAT(reader->received, ElementsAre("< frame 701 0.020000 05 >"));
}

TEST_F(SocketcandServerTest, ManyCommandsAtOnce_AreAllAnswered) {
  const auto client = connect();
  std::string questions = "< open line1 >";
  for (int i = 0; i < 10'000; ++i) questions += "<?>";
  client->send(questions + "< echo >");
  until([&] { return client->all().ends_with("< echo >"); });
  EXPECT_EQ(client->all().size(), std::string("< hi >< ok >< echo >").size() +
                                      10'000 * std::string("< error unknown command >").size());
}

}  // namespace
}  // namespace canopus::link
