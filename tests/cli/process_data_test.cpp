// The process data of a plant with the built-in PLC program go on after whatever happens to the module or the
// CPU; and where they do not, the run says so in words.

#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/run/live_table.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/text/file_text.hpp"

#include "cli/table_picture.hpp"
#include "paths.hpp"

namespace canopus::cli::process_data_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr std::uint16_t own_rpdo_word = 13000;  // io-block's RPDO1, 202H

/// The first example plant, in virtual time, with one more node that sends and listens.
class ProcessDataTest : public ::testing::Test, public plant::PlantObserver, public can::Participant {
 protected:
  /// `keys` go to the module.
  void build(const std::string& keys = "") {
    const std::string path = CANOPUS_SOURCE_DIR "/examples/first-plant/plant.toml";
    std::string text = text::read_file(path).value();
    const std::string key = "exchange = \"20ms\"";
    text.replace(text.find(key), key.size(), key + "\n" + keys);
    const plant::PlantReading reading = plant::read_plant(text, path);
    for (const text::FileError& error : reading.errors) ADD_FAILURE() << describe(error, path);
    auto built = plant::Plant::build(reading.plant, *this);
    ASSERT_TRUE(built.has_value()) << describe(built.error()[0], path);
    plant_ = std::move(*built);
    port_ = &plant_->bus(0).add_port("peer");
    plant_->timeline().add(*this);
    port_->connect(*this);
    plant_->power_on();
    run(2s);
    events.clear();
  }
  [[nodiscard]] can::Time now() const { return plant_->timeline().now(); }
  void run(can::Duration time) { plant_->timeline().run_until(now() + time); }
  /// An NMT command of a foreign master.
  void nmt(std::uint8_t command, std::uint8_t node) { port_->send({.dlc = 2, .data = {command, node}}); }
  plc::Rack& rack() { return plant_->rack(0); }
  std::uint16_t word(module::BufferAddress address) {
    std::uint16_t value = 0;
    EXPECT_TRUE(rack().read_buffer(0, address, {&value, 1}, now()));
    return value;
  }
  bool bit(plc::Device device, std::uint32_t number) {
    std::uint8_t value = 0;
    EXPECT_TRUE(rack().read_bits(device, number, {&value, 1}, now()));
    return value != 0;
  }
  void set(plc::Device device, std::uint32_t number, bool on) {
    const std::uint8_t value = on ? 1 : 0;
    EXPECT_TRUE(rack().write_bits(device, number, {&value, 1}, now()));
  }
  /// What the CPU writes leaves as a PDO within this time.
  bool process_data_flow(can::Duration time = 100ms) {
    const auto value = static_cast<std::uint16_t>(word(own_rpdo_word) + 1);
    EXPECT_TRUE(rack().write_buffer(0, own_rpdo_word, {&value, 1}, now()));
    heard_.reset();
    run(time);
    return heard_ == value;
  }

  void receive(const can::Frame& frame, can::Time) override {
    if (frame.identifier == 0x202) heard_ = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
  }
  void tick(can::Time) override {}

  void on(const plant::Event& event) override {
    if (const auto* change = std::get_if<plant::NmtStateChange>(&event.what);
        change != nullptr && change->node.node_id == 1)
      module_state_ = change->state;
    if (const auto* failure = std::get_if<plant::Failure>(&event.what))
      events.push_back(
          fmt::format("{:.3f} {}: {}", can::seconds(event.time), failure->source, failure->message));
  }

  std::vector<std::string> events;
  std::unique_ptr<plant::Plant> plant_;
  can::Port* port_ = nullptr;
  std::optional<std::uint16_t> heard_;
  canopen::NmtState module_state_ = canopen::NmtState::initialising;
};

// Wherever in the program's cycle of 20 ms the reset comes.
TEST_F(ProcessDataTest, NmtResetOfTheModule_ProcessDataGoOnAfterwards) {
  for (const std::uint8_t command : std::initializer_list<std::uint8_t>{0x81, 0x82}) {
    build();
    for (int i = 0; i < 40; ++i) {
      SCOPED_TRACE(fmt::format("{:02X}H, {} us into the cycle", command, i * 500));
      run(1000ms - now().time_since_epoch() % 20ms + i * 500us);
      nmt(command, 1);
      run(1s);
      EXPECT_EQ(module_state_, canopen::NmtState::operational);
      ASSERT_TRUE(process_data_flow());
    }
  }
}

TEST_F(ProcessDataTest, CpuStopAndRun_TheNetworkIsOperationalAgainAndProcessDataGoOn) {
  RecordProperty("spec", "ME3-EB-006 ME3-RQN-001");
  build();
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(fmt::format("{} us into the cycle", i * 500));
    run(1000ms - now().time_since_epoch() % 20ms + i * 500us);
    rack().set_cpu_state(module::CpuState::stop, now());
    run(500ms);
    EXPECT_EQ(module_state_, canopen::NmtState::pre_operational);
    EXPECT_FALSE(bit(plc::Device::y, 1)) << "the CPU turns Y OFF";
    EXPECT_FALSE(bit(plc::Device::x, 1)) << "no program runs";
    EXPECT_FALSE(process_data_flow());
    rack().set_cpu_state(module::CpuState::run, now());
    run(200ms);
    EXPECT_EQ(module_state_, canopen::NmtState::operational);
    ASSERT_TRUE(process_data_flow());
    EXPECT_FALSE(bit(plc::Device::y, 0x17));
  }
}

TEST_F(ProcessDataTest, CpuReset_ProcessDataGoOnAfterTheStart) {
  build();
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(fmt::format("{} us into the cycle", i * 500));
    run(1000ms - now().time_since_epoch() % 20ms + i * 500us);
    rack().reset_cpu(now());
    run(3s);
    ASSERT_TRUE(process_data_flow());
  }
}

TEST_F(ProcessDataTest, RestartOfTheModule_ProcessDataGoOnAfterTheStart) {
  build();
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(fmt::format("{} us into the cycle", i * 500));
    run(1000ms - now().time_since_epoch() % 20ms + i * 500us);
    set(plc::Device::y, 2, true);
    run(6100ms);
    set(plc::Device::y, 2, false);
    run(1s);
    ASSERT_TRUE(process_data_flow());
  }
}

TEST_F(ProcessDataTest, RequestsOfTheBuiltInProgram_AreSeenAtTheCpu) {
  build();
  run(20ms - now().time_since_epoch() % 20ms);
  bool seen = false;
  for (int i = 0; i < 200 && !seen; ++i) {
    run(100us);
    seen = bit(plc::Device::y, 1);
  }
  EXPECT_TRUE(seen) << "Y1, as GX Works would monitor it";
}

// Where the reset comes between Y01 and X01.
TEST_F(ProcessDataTest, RequestThatAResetSwallowed_IsMadeAgainAndReportedOnce) {
  build();
  unsigned reported = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(fmt::format("{} us into the cycle", i * 100));
    run(1000ms - now().time_since_epoch() % 20ms + i * 100us);
    events.clear();
    nmt(0x82, 1);
    run(2s);
    EXPECT_THAT(plant_->troubles(), IsEmpty());
    EXPECT_TRUE(process_data_flow());
    if (events.empty()) continue;
    ++reported;
    EXPECT_THAT(events, ElementsAre(AllOf(HasSubstr("ME3CAN1-Q U0: process data were not exchanged for "),
                                          HasSubstr(" ms: the module initialized while Y01 was ON; the "
                                                    "built-in PLC program took Y01 back and set it again"))));
  }
  EXPECT_GT(reported, 0U);
}

/// A second in which process data stand still is reported, with the way back, and the way back works.
TEST_F(ProcessDataTest, WithoutRecover_AResetMayStopTheProcessData_AndThatIsSaid) {
  RecordProperty("spec", "ME3-IO-002 ME3-STAT-005");
  build("recover = false");
  unsigned stopped = 0;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(fmt::format("{} us into the cycle", i * 500));
    run(1000ms - now().time_since_epoch() % 20ms + i * 500us);
    events.clear();
    nmt(0x82, 1);
    run(950ms);
    EXPECT_THAT(events, IsEmpty());
    run(1s);
    if (events.empty()) {
      EXPECT_TRUE(process_data_flow());
      EXPECT_THAT(plant_->troubles(), IsEmpty());
      continue;
    }
    ++stopped;
    ASSERT_THAT(events, ElementsAre(HasSubstr("ME3CAN1-Q U0: no process data exchange: X01 has not come "
                                              "for 1.0 s, because Y01 was set while the module initialized. "
                                              "To recover, set Y01 OFF and ON again")));
    run(5s);
    EXPECT_EQ(events.size(), 1U);
    EXPECT_FALSE(process_data_flow());
    EXPECT_EQ(module_state_, canopen::NmtState::operational) << "which alone says nothing";
    ASSERT_EQ(plant_->troubles().size(), 1U);
    EXPECT_THAT(plant_->troubles()[0].text, HasSubstr("X01 has not come for 7.0 s"));
    EXPECT_EQ(plant_->troubles()[0].module.node_id, 1);
    set(plc::Device::y, 1, false);
    set(plc::Device::y, 1, true);
    EXPECT_TRUE(process_data_flow());
    EXPECT_THAT(plant_->troubles(), IsEmpty());
  }
  EXPECT_GT(stopped, 3U);
}

TEST_F(ProcessDataTest, WithoutRecover_AfterStopAndRunTheWayBackIsSaid) {
  RecordProperty("spec", "ME3-EB-006");
  build("recover = false");
  rack().set_cpu_state(module::CpuState::stop, now());
  run(1s);
  EXPECT_THAT(events, IsEmpty());
  ASSERT_EQ(plant_->troubles().size(), 1U);
  EXPECT_THAT(plant_->troubles()[0].text, HasSubstr("the CPU is in STOP"));
  rack().set_cpu_state(module::CpuState::run, now());
  run(1s);
  constexpr const char* way_back =
      "no process data exchange: pre-operational since the CPU's STOP, and RUN alone does not change "
      "that. To recover, write 05H to 1F82:01 of the module (request NMT, Start remote node to itself), or "
      "restart it";
  EXPECT_THAT(events, ElementsAre(HasSubstr(way_back)));
  plant::Plant* plant = plant_.get();
  LiveTable table(plant);
  EXPECT_THAT(shown(table, now(), {40, 200}),
              HasSubstr("\n      no process data exchange: pre-operational "));
  const auto lines = describe(plant::RunSummary{.end = now(), .troubles = plant_->troubles()});
  EXPECT_THAT(lines, Contains(HasSubstr(way_back)));
  ASSERT_EQ(plant_->troubles().size(), 1U);
  EXPECT_EQ(plant_->troubles()[0].text, way_back);
  const std::uint16_t command[] = {2, 0, 0x1F82, 1, 1, 5};
  EXPECT_TRUE(rack().write_buffer(0, 1000, command, now()));
  set(plc::Device::y, 0x17, true);
  run(100ms);
  EXPECT_TRUE(bit(plc::Device::x, 0x17));
  set(plc::Device::y, 0x17, false);
  EXPECT_THAT(plant_->troubles(), IsEmpty());
  EXPECT_TRUE(process_data_flow());
}

TEST_F(ProcessDataTest, AModuleIsShownAsAProgramSeesIt_WithoutTheBuiltInProgramsExchange) {
  build("watch = [\"G25\"]");
  unsigned exchanges = 0;
  for (int i = 0; i < 200; ++i) {
    run(1ms);
    exchanges += bit(plc::Device::y, 0x01) ? 1 : 0;
    const plant::ModuleStatus module = plant_->modules().at(0);
    EXPECT_EQ(module.inputs, 0x1U);
    EXPECT_EQ(module.outputs, 0U);
  }
  EXPECT_GT(exchanges, 0U);
  const auto error_leds = [&] {
    std::vector<std::string_view> lit;
    const plant::ModuleStatus module = plant_->modules().at(0);
    for (const module::Led& led : module.leds) {
      if (led.error && led.pattern != module::LedPattern::off) lit.push_back(led.name);
    }
    return lit;
  };
  EXPECT_THAT(error_leds(), IsEmpty());
  const std::uint16_t no_bit_rate = 301;
  EXPECT_TRUE(rack().write_buffer(0, 24, {&no_bit_rate, 1}, now()));
  set(plc::Device::y, 0x17, true);
  run(100ms);
  const plant::ModuleStatus module = plant_->modules()[0];
  EXPECT_TRUE(module.outputs >> 0x17 & 1U);
  EXPECT_EQ(module.plc, "plc1");
  ASSERT_EQ(module.words.size(), 1U);
  EXPECT_EQ(module.words[0].address, 25U);
  EXPECT_EQ(module.words[0].value, word(25));
  EXPECT_THAT(error_leds(), ElementsAre("ERR.", "CAN ERR"));
}

// The CPU in STOP holds the start-up up; RUN lets it go on.
TEST_F(ProcessDataTest, CpuInStopWhileTheNetworkStarts_IsOperationalAfterRun) {
  build();
  rack().set_cpu_state(module::CpuState::stop, now());
  nmt(0x82, 1);
  run(3s);
  EXPECT_EQ(module_state_, canopen::NmtState::pre_operational);
  rack().set_cpu_state(module::CpuState::run, now());
  run(200ms);
  EXPECT_EQ(module_state_, canopen::NmtState::operational);
  EXPECT_TRUE(process_data_flow());

  build("recover = false");
  rack().set_cpu_state(module::CpuState::stop, now());
  nmt(0x82, 1);
  run(3s);
  rack().set_cpu_state(module::CpuState::run, now());
  run(1s);
  EXPECT_THAT(events, ElementsAre(HasSubstr("To recover, write 05H to 1F82:01 of the module")));
}

/// A program of the user's, by MC protocol.
TEST_F(ProcessDataTest, RequestOfAClientWhileTheModuleInitializes_IsReported) {
  build("recover = false");
  rack().set_cpu_state(module::CpuState::stop, now());  // so that nobody else asks
  nmt(0x82, 1);
  run(1ms);
  ASSERT_EQ(word(25) & 0x0080, 0x0080);
  set(plc::Device::y, 1, true);
  run(2s);
  EXPECT_THAT(events, ElementsAre(HasSubstr("Y01 was set while the module initialized")));
  set(plc::Device::y, 1, false);
  run(2s);
  EXPECT_EQ(events.size(), 1U);
  ASSERT_EQ(plant_->troubles().size(), 1U);
  EXPECT_THAT(plant_->troubles()[0].text, HasSubstr("the CPU is in STOP")) << "and no more than that";
}

// A device without supply is not on the wire; with it, its boot-up message waits for 11 recessive bits.
TEST_F(ProcessDataTest, ADeviceThatStartsLater_IsSilentAndAcknowledgesNothingBefore) {
  const std::string path = CANOPUS_SOURCE_DIR "/examples/first-plant/plant.toml";
  const std::string device = R"(
    [[device]]
    eds = "../devices/io-block.eds"
    node = )";
  const std::string text = "[[bus]]\nname = \"one\"\nbit_rate = 250_000\n" + device +
                           "5\nname = \"early\"\n" + device + "6\nname = \"late\"\nstart = \"2s\"\n";
  const plant::PlantReading reading = plant::read_plant(text, path);
  ASSERT_THAT(reading.errors, IsEmpty());
  auto built = plant::Plant::build(reading.plant, *this);
  ASSERT_TRUE(built.has_value()) << describe(built.error()[0], path);
  plant_ = std::move(*built);
  struct Frames final : can::BusObserver {
    void frame_completed(const can::Frame& frame, can::Time start, can::Time) override {
      all.push_back(fmt::format("{:X} {:.6f}", frame.identifier, can::seconds(start)));
    }
    std::vector<std::string> all;
  } frames;
  plant_->bus(0).add_observer(frames);
  plant_->power_on();
  run(1999ms);
  EXPECT_THAT(frames.all, IsEmpty());
  run(10ms);
  // 11 bits of 4 us, if the wire is recessive; early's attempts come between them.
  ASSERT_THAT(frames.all, ::testing::SizeIs(2));
  EXPECT_THAT(frames.all, Contains(::testing::StartsWith("705 2.000")));
  EXPECT_THAT(frames.all, Contains(::testing::StartsWith("706 2.000")));
  plant_->bus(0).remove_observer(frames);
}

}  // namespace
}  // namespace canopus::cli::process_data_test
