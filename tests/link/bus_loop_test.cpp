#include "canopus/link/bus_loop.hpp"

#include <csignal>
#include <cstddef>
#include <memory>

#include <boost/asio/post.hpp>
#include <gtest/gtest.h>

#include "canopus/link/bounded_poll.hpp"

namespace canopus::link::bus_loop_test {
namespace {

/// A peer that always has the next message ready. It gives up after so many that no portion is as large.
class EndlessPeer {
 public:
  static constexpr std::size_t most = 100 * most_handlers_at_once;

  explicit EndlessPeer(BusLoop& loop) : loop_(loop) { send_next(); }
  [[nodiscard]] std::size_t messages() const { return messages_; }

 private:
  void send_next() {
    if (messages_ == most) return;
    boost::asio::post(loop_.io(), [this] {
      ++messages_;
      send_next();
    });
  }

  BusLoop& loop_;
  std::size_t messages_ = 0;
};

class BusLoopTest : public testing::Test {
 protected:
  void SetUp() override {
    // Over UDP a bus is there without another side.
    BusAddress address;
    address.kind = BusAddress::Kind::cannelloni;
    address.host = "127.0.0.1";
    address.port = 9;
    auto opened = BusLoop::open(address, std::chrono::seconds(10));
    ASSERT_TRUE(opened) << opened.error();
    loop = std::move(*opened);
  }

  std::unique_ptr<BusLoop> loop;
};

TEST_F(BusLoopTest, EndlessPeer_TimeEndsTheRun) {
  const EndlessPeer peer(*loop);
  EXPECT_EQ(loop->run([] { return false; }, loop->now()), BusLoop::End::time_over);
  EXPECT_LE(peer.messages(), most_handlers_at_once);
}

TEST_F(BusLoopTest, EndlessPeer_AnswerEndsTheRun) {
  const EndlessPeer peer(*loop);
  EXPECT_EQ(loop->run([&] { return peer.messages() > 3; }), BusLoop::End::done);
  EXPECT_LE(peer.messages(), most_handlers_at_once);
}

TEST_F(BusLoopTest, EndlessPeer_SignalsEndTheRun) {
  for (const int signal : {SIGINT, SIGTERM}) {
    SetUp();
    const EndlessPeer peer(*loop);
    (void)std::raise(signal);
    EXPECT_EQ(loop->run([] { return false; }), BusLoop::End::interrupted);
    EXPECT_LE(peer.messages(), most_handlers_at_once);
  }
}

}  // namespace
}  // namespace canopus::link::bus_loop_test
