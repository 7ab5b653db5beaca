// A project against a module: what is read and written, in which order, and what a refusal leaves behind.

#include "canopus/module_settings/module_transfer.hpp"

#include <map>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/module/models/fx3u_can/configuration_tool.hpp"

namespace canopus::module_settings::module_transfer_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Keeps what it is given. Objects that nobody has written read as 0.
class FakeModule final : public ModuleAccess {
 public:
  Result<std::uint16_t> read_word(std::uint32_t address) override { return words[address]; }
  Result<void> write_word(std::uint32_t address, std::uint16_t value) override {
    words[address] = value;
    log.push_back("G" + std::to_string(address) + "=" + std::to_string(value));
    return {};
  }
  Result<std::vector<std::uint32_t>> read_objects(std::uint8_t node,
                                                  std::span<const ObjectNumber> asked) override {
    nodes_asked.push_back(node);
    std::vector<std::uint32_t> values;
    for (const ObjectNumber& object : asked) values.push_back(at(object.index, object.sub));
    return values;
  }
  Result<void> write_object(std::uint8_t, ObjectNumber object, std::uint32_t value,
                            std::uint8_t bytes) override {
    char text[64];
    std::snprintf(text, sizeof text, "%04X:%02X=%0*X", object.index, object.sub, 2 * bytes, value);
    if (refused == text) return std::unexpected("abort 06090030H, value range exceeded");
    log.push_back(text);
    at(object.index, object.sub) = value;
    return {};
  }
  Result<void> save_words() override {
    log.push_back("saved words");
    return {};
  }
  std::uint32_t& at(std::uint16_t index, std::uint8_t sub) { return objects[index << 8U | sub]; }

  std::map<std::uint32_t, std::uint16_t> words;
  std::map<std::uint32_t, std::uint32_t> objects;
  std::vector<std::string> log;
  std::vector<std::uint8_t> nodes_asked;
  std::optional<std::string> refused;
};

class ModuleTransferTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto& [address, value] : std::map<std::uint32_t, std::uint16_t>{
             {21, 405}, {24, 250}, {26, 20}, {27, 127}, {70, 500}, {71, 500}}) {
      module_.words[address] = value;
    }
    for (const auto& [sub, value] :
         std::map<std::uint8_t, std::uint32_t>{{1, 100}, {2, 500}, {3, 1}, {4, 1500}, {5, 10}, {6, 5270}}) {
      module_.at(0x1F90, sub) = value;
    }
    // as the defaults of node 127
    set("master", "Multiple NMT master detect cycle time", "5270");
  }
  void set(std::string_view word, std::string_view field, std::string_view text, std::uint32_t key = 0) {
    const auto done = project_.set(*project_.window(word), key, field, text);
    ASSERT_TRUE(done) << done.error();
  }
  void add(std::string_view word, std::uint32_t key) {
    ASSERT_TRUE(project_.add(*project_.window(word), key));
  }
  std::string write(std::string_view part, PdoRange range = {}, std::uint8_t node = 0) {
    steps_.clear();
    const auto done = write_module(project_, part, range, node, module_,
                                   [&](const TransferStep& step) { steps_.push_back(step); });
    return done ? "" : done.error();
  }
  ModuleProject project_{module::fx3u_can::configuration_tool};
  FakeModule module_;
  std::vector<TransferStep> steps_;
};

TEST_F(ModuleTransferTest, BasicSettingsAreWordsThatAreSaved) {
  RecordProperty("spec", "FX3U-TOOL-001");
  set("basic", "Node ID", "2");
  set("basic", "Baud-Rate", "500");
  set("basic", "FROM/TO Watchdog", "1230");
  set("basic", "SDO timeout", "1000");
  EXPECT_EQ(write("basic"), "");
  EXPECT_THAT(module_.log, ElementsAre("G24=500", "G26=123", "G27=2", "G71=1000", "saved words"));
  ModuleProject other(module::fx3u_can::configuration_tool);
  ASSERT_TRUE(read_module(other, "basic", {}, 0, module_));
  EXPECT_EQ(other.value("basic", "FROM/TO Watchdog"), 1230U);
  EXPECT_EQ(other.value("basic", "Node ID"), 2U);
  module_.log.clear();
  EXPECT_EQ(write("basic"), "");
  EXPECT_THAT(module_.log, IsEmpty()) << "nothing differs: the flash ROM is spared";
}

TEST_F(ModuleTransferTest, APdoIsWrittenInTheStepsOfCia301AndSaved) {
  RecordProperty("spec", "FX3U-TOOL-002 FX3U-TOOL-003");
  add("tpdo", 3);
  set("tpdo", "CAN-ID (11-bit)", "0x383", 3);
  set("tpdo", "Inhibit time", "100", 3);
  ASSERT_TRUE(project_.set_mapping(*project_.window("tpdo"), 3, {0xA1000110, 0xA1000210}));
  EXPECT_EQ(write("tpdo"), "");
  EXPECT_THAT(module_.log, ElementsAre("1802:01=C0000383", "1A02:00=00", "1A02:01=A1000110",
                                       "1A02:02=A1000210", "1A02:00=02", "1802:02=FE", "1802:03=0064",
                                       "1802:05=0000", "1802:01=40000383", "1010:01=65766173"));
}

TEST_F(ModuleTransferTest, AnInvalidPdoStaysInvalid) {
  RecordProperty("spec", "FX3U-TOOL-003");
  add("rpdo", 2);
  set("rpdo", "valid", "Not selected", 2);
  EXPECT_EQ(write("rpdo"), "");
  EXPECT_THAT(module_.log,
              ElementsAre("1401:01=8000037F", "1601:00=00", "1601:00=00", "1401:02=FE", "1010:01=65766173"));
}

TEST_F(ModuleTransferTest, TheAreaSaysWhichPdos) {
  RecordProperty("spec", "FX3U-TOOL-002");
  for (const std::uint32_t number : {1, 2, 3, 4}) {
    add("rpdo", number);
    ASSERT_TRUE(project_.set_mapping(*project_.window("rpdo"), number, {0xA5800110}));
  }
  const auto touched = [&](PdoRange range) {
    module_.objects.clear();
    const auto found = differences(project_, "rpdo", range, 0, module_);
    std::vector<std::string> numbers;
    for (const Difference& each : *found) {
      if (each.where.find("mapped") != std::string::npos) numbers.push_back(each.where.substr(0, 6));
    }
    return numbers;
  };
  EXPECT_THAT(touched({}), ElementsAre("rpdo 1", "rpdo 2", "rpdo 3", "rpdo 4"));
  EXPECT_THAT(touched({3, 0xFFFF}), ElementsAre("rpdo 3", "rpdo 4"));
  EXPECT_THAT(touched({2, 3}), ElementsAre("rpdo 2", "rpdo 3"));
  ModuleProject other(module::fx3u_can::configuration_tool);
  ASSERT_TRUE(read_module(other, "rpdo", {2, 3}, 0, module_));
  EXPECT_THAT(other.rows(*other.window("rpdo")), SizeIs(2));
}

TEST_F(ModuleTransferTest, NmtSettingsAreBitsAndObjects) {
  RecordProperty("spec", "FX3U-TOOL-004");
  set("master", "NMT master", "Selected");
  set("master", "Start node", "Selected");
  set("master", "Flying master", "Selected");
  set("master", "SYNC - Communication cycle period", "10000");
  set("master", "Boot time", "3000");
  set("master", "Start all nodes delay", "600");
  set("master", "NMT master priority", "High");
  set("master", "Guard time", "100");
  set("master", "Life time factor", "3");
  add("slave", 5);
  for (const char* flag : {"NMT slave", "NMT boot slave", "Mandatory", "Reset communication"})
    set("slave", flag, "Selected", 5);
  set("slave", "Retry factor", "2", 5);
  set("slave", "Guard time", "250", 5);
  set("slave", "Device type", "983441", 5);
  set("slave", "Vendor-ID", "0x195", 5);
  set("slave", "Product code", "1025", 5);
  set("slave", "Revision number", "0x10000", 5);
  set("slave", "Serial number", "0x7", 5);
  add("consumer", 5);
  set("consumer", "Consumer heartbeat time", "1500", 5);
  set("producer", "Producer heartbeat time", "1000");
  module_.at(0x1F81, 9) = 5;  // a slave that the project does not have
  EXPECT_EQ(write("nmt"), "");
  EXPECT_THAT(
      module_.log,
      ElementsAre("1006:00=00002710", "100C:00=0064", "100D:00=03", "1F80:00=00000029", "1F89:00=00000BB8",
                  "1F90:03=0000", "G70=600", "1F81:05=00FA021D", "1F81:09=00000000", "1F84:05=000F0191",
                  "1F85:05=00000195", "1F86:05=00000401", "1F87:05=00010000", "1F88:05=00000007",
                  "1016:01=000505DC", "1017:00=03E8", "1010:01=65766173", "saved words"));
  ModuleProject other(module::fx3u_can::configuration_tool);
  ASSERT_TRUE(read_module(other, "nmt", {}, 0, module_));
  EXPECT_EQ(other.rows(*other.window("slave")).at(5).values,
            project_.rows(*project_.window("slave")).at(5).values);
  EXPECT_EQ(other.rows(*other.window("master")).at(0).values,
            project_.rows(*project_.window("master")).at(0).values);
  EXPECT_EQ(other.value("consumer", "Consumer heartbeat time", 5), 1500U);
  EXPECT_EQ(other.value("producer", "Producer heartbeat time"), 1000U);
  EXPECT_THAT(*differences(other, "nmt", {}, 0, module_), IsEmpty());
}

TEST_F(ModuleTransferTest, ARefusalEndsTheTransferAndNothingIsSaved) {
  RecordProperty("spec", "FX3U-TOOL-005");
  add("tpdo", 1);
  ASSERT_TRUE(project_.set_mapping(*project_.window("tpdo"), 1, {0xA1000110}));
  module_.refused = "1A00:01=A1000110";
  EXPECT_EQ(write("all"), "tpdo 1: 1A00:01 = A1000110H: abort 06090030H, value range exceeded");
  EXPECT_THAT(module_.log, ElementsAre("1800:01=C00001FF", "1A00:00=00"));
  ASSERT_FALSE(steps_.empty());
  EXPECT_FALSE(steps_.back().good);
}

TEST_F(ModuleTransferTest, AnotherNodeHasNoWords) {
  RecordProperty("spec", "FX3U-TOOL-004");
  set("basic", "Node ID", "2");
  set("producer", "Producer heartbeat time", "500");
  set("master", "Start all nodes delay", "600");
  module_.at(0x1F90, 6) = 5270;
  EXPECT_EQ(write("all", {}, 9), "");
  EXPECT_THAT(module_.log, ElementsAre("1017:00=01F4", "1010:01=65766173"));
  EXPECT_THAT(module_.nodes_asked, testing::Each(9));
}

}  // namespace
}  // namespace canopus::module_settings::module_transfer_test
