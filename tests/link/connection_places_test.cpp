// Who gives way when all places of a server are taken. No socket, no clock.

#include "canopus/link/tcp/connection_places.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::link::connection_places_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

using Moment = HeldPlace::Clock::time_point;

struct Client {
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] HeldPlace place() const { return place_; }
  void close() { is_closed = true; }

  std::string name_;
  HeldPlace place_;
  bool is_closed = false;
};

class ConnectionPlacesTest : public ::testing::Test {
 protected:
  void add(const std::string& name, Hold hold, std::chrono::seconds used, std::uint64_t number = 0) {
    clients_.push_back(
        std::make_shared<Client>(Client{name, {.hold = hold, .used = Moment(used), .number = number}}));
  }
  bool make_room(std::size_t most, std::chrono::seconds now = 100s) {
    return ConnectionPlaces(most, 10s).make_room(
        clients_, "new", Moment(now),
        [this](const std::string& client, const std::string& what) { said_.push_back(client + ' ' + what); });
  }
  [[nodiscard]] std::string names() const {
    std::string all;
    for (const auto& one : clients_) all += one->name();
    return all;
  }

  std::vector<std::shared_ptr<Client>> clients_;
  std::vector<std::string> said_;
};

TEST_F(ConnectionPlacesTest, WhereThereIsRoom_NobodyGivesWay) {
  add("a", Hold::none, 0s);
  EXPECT_TRUE(make_room(2));
  EXPECT_EQ(names(), "a");
  EXPECT_THAT(said_, IsEmpty());
}

TEST_F(ConnectionPlacesTest, TheWeakestHold_ThenTheEarliest_ThenTheLowestNumber) {
  add("f", Hold::firm, 0s);
  add("u", Hold::while_used, 1s);
  add("w", Hold::weak, 2s);
  add("n", Hold::none, 9s, 2);
  add("m", Hold::none, 9s, 1);
  add("o", Hold::none, 8s, 7);
  for (const char* left : {"fuwnm", "fuwn", "fuw", "fu", "f"}) {
    EXPECT_TRUE(make_room(clients_.size()));
    EXPECT_EQ(names(), left);
  }
  EXPECT_FALSE(make_room(1));
  EXPECT_EQ(names(), "f");
  EXPECT_THAT(said_, ElementsAre("o gives way to new: its connection is closed",
                                 "m gives way to new: its connection is closed",
                                 "n gives way to new: its connection is closed",
                                 "w gives way to new: its connection is closed",
                                 "u has sent no request for 99 s: its connection gives way to new",
                                 "new was refused: all 1 connections are in use"));
}

TEST_F(ConnectionPlacesTest, AConnectionThatIsUsed_StaysForItsTime) {
  add("u", Hold::while_used, 91s);
  const auto client = clients_.front();
  EXPECT_FALSE(make_room(1));
  EXPECT_FALSE(client->is_closed);
  EXPECT_TRUE(make_room(1, 101s));
  EXPECT_TRUE(client->is_closed);
}

TEST_F(ConnectionPlacesTest, OfThoseThatAreMeantAlone) {
  add("a", Hold::none, 0s);
  add("b", Hold::none, 1s);
  const auto report = [](const std::string&, const std::string&) {};
  const ConnectionPlaces places(64, 10s);
  EXPECT_TRUE(places.give_way(clients_, "new", Moment(2s), report,
                              [](const Client& one) { return one.name() == "b"; }));
  EXPECT_EQ(names(), "a");
  EXPECT_FALSE(places.give_way(clients_, "new", Moment(2s), report, [](const Client&) { return false; }));
}

}  // namespace
}  // namespace canopus::link::connection_places_test
