// On real sockets of the loopback interface; the test turns the event loop itself. What one end sends is there at the
// other when send() has returned, so a turn of the loop without waiting finds it.

#include "canopus/link/tcp/watched_socket.hpp"

#include <array>
#include <cerrno>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>
#include <sys/socket.h>

namespace canopus::link::watched_socket_test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

class Listener final : public WatchedSocket::User {
 public:
  void can_read() override {
    ++reads;
    if (on_read) on_read();
  }
  void can_write() override { ++writes; }

  int reads = 0;
  int writes = 0;
  std::function<void()> on_read;
};

class WatchedSocketTest : public ::testing::Test {
 protected:
  WatchedSocketTest() {
    tcp::acceptor acceptor(far_io, {asio::ip::address_v4::loopback(), 0});
    far.connect(acceptor.local_endpoint());
    far.set_option(tcp::no_delay(true));
    tcp::socket near(*io);
    acceptor.accept(near);
    socket = std::make_unique<WatchedSocket>(*io, std::move(near), listener);
  }

  void turn() {
    io->restart();  // it may have run out of work
    io->poll();
  }
  void send(std::string_view text) { asio::write(far, asio::buffer(text)); }
  /// "" at the end of the stream, "?" when there is nothing.
  std::string read(std::size_t space = 100) {
    std::vector<std::uint8_t> memory(space);
    const auto result = socket->read(memory);
    if (result.has_to_wait()) return "?";
    EXPECT_EQ(result.error, 0);
    return {memory.begin(), memory.begin() + static_cast<std::ptrdiff_t>(result.count)};
  }
  /// Waits for something to read; the first look may come at once and in vain.
  void wait(const std::shared_ptr<void>& keeper = nullptr) {
    socket->wait_to_read(keeper);
    turn();
    if (listener.reads == 0) return;
    EXPECT_EQ(read(), "?");
    socket->wait_to_read(keeper);
    turn();
    listener.reads = 0;
  }

  std::unique_ptr<asio::io_context> io = std::make_unique<asio::io_context>();
  asio::io_context far_io;
  tcp::socket far{far_io};
  Listener listener;
  std::unique_ptr<WatchedSocket> socket;
};

TEST_F(WatchedSocketTest, WhatComes_IsToldOnce_UntilSomebodyWaitsAgain) {
  wait();
  EXPECT_EQ(listener.reads, 0) << "nothing has come";
  send("one");
  turn();
  EXPECT_EQ(listener.reads, 1);
  EXPECT_EQ(read(), "one");
  send("two");
  turn();
  EXPECT_EQ(listener.reads, 1) << "nobody waits";
  socket->wait_to_read(nullptr);
  turn();
  EXPECT_EQ(listener.reads, 2) << "it has come before the wait";
  EXPECT_EQ(read(), "two");
}

TEST_F(WatchedSocketTest, AfterAReadThatDidNotFillItsSpace_TheWaitAsksForNothing) {
  wait();
  send("one");
  turn();
  EXPECT_EQ(read(), "one");
  socket->wait_to_read(nullptr);
  turn();
  EXPECT_EQ(listener.reads, 1);
  send("two");
  turn();
  EXPECT_EQ(listener.reads, 2);
  EXPECT_EQ(read(), "two");
}

TEST_F(WatchedSocketTest, WhatAFullReadLeavesBehind_IsToldAtOnce) {
  wait();
  send("one two");
  turn();
  EXPECT_EQ(read(3), "one");
  socket->wait_to_read(nullptr);
  EXPECT_EQ(listener.reads, 1) << "from the loop alone";
  turn();
  EXPECT_EQ(listener.reads, 2);
  EXPECT_EQ(read(3), " tw");
  EXPECT_EQ(read(3), "o");
}

TEST_F(WatchedSocketTest, WhoDidNotReadWhatHeWasToldOf_IsToldAgain) {
  wait();
  send("one");
  turn();
  EXPECT_EQ(listener.reads, 1);
  socket->wait_to_read(nullptr);
  turn();
  EXPECT_EQ(listener.reads, 2);
  EXPECT_EQ(read(), "one");
}

TEST_F(WatchedSocketTest, TheEndOfTheStream_IsRead) {
  wait();
  far.shutdown(tcp::socket::shutdown_send);
  turn();
  EXPECT_EQ(listener.reads, 1);
  EXPECT_EQ(read(), "");
}

TEST_F(WatchedSocketTest, TheEndThatComesWithBytes_IsLeftInDoubt) {
  wait();
  EXPECT_FALSE(socket->is_doubtful()) << "it found nothing";
  send("one");
  far.shutdown(tcp::socket::shutdown_send);
  turn();
  EXPECT_EQ(read(), "one");
  EXPECT_TRUE(socket->is_doubtful());
  EXPECT_EQ(read(), "");
}

TEST_F(WatchedSocketTest, BytesBehindUrgentOnes_AreLeftInDoubt) {
  wait();
  send("one");
  ASSERT_EQ(::send(far.native_handle(), "!", 1, MSG_OOB), 1);
  send("two");
  turn();
  EXPECT_EQ(read(), "one");
  EXPECT_TRUE(socket->is_doubtful());
  EXPECT_EQ(read(), "two");
}

TEST_F(WatchedSocketTest, AResetOfTheOtherEnd_IsTold) {
  wait();
  far.set_option(asio::socket_base::linger(true, 0));
  far.close();
  turn();
  EXPECT_EQ(listener.reads, 1);
  std::array<std::uint8_t, 10> space{};
  EXPECT_EQ(socket->read(space).error, ECONNRESET);
  EXPECT_NE(socket->write(space).error, 0) << "and no SIGPIPE";
}

TEST_F(WatchedSocketTest, RoomToWrite_IsToldWhenTheOtherEndHasRead) {
  const std::vector<std::uint8_t> block(1'000'000);
  std::size_t written = 0;
  WatchedSocket::Transfer last;
  while (!(last = socket->write(block)).has_to_wait()) written += last.count;
  socket->wait_to_write(nullptr);
  turn();
  if (std::exchange(listener.writes, 0) != 0) {  // the first look may come at once and in vain
    EXPECT_TRUE(socket->write(block).has_to_wait());
    socket->wait_to_write(nullptr);
    turn();
  }
  EXPECT_EQ(listener.writes, 0);
  std::vector<std::uint8_t> there(written);
  asio::read(far, asio::buffer(there));
  turn();
  EXPECT_EQ(listener.writes, 1);
  EXPECT_GT(socket->write(block).count, 0U);
}

TEST_F(WatchedSocketTest, AClosedSocket_TellsNothing_AndLetsItsKeeperGo) {
  auto keeper = std::make_shared<int>();
  const std::weak_ptr<int> held = keeper;
  wait(std::exchange(keeper, nullptr));
  socket->close();
  turn();
  EXPECT_TRUE(held.expired());
  EXPECT_EQ(listener.reads, 0);
  io->restart();
  EXPECT_EQ(io->run(), 0U) << "it leaves no work";
}

TEST_F(WatchedSocketTest, TheKeeper_IsHeldUntilItIsTold) {
  auto keeper = std::make_shared<int>();
  const std::weak_ptr<int> held = keeper;
  wait(std::exchange(keeper, nullptr));
  EXPECT_FALSE(held.expired());
  listener.on_read = [&] { EXPECT_FALSE(held.expired()); };
  send("one");
  turn();
  EXPECT_EQ(listener.reads, 1);
  EXPECT_TRUE(held.expired());
}

TEST_F(WatchedSocketTest, ClosedByItsUser_WhileHeIsTold) {
  wait();
  listener.on_read = [&] { socket.reset(); };
  send("one");
  turn();
  EXPECT_EQ(listener.reads, 1);
  std::array<char, 10> space{};
  boost::system::error_code error;
  (void)far.read_some(asio::buffer(space), error);
  EXPECT_TRUE(error);
}

TEST_F(WatchedSocketTest, ClosedBetweenTheNewsAndItsTelling_TellsNothing) {
  wait();
  send("one two");
  turn();
  EXPECT_EQ(read(3), "one");
  socket->wait_to_read(nullptr);  // is to be told at once
  socket->close();
  turn();
  EXPECT_EQ(listener.reads, 1);
  EXPECT_LT(socket->native_handle(), 0);
}

TEST_F(WatchedSocketTest, ALoopThatEndsBeforeItsSockets_LetsKeepersGo) {
  struct Owner {
    std::unique_ptr<WatchedSocket> socket;
  };
  auto owner = std::make_shared<Owner>();
  const std::weak_ptr<Owner> held = owner;
  wait(owner);
  owner->socket = std::move(socket);
  owner.reset();
  EXPECT_FALSE(held.expired());
  io.reset();
  EXPECT_TRUE(held.expired());
}

}  // namespace
}  // namespace canopus::link::watched_socket_test
