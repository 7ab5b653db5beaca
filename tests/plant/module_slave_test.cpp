// Modules and nodes outside of the plant as slaves of a module: what the plant file says of them, what is
// wrong with it, and process data between two racks.

#include <optional>

#include <fmt/format.h>

#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plc/rack/rack.hpp"

#include "support/plant_folder.hpp"

namespace canopus::cli::module_slave_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr std::string_view head = "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n";
constexpr std::string_view served =
    "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\nserve = \"socketcand:127.0.0.1:0\"\n";

/// A rack with one module; three lines before the module's keys.
std::string rack(std::string_view keys, std::string_view name = "") {
  return fmt::format("[[plc]]\n{}listen = \"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\n{}", name, keys);
}
const std::string second =
    rack("name = \"rack2\"\nnode = 2\nrestart_time = \"100ms\"\nexchange = \"10ms\"\n", "name = \"plc2\"\n");

std::string master(std::string_view slave) {
  return rack("name = \"rack1\"\nnode = 1\nmaster = true\nrestart_time = \"100ms\"\nexchange = \"10ms\"\n") +
         std::string(slave);
}
std::string slave(std::string_view keys) { return fmt::format("[[plc.module.slave]]\n{}", keys); }

class ModuleSlave : public support::PlantFolder, public plant::PlantObserver {
 protected:
  void start(std::string_view text) {
    plant_ = support::PlantFolder::load(text, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
  }
  void run(can::Duration time) { plant_->timeline().run_until(plant_->timeline().now() + time); }
  std::uint16_t word(std::size_t rack_number, module::BufferAddress address) {
    std::uint16_t value = 0;
    EXPECT_TRUE(plant_->rack(rack_number).read_buffer(0, address, {&value, 1}, plant_->timeline().now()));
    return value;
  }
  void write_word(std::size_t rack_number, module::BufferAddress address, std::uint16_t value) {
    EXPECT_TRUE(plant_->rack(rack_number).write_buffer(0, address, {&value, 1}, plant_->timeline().now()));
  }
  void on(const plant::Event& event) override {
    const auto* const change = std::get_if<plant::NmtStateChange>(&event.what);
    if (change != nullptr && change->state == canopen::NmtState::operational)
      operational_.push_back(plant::describe(change->node));
  }

  std::unique_ptr<plant::Plant> plant_;
  std::vector<std::string> operational_;
};

TEST_F(ModuleSlave, ByName_ItsProcessDataGoBothWays) {
  RecordProperty("spec", "ME3-IO-003");
  start(std::string(head) + master(slave("name = \"rack2\"\nreceive = [1, 2]\nsend = [1]\n")) + second);
  EXPECT_THAT(
      plant_->connections(),
      ElementsAre("rack1 U0\\G10000-G10003 <- TPDO1 of node 2 (rack2, its G13000-G13003), 182H, 8 bytes",
                  "rack1 U0\\G10004-G10007 <- TPDO2 of node 2 (rack2, its G13004-G13007), 282H, 8 bytes",
                  "rack1 U0\\G13000-G13003 -> RPDO1 of node 2 (rack2, its G10000-G10003), 202H, 8 "
                  "bytes"));
  run(3s);
  EXPECT_THAT(operational_, ElementsAre("line1 node 1 (rack1)", "line1 node 2 (rack2)"));
  write_word(0, 13001, 0x1234);
  write_word(1, 13007, 0xABCD);
  run(100ms);
  EXPECT_EQ(word(1, 10001), 0x1234);
  EXPECT_EQ(word(0, 10007), 0xABCD);
  ASSERT_EQ(plant_->boots().size(), 1U);
  EXPECT_EQ(plant_->boots()[0].slave.name, "rack2");
  EXPECT_EQ(plant_->boots()[0].record.step, manager::BootStep::booted);
}

TEST_F(ModuleSlave, WhateverTheOrderOfTheRacks_ItsOwnObjectsCount) {
  const std::string mapped = rack(
      "name = \"rack2\"\nnode = 2\nobjects = { \"1A00:00\" = 1, \"1A00:01\" = 0xA100_0B10, \"1800:01\" = "
      "0x4000_0321 }\n",
      "name = \"plc2\"\n");
  start(std::string(head) + mapped + master(slave("node = 2\nreceive = [{ pdo = 1, at = \"G10050\" }]\n")));
  EXPECT_THAT(plant_->connections(),
              ElementsAre("rack1 U0\\G10050 <- TPDO1 of node 2 (rack2, its G13010), 321H, 2 bytes"));
}

TEST_F(ModuleSlave, SlavesAll_TakesTheOtherModulesOfTheBus) {
  std::string text = std::string(head) + master("") + second;
  const std::string key = "master = true\n";
  text.replace(text.find(key), key.size(), key + "slaves = \"all\"\n");
  start(text);
  EXPECT_EQ(plant_->connections().size(), 2U);
  run(3s);
  EXPECT_EQ(operational_.size(), 2U);
}

TEST_F(ModuleSlave, SlavesAll_LeavesPlainCanModulesAlone) {
  std::string text =
      std::string(head) + master("") + rack("node = 2\nbuffer = { G21 = 11 }\n", "name = \"plc2\"\n");
  const std::string key = "master = true\n";
  text.replace(text.find(key), key.size(), key + "slaves = \"all\"\n");
  EXPECT_THAT(check(text), IsEmpty());
  EXPECT_THAT(check(std::string(head) + master(slave("node = 2\n")) +
                    rack("node = 2\nbuffer = { G21 = 11 }\n", "name = \"plc2\"\n")),
              ElementsAre("plant.toml:14:8: slave: the module with node 2 (line 18) is in a Layer 2 mode; "
                          "expected a CANopen node"));
}

TEST_F(ModuleSlave, OutsideOfThePlant_IsAssignedAndWithAFileConnected) {
  write("io.eds",
        support::device_file("[1800]\nParameterName=T\nObjectType=9\n"
                             "[1800sub0]\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
                             "[1800sub1]\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x180\n"
                             "[1A00]\nParameterName=M\nObjectType=9\n"
                             "[1A00sub0]\nDataType=5\nAccessType=rw\nDefaultValue=1\n"
                             "[1A00sub1]\nDataType=7\nAccessType=rw\nDefaultValue=0x60000010\n"
                             "[6000]\nParameterName=In\nDataType=6\nAccessType=ro\nPDOMapping=1\n"));
  EXPECT_THAT(check(std::string(served) + master(slave("node = 9\n"))), IsEmpty())
      << "nothing is known of it";
  start(std::string(served) + master(slave("node = 9\neds = \"io.eds\"\nreceive = [1]\n")));
  EXPECT_THAT(plant_->connections(),
              ElementsAre("rack1 U0\\G10000 <- TPDO1 of node 9 (external node), 189H, 2 bytes"));
  run(3s);
  ASSERT_EQ(plant_->boots().size(), 1U);
  EXPECT_EQ(plant_->boots()[0].slave.node_id, 9);
}

TEST_F(ModuleSlave, OutsideOfThePlant_WhatCannotBeIsSaid) {
  EXPECT_THAT(
      check(std::string(served) + master(slave("node = 9\nreceive = [1]\n"))),
      ElementsAre("plant.toml:16:12: TPDO1 of node 9: nothing is known of the node's PDOs; expected eds "
                  "= its EDS or DCF file"));
  EXPECT_THAT(
      check(std::string(head) + master(slave("node = 9\n"))),
      ElementsAre("plant.toml:14:8: slave: there is no device or module with node = 9 on bus \"line1\"; "
                  "for an external node the bus needs serve or link"));
  EXPECT_THAT(
      check(std::string(served) + master(slave("node = 9\neds = \"none.eds\"\n"))),
      ElementsAre(AllOf(HasSubstr("plant.toml:16:7: eds = \"none.eds\": "), HasSubstr("No such file"))));
  EXPECT_THAT(check(std::string(served) + master(slave("node = 2\neds = \"io.eds\"\n")) + second),
              ElementsAre("plant.toml:16:7: slave: eds is for an external node; node 2 is in the plant "
                          "file, in line 20"));
}

TEST_F(ModuleSlave, EachWrongUseIsSaidWithItsPlace) {
  const std::string racks = std::string(head) + master(slave("name = \"RACK\"\n")) + second;
  EXPECT_THAT(check(racks),
              ElementsAre("plant.toml:14:8: slave: name = \"RACK\": there is no device or module of "
                          "this name; expected one of rack1, rack2"));
  EXPECT_THAT(check(std::string(head) + master(slave("name = \"rack1\"\n"))),
              ElementsAre("plant.toml:14:8: slave: node 1 is the module itself; expected another node"));
  EXPECT_THAT(check(std::string(head) + master(slave("node = 1\n"))),
              ElementsAre("plant.toml:14:8: slave: node 1 is the module itself; expected another node"));
  EXPECT_THAT(check(std::string(head) + master(slave("name = \"rack2\"\nnode = 2\n")) + second),
              ElementsAre("plant.toml:14:8: name = \"rack2\": expected node or name, not both"));
  EXPECT_THAT(check(std::string(head) + master(slave("mandatory = true\n"))),
              ElementsAre("plant.toml:13:1: plc.module.slave: node is missing; a node-ID is 1 to 127; or "
                          "name = the name of a "
                          "device or module"));
  EXPECT_THAT(
      check(std::string(head) + master(slave("name = \"rack2\"\n") + slave("node = 2\n")) + second),
      ElementsAre("plant.toml:16:8: slave: node 2 is assigned already, in another [[plc.module.slave]]"));
}

TEST_F(ModuleSlave, OfAnotherBus_IsRefused) {
  const std::string buses = std::string(head) + "[[bus]]\nname = \"line2\"\nbit_rate = 250_000\n";
  std::string text = buses + master(slave("name = \"rack2\"\n")) + second;
  for (const auto& [node, bus] :
       {std::pair{"node = 1\n", "bus = \"line1\"\n"}, {"node = 2\n", "bus = \"line2\"\n"}})
    text.insert(text.find(node), bus);
  EXPECT_THAT(check(text),
              ElementsAre("plant.toml:18:8: slave: \"rack2\" (line 22) is on bus \"line2\"; expected a "
                          "node of bus \"line1\""));
}

TEST_F(ModuleSlave, TwoMasters_AreOneTooMany_UnlessTheyFly) {
  std::string text = std::string(head) + master(slave("name = \"rack2\"\n")) + second;
  const std::string key = "node = 2\n";
  text.replace(text.find(key), key.size(), key + "master = true\n");
  EXPECT_THAT(
      check(text),
      ElementsAre("plant.toml:14:8: slave: the module with node 2 (line 18) has master = true; expected a "
                  "slave",
                  "plant.toml:18:1: master = true: bus \"line1\" has an NMT master already, in line 6; "
                  "expected one, or flying masters: objects = { \"1F80:00\" = 0x21 } for each"));
  for (const std::string_view name : {"name = \"rack1\"\n", "name = \"rack2\"\nnode"}) {
    text.insert(text.find(name), "objects = { \"1F80:00\" = 0x21 }\n");
  }
  EXPECT_THAT(check(text), IsEmpty());
}

TEST_F(ModuleSlave, ANameIsThereOnce) {
  std::string text = std::string(head) + master("") + second;
  text.replace(text.find("rack2"), 5, "rack1");
  EXPECT_THAT(check(text),
              ElementsAre("plant.toml:18:8: name = \"rack1\": a module has this name already, in line 6"));
}

TEST_F(ModuleSlave, ANodeIdIsThereOnce) {
  std::string text = std::string(head) + master("") + second;
  text.replace(text.find("node = 2"), 8, "node = 1");
  EXPECT_THAT(check(text),
              ElementsAre("plant.toml:16:1: module: node 1 of bus \"line1\" is taken already, in line 6"));
}

}  // namespace
}  // namespace canopus::cli::module_slave_test
