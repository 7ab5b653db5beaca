#include "canopus/plc/rack/rack.hpp"

#include <array>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/module/interface/observer.hpp"
#include "canopus/plc/cpu/device_points.hpp"
#include "canopus/plc/melsec/target.hpp"

#include "plc/conversation.hpp"

namespace canopus::plc::rack_test {
namespace {

using module::CpuState;
using ::testing::ElementsAre;
using testing::FakeModule;
using ::testing::IsEmpty;
using ::testing::Pair;
using testing::Plc;
using namespace std::chrono_literals;

AccessError error_of(const Rack::Access& access) { return access.error(); }

TEST(Rack, Insert_OverlappingPoints_IsRefused) {
  can::Timeline timeline;
  Rack rack(timeline);
  FakeModule first;
  FakeModule second;
  timeline.add(first);
  ASSERT_TRUE(rack.insert(0x20, first));
  timeline.add(second);
  EXPECT_FALSE(rack.insert(0x30, second));
  EXPECT_FALSE(rack.insert(0x10, second));
  EXPECT_FALSE(rack.insert(0x48, second));
  EXPECT_FALSE(rack.insert(0xFF0, second));
  EXPECT_TRUE(rack.insert(0x40, second));
  EXPECT_EQ(rack.module_at(0x20), &first);
  EXPECT_EQ(rack.module_at(0x30), nullptr);
  EXPECT_EQ(rack.module_at(0x40), &second);
}

TEST(Rack, PowerOn_StartsModulesAndTellsThemTheCpuState) {
  Plc plc;
  EXPECT_EQ(plc.module.power_ons, 1);
  EXPECT_THAT(plc.module.states, ElementsAre(CpuState::run));
}

TEST(Rack, Words_AcrossTheLastDevice_AreRefusedAsAWhole) {
  Plc plc;
  std::array<std::uint16_t, 2> words = {1, 2};
  EXPECT_EQ(error_of(plc.rack.write_words(Device::d, 18431, words, plc.now)), AccessError::out_of_range);
  EXPECT_EQ(plc.word(Device::d, 18431), 0);
  EXPECT_EQ(error_of(plc.rack.read_words(Device::d, 0xFFFFFFFF, words, plc.now)), AccessError::out_of_range);
}

TEST(Rack, Bits_OfAWordDevice_AreRefused) {
  Plc plc;
  std::array<std::uint8_t, 1> bits{};
  EXPECT_EQ(error_of(plc.rack.read_bits(Device::d, 0, bits, plc.now)), AccessError::wrong_unit);
  EXPECT_EQ(error_of(plc.rack.write_bits(Device::d, 0, bits, plc.now)), AccessError::wrong_unit);
}

TEST(Rack, RetentiveTimers_OfANewProject_DoNotExist) {
  Plc plc;
  std::array<std::uint16_t, 1> words{};
  EXPECT_EQ(error_of(plc.rack.read_words(Device::stn, 0, words, plc.now)), AccessError::no_device);
}

TEST(Rack, BitDeviceAsWords_FromAnyNumber_JoinsSixteenPoints) {
  Plc plc;
  plc.bit(Device::m, 5, true);
  plc.bit(Device::m, 20, true);
  plc.bit(Device::m, 36, true);
  std::array<std::uint16_t, 2> words{};
  ASSERT_TRUE(plc.rack.read_words(Device::m, 5, words, plc.now));
  EXPECT_THAT(words, ElementsAre(0x8001, 0x8000));
}

TEST(Rack, BitDeviceAsWords_EndingAtTheLastPoint_IsRead) {
  Plc plc;
  plc.bit(Device::m, 12287, true);
  std::array<std::uint16_t, 1> words{};
  ASSERT_TRUE(plc.rack.read_words(Device::m, 12272, words, plc.now));
  EXPECT_EQ(words[0], 0x8000);
  EXPECT_FALSE(plc.rack.read_words(Device::m, 12273, words, plc.now));
}

TEST(Rack, R_AndZr_AreTheSameWords) {
  Plc plc;
  plc.word(Device::r, 100, 0x1234);
  EXPECT_EQ(plc.word(Device::zr, 100), 0x1234);
}

TEST(Rack, RefreshDataRegisters_AreAnIqRsAlone) {
  Plc plc;
  plc.word(Device::rd, 524287, 0x1234);
  EXPECT_EQ(plc.word(Device::rd, 524287), 0x1234);
  EXPECT_EQ(plc.word(Device::rd, 0), 0);
  EXPECT_FALSE(plc.rack.check(Device::rd, 524288, 1));
  EXPECT_EQ(melsec::device_code(Device::rd), 0x2C);
  for (const CpuModel* model : {&q03udvcpu(), &fx3u(), &fx5u(), &as300()}) {
    EXPECT_EQ(model->points_of(Device::rd), 0U) << model->name;
  }
}

TEST(Rack, X_OfAModule_IsWhatTheModuleSaysWhateverIsWritten) {
  Plc plc;
  plc.module.x = 0x80000001;
  plc.bit(Device::x, 1, true);
  EXPECT_TRUE(plc.bit(Device::x, 0x00));
  EXPECT_FALSE(plc.bit(Device::x, 0x01));
  EXPECT_TRUE(plc.bit(Device::x, 0x1F));
  EXPECT_EQ(plc.word(Device::x, 0x10), 0x8000);
}

TEST(Rack, X_WithoutModule_IsMemory) {
  Plc plc;
  plc.bit(Device::x, 0x100, true);
  EXPECT_TRUE(plc.bit(Device::x, 0x100));
}

TEST(Rack, Y_WrittenOnce_IsOneEdgeAtTheModule) {
  Plc plc;
  plc.bit(Device::y, 0x31, true);
  plc.bit(Device::y, 0x31, true);
  plc.bit(Device::y, 0x31, false);
  EXPECT_THAT(plc.other_module.edges, ElementsAre(Pair(1U, true), Pair(1U, false)));
}

TEST(Rack, Y_WrittenAsWord_SetsSignalsInOrder) {
  Plc plc;
  plc.word(Device::y, 0x30, 0x8006);
  EXPECT_THAT(plc.other_module.edges, ElementsAre(Pair(1U, true), Pair(2U, true), Pair(15U, true)));
}

TEST(Rack, BufferWrite_MovesTheModulesDeadlineInTheTimeline) {
  Plc plc;
  plc.module.wakes_after_write = true;
  const std::array<std::uint16_t, 1> word = {7};
  ASSERT_TRUE(plc.rack.write_buffer(0x00, 10, word, plc.now));
  EXPECT_EQ(plc.timeline.next(), plc.now + 1ms);
  plc.timeline.run_until(plc.now + 1ms);
  EXPECT_THAT(plc.module.ticks, ElementsAre(plc.now + 1ms));
}

TEST(Rack, Buffer_BeyondItsEnd_IsRefusedBeforeAnythingIsWritten) {
  Plc plc;
  const std::array<std::uint16_t, 2> words = {1, 2};
  EXPECT_EQ(error_of(plc.rack.write_buffer(0x30, 511, words, plc.now)), AccessError::beyond_buffer);
  EXPECT_TRUE(plc.other_module.writes.empty());
  EXPECT_EQ(error_of(plc.rack.write_buffer(0x50, 0, words, plc.now)), AccessError::no_module);
}

TEST(Rack, Stop_TellsModulesAndTurnsYOff_RunRestoresThem) {
  Plc plc;
  plc.bit(Device::y, 0x30, true);
  plc.other_module.edges.clear();
  plc.rack.set_cpu_state(CpuState::stop, plc.now);
  EXPECT_THAT(plc.other_module.states, ElementsAre(CpuState::run, CpuState::stop));
  EXPECT_THAT(plc.other_module.edges, ElementsAre(Pair(0U, false)));
  EXPECT_FALSE(plc.bit(Device::y, 0x30));
  plc.rack.set_cpu_state(CpuState::run, plc.now);
  EXPECT_TRUE(plc.bit(Device::y, 0x30));
  EXPECT_THAT(plc.other_module.edges, ElementsAre(Pair(0U, false), Pair(0U, true)));
}

TEST(Rack, Stop_WhenAlreadyStopped_IsToldOnce) {
  Plc plc;
  plc.rack.set_cpu_state(CpuState::stop, plc.now);
  plc.rack.set_cpu_state(CpuState::stop, plc.now);
  EXPECT_THAT(plc.module.states, ElementsAre(CpuState::run, CpuState::stop));
}

TEST(Rack, SpecialRelays_ShowStateAndClocks) {
  Plc plc;
  plc.now += 10ms;  // the first scan is over
  EXPECT_EQ(plc.word(Device::sm, 400) & 0x000F, 0b1001);
  EXPECT_FALSE(plc.bit(Device::sm, 203));
  plc.bit(Device::sm, 400, false);
  EXPECT_TRUE(plc.bit(Device::sm, 400));
  plc.rack.set_cpu_state(CpuState::stop, plc.now);
  EXPECT_TRUE(plc.bit(Device::sm, 203));
  EXPECT_FALSE(plc.bit(Device::sm, 412));
  plc.now += 500ms;
  EXPECT_TRUE(plc.bit(Device::sm, 412));
}

TEST(Rack, Sd203_ShowsRemoteStop) {
  Plc plc;
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0000);
  plc.rack.set_cpu_state(CpuState::stop, plc.now);
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0022);
}

TEST(Rack, Pause_LeavesModulesAndYAlone_AndListenersHearOfIt) {
  struct Listener final : RackListener {
    void supply_changed(bool on, can::Time) override { heard.push_back(on ? "on" : "off"); }
    void cpu_changed(CpuState state, can::Time) override {
      heard.push_back(state == CpuState::run ? "run" : "stop");
    }
    void cpu_paused(bool paused, can::Time) override { heard.push_back(paused ? "pause" : "goes on"); }
    std::vector<std::string> heard;
  } listener;
  Plc plc;
  plc.rack.add_listener(listener);
  plc.bit(Device::y, 0x30, true);
  plc.other_module.edges.clear();
  plc.rack.pause(plc.now);
  plc.rack.pause(plc.now);
  EXPECT_TRUE(plc.rack.is_paused());
  EXPECT_EQ(plc.rack.cpu_state(), CpuState::run);
  plc.rack.set_cpu_state(CpuState::run, plc.now);
  plc.rack.set_cpu_state(CpuState::run, plc.now);
  EXPECT_FALSE(plc.rack.is_paused());
  EXPECT_THAT(listener.heard, ElementsAre("pause", "goes on"));
  EXPECT_THAT(plc.other_module.states, ElementsAre(CpuState::run));
  EXPECT_THAT(plc.other_module.edges, IsEmpty());
  plc.rack.pause(plc.now);
  plc.rack.set_cpu_state(CpuState::stop, plc.now);
  plc.rack.pause(plc.now);
  EXPECT_FALSE(plc.rack.is_paused());
  plc.rack.set_cpu_state(CpuState::run, plc.now);
  EXPECT_THAT(listener.heard, ElementsAre("pause", "goes on", "pause", "stop", "run"));
  plc.rack.pause(plc.now);
  plc.rack.reset_cpu(plc.now);
  EXPECT_FALSE(plc.rack.is_paused());
  plc.rack.power_off(plc.now);
  plc.rack.pause(plc.now);
  EXPECT_FALSE(plc.rack.is_paused());
  EXPECT_THAT(listener.heard,
              ElementsAre("pause", "goes on", "pause", "stop", "run", "pause", "off", "on", "off"));
}

TEST(Rack, Sd203_ShowsWhyTheCpuStopped) {
  Plc plc;
  plc.rack.fail_cpu(plc.now);
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0042);  // by an error
  plc.rack.power_on(plc.now, CpuState::stop);
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0002);  // by the switch
}

TEST(Rack, DevicePoints_OfAnR04Cpu_AreDoubleWordsFromSd260On) {
  Plc plc;
  std::array<std::uint16_t, 50> words{};
  ASSERT_TRUE(plc.rack.read_words(Device::sd, 260, words, plc.now));
  const auto points = [&](unsigned number) { return words[number - 260] | words[number - 259] << 16; };
  EXPECT_EQ(points(260), 12288);   // X
  EXPECT_EQ(points(262), 12288);   // Y
  EXPECT_EQ(points(264), 12288);   // M
  EXPECT_EQ(points(266), 8192);    // B
  EXPECT_EQ(points(268), 2048);    // SB
  EXPECT_EQ(points(270), 2048);    // F
  EXPECT_EQ(points(272), 2048);    // V
  EXPECT_EQ(points(274), 8192);    // L
  EXPECT_EQ(points(276), 0);       // S
  EXPECT_EQ(points(280), 18432);   // D
  EXPECT_EQ(points(282), 8192);    // W
  EXPECT_EQ(points(284), 2048);    // SW
  EXPECT_EQ(points(288), 1024);    // T
  EXPECT_EQ(points(290), 0);       // ST
  EXPECT_EQ(points(292), 512);     // C
  EXPECT_EQ(words[40], 20);        // Z, one word: SD300
  EXPECT_EQ(points(306), 32768);   // ZR
  EXPECT_EQ(points(308), 524288);  // RD
}

TEST(Rack, DevicePoints_OfAQ03Udv_AreWordsFromSd290OnAndDoubleWordsAround) {
  Plc plc(q03udvcpu());
  std::array<std::uint16_t, 26> words{};
  ASSERT_TRUE(plc.rack.read_words(Device::sd, 286, words, plc.now));
  EXPECT_THAT(words, ElementsAre(8192, 0, 8192, 0,                     // M, B
                                 8192, 8192, 8192, 8192, 8192,         // X Y M L B
                                 2048, 2048, 2048, 0,                  // F SB V S
                                 2048, 0, 1024, 12288, 8192, 2048, 0,  // T ST C D W SW
                                 32768, 0, 12288, 0, 8192, 0));        // ZR, D, W
}

TEST(Rack, DevicePoints_ThatAProjectSets_ShowAndHold) {
  CpuModel model = q03udvcpu();
  ASSERT_TRUE(set_device_points(model, "M", 61440));
  ASSERT_TRUE(set_device_points(model, "L", 0));
  ASSERT_TRUE(set_device_points(model, "ZR", 98304));
  Plc plc(model);
  EXPECT_EQ(plc.word(Device::sd, 286), 61440);
  EXPECT_EQ(plc.word(Device::sd, 292), 32768);  // all that this word can show
  EXPECT_EQ(plc.word(Device::sd, 293), 0);
  EXPECT_EQ(plc.word(Device::sd, 306), 0x8000);
  EXPECT_EQ(plc.word(Device::sd, 307), 1);
  plc.bit(Device::m, 61439, true);
  EXPECT_TRUE(plc.bit(Device::m, 61439));
  plc.word(Device::zr, 98303, 7);
  EXPECT_EQ(plc.word(Device::zr, 98303), 7);
  std::array<std::uint16_t, 1> word{};
  EXPECT_EQ(plc.rack.read_words(Device::l, 0, word, plc.now).error(), AccessError::no_device);
  EXPECT_EQ(plc.rack.read_words(Device::zr, 98304, word, plc.now).error(), AccessError::out_of_range);
  EXPECT_EQ(plc.rack.read_words(Device::r, 32768, word, plc.now).error(), AccessError::out_of_range);
}

// A CPU takes the points of a new project, and those that fill its memory to the last word.
TEST(DevicePoints, FitIntoTheCpu_ToTheLastWord) {
  for (const CpuModel* cpu : {&r04cpu(), &q03udvcpu()}) {
    CpuModel model = *cpu;
    EXPECT_TRUE(check_device_points(model));
    for (const std::string_view device : {"M", "L", "F", "V", "B", "SB", "T", "ST", "C", "D", "W", "SW"}) {
      EXPECT_TRUE(set_device_points(model, device, 0)) << device;
    }
    const std::uint32_t inputs_and_outputs = 2 * model.points_of(Device::x) / 16;
    const std::uint32_t left = model.device_words - inputs_and_outputs;
    EXPECT_TRUE(set_device_points(model, "ST", 128));
    ASSERT_TRUE(set_device_points(model, "D", left - 144));  // 128 values, contacts and coils
    EXPECT_TRUE(check_device_points(model));
    ASSERT_TRUE(set_device_points(model, "D", left - 128));
    EXPECT_FALSE(check_device_points(model));
  }
}

TEST(Rack, DevicePoints_WrittenByAClient_StayTheCpus) {
  Plc plc;
  plc.word(Device::sd, 260, 7);
  EXPECT_EQ(plc.word(Device::sd, 260), 12288);
}

TEST(Rack, Clock_OfAnR04Cpu_RunsInBinaryWords) {
  Plc plc;
  using std::chrono::local_days;
  plc.rack.set_clock(local_days{std::chrono::year{2024} / 2 / 28} + 23h + 59min + 58s, plc.now);
  plc.now += 3s;
  std::array<std::uint16_t, 7> words{};
  ASSERT_TRUE(plc.rack.read_words(Device::sd, 210, words, plc.now));
  EXPECT_THAT(words, ElementsAre(2024, 2, 29, 0, 0, 1, 4));
}

TEST(Rack, Clock_OfAQ03Udv_IsBcdInPairs) {
  Plc plc(q03udvcpu());
  using std::chrono::local_days;
  plc.rack.set_clock(local_days{std::chrono::year{2024} / 12 / 31} + 13h + 45min + 59s, plc.now);
  std::array<std::uint16_t, 4> words{};
  ASSERT_TRUE(plc.rack.read_words(Device::sd, 210, words, plc.now));
  EXPECT_THAT(words, ElementsAre(0x2412, 0x3113, 0x4559, 0x2002));
}

/// What every module has, and nothing else.
struct BareModule final : module::Module {
  [[nodiscard]] std::string_view model() const noexcept override { return "BARE"; }
  [[nodiscard]] unsigned points() const noexcept override { return 16; }
  void power_on(can::Time /*now*/) override {}
  void power_off(can::Time /*now*/) override {}
  void cpu_changed(CpuState /*state*/, can::Time /*now*/) override {}
  void set_observer(module::ModuleObserver* /*observer*/) override {}
  void receive(const can::Frame& /*frame*/, can::Time /*now*/) override {}
  void tick(can::Time /*now*/) override {}
};

TEST(Rack, ModuleWithoutBufferMemoryAndSignals_HasNoWords_AndItsPointsReadZero) {
  can::Timeline timeline;
  Rack rack(timeline);
  BareModule module;
  timeline.add(module);
  ASSERT_TRUE(rack.insert(0x20, module));
  rack.power_on({});
  std::array<std::uint16_t, 1> words{};
  EXPECT_EQ(error_of(rack.read_buffer(0x20, 0, words, {})), AccessError::beyond_buffer);
  EXPECT_EQ(error_of(rack.write_buffer(0x20, 0, words, {})), AccessError::beyond_buffer);
  EXPECT_TRUE(rack.write_bits(Device::y, 0x20, std::array<std::uint8_t, 1>{1}, {}));
  ASSERT_TRUE(rack.read_words(Device::x, 0x20, words, {}));
  EXPECT_EQ(words[0], 0);
  EXPECT_EQ(rack.product_list().at(0).product.points, 16U);
}

TEST(Rack, Switched_Off_HasNoModulesAndNoSignals) {
  Plc plc;
  plc.module.x = 1;
  plc.rack.power_off(plc.now);
  EXPECT_EQ(plc.module.power_offs, 1);
  EXPECT_FALSE(plc.bit(Device::x, 0));
  std::array<std::uint16_t, 1> words{};
  EXPECT_FALSE(plc.rack.read_buffer(0, 0, words, plc.now));
}

// Those who go with the CPU hear of it when the modules know and Y are as they will be.
TEST(Rack, Listener_HearsOfSupplyAndCpu) {
  struct Listener final : RackListener {
    void supply_changed(bool on, can::Time) override {
      heard.push_back(on ? "on" : "off");
      EXPECT_EQ(plc->module.power_ons, on ? 2 : 1);
    }
    void cpu_changed(CpuState state, can::Time) override {
      heard.push_back(state == CpuState::run ? "run" : "stop");
      EXPECT_EQ(plc->module.states.back(), state);
      EXPECT_EQ(plc->module.y, state == CpuState::run ? 2U : 0U);
    }
    Plc* plc = nullptr;
    std::vector<std::string> heard;
  } listener;
  Plc plc;
  listener.plc = &plc;
  plc.rack.add_listener(listener);
  const std::array<std::uint8_t, 1> on{1};
  ASSERT_TRUE(plc.rack.write_bits(Device::y, 1, on, plc.now));
  plc.rack.set_cpu_state(CpuState::stop, plc.now);
  plc.rack.set_cpu_state(CpuState::stop, plc.now);
  plc.rack.set_cpu_state(CpuState::run, plc.now);
  EXPECT_THAT(listener.heard, ElementsAre("stop", "run"));
  plc.rack.reset_cpu(plc.now);
  plc.module.y = 0;
  plc.rack.fail_cpu(plc.now);
  EXPECT_THAT(listener.heard, ElementsAre("stop", "run", "off", "on", "stop"));
}

}  // namespace
}  // namespace canopus::plc::rack_test
