// Faults of lifts, and what the words of an FX3U-CAN show of them [FX3U-CAN 5.10.5, 5.10.6, 5.10.12, 6.24, 8.6, 8.7].

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/plant/event.hpp"

#include "plant/lift_run.hpp"

namespace canopus::plant::lift_faults_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class LiftFaults : public LiftRun {
 protected:
  void start_with(std::string_view kind, std::string_view more = "") {
    start(fmt::format("[[lift]]\nfloors = 5\n[[lift.fault]]\nkind = \"{}\"\nat = \"20s\"\nfor = \"10s\"\n{}",
                      kind, more));
    control_.emplace(*plant_, 1, std::vector<std::uint32_t>{}, 0);
    until(10s);
  }
  void until(can::Duration time) { control_->run_until(can::Time{time}); }
  std::uint16_t word(std::uint32_t address) { return control_->read(address); }
  /// Node and code of the emergencies in #750 on.
  std::vector<std::string> emergencies() {
    std::vector<std::string> all;
    for (std::uint32_t first = 750; word(first) != 0; first += 5)
      all.push_back(fmt::format("{}: {:04X}", word(first), word(first + 1)));
    return all;
  }
  void on(const Event& any) override {
    const auto* const change = std::get_if<LiftChange>(&any.what);
    if (change == nullptr) return;
    const sim::lift::LiftEvent& event = change->event;
    if (event.kind != sim::lift::LiftEvent::Kind::fault_began &&
        event.kind != sim::lift::LiftEvent::Kind::fault_ended)
      return;
    events_.push_back(fmt::format("{} {} {}: {}", can::seconds(event.time), change->bus,
                                  sim::lift::name(event.kind), sim::lift::name(event.fault)));
  }

  std::optional<LiftControl> control_;
  std::vector<std::string> events_;
};

TEST_F(LiftFaults, LightBarrierBlocked) {
  RecordProperty("spec", "FX3U-DOOR-012 FX3U-DOOR-007");
  start_with("light barrier blocked");
  control_->write(13050, 0x4FFF);
  until(14s);
  EXPECT_EQ(word(12050), 0x3000);
  EXPECT_EQ(word(12082), 900);
  EXPECT_EQ(word(12114), 0x003F);
  // It closes as the fault comes: it opens again, and does not close by itself.
  until(19s);
  control_->write(13050, 0x1FFF);
  until(20s + 500ms);
  EXPECT_EQ(word(12114), 0x007F);
  EXPECT_EQ(word(12050), 0x6000);
  until(23s);
  EXPECT_EQ(word(12050), 0x3000);
  // Told to close, it waits until the doorway is free.
  control_->write(13050, 0xFFFF);
  until(24s);
  control_->write(13050, 0x1FFF);
  until(29s);
  EXPECT_EQ(word(12050), 0x3000);
  until(34s);
  EXPECT_EQ(word(12114), 0x003F);
  EXPECT_EQ(word(12050), 0x0011);
  EXPECT_EQ(word(12082), 0);
  EXPECT_EQ(report().cars[0].reversals, 1U);
  EXPECT_THAT(emergencies(), ElementsAre());
  EXPECT_THAT(events_, ElementsAre("20 hoist fault began: light barrier blocked",
                                   "30 hoist fault ended: light barrier blocked"));
}

TEST_F(LiftFaults, LightBarrierDefect) {
  RecordProperty("spec", "FX3U-DOOR-013");
  start_with("light barrier defect");
  until(25s);
  EXPECT_EQ(word(12114), 0x00BF);
  EXPECT_THAT(emergencies(), ElementsAre("11: FF01"));
  until(31s);
  EXPECT_EQ(word(12114), 0x003F);
  EXPECT_THAT(emergencies(), ElementsAre("11: FF01", "11: 0000"));
}

TEST_F(LiftFaults, DriveFault_StopsTheCar_AndNeedsAReset) {
  RecordProperty("spec", "FX3U-DRV-004 FX3U-DRV-008");
  start_with("drive fault");
  control_->enable(0);
  until(18s);
  control_->travel(0, 12'000, 1000);
  until(20s + 100ms);
  EXPECT_EQ(word(12428) & 0x4F, 0x0F);
  until(24s);
  EXPECT_EQ(word(12428) & 0x4F, 0x08);
  EXPECT_EQ(word(12492), 0);
  const std::uint16_t stopped = word(12300);
  EXPECT_GT(stopped, 100);
  EXPECT_LT(stopped, 3000);
  EXPECT_THAT(emergencies(), ElementsAre("8: 2310"));
  control_->command(0, 0x80);
  until(25s);
  EXPECT_EQ(word(12428) & 0x4F, 0x08);  // it is broken still
  until(31s);
  control_->command(0, 0);
  control_->command(0, 0x80);
  EXPECT_EQ(word(12428) & 0x4F, 0x40);
  EXPECT_EQ(word(12300), stopped);
  control_->enable(0);
  control_->travel(0, 12'000, 1000);
  until(50s);
  EXPECT_EQ(word(12300), 12'000);
}

TEST_F(LiftFaults, PositionLost) {
  RecordProperty("spec", "FX3U-DRV-012");
  start_with("position lost");
  EXPECT_EQ(word(12300), 0);
  EXPECT_EQ(word(12301), 0);
  until(25s);
  EXPECT_EQ(word(12300), 0xFFFF);
  EXPECT_EQ(word(12301), 0xFFFF);
  EXPECT_THAT(emergencies(), ElementsAre("9: 7305"));
  until(31s);
  EXPECT_EQ(word(12300), 0);
  EXPECT_EQ(word(12301), 0);
}

TEST_F(LiftFaults, Overload) {
  RecordProperty("spec", "FX3U-LOAD-001 FX3U-LOAD-004");
  start_with("overload");
  EXPECT_EQ(word(12508), 0);
  EXPECT_EQ(word(12524), 0x0001);
  until(25s);
  EXPECT_EQ(word(12508), 945);
  EXPECT_EQ(word(12509), 2);
  EXPECT_EQ(word(12524), 0x000C);
  control_->enable(0);
  control_->travel(0, 3000, 1000);
  until(28s);
  EXPECT_EQ(report().cars[0].overload_travels, 1U);
  until(35s);
  EXPECT_EQ(word(12524), 0x0001);
}

// The hall panel of floor 2 is node 3, whose heartbeat the module consumes here.
TEST_F(LiftFaults, PanelUnplugged_ItsHeartbeatIsMissing) {
  start(
      "\"1016:01\" = 0x000307D0\n[[lift]]\nfloors = 5\n[[lift.fault]]\nkind = \"panel unplugged\"\nfloor = "
      "2\n"
      "at = \"20s\"\nfor = \"10s\"\n");
  control_.emplace(*plant_, 1, std::vector<std::uint32_t>{}, 0);
  plant_->timeline().run_until(can::Time{10s});  // no words while the module starts
  until(19s);
  const auto is_on = [&] {
    const std::vector<NodeStatus> nodes = plant_->nodes();
    return std::ranges::find_if(nodes, [](const NodeStatus& node) { return node.label.node_id == 3; })->is_on;
  };
  EXPECT_TRUE(is_on());
  EXPECT_EQ(word(603), 5);
  EXPECT_EQ(word(901), 0x0002);  // by heartbeat
  EXPECT_EQ(word(29), 0);
  until(25s);
  EXPECT_FALSE(is_on());
  EXPECT_EQ(word(901) & 0x0080, 0x0080);  // missing
  EXPECT_EQ(word(29), 0x0401);
  until(35s);
  EXPECT_TRUE(is_on());
  EXPECT_EQ(word(603), 127);  // Pre-operational: somebody has to start it
}

TEST_F(LiftFaults, PlantFile_NamesEachMistake) {
  const auto lines = check(std::string(lift_controller) + R"([[lift]]
number = [1, 9]
floors = 1
speed = 99
doors = { open_time = "1h", rear_floors = [3] }
passengers = { count = 3, rate = 2, until = "0s" }
colour = "red"

[[lift]]
floors = [0, 3, 4]

[[lift]]
first_node = 60
floors = 8

[[lift]]
floors = 2
first_node = 2
[[lift.fault]]
kind = "earthquake"
[[lift.fault]]
kind = "overload"
at = "1s"
floor = 2
number = 2
)");
  const std::string all = fmt::format("{}", fmt::join(lines, "\n"));
  for (const std::string_view part :
       {"number = an array: a lift has a number 1 to 8", "floors = 1: expected the number of floors, 2 to 63",
        "speed = 99: expected 0.1 to 10 m/s", "open_time = \"1h\": a door takes 500ms to 20s",
        "rear_floors: found 3, expected floors 1 to 2", "until = \"0s\": must be later than from",
        "rate = 2: expected count or rate, not both", "lift: unknown key colour",
        "floors = an array: expected the number of floors", "lift: its panels have the node-IDs 60 to 68",
        "kind = \"earthquake\": expected one of light barrier blocked, ", "lift.fault: at is missing",
        "floor = 2: is of a panel that is unplugged", "number = 2: expected one of 1"}) {
    EXPECT_THAT(all, HasSubstr(part));
  }
  EXPECT_EQ(exit_code_, 2);
}

TEST_F(LiftFaults, TwoLifts_NeedNumbersAndNodesOfTheirOwn) {
  const auto lines =
      check(std::string(lift_controller) + "[[lift]]\nfloors = 2\n[[lift]]\nfloors = 2\nfirst_node = 20\n");
  EXPECT_THAT(lines, ElementsAre(HasSubstr("lift: bus \"hoist\" has a lift 1 already, in line 25")));
  const auto nodes = check(std::string(lift_controller) +
                           "[[lift]]\nfloors = 2\n[[lift]]\nnumber = 2\nfloors = 2\nfirst_node = 8\n");
  EXPECT_THAT(nodes,
              ElementsAre(HasSubstr("lift 2 floor 1: node 8 of bus \"hoist\" is taken already, in line 25")));
}

}  // namespace
}  // namespace canopus::plant::lift_faults_test
