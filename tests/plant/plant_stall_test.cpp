// A part of a plant that would stop time for all others.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/file_error.hpp"

#include "paths.hpp"

namespace canopus::plant::plant_stall_test {
namespace {

using namespace std::chrono_literals;

TEST(PlantStall, APartThatAsksForOneMomentWithoutEnd_IsReportedByNameAndTheOthersGoOn) {
  const PlantReading reading = read_plant(
      "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[device]]\nnode = 5\neds = \"" CANOPUS_SOURCE_DIR
      "/examples/devices/io-block.eds\"\n",
      "test.toml");
  for (const text::FileError& error : reading.errors) ADD_FAILURE() << describe(error, "test.toml");
  struct Watcher final : PlantObserver {
    void on(const Event& event) override {
      if (const auto* failure = std::get_if<Failure>(&event.what)) {
        errors.push_back(failure->source + ": " + failure->message);
        at = event.time;
      }
      if (const auto* boot = std::get_if<BootUp>(&event.what)) booted_nodes.push_back(boot->node.node_id);
    }
    std::vector<std::string> errors;
    std::vector<unsigned> booted_nodes;
    can::Time at{};
  } watcher;
  auto plant = Plant::build(reading.plant, watcher);
  ASSERT_TRUE(plant);
  struct Spinner final : can::Participant {
    void receive(const can::Frame&, can::Time) override {}
    void tick(can::Time) override {}
  } spinner;
  struct Listener final : can::Participant {  // acknowledges
    void receive(const can::Frame&, can::Time) override {}
    void tick(can::Time) override {}
  } listener;
  can::Timeline& timeline = (*plant)->timeline();
  timeline.add(listener);
  (*plant)->bus(0).add_port("tool").connect(listener);
  spinner.alarm() = can::Time(10ms);
  timeline.add(spinner, "spinner");
  (*plant)->power_on();
  timeline.run_until(can::Time(9ms));
  EXPECT_FALSE((*plant)->has_stalled());
  timeline.run_until(can::Time(5s));
  EXPECT_TRUE((*plant)->has_stalled());
  EXPECT_EQ(watcher.errors, (std::vector<std::string>{"spinner: sets its deadline to this moment without end "
                                                      "and is stopped from here on. This is an error in "
                                                      "Canopus: please report it with the plant file"}));
  EXPECT_EQ(watcher.at, can::Time(10ms));
  EXPECT_EQ(watcher.booted_nodes, (std::vector<unsigned>{5}));
}

}  // namespace
}  // namespace canopus::plant::plant_stall_test
