#include "canopus/link/tcp/tcp_port.hpp"

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace canopus::link::tcp_port_test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using testing::HasSubstr;

class TcpPortTest : public testing::Test {
 protected:
  TcpPort::Users users() {
    return {.admit = [this](tcp::socket socket) { admitted.push_back(std::move(socket)); },
            .refuse = [this](tcp::socket& socket) { refused += socket.is_open() ? 1U : 0U; }};
  }
  void listen() {
    io.restart();  // it may have run out of work
    const auto listening = port.listen("127.0.0.1", 0, users());
    ASSERT_TRUE(listening) << listening.error();
    ASSERT_NE(port.port(), 0);
  }
  /// The system completes the connection, whether it is accepted or not.
  void connect(tcp::socket& client) { client.connect({asio::ip::address_v4::loopback(), port.port()}); }
  void run_until(const std::function<bool()>& done) {
    while (!done() && io.run_one_for(std::chrono::seconds(10)) != 0) {
    }
    EXPECT_TRUE(done());
  }

  asio::io_context io;
  TcpPort port{io};
  std::vector<tcp::socket> admitted;
  unsigned refused = 0;
};

TEST_F(TcpPortTest, ClientsAreAdmitted_OneAfterTheOther) {
  listen();
  tcp::socket first(io), second(io);
  connect(first);
  connect(second);
  run_until([&] { return admitted.size() == 2; });
  EXPECT_EQ(admitted[0].remote_endpoint(), first.local_endpoint());
  EXPECT_EQ(admitted[1].remote_endpoint(), second.local_endpoint());
  EXPECT_EQ(refused, 0U);
}

TEST_F(TcpPortTest, WhoIsGoneBeforeItsTurn_IsNotAdmitted) {
  listen();
  tcp::socket gone(io), there(io);
  connect(gone);
  gone.set_option(asio::socket_base::linger(true, 0));
  gone.close();
  connect(there);
  run_until([&] { return !admitted.empty(); });
  ASSERT_EQ(admitted.size(), 1U);
  boost::system::error_code failure;
  EXPECT_EQ(admitted[0].remote_endpoint(failure), there.local_endpoint());
  EXPECT_FALSE(failure);
}

TEST_F(TcpPortTest, PortInUse_IsASentenceWithItsAddress_AndNothingIsOpen) {
  listen();
  TcpPort other(io);
  const auto failed = other.listen("127.0.0.1", port.port(), users());
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error(), "127.0.0.1:" + std::to_string(port.port()) + ": Address already in use");
  EXPECT_EQ(other.port(), 0);
}

TEST_F(TcpPortTest, NameThatIsNone_IsASentenceToo) {
  const auto failed = port.listen("no such host", 5007, users());
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error(), HasSubstr("no such host:5007: "));
}

TEST_F(TcpPortTest, PortThatWasClosed_CallsNobodyAndCanListenAgain) {
  listen();
  tcp::socket client(io);
  connect(client);
  port.close();
  EXPECT_EQ(port.port(), 0);
  io.poll();
  EXPECT_TRUE(admitted.empty());
  listen();
  tcp::socket again(io);
  connect(again);
  run_until([&] { return admitted.size() == 1; });
}

TEST_F(TcpPortTest, AUserMayCloseThePort) {
  const auto listening = port.listen(
      "127.0.0.1", 0, {.admit = [this](tcp::socket) { port.close(); }, .refuse = [](tcp::socket&) {}});
  ASSERT_TRUE(listening);
  tcp::socket client(io);
  connect(client);
  run_until([&] { return port.port() == 0; });
}

TEST_F(TcpPortTest, WithoutAFileDescriptor_AClientIsTakenToBeRefused_AndLaterOnesAreAdmitted) {
  listen();
  tcp::socket refused_client(io, tcp::v4()), late_client(io, tcp::v4());
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &limit), 0);
  std::vector<int> all;  // every descriptor that is left
  const rlimit few{.rlim_cur = 64, .rlim_max = limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  const auto reserve = [] { return ::open("/dev/null", O_RDONLY | O_CLOEXEC); };
  for (int file = reserve(); file >= 0; file = reserve()) all.push_back(file);
  connect(refused_client);
  run_until([&] { return refused == 1; });
  EXPECT_TRUE(admitted.empty());
  for (const int file : all) ::close(file);
  EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
  connect(late_client);
  run_until([&] { return admitted.size() == 1; });
}

}  // namespace
}  // namespace canopus::link::tcp_port_test
