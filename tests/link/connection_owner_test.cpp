// Who of this machine is at the other end: tables as the kernel prints them, and real connections.
#include "canopus/link/tcp/connection_owner.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address_v6.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <unistd.h>

namespace canopus::link::connection_owner_test {
namespace {

using boost::asio::ip::make_address;
using boost::asio::ip::tcp;

// Lines of a kernel 6.1.
constexpr std::string_view table =
    "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n"
    "   0: 0100007F:1F90 00000000:0000 0A 00000000:00000000 00:00000000 00000000  1000        0 38401 1 0 "
    "100 0 0 10 0\n"
    "   1: 0100007F:1F90 0100007F:C350 01 00000000:00000000 00:00000000 00000000  1000        0 38410 1 0 20 "
    "4 30 10 -1\n"
    "   2: 0100007F:C350 0100007F:1F90 01 00000000:00000000 00:00000000 00000000  1001        0 38409 1 0 20 "
    "4 30 10 -1\n"
    "  17: 0100007F:C351 0100007F:1F90 01 00000000:00000000 00:00000000 00000000 4294967295 0 38409 1\n";

tcp::endpoint at(const char* address, std::uint16_t port) { return {make_address(address), port}; }

TEST(ConnectionOwner, IsOfTheLineWithBothEnds) {
  EXPECT_EQ(owner_in_table(table, at("127.0.0.1", 50000), at("127.0.0.1", 8080)), 1001U);
  EXPECT_EQ(owner_in_table(table, at("127.0.0.1", 8080), at("127.0.0.1", 50000)), 1000U);
  EXPECT_EQ(owner_in_table(table, at("127.0.0.1", 50001), at("127.0.0.1", 8080)), 4294967295U);
  EXPECT_EQ(owner_in_table(table, at("127.0.0.1", 50002), at("127.0.0.1", 8080)), std::nullopt);
  EXPECT_EQ(owner_in_table(table, at("127.0.0.2", 50000), at("127.0.0.1", 8080)), std::nullopt);
  EXPECT_EQ(owner_in_table(table, at("127.0.0.1", 50000), at("127.0.0.1", 8081)), std::nullopt);
  EXPECT_EQ(owner_in_table(table, at("::1", 50000), at("::1", 8080)), std::nullopt);
}

TEST(ConnectionOwner, IsNobodyInATableThatIsNone) {
  for (const std::string_view text :
       {"", "\n\n", "   2: 0100007F:C350 0100007F:1F90", "2: 0100007F:C350 0100007F:1F90 01 0 0 0 -1\n",
        "2: 0100007F:C350 0100007F:1F90 01 0 0 0 1001x\n",
        "2: 0100007F:C350 0100007F:1F90 01 0 0 0 99999999999\n"}) {
    EXPECT_EQ(owner_in_table(text, at("127.0.0.1", 50000), at("127.0.0.1", 8080)), std::nullopt) << text;
  }
}

RC_GTEST_PROP(ConnectionOwner, NoTableDoesHarm, (const std::string& text)) {
  (void)owner_in_table(text, at("127.0.0.1", 50000), at("127.0.0.1", 8080));
}

TEST(ConnectionOwner, OfAConnectionOfThisProcess_IsItsOwnUser) {
  boost::asio::io_context io;
  tcp::acceptor acceptor(io, at("127.0.0.1", 0));
  tcp::socket client(io);
  client.connect(acceptor.local_endpoint());
  const tcp::socket server = acceptor.accept();
  EXPECT_TRUE(is_of_own_user(server));
  EXPECT_FALSE(is_of_own_user(tcp::socket(io)));
  if (::geteuid() != 0) GTEST_SKIP() << "only root can ask as another user";
  ASSERT_EQ(::seteuid(65534), 0);
  const bool is_own = is_of_own_user(server);
  ASSERT_EQ(::seteuid(0), 0);
  EXPECT_FALSE(is_own) << "its client is root's";
}

}  // namespace
}  // namespace canopus::link::connection_owner_test
