// What devices and modules save belongs to one of them: two that share a folder keep their own, what belongs to
// another or cannot be read is refused before anything starts, and a folder has one run at a time.

#include <array>

#include <sys/stat.h>

#include "canopus/can/bus.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/store/file_memory.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/text/file_text.hpp"

#include "support/plant_folder.hpp"

namespace canopus::plant::plant_stores_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using namespace std::chrono_literals;

constexpr std::string_view two_buses =
    "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[bus]]\nname = \"line2\"\nbit_rate = 250_000\n";
constexpr std::string_view one_bus = "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n";

/// A tool on a simulated bus that writes and reads objects of node 5 by SDO.
class Tool final : public can::Participant {
 public:
  Tool(Plant& plant, std::size_t bus) : timeline_(plant.timeline()), port_(plant.bus(bus).add_port("tool")) {
    timeline_.add(*this);
    port_.connect(*this);
  }
  std::uint32_t transfer(std::uint8_t command, std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    can::Frame request{.identifier = 0x605, .dlc = 8};
    request.data = {command,
                    static_cast<std::uint8_t>(index & 0xFF),
                    static_cast<std::uint8_t>(index >> 8),
                    sub,
                    static_cast<std::uint8_t>(value),
                    static_cast<std::uint8_t>(value >> 8),
                    static_cast<std::uint8_t>(value >> 16),
                    static_cast<std::uint8_t>(value >> 24)};
    answer_ = {};
    port_.send(request);
    timeline_.run_until(timeline_.now() + 10ms);
    EXPECT_NE(answer_.data[0], 0x80) << "aborted";
    EXPECT_NE(answer_.data[0], 0x00) << "no answer";
    return static_cast<std::uint32_t>(answer_.data[4] | answer_.data[5] << 8);
  }
  void set_heartbeat(std::uint16_t milliseconds) { transfer(0x2B, 0x1017, 0, milliseconds); }
  std::uint32_t heartbeat() { return transfer(0x40, 0x1017, 0, 0); }
  void save() { transfer(0x23, 0x1010, 1, 0x65766173); }

  void receive(const can::Frame& frame, can::Time) override {
    if (frame.identifier == 0x585) answer_ = frame;
  }
  void transmitted(const can::Frame&, can::Time) override {}
  void controller_changed(can::Time) override {}
  void tick(can::Time) override {}

 private:
  can::Timeline& timeline_;
  can::Port& port_;
  can::Frame answer_;
};

class PlantStoresTest : public support::PlantFolder {
 protected:
  PlantStoresTest() {
    write("a.eds", support::device_file(support::variable("1017", 6) + support::array_of_one("1010")));
  }

  [[nodiscard]] static std::string device(const std::string& more) {
    return "[[device]]\nnode = 5\neds = \"a.eds\"\nstore = \"state\"\n" + more + "\n";
  }
  [[nodiscard]] static std::string rack(const std::string& name, std::string_view bus) {
    return "[[plc]]\nlisten = \"off\"\nstore = \"state\"\n" +
           (name.empty() ? "" : "name = \"" + name + "\"\n") +
           "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = 1\nbus = \"" + std::string(bus) + "\"\n";
  }
  /// As a run does it, up to the point where everything is on.
  std::unique_ptr<Plant> start(std::string_view text) {
    auto plant = load(text, nobody_);
    if (plant == nullptr) return nullptr;
    for (const text::FileError& error : plant->open_stores()) ADD_FAILURE() << error.message;
    plant->power_on();
    plant->timeline().run_until(can::Time{10ms});
    return plant;
  }
  std::vector<std::string> stored() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "state")) {
      if (entry.path().filename() != ".lock") names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }
  class Nobody final : public PlantObserver {
  } nobody_;
  /// As a version without owners has left it.
  void put_old(const std::string& name, std::vector<std::uint8_t> content = {}) const {
    ASSERT_TRUE(store::FileMemory(folder_ / "state").write(name, content));
  }
};

TEST_F(PlantStoresTest, TwoDevicesWithOneNodeIdOnTwoBuses_KeepTheirOwn) {
  const std::string text = std::string(two_buses) + device("bus = \"line1\"") + device("bus = \"line2\"");
  {
    auto plant = start(text);
    Tool tool(*plant, 0);
    tool.set_heartbeat(500);
    tool.save();
  }
  EXPECT_THAT(stored(), ElementsAre("line1.node-005"));
  auto plant = start(text);
  Tool first(*plant, 0);
  Tool second(*plant, 1);
  EXPECT_EQ(first.heartbeat(), 500U);
  EXPECT_EQ(second.heartbeat(), 0U);
}

TEST_F(PlantStoresTest, NameOfADevice_IsInItsFilesName) {
  const std::string text = std::string(one_bus) + device("name = \"valves left\"");
  {
    auto plant = start(text);
    Tool tool(*plant, 0);
    tool.save();
  }
  EXPECT_THAT(stored(), ElementsAre("line1.valves%20left.node-005"));
}

// "/", "..", NUL, control characters and 10,000 letters.
TEST_F(PlantStoresTest, NamesThatWouldLeadElsewhere_StayInTheFolder) {
  for (const std::string& name :
       {std::string("../../outside"), std::string(R"(/etc/x)"), std::string(".."), std::string(R"(a\u0000b)"),
        std::string(R"(\u001B[2J\n)"), std::string(10'000, 'x')}) {
    SCOPED_TRACE(name.substr(0, 20));
    fs::remove_all(folder_ / "state");
    {
      auto plant = start(std::string(one_bus) + device("name = \"" + name + "\""));
      Tool tool(*plant, 0);
      tool.set_heartbeat(500);
      tool.save();
    }
    EXPECT_THAT(stored(), SizeIs(1));
    std::size_t around = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) around += entry.exists() ? 1U : 0U;
    EXPECT_EQ(around, 3U);  // plant.toml, a.eds, state
    auto plant = start(std::string(one_bus) + device("name = \"" + name + "\""));
    EXPECT_EQ(Tool(*plant, 0).heartbeat(), 500U);
  }
}

TEST_F(PlantStoresTest, TwoRacksThatShareAFolder_HaveAFolderEachIfTheyHaveNames) {
  const std::string text = std::string(two_buses) + rack("left", "line1") + rack("right", "line2");
  EXPECT_THAT(check(text), IsEmpty());
  ASSERT_TRUE(store::FileMemory(folder_ / "state" / "left.U000-ME3CAN1-Q").write("object-dictionary", {}));
  ASSERT_TRUE(store::FileMemory(folder_ / "state" / "right.U000-ME3CAN1-Q").write("object-dictionary", {}));
  EXPECT_THAT(check(text), IsEmpty());  // both are known
}

TEST_F(PlantStoresTest, TwoOwnersOfOneFile_AreAMistake) {
  EXPECT_THAT(
      check(std::string(two_buses) + rack("", "line1") + rack("", "line2")),
      ElementsAre(
          "plant.toml:17:9: store = \"state\": the ME3CAN1-Q at head 000H of a PLC without a name and "
          "the ME3CAN1-Q at head 000H of a PLC without a name (line 9) would share "
          "\"U000-ME3CAN1-Q\" there; give them names that differ, or folders of their own"));
  EXPECT_EQ(exit_code_, 2);
}

TEST_F(PlantStoresTest, TwoSpellingsOfOneFolder_AreOneFolder) {
  fs::create_directory(folder_ / "state");
  fs::create_directory_symlink("state", folder_ / "link");
  std::string text = std::string(two_buses) + rack("", "line1") + rack("", "line2");
  text.replace(text.rfind("\"state\""), 7, "\"./link\"");
  EXPECT_THAT(check(text), ElementsAre(HasSubstr("would share \"U000-ME3CAN1-Q\"")));
}

TEST_F(PlantStoresTest, FileOfAnother_IsRefused) {
  {
    auto plant = start(std::string(one_bus) + device("name = \"left\""));
    Tool(*plant, 0).save();
  }
  fs::copy_file(folder_ / "state/line1.left.node-005", folder_ / "state/line1.right.node-005");
  EXPECT_THAT(
      check(std::string(one_bus) + device("name = \"right\"")),
      ElementsAre("plant.toml:7:9: store: state/line1.right.node-005: belongs to device \"left\" (node 5) of "
                  "bus \"line1\", not to device \"right\" (node 5) of bus \"line1\""));
}

TEST_F(PlantStoresTest, DamagedOrUnreadableFile_IsRefusedWithPathAndReason) {
  fs::create_directories(folder_ / "state/plc1.U000-ME3CAN1-Q/object-dictionary");
  std::ofstream(folder_ / "state/plc1.U000-ME3CAN1-Q/buffer-memory") << "not mine";
  EXPECT_THAT(
      check(std::string(one_bus) + rack("plc1", "line1")),
      ElementsAre(
          "plant.toml:6:9: store: state/plc1.U000-ME3CAN1-Q/buffer-memory: is damaged, or not a file "
          "that Canopus has "
          "stored",
          "plant.toml:6:9: store: state/plc1.U000-ME3CAN1-Q/object-dictionary: cannot read: Is a directory"));
  EXPECT_EQ(exit_code_, 2);
}

TEST_F(PlantStoresTest, FifoInAStore_IsRefusedAndNotWaitedFor) {
  fs::create_directory(folder_ / "state");
  ASSERT_EQ(::mkfifo((folder_ / "state/line1.node-005").c_str(), 0600), 0);
  EXPECT_THAT(check(std::string(one_bus) + device("")),
              ElementsAre(HasSubstr("state/line1.node-005: cannot read: it is not a file")));
}

TEST_F(PlantStoresTest, WhatIsNoFolder_IsRefused) {
  write("state", "a file");
  EXPECT_THAT(check(std::string(one_bus) + device("")),
              Contains("plant.toml:7:9: store = \"state\": it is not a folder"));
}

TEST_F(PlantStoresTest, FolderInUse_IsRefusedByTheNextRun) {
  const std::string text = std::string(one_bus) + device("");
  const auto first = start(text);
  const auto second = load(text, nobody_);
  const auto errors = second->open_stores();
  ASSERT_THAT(errors, SizeIs(1));
  EXPECT_EQ(describe(errors[0], "plant.toml"), "plant.toml:7:9: store = \"state\": another process (" +
                                                   std::to_string(::getpid()) + ") uses it");
}

TEST_F(PlantStoresTest, CheckingLeavesTheFolderAlone) {
  const std::string text = std::string(one_bus) + device("");
  EXPECT_THAT(check(text), IsEmpty());
  EXPECT_FALSE(fs::exists(folder_ / "state"));
  const auto running = start(text);
  EXPECT_THAT(check(text), IsEmpty());
}

TEST_F(PlantStoresTest, FileOfAnEarlierVersion_IsTakenOver) {
  put_old("node-005", {0x17, 0x10, 0, 2, 0, 0, 0, 0xF4, 0x01});  // 1017H = 500, as StoredParameters keeps it
  const std::string text = std::string(one_bus) + device("name = \"encoder\"");
  EXPECT_THAT(
      check(text),
      ElementsAre(
          "plant.toml:7:9: warning: store = \"state\": \"node-005\" there is of an earlier version; a "
          "run keeps it as \"line1.encoder.node-005\", for device \"encoder\" (node 5) of bus "
          "\"line1\""));
  EXPECT_EQ(exit_code_, 0);
  EXPECT_THAT(stored(), ElementsAre("node-005"));
  const auto plant = start(text);
  EXPECT_EQ(Tool(*plant, 0).heartbeat(), 500U);
  EXPECT_THAT(stored(), ElementsAre("line1.encoder.node-005"));
}

TEST_F(PlantStoresTest, FolderOfAnEarlierVersion_IsTakenOver) {
  ASSERT_TRUE(store::FileMemory(folder_ / "state/U000-ME3CAN1-Q").write("object-dictionary", {}));
  const std::string text = std::string(one_bus) + rack("plc1", "line1");
  EXPECT_THAT(check(text), ElementsAre(HasSubstr("a run keeps it as \"plc1.U000-ME3CAN1-Q\"")));
  const auto plant = start(text);
  EXPECT_THAT(stored(), ElementsAre("plc1.U000-ME3CAN1-Q"));
}

TEST_F(PlantStoresTest, FileOfAnEarlierVersionThatTwoCouldMean_IsRefused) {
  put_old("node-005");
  const auto lines =
      check(std::string(two_buses) + device("bus = \"line1\"") + device("bus = \"line2\"\nname = \"b\""));
  EXPECT_THAT(lines, ElementsAre(AllOf(
                         HasSubstr("\"node-005\" there is of an earlier version, which did not say whose "
                                   "it is; delete it, or rename it: "),
                         HasSubstr("\"line1.node-005\" for the device with node 5 of bus \"line1\""),
                         HasSubstr("\"line2.b.node-005\" for device \"b\" (node 5)"))));
  EXPECT_EQ(exit_code_, 2);
}

TEST_F(PlantStoresTest, FileThatNobodyOwns_IsAWarning) {
  put_old("line1.old%20name.node-005");
  write("state/notes.txt", "mine");  // not ours to speak of
  EXPECT_THAT(
      check(std::string(one_bus) + device("name = \"new name\"")),
      ElementsAre("plant.toml:7:9: warning: store = \"state\": no device or module of this plant owns "
                  "\"line1.old%20name.node-005\" there"));
}

}  // namespace
}  // namespace canopus::plant::plant_stores_test
