// The server on real sockets of the loopback interface, one thread: the test turns the event loop itself.

#include "canopus/serve/melsec_server.hpp"

#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "plc/conversation.hpp"

namespace canopus::serve::melsec_server_test {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;
using plc::testing::bytes;
using plc::testing::shown;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

const std::string read_d100 = bytes("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00");
const std::string read_d100_reply = "d0 00 00 ff ff 03 00 04 00 00 00 34 12";

class TestClock final : public link::LoopClock {
 public:
  can::Time now() override {
    ++asked;
    if (stop_when_asked != nullptr && asked > answered_before_stop) stop_when_asked->stop();
    return time;
  }
  void touched() override { ++touches; }
  void accessed() override { ++accesses; }

  can::Time time{10s};
  int asked = 0;
  int touches = 0;
  int accesses = 0;
  MelsecServer* stop_when_asked = nullptr;
  int answered_before_stop = 0;
};

class MelsecServerTest : public ::testing::Test {
 protected:
  MelsecServerTest() { plc_.word(plc::Device::d, 100, 0x1234); }

  MelsecServer& start(MelsecServerOptions options = {}) {
    server_ = std::make_unique<MelsecServer>(
        context_, plc_.rack, clock_, std::move(options),
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

  static std::string name_of(const tcp::socket& socket) {
    return "127.0.0.1:" + std::to_string(socket.local_endpoint().port());
  }

  static void send(tcp::socket& socket, const std::string& data) {
    boost::asio::write(socket, boost::asio::buffer(data));
  }

  /// Turns the loop until the client has something to read; what one recv gives. "closed" at the end of the
  /// stream, "nothing" after a second without.
  std::string receive(tcp::socket& socket) {
    std::vector<char> memory(100000);
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
  std::unique_ptr<MelsecServer> server_;
};

TEST_F(MelsecServerTest, Request_IsAnsweredInOneSegment) {
  start();
  auto client = connect();
  send(client, read_d100);
  EXPECT_EQ(receive(client), read_d100_reply);
}

TEST_F(MelsecServerTest, Access_AsksTheTimeBeforeAndTellsTheLoopAfter) {
  start();
  auto client = connect();
  send(client, read_d100);
  (void)receive(client);
  EXPECT_EQ(clock_.asked, 1);
  EXPECT_EQ(clock_.accesses, 1);
  EXPECT_EQ(clock_.touches, 0) << "it waits for nothing more";
  EXPECT_EQ(server_->requests(), 1U);
}

TEST_F(MelsecServerTest, Access_HappensAtTheClocksTime) {
  start();
  clock_.time = can::Time(42s);
  auto client = connect();
  send(client, bytes("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 00 00 19 00 00 ab 00 00 00 00 f8 01 00"));
  (void)receive(client);
  EXPECT_EQ(plc_.module.last_time, can::Time(42s));
}

TEST_F(MelsecServerTest, HalfARequest_StopsNobodyElseAndIsAnsweredWhenComplete) {
  start();
  auto half = connect();
  auto other = connect();
  send(half, read_d100.substr(0, 10));
  send(other, read_d100);
  EXPECT_EQ(receive(other), read_d100_reply);
  send(half, read_d100.substr(10));
  EXPECT_EQ(receive(half), read_d100_reply);
}

TEST_F(MelsecServerTest, HalfARequest_ThatStaysHalf_LosesItsConnection) {
  start({.half_request_timeout = 20ms});
  auto half = connect();
  auto idle = connect();
  send(half, read_d100.substr(0, 10));
  EXPECT_EQ(receive(half), "closed");
  EXPECT_EQ(server_->clients(), 1U);
  EXPECT_THAT(reports_, ElementsAre(name_of(half) + " left a request incomplete: its connection is closed"));
  send(idle, read_d100);
  EXPECT_EQ(receive(idle), read_d100_reply);
}

TEST_F(MelsecServerTest, BytesThatDrip_DoNotProlongTheTime) {
  start({.half_request_timeout = 100ms});
  auto client = connect();
  send(client, read_d100);  // what was answered before does neither
  EXPECT_EQ(receive(client), read_d100_reply);
  const auto begin = std::chrono::steady_clock::now();
  error_code error;
  // A byte every few milliseconds: a request of 21 bytes that never becomes complete within the time.
  for (std::size_t i = 0; i < 20 && !error; ++i) {
    boost::asio::write(client, boost::asio::buffer(read_d100.substr(i, 1)), error);
    context_.run_for(20ms);
  }
  EXPECT_EQ(server_->clients(), 0U);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 100ms);
}

TEST_F(MelsecServerTest, NoRequest_ClosesTheConnection) {
  start();
  auto client = connect();
  send(client, "GET / HTTP/1.1\r\n\r\n");
  EXPECT_EQ(receive(client), "closed");
  EXPECT_THAT(reports_, ElementsAre(name_of(client) +
                                    " sent what is no request of the MC protocol: its connection is closed"));
}

TEST_F(MelsecServerTest, TooLongRequest_GetsItsEndCodeThenTheEnd) {
  start();
  auto client = connect();
  send(client, bytes("50 00 00 ff ff 03 00 ff ff 10 00"));
  EXPECT_EQ(receive(client), "d0 00 00 ff ff 03 00 0b 00 61 c0 00 ff ff 03 00 00 00 00 00");
  EXPECT_EQ(receive(client), "closed");
}

TEST_F(MelsecServerTest, ClientThatTakesNoReplies_StopsNobodyElseAndLosesItsConnection) {
  start({.send_timeout = 3s});
  auto deaf = connect();
  auto other = connect();
  const std::string read_960 = bytes("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 00 00 00 a8 c0 03");
  std::string flood;
  for (int i = 0; i < 500; ++i) flood += read_960;
  // Until both directions are full: 60 bytes of reply for each byte of request.
  error_code error;
  for (int quiet = 0; quiet < 10;) {
    const std::size_t count = deaf.write_some(boost::asio::buffer(flood), error);
    quiet = count == 0 ? quiet + 1 : 0;
    context_.poll();
  }
  EXPECT_EQ(error, boost::asio::error::would_block);
  send(other, read_d100);
  EXPECT_EQ(receive(other), read_d100_reply);
  EXPECT_EQ(server_->clients(), 2U);
  context_.run_for(3100ms);
  EXPECT_EQ(server_->clients(), 1U);
  EXPECT_THAT(reports_, ElementsAre(name_of(deaf) + " does not take its replies: its connection is closed"));
}

TEST_F(MelsecServerTest, PipelinedRequests_AreAllAnswered) {
  start();
  auto client = connect();
  std::string flood;
  for (int i = 0; i < 2000; ++i) flood += read_d100;
  std::size_t received = 0;
  std::size_t sent = 0;
  std::vector<char> memory(65536);
  for (int turn = 0; turn < 10000 && received < 2000 * 13; ++turn) {
    error_code error;
    if (sent < flood.size())
      sent += client.write_some(boost::asio::buffer(flood.data() + sent, flood.size() - sent), error);
    context_.poll();
    received += client.read_some(boost::asio::buffer(memory), error);
  }
  EXPECT_EQ(received, 2000U * 13U);
}

TEST_F(MelsecServerTest, AClientThatFloods_DoesNotKeepOthersWaiting) {
  start();
  auto floods = connect();
  auto other = connect();
  std::string flood;
  for (int i = 0; i < 20000; ++i) flood += read_d100;
  error_code error;
  for (std::size_t count = 1; count != 0 && !error;)
    count = floods.write_some(boost::asio::buffer(flood), error);
  send(other, read_d100);
  std::vector<char> memory(100);
  std::size_t received = 0;
  for (int turn = 0; turn < 8 && received == 0; ++turn) {
    context_.run_one_for(1s);
    received = other.read_some(boost::asio::buffer(memory), error);
  }
  EXPECT_EQ(received, 13U);
}

TEST_F(MelsecServerTest, AClientThatEndsItsStreamBehindItsRequests_IsAnsweredAndThenClosed) {
  start();
  auto client = connect();
  send(client, read_d100 + read_d100 + read_d100.substr(0, 10));
  client.shutdown(tcp::socket::shutdown_send);
  EXPECT_EQ(receive(client), read_d100_reply + ' ' + read_d100_reply);
  EXPECT_EQ(receive(client), "closed");
  EXPECT_EQ(server_->clients(), 0U);
  EXPECT_THAT(reports_, ::testing::IsEmpty());
}

TEST_F(MelsecServerTest, UrgentBytesOfAClient_AreNoneOfItsRequests_AndHideNothing) {
  start();
  auto client = connect();
  send(client, read_d100);
  ASSERT_EQ(::send(client.native_handle(), "!", 1, MSG_OOB), 1);
  send(client, read_d100);
  std::string replies = receive(client);
  if (replies.size() == read_d100_reply.size()) replies += ' ' + receive(client);
  EXPECT_EQ(replies, read_d100_reply + ' ' + read_d100_reply);
  client.shutdown(tcp::socket::shutdown_send);
  EXPECT_EQ(receive(client), "closed");
}

TEST_F(MelsecServerTest, MoreClientsThanAllowed_AreClosedAtOnce) {
  start({.maximum_clients = 2});
  auto first = connect();
  auto second = connect();
  auto third = connect();
  EXPECT_EQ(receive(third), "closed");
  EXPECT_THAT(reports_, ElementsAre(name_of(third) + " was refused: all 2 connections are in use"));
  send(second, read_d100);
  EXPECT_EQ(receive(second), read_d100_reply);
  second.close();
  while (server_->clients() > 1) context_.run_one_for(100ms);
  auto fourth = connect();
  send(fourth, read_d100);
  EXPECT_EQ(receive(fourth), read_d100_reply);
}

TEST_F(MelsecServerTest, AllConnectionsTaken_TheOneThatIsSilentLongestGivesWay) {
  start({.maximum_clients = 2, .gives_way_after = 0ms});
  auto silent = connect();
  auto asking = connect();
  auto newcomer = connect();
  EXPECT_EQ(receive(silent), "closed");
  EXPECT_THAT(reports_,
              ElementsAre(name_of(silent) + " has sent no request for 0 s: its connection gives way to " +
                          name_of(newcomer)));
  send(asking, read_d100);
  EXPECT_EQ(receive(asking), read_d100_reply);
  auto later = connect();
  EXPECT_EQ(receive(newcomer), "closed");
  send(asking, read_d100);
  EXPECT_EQ(receive(asking), read_d100_reply);
  send(later, read_d100);
  EXPECT_EQ(receive(later), read_d100_reply);
}

TEST_F(MelsecServerTest, SilentClient_IsCheckedAsByACpu) {
  start();
  auto client = connect();
  const auto option = [&](int name) {
    int value = 0;
    socklen_t size = sizeof value;
    // The server's end is the only other socket of this process that is connected to the client's port.
    for (int descriptor = 3; descriptor < 1024; ++descriptor) {
      sockaddr_in peer{};
      socklen_t peer_size = sizeof peer;
      if (::getpeername(descriptor, reinterpret_cast<sockaddr*>(&peer), &peer_size) != 0) continue;
      if (ntohs(peer.sin_port) != client.local_endpoint().port()) continue;
      ::getsockopt(descriptor, name == SO_KEEPALIVE ? SOL_SOCKET : IPPROTO_TCP, name, &value, &size);
    }
    return value;
  };
  EXPECT_NE(option(SO_KEEPALIVE), 0);
  EXPECT_EQ(option(TCP_KEEPIDLE) + option(TCP_KEEPINTVL) * option(TCP_KEEPCNT), 45);
}

TEST_F(MelsecServerTest, Stop_ClosesEverythingAndLeavesTheLoopWithoutWork) {
  start();
  auto client = connect();
  server_->stop();
  EXPECT_EQ(server_->clients(), 0U);
  context_.run();  // returns: nothing is left
  EXPECT_EQ(receive(client), "closed");
  tcp::socket late(client_context_);
  error_code error;
  late.connect({boost::asio::ip::address_v4::loopback(), server_->port()}, error);
  EXPECT_TRUE(error);
}

TEST_F(MelsecServerTest, ServerDestroyed_BeforeItsHandlersRan_IsNotTouchedByThem) {
  start();
  auto client = connect();
  send(client, read_d100);
  server_.reset();
  context_.restart();
  context_.run();
  EXPECT_EQ(clock_.asked, 0);
}

TEST_F(MelsecServerTest, RunThatEndsWhileTheTimeIsAsked_LeavesTheRequestUnanswered) {
  clock_.stop_when_asked = &start();
  auto client = connect();
  send(client, read_d100);
  EXPECT_EQ(receive(client), "closed");
  EXPECT_EQ(clock_.accesses + clock_.touches, 0);
}

TEST_F(MelsecServerTest, RequestsOfManyClients_AreAnsweredInTheirOrder) {
  start();
  auto writes = connect();
  auto reads = connect();
  send(writes, bytes("50 00 00 ff ff 03 00 0e 00 10 00 01 14 00 00 64 00 00 a8 01 00 78 56"));
  send(reads, read_d100);
  EXPECT_EQ(receive(reads), "d0 00 00 ff ff 03 00 04 00 00 00 78 56");
  EXPECT_EQ(receive(writes), "d0 00 00 ff ff 03 00 02 00 00 00");
}

TEST_F(MelsecServerTest, ClientsThatAskAtOnce_DoNotDisturbEachOther) {
  start({.half_request_timeout = 3s});
  std::vector<tcp::socket> clients;
  for (int i = 0; i < 6; ++i) clients.push_back(connect());
  send(clients[0], read_d100 + read_d100);
  send(clients[1], bytes("99 99 99"));
  send(clients[2], read_d100.substr(0, 10));
  clients[3].set_option(boost::asio::socket_base::linger(true, 0));
  send(clients[3], read_d100);
  clients[3].close();
  clients[4].shutdown(tcp::socket::shutdown_send);
  send(clients[5], read_d100);
  EXPECT_EQ(receive(clients[0]), read_d100_reply + ' ' + read_d100_reply);
  EXPECT_EQ(receive(clients[1]), "closed");
  EXPECT_EQ(receive(clients[4]), "closed");
  EXPECT_EQ(receive(clients[5]), read_d100_reply);
  EXPECT_EQ(server_->clients(), 3U);
  send(clients[2], read_d100.substr(10));
  EXPECT_EQ(receive(clients[2]), read_d100_reply);
  context_.run_for(3100ms);
  EXPECT_EQ(server_->clients(), 3U) << "no request is half any more";
  EXPECT_THAT(reports_, ElementsAre(name_of(clients[1]) +
                                    " sent what is no request of the MC protocol: its connection is closed"));
}

TEST_F(MelsecServerTest, RunThatEndsWhileManyAsk_LeavesTheRestUnanswered) {
  clock_.stop_when_asked = &start();
  clock_.answered_before_stop = 2;
  std::vector<tcp::socket> clients;
  for (int i = 0; i < 4; ++i) clients.push_back(connect());
  for (auto& client : clients) send(client, read_d100);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(receive(clients[i]), read_d100_reply);
  for (std::size_t i = 2; i < 4; ++i) EXPECT_EQ(receive(clients[i]), "closed");
  EXPECT_EQ(clock_.asked, 3);
  EXPECT_EQ(clock_.accesses, 2);
}

TEST_F(MelsecServerTest, ServerDestroyed_BetweenTheHandlersOfTwoClients_IsNotTouchedByTheSecond) {
  start();
  auto first = connect();
  auto second = connect();
  send(first, read_d100);
  send(second, read_d100);
  context_.run_one();
  EXPECT_EQ(clock_.asked, 1);
  server_.reset();
  context_.restart();
  context_.run();
  EXPECT_EQ(clock_.asked, 1);
}

TEST_F(MelsecServerTest, Listen_OnATakenPort_SaysSo) {
  start();
  MelsecServer second(context_, plc_.rack, clock_);
  const auto result = second.listen("127.0.0.1", server_->port());
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error(),
              HasSubstr("127.0.0.1:" + std::to_string(server_->port()) + ": Address already in use"));
}

}  // namespace
}  // namespace canopus::serve::melsec_server_test
