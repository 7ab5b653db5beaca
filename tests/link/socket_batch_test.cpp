// On real sockets of the loopback interface. What one end sends is there at the other when send() has returned.

#include "canopus/link/tcp/socket_batch.hpp"

#include <cerrno>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>

namespace canopus::link::socket_batch_test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using ::testing::ElementsAre;
using Way = SocketBatch::Way;

/// Both ends of a connection: the far one is the client's.
struct Pair final : WatchedSocket::User {
  Pair(asio::io_context& io, tcp::acceptor& acceptor) : far(io) {
    far.connect(acceptor.local_endpoint());
    far.set_option(tcp::no_delay(true));
    tcp::socket accepted(io);
    acceptor.accept(accepted);
    near = std::make_unique<WatchedSocket>(io, std::move(accepted), *this);
  }
  void can_read() override { ++reads; }
  void can_write() override { ++writes; }

  void send(std::string_view text) { asio::write(far, asio::buffer(text)); }
  void reset() {
    far.set_option(tcp::socket::linger(true, 0));
    far.close();
  }
  std::string received() {
    std::string text(far.available(), ' ');
    asio::read(far, asio::buffer(text));
    return text;
  }

  tcp::socket far;
  std::unique_ptr<WatchedSocket> near;
  int reads = 0;
  int writes = 0;
};

class SocketBatchTest : public ::testing::TestWithParam<Way> {
 protected:
  /// What is waited for has to end before the sockets do.
  void TearDown() override {
    for (const auto& pair : pairs) pair->near->close();
    turn();
  }

  Pair& connect() { return *pairs.emplace_back(std::make_unique<Pair>(io, acceptor)); }
  /// "?" where there was nothing, "end" of a stream, or the error.
  std::vector<std::string> read(std::size_t space = 100) {
    std::vector<std::vector<std::uint8_t>> memory(pairs.size(), std::vector<std::uint8_t>(space));
    std::vector<BatchedRead> reads;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      reads.push_back({.socket = pairs[i]->near.get(), .bytes = memory[i]});
    batch.read(reads);
    std::vector<std::string> shown;
    for (const BatchedRead& read : reads) {
      if (read.result.has_to_wait())
        shown.emplace_back("?");
      else if (read.result.error != 0)
        shown.emplace_back("error " + std::to_string(read.result.error));
      else if (read.result.count == 0)
        shown.emplace_back("end");
      else
        shown.emplace_back(read.bytes.begin(),
                           read.bytes.begin() + static_cast<std::ptrdiff_t>(read.result.count));
    }
    return shown;
  }
  std::vector<WatchedSocket::Transfer> write(const std::vector<std::string>& texts) {
    std::vector<BatchedWrite> writes;
    for (std::size_t i = 0; i < texts.size(); ++i)
      writes.push_back(
          {.socket = pairs[i]->near.get(),
           .bytes = std::span(reinterpret_cast<const std::uint8_t*>(texts[i].data()), texts[i].size())});
    batch.write(writes);
    std::vector<WatchedSocket::Transfer> results;
    for (const BatchedWrite& write : writes) results.push_back(write.result);
    return results;
  }
  void turn() {
    io.restart();
    io.poll();
  }
  /// The first look may come at once and in vain.
  void wait(Pair& pair) {
    pair.near->wait_to_read(nullptr);
    turn();
    pair.reads = 0;
    if (pair.near->read(spare).has_to_wait()) pair.near->wait_to_read(nullptr);
    turn();
  }

  asio::io_context io;
  tcp::acceptor acceptor{io, {asio::ip::address_v4::loopback(), 0}};
  std::vector<std::unique_ptr<Pair>> pairs;
  SocketBatch batch{GetParam()};
  std::vector<std::uint8_t> spare = std::vector<std::uint8_t>(100);
};

TEST_P(SocketBatchTest, EachSocketReadsItsOwn) {
  connect().send("one");
  connect();
  connect().send("three");
  connect().far.shutdown(tcp::socket::shutdown_send);
  connect().reset();
  EXPECT_THAT(read(), ElementsAre("one", "?", "three", "end", "error " + std::to_string(ECONNRESET)));
  EXPECT_TRUE(pairs[0]->near->is_doubtful());
  EXPECT_FALSE(pairs[1]->near->is_doubtful());
}

TEST_P(SocketBatchTest, EachSocketWritesItsOwn_AndAClientThatIsGoneSendsNoSignal) {
  for (int i = 0; i < 3; ++i) connect();
  pairs[1]->reset();
  (void)write({"1", "two"});  // the reset is told once, then the pipe is broken
  const auto results = write({"one", "two", "three"});
  EXPECT_EQ(results[0].count, 3U);
  EXPECT_EQ(results[1].error, EPIPE);
  EXPECT_EQ(results[2].count, 5U);
  EXPECT_EQ(pairs[0]->received(), "1one");
  EXPECT_EQ(pairs[2]->received(), "three");
}

TEST_P(SocketBatchTest, WhoHasNoRoom_WritesInPart_ThenHasToWait_AndHoldsNobodyUp) {
  connect();
  connect();
  const std::string flood(1 << 20, 'x');
  std::size_t sent = 0;
  while (true) {
    const auto results = write({flood, "y"});
    EXPECT_EQ(results[1].count, 1U);
    if (results[0].has_to_wait()) break;
    ASSERT_EQ(results[0].error, 0);
    sent += results[0].count;
    ASSERT_LT(sent, std::size_t{1} << 30);
  }
  EXPECT_GT(sent, 0U);
  pairs[0]->near->wait_to_write(nullptr);
  turn();
  if (std::exchange(pairs[0]->writes, 0) != 0) {  // the first look may come at once and in vain
    EXPECT_TRUE(write({flood, "y"})[0].has_to_wait());
    pairs[0]->near->wait_to_write(nullptr);
    turn();
  }
  EXPECT_EQ(pairs[0]->writes, 0);
  std::size_t received = 0;
  for (int round = 0; round < 100000 && received < sent; ++round) received += pairs[0]->received().size();
  EXPECT_EQ(received, sent);
  turn();
  EXPECT_EQ(pairs[0]->writes, 1) << "there is room again";
}

TEST_P(SocketBatchTest, AfterAReadThatDidNotFillItsSpace_TheWaitAsksForNothing_AndAFullOneIsToldAtOnce) {
  for (Pair* pair : {&connect(), &connect()}) wait(*pair);
  pairs[0]->send("one");
  pairs[1]->send("one two");
  turn();
  EXPECT_EQ(pairs[0]->reads, 1);
  EXPECT_EQ(pairs[1]->reads, 1);
  EXPECT_THAT(read(4), ElementsAre("one", "one "));
  for (const auto& pair : pairs) pair->near->wait_to_read(nullptr);
  turn();
  EXPECT_EQ(pairs[0]->reads, 1) << "nothing is there";
  EXPECT_EQ(pairs[1]->reads, 2) << "the rest is there";
  EXPECT_THAT(read(4), ElementsAre("?", "two"));
}

TEST_P(SocketBatchTest, MoreSocketsThanTheKernelTakesAtOnce) {
  std::vector<std::string> texts;
  for (int i = 0; i < 100; ++i) {
    texts.push_back("socket " + std::to_string(i));
    connect().send(texts.back());
  }
  EXPECT_EQ(read(), texts);
  EXPECT_EQ(write(texts).size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(pairs[i]->received(), texts[i]);
  if (batch.way() != GetParam()) std::cout << "this kernel reads and writes one by one\n";
}

TEST_P(SocketBatchTest, NoneAndOne) {
  EXPECT_THAT(read(), ElementsAre());
  connect().send("one");
  EXPECT_THAT(read(), ElementsAre("one"));
  EXPECT_EQ(write({"two"})[0].count, 3U);
  EXPECT_EQ(pairs[0]->received(), "two");
}

TEST_P(SocketBatchTest, AClosedSocket_IsAnError) {
  connect().send("one");
  connect().send("two");
  pairs[0]->near->close();
  EXPECT_THAT(read(), ElementsAre("error " + std::to_string(EBADF), "two"));
  EXPECT_EQ(write({"one", "two"})[0].error, EBADF);
  EXPECT_EQ(pairs[1]->received(), "two");
}

INSTANTIATE_TEST_SUITE_P(Ways, SocketBatchTest, ::testing::Values(Way::together, Way::one_by_one),
                         [](const auto& way) {
                           return std::string(way.param == Way::together ? "Together" : "OneByOne");
                         });

/// The process may open nothing more while this lives.
class NoDescriptorLeft {
 public:
  NoDescriptorLeft() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    rlimit none = before_;
    none.rlim_cur = 0;
    ::setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoDescriptorLeft() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptorLeft(const NoDescriptorLeft&) = delete;
  NoDescriptorLeft& operator=(const NoDescriptorLeft&) = delete;

 private:
  rlimit before_{};
};

TEST_P(SocketBatchTest, ASystemThatRefuses_HasItReadOneByOne) {
  connect().send("one");
  connect().send("two");
  {
    const NoDescriptorLeft refuses;
    EXPECT_THAT(read(), ElementsAre("one", "two"));
  }
  EXPECT_EQ(batch.way(), Way::one_by_one);
  pairs[1]->send("more");
  EXPECT_THAT(read(), ElementsAre("?", "more"));
}

}  // namespace
}  // namespace canopus::link::socket_batch_test
