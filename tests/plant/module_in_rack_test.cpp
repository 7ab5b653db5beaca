// A module of another kind than the ME3CAN1-Q in a plant: settings, process data, built-in program.

#include "canopus/plant/module_in_rack.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/eds/device_file.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/module_network.hpp"
#include "canopus/plant/plant_assembly.hpp"

#include "support/fake_communication_module.hpp"

namespace canopus::plant::module_in_rack_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr BusSection fast_bus() { return {.name = "line1", .bit_rate = 500'000}; }

std::vector<std::string> described(const std::vector<text::FileError>& errors) {
  std::vector<std::string> lines;
  for (const text::FileError& error : errors) lines.push_back(describe(error, "plant.toml"));
  return lines;
}

std::vector<std::string> words_refused(const ModuleSection& section, const BusSection& bus = fast_bus()) {
  support::FakeCommunicationModule module;
  return described(preset_words(module, support::FakeCommunicationModule::data_sheet, section, bus));
}

TEST(ModulePresets, BitRateNodeIdAndWords_GoWhereverTheModuleKeepsThem) {
  support::FakeCommunicationModule module;
  const ModuleSection section{
      .place = {7, 1}, .model = "FAKE", .node = 5, .buffer = {{{8, 1}, 12, 34}}, .watch = {699}};
  EXPECT_THAT(preset_words(module, support::FakeCommunicationModule::data_sheet, section, fast_bus()),
              IsEmpty());
  EXPECT_THAT(module.presets, ElementsAre("500000 bit/s", "node 5", "G12 = 34"));
}

TEST(ModulePresets, WithoutANodeId_TheModulesOwnStays) {
  support::FakeCommunicationModule module;
  EXPECT_THAT(
      preset_words(module, support::FakeCommunicationModule::data_sheet, {.model = "FAKE"}, fast_bus()),
      IsEmpty());
  EXPECT_THAT(module.presets, ElementsAre("500000 bit/s"));
}

TEST(ModulePresets, BitRateThatTheModuleDoesNotHave_IsRefusedWithThoseItHas) {
  EXPECT_THAT(words_refused({.place = {7, 1}, .model = "FAKE"}, {.name = "line1", .bit_rate = 800'000}),
              ElementsAre("plant.toml:7:1: module: bus \"line1\" has 800000 bit/s, which the FAKE does not "
                          "have; expected one of 20000, 500000"));
}

TEST(ModulePresets, NodeIdThatTheModuleCannotHave_IsRefused) {
  EXPECT_THAT(words_refused({.place = {7, 1}, .model = "FAKE", .node = 100}),
              ElementsAre("plant.toml:7:1: module: node = 100: the FAKE cannot have this node-ID"));
}

TEST(ModulePresets, OnlineWithoutALayer2Mode_IsRefused) {
  EXPECT_THAT(words_refused({.place = {7, 1}, .model = "FAKE", .online = true}),
              ElementsAre("plant.toml:7:1: module: online = true: the FAKE has no Layer 2 mode"));
}

TEST(ModulePresets, WatchedWordBehindTheBufferMemory_IsRefused) {
  EXPECT_THAT(words_refused({.place = {7, 1}, .model = "FAKE", .watch = {699, 700}}),
              ElementsAre("plant.toml:7:1: module: watch: G700: the FAKE has 700 words of buffer memory"));
}

/// A device whose TPDO1 and TPDO2 carry three bytes each, and whose RPDO1 carries two.
eds::DeviceFile three_byte_device() {
  std::string text =
      "[MandatoryObjects]\nSupportedObjects=2\n1=0x1000\n2=0x1001\n"
      "[1000]\nParameterName=t\nDataType=7\nAccessType=ro\nDefaultValue=0x191\n"
      "[1001]\nParameterName=e\nDataType=5\nAccessType=ro\n"
      "[OptionalObjects]\nSupportedObjects=6\n1=0x1400\n2=0x1600\n3=0x1800\n4=0x1801\n5=0x1A00\n6=0x1A01\n"
      "[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n"
      "[2000]\nParameterName=d\nDataType=5\nAccessType=rw\nPDOMapping=1\n";
  const auto pdo = [&](unsigned communication, unsigned mapping, std::string_view cob_id, unsigned bytes) {
    text += fmt::format(
        "[{0:04X}]\nParameterName=c\nObjectType=9\nSubNumber=2\n"
        "[{0:04X}sub0]\nParameterName=n\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
        "[{0:04X}sub1]\nParameterName=i\nDataType=7\nAccessType=rw\nDefaultValue={1}\n"
        "[{2:04X}]\nParameterName=m\nObjectType=9\nSubNumber={3}\n"
        "[{2:04X}sub0]\nParameterName=n\nDataType=5\nAccessType=rw\nDefaultValue={4}\n",
        communication, cob_id, mapping, bytes + 1, bytes);
    for (unsigned i = 1; i <= bytes; ++i) {
      text += fmt::format(
          "[{:04X}sub{}]\nParameterName=e\nDataType=7\nAccessType=rw\nDefaultValue=0x20000008\n", mapping, i);
    }
  };
  pdo(0x1800, 0x1A00, "$NODEID+0x180", 3);
  pdo(0x1801, 0x1A01, "$NODEID+0x280", 3);
  pdo(0x1400, 0x1600, "$NODEID+0x200", 2);
  const auto result = eds::read_device_file(text);
  EXPECT_NE(result.file, nullptr);
  return *result.file;
}

TEST(ModuleNetwork, OfAnotherLayout_ConnectsItsWords) {
  support::FakeCommunicationModule module;
  ModuleNetwork network(module, "U0");
  SlaveSection slave{.node = 5};
  slave.receive.push_back({.pdo = 1, .address = 506});
  slave.send.push_back({.pdo = 1});
  EXPECT_THAT(network.add_slave(slave, three_byte_device(), "io", true), IsEmpty());
  // 7th word and low byte of the 8th of the RPDO data, 1st word of the TPDO data [CiA 405].
  EXPECT_THAT(module.presets,
              ElementsAre("1F81:05 = D", "1F84:05 = 191", "1F85:05 = 0", "1F86:05 = 0", "1F87:05 = 0",
                          "1400:01 = 80000185", "1600:00 = 0", "1600:01 = A5800710", "1600:02 = A4C00F08",
                          "1600:00 = 2", "1400:01 = 185", "1800:01 = C0000205", "1A00:00 = 0",
                          "1A00:01 = A1000110", "1A00:00 = 1", "1800:01 = 40000205"));
  EXPECT_THAT(network.connections(), ElementsAre("U0\\G506-G507 <- TPDO1 of node 5 (io), 185H, 3 bytes",
                                                 "U0\\G600 -> RPDO1 of node 5 (io), 205H, 2 bytes"));
}

TEST(ModuleNetwork, OfAnotherLayout_NamesItsOwnLimits) {
  support::FakeCommunicationModule module;
  ModuleNetwork network(module, "U0");
  SlaveSection slave{.place = {9, 1}, .node = 5};
  slave.receive.push_back({.place = {9, 1}, .pdo = 1, .address = 507});
  slave.send.push_back({.place = {10, 1}, .pdo = 1, .address = 599});
  EXPECT_THAT(described(network.add_slave(slave, three_byte_device(), "io", true)),
              ElementsAre("plant.toml:9:1: TPDO1 of node 5: G507 is no place for 2 words; expected G500 to "
                          "G506",
                          "plant.toml:10:1: RPDO1 of node 5: G599 is no place for 1 word; expected G600 to "
                          "G607"));
  slave.send.clear();
  slave.receive = {{.place = {11, 1}, .pdo = 1},
                   {.place = {12, 1}, .pdo = 2},
                   {.place = {13, 1}, .pdo = 1, .address = 500}};
  EXPECT_THAT(described(network.add_slave(slave, three_byte_device(), "io", true)),
              ElementsAre("plant.toml:13:1: TPDO1 of node 5: the module has no more than 2 PDOs"));
}

TEST(ModuleInRack, OfAModuleWithoutSignals_LetsTheBuiltInProgramWork) {
  struct Watcher final : PlantObserver {
    void on(const Event& event) override {
      if (std::holds_alternative<SignalChange>(event.what)) events.emplace_back("signal");
      const auto* const change = std::get_if<BufferChange>(&event.what);
      if (change == nullptr) return;
      events.push_back(fmt::format("{}ms {:X} G{}={} {}", event.time.time_since_epoch() / 1ms, change->head,
                                   change->address, change->value, change->by_cpu ? "cpu" : "module"));
    }
    std::vector<std::string> events;
  } watcher;
  const NodeRegistry bus("line1", 250'000, watcher);
  const ModuleSection section{
      .model = "FAKE", .head = 0x20, .exchange = 10ms, .writes = {{{}, 100, 7}}, .watch = {500}};
  auto owned = std::make_unique<support::FakeCommunicationModule>();
  support::FakeCommunicationModule& module = *owned;
  can::Timeline timeline;
  plc::Rack rack(timeline);
  ModuleInRack seat(section, "plc1", rack, nullptr, std::move(owned), bus, watcher);
  timeline.add(seat);
  rack.power_on(timeline.now());
  timeline.run_until(can::Time{} + 11ms);
  EXPECT_EQ(module.words[support::FakeCommunicationModule::exchange_word], 1);
  module.words[500] = 9;
  timeline.run_until(can::Time{} + 19ms);
  EXPECT_EQ(module.words[support::FakeCommunicationModule::exchange_word], 0);
  EXPECT_THAT(watcher.events, ElementsAre("0ms 20 G100=7 cpu", "12ms 20 G500=9 module"))
      << "the exchanges are no news";
  module.write_word(support::FakeCommunicationModule::exchange_word, 1, timeline.now());
  EXPECT_EQ(watcher.events.back(), "19ms 20 G41=1 cpu") << "a client's is";
}

TEST(ModuleInRack, InPause_SaysThatTheBuiltInProgramStandsStill) {
  struct Observer final : PlantObserver {
  } observer;
  const NodeRegistry bus("line1", 250'000, observer);
  for (const bool has_program : {true, false}) {
    ModuleSection section{.model = "FAKE", .head = 0x20};
    if (has_program) section.exchange = 10ms;
    can::Timeline timeline;
    plc::Rack rack(timeline);
    ModuleInRack seat(section, "plc1", rack, nullptr, std::make_unique<support::FakeCommunicationModule>(),
                      bus, observer);
    (void)timeline.add(seat);
    rack.power_on(timeline.now());
    EXPECT_FALSE(seat.trouble(timeline.now()));
    rack.pause(timeline.now());
    const auto trouble = seat.trouble(timeline.now());
    EXPECT_EQ(trouble ? trouble->text : "",
              has_program ? "the built-in PLC program stands still: the CPU is in PAUSE" : "");
    rack.set_cpu_state(module::CpuState::run, timeline.now());
    EXPECT_FALSE(seat.trouble(timeline.now()));
  }
}

}  // namespace
}  // namespace canopus::plant::module_in_rack_test
