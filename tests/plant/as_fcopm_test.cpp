// AS300 racks with function cards: what CANopen Builder downloads, from the plant file.

#include <fmt/format.h>

#include "canopus/can/bus.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plc/rack/rack.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant::as_fcopm_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr std::string_view head = R"([[bus]]
name = "machine"
bit_rate = 500_000
[[device]]
node = 3
name = "drive"
eds = "drive.eds"
[[device.behaviour]]
object = "606C:00"
kind = "echo"
source = "60FF:00"
)";
constexpr std::string_view card = R"([[plc]]
name = "as300"
family = "AS300"
[[plc.module]]
model = "AS-FCOPM"
name = "card"
bus = "machine"
)";
constexpr std::string_view slave = R"([plc.module.download]
[[plc.module.download.slave]]
node = 3
heartbeat = "100ms"
rx_pdo = [{ number = 1, objects = ["6040:00", "60FF:00"] }]
tx_pdo = [{ number = 1, type = 1, objects = ["6041:00", "606C:00"] }]
auto_sdo = [{ object = "6083:00", value = 2000 }]
)";

class AsFcopmPlant : public support::PlantFolder, public PlantObserver {
 protected:
  AsFcopmPlant() {
    std::filesystem::copy_file(CANOPUS_SOURCE_DIR "/examples/devices/drive.eds", folder_ / "drive.eds");
  }
  void start(const std::string& text) {
    plant_ = support::PlantFolder::load(text, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
    run(6s);
  }
  void run(can::Duration time) { plant_->timeline().run_until(plant_->timeline().now() + time); }
  std::uint16_t word(plc::Device device, std::uint32_t number) {
    std::uint16_t value = 0;
    EXPECT_TRUE(plant_->rack(0).read_words(device, number, {&value, 1}, plant_->timeline().now()));
    return value;
  }
  void write_d(std::uint32_t first, const std::vector<std::uint16_t>& words) {
    EXPECT_TRUE(plant_->rack(0).write_words(plc::Device::d, first, words, plant_->timeline().now()));
    run(20ms);
  }
  static std::string plant_of(std::string_view keys, std::string_view download = slave) {
    return fmt::format("{}{}{}\n{}", head, card, keys, download);
  }

  std::unique_ptr<Plant> plant_;
};

TEST_F(AsFcopmPlant, TheNodeListIsDownloaded_AndTheSlaveDriven) {
  RecordProperty("spec",
                 "ASF-GEN-001 ASF-GEN-010 ASF-CFG-001 ASF-CFG-008 ASF-TOOL-004 ASF-TOOL-006 ASF-TOOL-008");
  EXPECT_THAT(check(plant_of("node = 1")), IsEmpty());
  start(plant_of("node = 1"));
  EXPECT_EQ(word(plc::Device::sd, 822), 500U);
  EXPECT_EQ(word(plc::Device::sd, 825), 0U);
  EXPECT_EQ(word(plc::Device::sd, 832), 0U);
  write_d(25032, {0x000F, 0x5678, 0x0001});
  run(200ms);
  EXPECT_EQ(word(plc::Device::d, 24033), 0x5678U) << "the drive turns";
  EXPECT_EQ(word(plc::Device::d, 24034), 0x0001U);
  // An SDO request in one write, as a Modbus client does it: D25000 comes first.
  write_d(25000, {0x0101, 4, 0x0103, 0x6083, 0});
  EXPECT_EQ(word(plc::Device::d, 24000), 0x0101U);
  EXPECT_EQ(word(plc::Device::d, 24002), 0x4303U);
  EXPECT_EQ(word(plc::Device::d, 24005), 2000U) << "the auto SDO";
  // STOP changes nothing for it.
  plant_->rack(0).set_cpu_state(module::CpuState::stop, plant_->timeline().now());
  write_d(25033, {0x0042});
  run(200ms);
  EXPECT_EQ(word(plc::Device::d, 24033), 0x0042U);
  EXPECT_THAT(plant_->troubles(), IsEmpty());
}

TEST_F(AsFcopmPlant, TheRestOfTheRegistersIsTheCpus) {
  RecordProperty("spec", "ASF-GEN-007");
  start(plant_of("node = 1"));
  write_d(24979, {7});
  write_d(25979, {8});
  write_d(24978, {9});
  EXPECT_EQ(word(plc::Device::d, 24979), 7U);
  EXPECT_EQ(word(plc::Device::d, 25979), 8U);
  EXPECT_EQ(word(plc::Device::d, 24978), 0U);
}

TEST_F(AsFcopmPlant, AnotherDeviceThanExpected) {
  RecordProperty("spec", "ASF-SRN-006");
  std::filesystem::copy_file(CANOPUS_SOURCE_DIR "/examples/devices/io-block.eds", folder_ / "io-block.eds");
  start(plant_of("node = 1",
                 "[plc.module.download]\n[[plc.module.download.slave]]\nnode = 3\neds = \"io-block.eds\"\n"));
  EXPECT_EQ(word(plc::Device::sd, 832), 0xE5U);
}

TEST_F(AsFcopmPlant, AsSlave) {
  RecordProperty("spec", "ASF-GEN-001 ASF-CFG-004 ASF-CFG-008");
  start(plant_of("node = 9\nobjects = { \"1017:00\" = 100 }\n",
                 "[plc.module.download]\nwork_mode = \"slave\"\n"));
  EXPECT_EQ(word(plc::Device::sd, 825), 0xA1U);
  EXPECT_EQ(word(plc::Device::sd, 822), 500U);
}

// "The node address in the AS300 Series PLC should be between: 1-127" [10.5.1 F5].
TEST_F(AsFcopmPlant, ANodeIdThatIsNone_IsASettingError) {
  RecordProperty("spec", "ASF-SRM-005 ASF-CFG-007 ASF-CFG-011");
  for (const unsigned id : {0U, 128U, 255U}) {
    const std::string text = plant_of(
        "node = 1",
        fmt::format("{}", slave).replace(0, 22, fmt::format("[plc.module.download]\nnode_id = {}\n", id)));
    EXPECT_THAT(check(text),
                ElementsAre(HasSubstr(fmt::format(
                    "download: node_id = {} is no node-ID: the AS-FCOPM stays off the bus", id))));
    start(text);
    EXPECT_EQ(word(plc::Device::sd, 825), 0xF5U);
    run(1min);
    EXPECT_EQ(word(plc::Device::sd, 825), 0xF5U);
    EXPECT_EQ(word(plc::Device::sd, 832), 0U) << "it looks for nobody";
  }
}

TEST_F(AsFcopmPlant, ADownloadIntoTheRunningCard_IsShownWhileItRuns) {
  RecordProperty("spec", "ASF-SRM-002 ASF-SRS-003 ASF-CFG-010 ASF-CFG-012");
  const auto shown = [&] { return word(plc::Device::sd, 825); };
  start(plant_of("node = 1",
                 fmt::format("{}", slave).replace(0, 22, "[plc.module.download]\nagain_at = \"10s\"\n")));
  EXPECT_EQ(shown(), 0U);
  run(3990ms);
  EXPECT_EQ(shown(), 0U);
  run(20ms);
  EXPECT_EQ(shown(), 0xF2U);
  run(1980ms);
  EXPECT_EQ(shown(), 0xF2U);
  run(20ms);
  EXPECT_EQ(shown(), 0U);
  run(1min);
  EXPECT_EQ(shown(), 0U) << "once";
  EXPECT_EQ(word(plc::Device::sd, 832), 0U);
  start(plant_of("node = 9", "[plc.module.download]\nwork_mode = \"slave\"\nagain_at = \"10s\"\n"));
  run(4010ms);
  EXPECT_EQ(shown(), 0xA3U);
  run(2s);
  EXPECT_EQ(shown(), 0xA1U);
}

TEST_F(AsFcopmPlant, MistakesAreFoundWithTheirPlaces) {
  RecordProperty("spec", "ASF-GEN-010 ASF-GEN-004 ASF-GEN-006 ASF-SDO-006 ASF-TOOL-005");
  const auto of_slave = [](std::string_view line) {
    return fmt::format("[plc.module.download]\n[[plc.module.download.slave]]\nnode = 3\n{}\n", line);
  };
  EXPECT_THAT(check(plant_of("node = 1\ncard = 1")),
              ElementsAre(HasSubstr("the AS-FCOPM fits into card 2 alone")));
  EXPECT_THAT(check(plant_of("node = 1\nmaster = true")),
              ElementsAre(HasSubstr("the AS-FCOPM has its node list in [plc.module.download]")));
  EXPECT_THAT(check(plant_of("node = 1\nexchange = \"10ms\"")),
              ElementsAre(HasSubstr("exchanges process data by itself")));
  const std::vector<std::pair<std::string, std::string>> mistakes = {
      {of_slave("rx_pdo = [{ number = 1, objects = [\"9999:00\"] }]"), "node 3 has no object 9999:00"},
      {of_slave("rx_pdo = [{ number = 1, objects = [\"6041:00\", \"6083:00\"] }]"),
       "6041:00 of node 3 cannot be mapped into an RxPDO"},
      {of_slave("rx_pdo = [{ number = 200, cob_id = 0x300, objects = [\"6040:00\"] }]"),
       "node 3 has no RxPDO200 (14C7H)"},
      {of_slave("rx_pdo = [{ number = 1 }]"), "objects is missing"},
      {of_slave("rx_pdo = [{ number = 1, type = 252, objects = [\"6040:00\"] }]"), "0 to 240, 254 or 255"},
      {of_slave("rx_pdo = [{ number = 1, event_timer = \"1ms\", objects = [\"6040:00\"] }]"),
       "unknown key event_timer"},
      {of_slave("tx_pdo = [{ number = 1, inhibit_time = \"50us\", objects = [\"6041:00\"] }]"),
       "multiples of 100us"},
      {of_slave("auto_sdo = [{ object = \"6083:00\", value = \"x\" }]"), "auto_sdo: 6083:00"},
      {of_slave("auto_sdo = [{ object = \"9999:00\", value = 1 }]"), "auto_sdo: node 3 has no object"},
      {of_slave("auto_sdo = [{ object = \"6083:00\" }]"), "value is missing"},
      {of_slave("heartbeat = \"100ms\"\nheartbeat_time_out = \"100ms\""), "time-out must be longer"},
      {of_slave("heartbeat = \"70000ms\""), "up to 65535ms"},
      {of_slave("node_list = 1"), "unknown key node_list"},
      {"[plc.module.download]\n[[plc.module.download.slave]]\nnode = 65\n",
       "the nodes of slaves are 1 to 64"},
      {"[plc.module.download]\n[[plc.module.download.slave]]\nnode = 4\n",
       "there is no device or module with node = 4"},
      {"[plc.module.download]\nwork_mode = \"both\"\n", "expected \"master\" or \"slave\""},
      {"[plc.module.download]\nnode_id = 5\n",
       "node_id = 5: expected 0 or 128 to 255, which are no node-IDs"},
      {"[plc.module.download]\nnode_id = 256\n",
       "node_id = 256: expected 0 or 128 to 255, which are no node-IDs"},
      {"[plc.module.download]\nagain_at = \"soon\"\n", "again_at"},
      {of_slave("") + "[[plc.module.download.slave]]\nnode = 3\n", "node 3 is in the node list already"},
  };
  for (const auto& [download, message] : mistakes) {
    const auto lines = check(plant_of("node = 1", download));
    ASSERT_FALSE(lines.empty()) << message;
    EXPECT_THAT(lines[0], HasSubstr(message));
    EXPECT_THAT(lines[0], HasSubstr("plant.toml:"));
    EXPECT_EQ(exit_code_, 2) << message;
  }
}

TEST_F(AsFcopmPlant, AFastValueInAnAsynchronousPdoIsAdvisedAgainst_AndLoadsTheBus) {
  RecordProperty("spec", "ASF-PDO-015");
  const auto plant_with = [](std::string_view kind, std::string_view pdo) {
    return plant_of("node = 1", fmt::format("[plc.module.download]\ncycle_period = \"50ms\"\n"
                                            "[[plc.module.download.slave]]\nnode = 3\ntx_pdo = [{}]\n",
                                            pdo))
        .replace(
            0, head.size(),
            fmt::format("{}", std::string(head.substr(0, head.find("[[device.behaviour]]"))) +
                                  fmt::format("[[device.behaviour]]\nobject = \"606C:00\"\n{}\n", kind)));
  };
  constexpr std::string_view sine = "kind = \"sine\"\nlow = -3000\nhigh = 3000\nperiod = \"2s\"";
  constexpr std::string_view slow = "kind = \"counter\"\nlow = 0\nhigh = 9\nperiod = \"200ms\"";
  constexpr std::string_view asynchronous = "{ number = 2, type = 255, objects = [\"606C:00\"] }";
  constexpr std::string_view synchronous = "{ number = 2, type = 1, objects = [\"606C:00\"] }";
  constexpr std::string_view inhibited =
      "{ number = 2, type = 255, inhibit_time = \"50ms\", objects = [\"606C:00\"] }";
  EXPECT_THAT(check(plant_with(sine, asynchronous)),
              ElementsAre(HasSubstr(
                  "node 3: TxPDO2 of type 255 is sent at each change of 606C:00, which changes all the time; "
                  "a synchronous type (1 to 240) keeps the bus free")));
  EXPECT_THAT(check(plant_with(sine, synchronous)), IsEmpty());
  EXPECT_THAT(check(plant_with(sine, inhibited)), IsEmpty());
  EXPECT_THAT(check(plant_with(slow, asynchronous)), IsEmpty());
  const auto frames_in_a_second = [&](std::string_view pdo) {
    start(plant_with(sine, pdo));
    const auto before = plant_->bus(0).frames_of(0x283);
    run(1s);
    return plant_->bus(0).frames_of(0x283) - before;
  };
  EXPECT_EQ(frames_in_a_second(synchronous), 20U) << "one for each SYNC";
  EXPECT_GT(frames_in_a_second(asynchronous), 80U) << "one for each change";
}

TEST_F(AsFcopmPlant, OtherModulesTakeNoDownload_OtherRacksNoCard) {
  RecordProperty("spec", "ASF-GEN-010");
  const auto plant = [](std::string_view family, std::string_view model, std::string_view rest) {
    return fmt::format(
        "{}[[plc]]\nname = \"plc\"\nfamily = \"{}\"\nlisten = \"off\"\n[[plc.module]]\nmodel = \"{}\"\nbus = "
        "\"machine\"\nnode = 1\n{}",
        head, family, model, rest);
  };
  EXPECT_THAT(check(plant("FX3", "FX3U-CAN", "[plc.module.download]\n")),
              ElementsAre(HasSubstr("the FX3U-CAN takes none")));
  EXPECT_THAT(check(plant("FX3", "AS-FCOPM", "")),
              ElementsAre(HasSubstr("its [[plc]] needs family = \"AS300\"; this one has")));
  EXPECT_THAT(check(plant("AS300", "FX3U-CAN", "")), ElementsAre(HasSubstr("this one has \"AS300\"")));
}

TEST_F(AsFcopmPlant, ABitRateThatTheCardDoesNotHave) {
  RecordProperty("spec", "ASF-GEN-005");
  std::string text = plant_of("node = 1");
  text.replace(text.find("500_000"), 7, "800_000");
  EXPECT_THAT(
      check(text),
      ElementsAre(HasSubstr("800000 bit/s, which the AS-FCOPM does not have; expected one of 20000, ")));
}

TEST(AsFcopmEds, DescribesTheSlave) {
  RecordProperty("spec", "ASF-OD-001 ASF-OD-002 ASF-OD-003 ASF-OD-004 ASF-OD-005 ASF-GEN-008");
  const eds::ReadResult read = eds::read_device_file(module_eds(*find_module("as-fcopm")));
  ASSERT_NE(read.file, nullptr);
  for (const eds::Problem& problem : read.problems) ADD_FAILURE() << problem.line << ": " << problem.message;
  EXPECT_EQ(read.file->device.vendor_number, 0x1DDU);
  EXPECT_EQ(read.file->device.product_number, 0x55U);
  EXPECT_EQ(read.file->device.revision_number, 0x10002U);
  EXPECT_EQ(read.file->device.rpdos, 8);
  EXPECT_EQ(read.file->device.tpdos, 8);
  const canopen::ObjectDictionary objects(read.file->dictionary, 7);
  EXPECT_EQ(objects.get<std::uint32_t>(0x1800, 1), 0x187U);
  EXPECT_EQ(objects.get<std::uint32_t>(0x1A00, 4), 0x20010410U);
}

// Five racks, three buses.
TEST_F(AsFcopmPlant, AllFiveModulesInOnePlant) {
  RecordProperty("spec", "ASF-GEN-001 ASF-GEN-010");
  text::TextOutput out, err;
  const std::string path = CANOPUS_SOURCE_DIR "/examples/five-modules/plant.toml";
  EXPECT_EQ(cli::check_plant({.plant = path, .strict = true}, out, err), 0) << err.text();
  plant_ = plant::load_plant(path, *this, err);
  ASSERT_NE(plant_, nullptr) << err.text();
  plant_->power_on();
  run(15s);
  EXPECT_EQ(plant_->plc_count(), module_catalogue().size());
  const auto operational = [&] {
    std::size_t count = 0;
    for (const auto& node : plant_->nodes()) count += node.state == canopen::NmtState::operational ? 1U : 0U;
    return count;
  };
  EXPECT_EQ(operational(), 9U);
}

TEST_F(AsFcopmPlant, TheExampleRuns) {
  RecordProperty("spec", "ASF-GEN-001 ASF-NMT-003");
  text::TextOutput out, err;
  EXPECT_EQ(cli::check_plant({.plant = CANOPUS_SOURCE_DIR "/examples/as-fcopm/plant.toml", .strict = true},
                             out, err),
            0)
      << err.text();
  plant_ = plant::load_plant(CANOPUS_SOURCE_DIR "/examples/as-fcopm/plant.toml", *this, err);
  ASSERT_NE(plant_, nullptr) << err.text();
  plant_->power_on();
  run(10s);
  EXPECT_EQ(word(plc::Device::sd, 825), 0U);
  EXPECT_EQ(word(plc::Device::sd, 826), 0U);
  write_d(25032, {0, 1500, 0, 0x0201});
  run(200ms);
  EXPECT_EQ(word(plc::Device::d, 24033), 1500U) << "the drive turns";
  EXPECT_NE(word(plc::Device::d, 24035), 0U) << "the inputs count";
  // The card that is a slave, and the FX3U-CAN that is its master.
  auto& fx = plant_->rack(2);
  auto& as = plant_->rack(1);
  const std::vector<std::uint16_t> to_master{0x1234}, to_slave{0x4321};
  const can::Time now = plant_->timeline().now();
  EXPECT_TRUE(as.write_words(plc::Device::d, 25032, to_master, now));
  EXPECT_TRUE(fx.write_buffer(0, 11000, to_slave, now));
  run(500ms);
  std::uint16_t value = 0;
  EXPECT_TRUE(as.read_words(plc::Device::d, 24032, {&value, 1}, plant_->timeline().now()));
  EXPECT_EQ(value, 0x4321U);
  EXPECT_TRUE(fx.read_buffer(0, 10000, {&value, 1}, plant_->timeline().now()));
  EXPECT_EQ(value, 0x1234U);
}

}  // namespace
}  // namespace canopus::plant::as_fcopm_test
