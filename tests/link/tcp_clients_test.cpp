// What all TCP servers have in common, shown with one that does nothing else. On real sockets of the loopback interface.

#include "canopus/link/tcp_clients.hpp"

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::link::tcp_clients_test {
namespace {

using boost::asio::ip::tcp;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

class Client final : public TcpClient<Client> {
 public:
  Client(TcpClients<Client>& clients, tcp::socket socket)
      : TcpClient(clients, name_of_peer(socket)), socket_(std::move(socket)) {}
  [[nodiscard]] HeldPlace place() const noexcept { return {.hold = Hold::firm}; }
  void close() noexcept { close_socket(socket_); }
  using TcpClient::end;
  using TcpClient::is_closed;
  using TcpClient::set_timer;

 private:
  tcp::socket socket_;
};

class TcpClientsTest : public ::testing::Test {
 protected:
  void listen(TcpClients<Client>::Rules rules) {
    clients = std::make_unique<TcpClients<Client>>(
        io, std::move(rules), [this](std::string_view sentence) { reports.emplace_back(sentence); });
    ASSERT_TRUE(clients->listen("127.0.0.1", 0, [this](tcp::socket socket) {
      if (!clients->may_connect(socket, "no\n")) return;
      if (clients->is_full()) return clients->refuse(socket, "was refused: full", "full\n");
      clients->add(std::make_shared<Client>(*clients, std::move(socket)));
    }));
  }
  tcp::socket connect() {
    tcp::socket socket(far_io);
    socket.connect({boost::asio::ip::address_v4::loopback(), clients->port()});
    io.restart();
    io.poll();
    return socket;
  }
  static std::string name_of(const tcp::socket& far) {
    return "127.0.0.1:" + std::to_string(far.local_endpoint().port());
  }
  /// Up to the end of the stream.
  static std::string received(tcp::socket& far) {
    std::string text;
    std::array<char, 100> space{};
    boost::system::error_code error;
    while (const std::size_t count = far.read_some(boost::asio::buffer(space), error))
      text.append(space.data(), count);
    return text;
  }

  boost::asio::io_context io;
  boost::asio::io_context far_io;
  std::vector<std::string> reports;
  std::unique_ptr<TcpClients<Client>> clients;
};

TEST_F(TcpClientsTest, WhoIsRefused_GetsTheAnswer_AndIsReported) {
  listen({.most = 1});
  const auto first = connect();
  auto second = connect();
  EXPECT_EQ(received(second), "full\n");
  EXPECT_EQ(clients->size(), 1U);
  EXPECT_THAT(reports, ElementsAre(name_of(second) + " was refused: full"));
}

TEST_F(TcpClientsTest, AConnectionThatEndsForAReason_IsReported_ClosedAndOffTheList) {
  listen({.most = 2});
  auto first = connect();
  const auto second = connect();
  const auto client = clients->all().front();
  client->end("sent nonsense");
  EXPECT_EQ(received(first), "");
  EXPECT_TRUE(client->is_closed());
  EXPECT_EQ(clients->size(), 1U);
  EXPECT_EQ(clients->all().front()->name(), name_of(second));
  EXPECT_THAT(reports, ElementsAre(name_of(first) + " sent nonsense: its connection is closed"));
}

TEST_F(TcpClientsTest, AConnectionWhoseTimeIsOver_Ends) {
  listen({.most = 2});
  auto far = connect();
  clients->all().front()->set_timer(1ms, "was too slow");
  io.restart();
  while (clients->size() != 0) io.run_one();
  EXPECT_THAT(reports, ElementsAre(name_of(far) + " was too slow: its connection is closed"));
}

TEST_F(TcpClientsTest, AServerThatCloses_ReportsNothing_AndLeavesTheLoopWithoutWork) {
  listen({.most = 2});
  auto far = connect();
  clients->all().front()->set_timer(1h, "was too slow");
  clients->close();
  EXPECT_EQ(received(far), "");
  io.restart();
  io.run();
  EXPECT_EQ(clients->size(), 0U);
  EXPECT_THAT(reports, IsEmpty());
}

}  // namespace
}  // namespace canopus::link::tcp_clients_test
