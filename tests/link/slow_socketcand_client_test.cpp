// The socketcand server with clients that do not read.

#include "link/socketcand_client.hpp"

namespace canopus::link::slow_socketcand_client_test {
namespace {

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
}  // namespace canopus::link::slow_socketcand_client_test
