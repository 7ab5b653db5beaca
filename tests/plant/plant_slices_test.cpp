// Parts of a plant that run apart from each other: whatever the slices and the threads, the bytes are the same.

#include "canopus/serve/slices/plant_slices.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "canopus/can/frame.hpp"
#include "canopus/cli/run/run_recording.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plant/plant_partitioning.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant::plant_slices_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

const std::string devices = CANOPUS_SOURCE_DIR "/examples/devices/";

/// Node 9, which saves when it is told to.
std::string saving_device(const std::string& bus) {
  return "[[device]]\nbus = \"" + bus + "\"\nnode = 9\nname = \"" + bus +
         "-9\"\neds = \"saving.eds\"\nstore = \"stored-" + bus + "\"\nobjects = { \"1017:00\" = 150 }\n";
}

/// A device whose value moves.
std::string moving_device(const std::string& bus, unsigned node) {
  return "[[device]]\nbus = \"" + bus + "\"\nnode = " + std::to_string(node) + "\nname = \"" + bus + "-" +
         std::to_string(node) + "\"\neds = \"" + devices +
         "io-block.eds\"\nobjects = { \"1017:00\" = 100 }\n"
         "[[device.behaviour]]\nobject = \"6000:01\"\nkind = \"noise\"\nlow = 0\nhigh = 200\nperiod = "
         "\"7ms\"\n";
}

std::string bus_section(const std::string& name, const std::string& faults = "") {
  return "[[bus]]\nname = \"" + name + "\"\nbit_rate = 250_000\n" + faults;
}

std::string rack(const std::string& name) { return "[[plc]]\nname = \"" + name + "\"\nlisten = \"off\"\n"; }

std::string master(const std::string& bus, unsigned head, unsigned node, const std::string& more = "") {
  return "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nbus = \"" + bus + "\"\nhead = " + std::to_string(head) +
         "\nnode = " + std::to_string(node) + "\nmaster = true\nexchange = \"10ms\"\n" + more;
}

constexpr const char* faults =
    "[[bus.fault]]\nkind = \"corrupt\"\nprobability = 0.02\n"
    "[[bus.fault]]\nkind = \"drop\"\nprobability = 0.01\n"
    "[[bus.fault]]\nkind = \"cut\"\nports = [\"stormy-3\"]\nfrom = \"2500ms\"\nuntil = \"2900ms\"\n";

/// A bus with faults, two racks with flying masters on one bus, a rack on two buses, a bridge, and a bus alone.
std::string plant_text() {
  const std::string flying = "objects = { \"1F80:00\" = 0x21 }\n";
  std::string text = "[plant]\nseed = 7\n";
  text += bus_section("stormy", faults) + bus_section("flying") + bus_section("left") + bus_section("right");
  text += bus_section("from") + bus_section("to") + bus_section("alone");
  for (const std::string bus : {"stormy", "left", "right"}) {
    for (unsigned node = 2; node < 6; ++node) {
      text += moving_device(bus, node);
    }
  }
  text += moving_device("flying", 5) + moving_device("from", 2) + moving_device("to", 3);
  text += moving_device("alone", 2) + moving_device("alone", 3);
  for (const std::string bus : {"stormy", "left", "right", "alone"}) text += saving_device(bus);
  text += "[[bridge]]\nfrom = \"from\"\nto = \"to\"\nboth_ways = true\n";
  text += rack("plc1") + master("stormy", 0, 1, "slaves = \"all\"\n");
  text += rack("plc2") + master("flying", 0, 1, flying) + rack("plc3") + master("flying", 0, 2, flying);
  text += rack("plc4") + master("left", 0, 1, "slaves = \"all\"\n") +
          master("right", 32, 1, "slaves = \"all\"\n");
  return text;
}

/// Has node 9 of a bus save its parameters (1010H), twice.
class Saver final : public can::Participant {
 public:
  Saver(Plant& plant, std::size_t bus) {
    alarm() = can::Time(2100ms);
    port_ = &plant.bus(bus).add_port("saver");
    plant.timeline_of_bus(bus).add(*this, "saver");
    port_->connect(*this);
  }
  void receive(const can::Frame& frame, can::Time) override {
    if (frame.identifier == 0x589 && frame.data[0] == 0x60) ++saved;
  }
  void tick(can::Time) override {
    EXPECT_TRUE(port_->send(can::data_frame(0x609, {0x23, 0x10, 0x10, 0x01, 0x73, 0x61, 0x76, 0x65})));
    alarm() = deadline() == can::Time(2100ms) ? can::Time(3300ms) : can::never;
  }

  unsigned saved = 0;

 private:
  can::Port* port_;
};

class PlantSlices : public support::PlantFolder {
 protected:
  /// All files by name, and what was printed, of 4 s. Without slices: the whole runs together.
  std::map<std::string, std::string> run(std::size_t threads, can::Duration least, can::Duration most,
                                         bool apart = true) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    write("saving.eds",
          support::device_file(support::array_of_one("1010", "1") + support::variable("1017", 6)));
    text::TextOutput events;
    plant::JsonPrinter printer(events);
    const auto plant = load(plant_text(), printer);
    if (plant == nullptr) return {};
    EXPECT_THAT(plant->open_stores(), IsEmpty());
    std::vector<std::unique_ptr<Saver>> savers;
    for (const std::size_t bus : {0, 2, 3, 6}) savers.push_back(std::make_unique<Saver>(*plant, bus));
    cli::RunRecording recording;
    EXPECT_TRUE(recording.open_trace((folder_ / "all.log").string(), *plant));
    EXPECT_TRUE(recording.open_vcd((folder_ / "wire.vcd").string(), *plant));
    plant->power_on();
    const can::Time end(4s);
    if (apart) {
      serve::PlantSlices slices(
          *plant,
          {.threads = threads, .least = least, .most = most, .met = [&recording] { recording.parts_met(); }});
      slices.run_until(can::Time(1234567us));
      slices.run_until(end);
    } else {
      plant->timeline().run_until(end);
    }
    EXPECT_FALSE(plant->has_stalled());
    for (const auto& saver : savers) EXPECT_EQ(saver->saved, 2U);
    EXPECT_THAT(recording.close(plant->timeline().now(), {}), IsEmpty());
    plant::RunSummary summary{.end = end, .nodes = plant->nodes(), .boots = plant->boots()};
    for (std::size_t i = 0; i < plant->bus_count(); ++i) {
      summary.buses.push_back({plant->bus(i).name(), plant->bus(i).load(end)});
    }
    printer.summary(summary);
    std::map<std::string, std::string> files{{"events", events.text()}};
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      if (!entry.is_regular_file() || entry.path().filename() == ".lock") continue;
      std::ostringstream text;
      text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
      files[entry.path().lexically_relative(folder_).string()] = text.str();
    }
    return files;
  }
};

TEST_F(PlantSlices, Buses_AreOnePartIfARackOrABridgeJoinsThem) {
  const PlantReading reading = read_plant(plant_text(), "plant.toml");
  for (const text::FileError& error : reading.errors) ADD_FAILURE() << describe(error, "plant.toml");
  const PlantPartitioning division = PlantPartitioning::of(reading.plant);
  EXPECT_EQ(division.count, 5U);
  EXPECT_THAT(division.buses, ElementsAre(0, 1, 2, 2, 3, 3, 4));
  EXPECT_THAT(division.racks, ElementsAre(0, 1, 1, 2));
}

TEST_F(PlantSlices, EveryNumberOfThreadsAndEverySlice_GivesTheSameBytes) {
  const auto together = run(1, 100ms, 100ms, false);
  // The test is worth something: there are errors on the wire, two masters, frames of all buses, and stored files.
  const std::string& events = together.at("events");
  for (const char* word :
       {"\"bus error\"", "\"flying-5\"", "\"stormy-3\"", "\"alone-3\"", "operational", "\"load\""}) {
    EXPECT_NE(events.find(word), std::string::npos) << word;
  }
  for (const char* bus : {"stormy", "flying", "left", "right", "from", "to", "alone"}) {
    EXPECT_NE(together.at("all.log").find(std::string(" ") + bus + " "), std::string::npos) << bus;
    EXPECT_GT(together.at(std::string("wire-") + bus + ".vcd").size(), 10'000U) << bus;
  }
  std::size_t stored = 0;
  for (const auto& [name, bytes] : together) stored += name.starts_with("stored-") && !bytes.empty() ? 1 : 0;
  EXPECT_GE(stored, 4U);

  for (const std::size_t threads : {1, 2, 4}) {
    struct Slices {
      can::Duration least;
      can::Duration most;
    };
    for (const Slices slices :
         std::array<Slices, 4>{{{3'141us, 3'141us}, {100ms, 100ms}, {3s, 3s}, {7ms, 3s}}}) {
      const auto apart = run(threads, slices.least, slices.most);
      EXPECT_EQ(apart.size(), together.size());
      for (const auto& [name, bytes] : together) {
        const auto found = apart.find(name);
        ASSERT_NE(found, apart.end()) << name;
        EXPECT_TRUE(found->second == bytes)
            << name << " differs with " << threads << " threads and slices of " << slices.least / 1us
            << " to " << slices.most / 1us << " us";
      }
    }
  }
}

/// Somebody who belongs to no part may look at any of them: nobody runs ahead of him.
TEST_F(PlantSlices, WhoBelongsToNoPart_FindsAllPartsAtHisMoment) {
  struct Looker final : can::Ticker {
    explicit Looker(Plant& looked_at) : plant(looked_at) { alarm() = can::Time(50ms); }
    void tick(can::Time now) override {
      for (std::size_t bus = 0; bus < plant.bus_count(); ++bus) {
        EXPECT_LE(plant.timeline_of_bus(bus).now(), now);
      }
      alarm() = deadline() < can::Time(400ms) ? deadline() + 70ms : can::never;
      ++looks;
    }
    Plant& plant;
    unsigned looks = 0;
  };
  struct Nobody final : PlantObserver {
  } nobody;
  write("saving.eds",
        support::device_file(support::array_of_one("1010", "1") + support::variable("1017", 6)));
  const auto plant = load(plant_text(), nobody);
  ASSERT_NE(plant, nullptr);
  Looker looker(*plant);
  plant->timeline().add(looker, "looker");
  plant->power_on();
  serve::PlantSlices slices(*plant, {.threads = 2, .least = 30ms, .most = 30ms});
  for (can::Time end{}; end < can::Time(1s);) slices.run_until(end += 45ms);
  EXPECT_EQ(looker.looks, 6U);
  EXPECT_EQ(plant->timeline().now(), can::Time(1035ms));
}

}  // namespace
}  // namespace canopus::plant::plant_slices_test
