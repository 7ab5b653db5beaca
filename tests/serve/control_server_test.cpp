// The control server on real sockets of the loopback interface, one thread: the test turns the event loop itself.

#include "canopus/serve/control_server.hpp"

#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::serve::control_server_test {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

class TestClock final : public link::LoopClock {
 public:
  can::Time now() override {
    ++asked;
    if (stop_when_asked != nullptr) stop_when_asked->stop();
    return can::Time{10s};
  }
  void touched() override { ++touches; }

  int asked = 0;
  int touches = 0;
  ControlServer* stop_when_asked = nullptr;
};

/// A server that answers each line with its length and the line.
class ControlServerTest : public ::testing::Test {
 protected:
  ControlServer& start(ControlServerOptions options = {}) {
    const auto answer = [this](std::string_view line, ControlServer::Reply reply) -> ControlServer::CallOff {
      lines_.emplace_back(line);
      if (line == "later") {
        later_.push_back(std::move(reply));
        return [this] { ++called_off_; };
      }
      reply(std::to_string(line.size()) + '\n');
      return {};
    };
    server_ = std::make_unique<ControlServer>(
        context_, clock_, answer, std::move(options),
        [this](std::string_view sentence) { reports_.emplace_back(sentence); });
    EXPECT_TRUE(server_->listen("127.0.0.1", 0));
    return *server_;
  }
  tcp::socket connect() {
    tcp::socket socket(client_context_);
    socket.connect({boost::asio::ip::address_v4::loopback(), server_->port()});
    socket.non_blocking(true);
    context_.poll();
    return socket;
  }
  static void send(tcp::socket& socket, const std::string& data) {
    boost::asio::write(socket, boost::asio::buffer(data));
  }
  /// What came until `end` did; "... closed" at the end of the stream, "... nothing" when nothing comes.
  std::string receive(tcp::socket& socket, std::string_view end = "\n") {
    std::string all;
    std::vector<char> memory(100000);
    for (int turn = 0; turn < 100 && !all.ends_with(end); ++turn) {
      context_.run_one_for(10ms);
      context_.poll();
      error_code error;
      const std::size_t count = socket.read_some(boost::asio::buffer(memory), error);
      if (error == boost::asio::error::would_block) continue;
      if (error) return all + "closed";
      all.append(memory.data(), count);
    }
    return all.ends_with(end) ? all : all + "nothing";
  }

  boost::asio::io_context context_;
  boost::asio::io_context client_context_;
  TestClock clock_;
  std::vector<std::string> reports_;
  std::vector<std::string> lines_;
  std::vector<ControlServer::Reply> later_;
  int called_off_ = 0;
  std::unique_ptr<ControlServer> server_;
};

TEST_F(ControlServerTest, ALineIsAnswered_AtThePresentMoment) {
  start();
  auto client = connect();
  send(client, "abc\n");
  EXPECT_EQ(receive(client), "3\n");
  EXPECT_EQ(clock_.asked, 1);
  EXPECT_EQ(clock_.touches, 1) << "the loop looks at the deadlines anew";
}

TEST_F(ControlServerTest, LinesInPieces_AndSeveralAtOnce) {
  start();
  auto client = connect();
  send(client, "ab");
  EXPECT_EQ(receive(client), "nothing");
  send(client, "c\r\nd\n\n");
  EXPECT_EQ(receive(client, "4\n1\n0\n"), "4\n1\n0\n");
  EXPECT_THAT(lines_, ElementsAre("abc\r", "d", ""));
}

TEST_F(ControlServerTest, AnyByteMayBeInALine) {
  start();
  auto client = connect();
  send(client, std::string("\0\xFF\x1B[2J", 6) + "\n");
  EXPECT_EQ(receive(client), "6\n");
}

TEST_F(ControlServerTest, ALineThatIsTooLong_IsAnErrorAndTheEnd) {
  start({.longest_line = 100});
  auto client = connect();
  send(client, std::string(100, 'x') + "\n");
  EXPECT_EQ(receive(client), "100\n");
  send(client, std::string(101, 'x'));
  EXPECT_EQ(receive(client, "closed"),
            "{\"ok\":false,\"error\":\"a request has at most 100 bytes\"}\nclosed");
  EXPECT_EQ(server_->clients(), 0U);
  EXPECT_THAT(reports_,
              ElementsAre(HasSubstr("sent a line of more than 100 bytes: its connection is closed")));
}

TEST_F(ControlServerTest, ALineThatNeverEnds_EndsTheConnection) {
  start({.half_line_timeout = 30ms});
  auto idle = connect();
  auto client = connect();
  send(client, "{");
  EXPECT_EQ(receive(client, "closed"), "closed");
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("left a request incomplete")));
  EXPECT_EQ(server_->clients(), 1U) << "who sends nothing stays";
}

TEST_F(ControlServerTest, WhenAllConnectionsAreTaken_TheIdlestGivesWay) {
  start({.maximum_clients = 2, .gives_way_after = 0ms});
  auto first = connect();
  auto second = connect();
  send(first, "a\n");
  EXPECT_EQ(receive(first), "1\n");
  auto third = connect();
  EXPECT_EQ(receive(second), "closed");
  EXPECT_EQ(server_->clients(), 2U);
  send(third, "ab\n");
  EXPECT_EQ(receive(third), "2\n");
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("its connection gives way to")));
}

TEST_F(ControlServerTest, WhoHasAskedJustNow_DoesNotGiveWay) {
  start({.maximum_clients = 1});
  auto first = connect();
  auto second = connect();
  EXPECT_EQ(receive(second), "closed");
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("was refused: all 1 connections are in use")));
}

TEST_F(ControlServerTest, ALateAnswer_ComesBeforeThoseOfLinesSentMeanwhile) {
  start();
  auto client = connect();
  auto other = connect();
  send(client, "later\nabc\n");
  EXPECT_EQ(receive(client), "nothing");
  EXPECT_THAT(lines_, ElementsAre("later"));
  send(other, "ab\n");
  EXPECT_EQ(receive(other), "2\n") << "nobody else waits";
  later_.front()("now\n");
  EXPECT_EQ(receive(client, "3\n"), "now\n3\n");
  EXPECT_EQ(called_off_, 0);
}

TEST_F(ControlServerTest, WhoLeavesBeforeTheAnswer_CallsItOff) {
  start();
  auto client = connect();
  send(client, "later\n");
  EXPECT_EQ(receive(client), "nothing");
  client.close();
  for (int turn = 0; turn < 100 && server_->clients() != 0; ++turn) context_.run_one_for(10ms);
  EXPECT_EQ(server_->clients(), 0U);
  EXPECT_EQ(called_off_, 1);
  later_.front()("too late\n");
}

TEST_F(ControlServerTest, AServerThatStops_CallsOffWhatIsNotAnswered) {
  start();
  auto client = connect();
  send(client, "later\n");
  EXPECT_EQ(receive(client), "nothing");
  server_->stop();
  EXPECT_EQ(called_off_, 1);
}

TEST_F(ControlServerTest, WhoWaitsForAnAnswer_DoesNotGiveWay) {
  start({.maximum_clients = 2, .gives_way_after = 0ms});
  auto waiting = connect();
  send(waiting, "later\n");
  EXPECT_EQ(receive(waiting), "nothing");
  auto idle = connect();
  auto third = connect();
  EXPECT_EQ(receive(idle), "closed");
  send(third, "later\n");
  EXPECT_EQ(receive(third), "nothing");
  auto fourth = connect();
  EXPECT_EQ(receive(fourth), "closed") << "all of them wait";
  later_.front()("now\n");
  EXPECT_EQ(receive(waiting), "now\n");
}

TEST_F(ControlServerTest, WhoSendsOnWhileItWaits_IsReadNoFurtherThanALimit) {
  start({.most_waiting = 2000});
  auto client = connect();
  send(client, "later\n");
  EXPECT_EQ(receive(client), "nothing");
  const std::string lines(500000, '\n');
  error_code full;
  std::size_t sent = 0;
  for (int turn = 0; turn < 200 && !full; ++turn) {
    sent += client.write_some(boost::asio::buffer(lines), full);
    context_.poll();
  }
  EXPECT_TRUE(full) << sent << " bytes were read while the client waits";
  server_->stop();
}

TEST_F(ControlServerTest, TheRunMayEndWhileARequestIsLookedAt) {
  start();
  auto client = connect();
  clock_.stop_when_asked = server_.get();
  send(client, "abc\n");
  EXPECT_EQ(receive(client, "closed"), "closed");
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(ControlServerTest, WhoIsNotOnTheListMayNotConnect) {
  const auto network = link::parse_network("10.0.0.0/8");
  ASSERT_TRUE(network.has_value());
  start({.allowed = link::AllowList({*network})});
  auto client = connect();
  send(client, "abc\n");
  EXPECT_EQ(receive(client), "3\n") << "this machine always may";
}

}  // namespace
}  // namespace canopus::serve::control_server_test
