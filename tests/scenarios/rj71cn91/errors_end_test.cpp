// Each bit of G29 goes when its cause is gone, and comes again after YF if it is not [RJ71CN91 5.3, 5.5, App. 1 XF and YF,
// App. 2 G29, G39].

#include "canopus/sim/bus/bus.hpp"

#include "scenarios/me3can1_q/layer2_forms.hpp"
#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_errors_end_test {
namespace {

using namespace rj71cn91_presets;
using Codes = std::vector<std::uint16_t>;

const Bytes overrun_message{0x10, 0x81, 0x11, 0, 0, 0, 0, 0};

TEST(Rj71ErrorsEnd, SaveWhileOnline_WithTheRequest_AndWithTheOnlineMode) {
  RecordProperty("spec", "RJ71-BM-023 RJ71-L2-009 RJ71-IO-005");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    s.online().write(22, 1);
    const auto is_there = [&](bool there) {
      s.expect(29, there ? 0x0020 : 0).expect_x(0x0F, there).expect_x(0x1F, false);
      EXPECT_EQ(error_codes(s), there ? Codes{0x1805} : Codes{});
    };
    s.y(0x1F, true).advance(10s);
    is_there(true);
    s.y(0x1F, false);
    is_there(false);
    s.y(0x1F, true);
    is_there(true);
    s.y(0x0F, true);
    is_there(false);
    s.y(0x0F, false);
    is_there(true);  // Y1F is still ON
    s.y(0x0F, true).y(0x1F, false).y(0x0F, false);
    is_there(false);
    s.y(0x1F, true).y(0x03, false);
    is_there(false);  // offline; the request was refused, and is not carried out
    s.advance(10s).expect(22, 1).expect_x(0x1F, false).y(0x1F, false);
    s.save().expect(29, 0);
  }
}

TEST(Rj71ErrorsEnd, Overflow_ASecondAfterTheLastLostFrame_WhenTheQueueHasRoom) {
  RecordProperty("spec", "RJ71-BM-023 RJ71-ERR-002 RJ71-L2TX-014");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(5);
  const auto lose = [&] {
    ++s.controller().overflows;
    s.write(20, 0);
  };
  const auto is_there = [&](bool there) {
    s.expect(29, there ? 0x0100 : 0).expect_x(0x0F, there);
    EXPECT_EQ(error_codes(s), there ? Codes{0x1800} : Codes{});
    EXPECT_EQ(led(s, "ERR"), there ? module::LedPattern::on : module::LedPattern::off);
  };
  lose();
  s.tx(0x085, overrun_message);
  is_there(true);
  s.advance(600ms);
  lose();  // the same overflow: one message
  s.advance(999ms);
  is_there(true);
  s.advance(1ms);
  is_there(false);
  s.no_tx().advance(1h).no_tx();
  lose();
  s.tx(0x085, overrun_message);  // a new one
  s.controller().accepts = false;
  s.advance(5s);
  is_there(true);  // full
  s.controller().accepts = true;
  s.advance(1s);
  is_there(false);
  // YF ends it at once: it was an event.
  lose();
  is_there(true);
  s.y(0x0F, true);
  is_there(false);
  s.y(0x0F, false);
  is_there(false);
  s.ignore_tx();
}

/// What the module sends at a place on a real bus, in the order on the wire.
struct Partner : can::Listener {
  void receive(const can::Frame& frame, can::Time) override { frames.push_back(frame); }
  std::vector<can::Frame> frames;
};

TEST(Rj71ErrorsEnd, ReceiveOverflow_IsReported_WhileTheModuleSendsNothing) {
  RecordProperty("spec", "RJ71-BM-024 RJ71-ERR-002");
  can::Timeline timeline;
  sim::Bus bus("field", 500'000, timeline);
  sim::Port& own = bus.add_port("module");
  sim::Port& other = bus.add_port("partner");
  RamMemory memory;
  const auto module = make_module(rj71cn91, own, memory);
  module->preset_bit_rate(500'000);
  module->preset_node_id(5);
  timeline.add(*module);
  own.connect(*module);
  Partner partner;
  other.connect(partner);
  module->power_on(timeline.now());
  const auto run = [&](can::Duration duration) { timeline.run_until(timeline.now() + duration); };
  const auto g = [&](module::BufferAddress address) { return module->program_read(address, timeline.now()); };
  run(2s);
  other.send(can::data_frame(0x000, Bytes{0x01, 0x05}));
  run(10ms);
  ASSERT_EQ(g(605), 0x05);
  partner.frames.clear();
  const sim::Fault jam{.kind = sim::FaultKind::jam, .ports = {"module"}, .capacity = 3};
  ASSERT_TRUE(bus.set_faults({jam}, 1).has_value());
  const auto receive = [&](unsigned count) {  // its RPDO1
    for (unsigned i = 0; i < count; ++i) other.send(can::data_frame(0x205, Bytes(8, 1)));
    run(100ms);
  };
  receive(3);
  EXPECT_EQ(g(29), 0);
  EXPECT_TRUE(partner.frames.empty());
  receive(1);  // nothing but this frame that is lost
  EXPECT_EQ(g(29), 0x0100);
  EXPECT_TRUE((module->signals()->inputs() >> 0x0F & 1U) != 0);
  ASSERT_EQ(module->module_errors().size(), 1U);
  EXPECT_EQ(module->module_errors()[0].code, 0x1800);
  ASSERT_EQ(partner.frames.size(), 1U);
  EXPECT_EQ(partner.frames[0], can::data_frame(0x085, overrun_message));
  ASSERT_TRUE(bus.set_faults({}, 1).has_value());
  run(2s);
  EXPECT_EQ(g(29), 0);
  EXPECT_EQ(module->signals()->inputs() >> 0x0F & 1U, 0U);
}

TEST(Rj71ErrorsEnd, MessageSlots_WithTheLastErrorCode) {
  RecordProperty("spec", "RJ71-BM-023 RJ71-L2RX-008");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    s.write(parameters(1), {0x101, 0, 0, 0}).write(parameters(42), {0x142, 0, 0, 0}).y(0x03, true);
    for (int i = 0; i < 50; ++i) s.rx(frame(form, 0x101, {}));
    for (int i = 0; i < 50; ++i) s.rx(frame(form, 0x142, {}));
    s.expect(5001, 0x2000).expect(5042, 0x2000).expect(29, 0x8000).expect_x(0x0F, true);
    EXPECT_EQ(error_codes(s), Codes{0x1803});
    s.y(0x0F, true).expect(29, 0).expect_x(0x0F, false);
    EXPECT_EQ(error_codes(s), Codes{});
    s.y(0x0F, false).expect(29, 0x8000).expect_x(0x0F, true);
    EXPECT_EQ(error_codes(s), Codes{0x1803});
    s.write(5001, 0).expect(29, 0x8000).write(5042, 0).expect(29, 0).expect_x(0x0F, false).ignore_tx();
    EXPECT_EQ(error_codes(s), Codes{});
  }
}

TEST(Rj71ErrorsEnd, WrongTime_WhenTheWordsAreATimeAgain_WhoeverWritesThem) {
  RecordProperty("spec", "RJ71-BM-025 RJ71-TIME-004 RJ71-TIME-005");
  const auto set = [](IntelligentScenario& s) { s.y(0x12, true).expect_x(0x12, true).y(0x12, false); };
  IntelligentScenario s(rj71cn91);
  s.power_on();
  s.write(50, {2, 2024, 2, 29, 13, 5, 30});
  set(s);
  s.expect(29, 0);
  const auto find_wrong = [&] {
    s.write(51, {2023, 2, 30});
    set(s);
    s.expect(29, 0x0040).expect(39, 53).expect_x(0x0F, true);
    EXPECT_EQ(error_codes(s), Codes{0x3000});
    EXPECT_EQ(s.plug_in().module_errors()[0].details[0].value, 53U);
  };
  find_wrong();
  s.y(0x0F, true).expect(29, 0).expect(39, 0).y(0x0F, false);
  s.expect(29, 0x0040).expect(39, 53).expect_x(0x0F, true);  // the words are still no date
  EXPECT_EQ(error_codes(s), Codes{0x3000});
  s.y(0x13, true).expect(51, {2024, 2, 29}).y(0x13, false);  // the clock's own are over them
  s.expect(29, 0).expect_x(0x0F, false);
  EXPECT_EQ(error_codes(s), Codes{});
  s.y(0x0F, true).y(0x0F, false).expect(29, 0).expect(39, 0);
  find_wrong();
  s.write(53, 31).expect(29, 0x0040).write(52, 1).expect(29, 0);  // another word than the one of G39
  find_wrong();
  s.write(51, {2024, 2, 29}).expect(29, 0);
  set(s);
  s.expect(29, 0);
  find_wrong();
  s.write(50, 1);
  set(s);  // a consumer's words do not count
  s.expect(29, 0).y(0x0F, true).y(0x0F, false).expect(29, 0).ignore_tx();
}

TEST(Rj71ErrorsEnd, G39_HasTheFirstWord_UntilYf_OrTheNextError) {
  RecordProperty("spec", "RJ71-BM-011 RJ71-BM-010");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  s.write(27, 0).expect(29, 0x0040).expect(39, 27).expect(27, 127);
  s.write(24, 99).expect(39, 27);  // the first one
  s.write(27, 5).write(24, 250).expect(29, 0).expect(39, 27);
  s.write(71, 49).expect(29, 0x0040).expect(39, 71);  // G29.6 was OFF: this one turns it ON
  s.y(0x0F, true).expect(39, 0).y(0x0F, false).expect(29, 0x0040).expect(39, 71);
  s.write(71, 50).expect(29, 0).expect(39, 71).y(0x0F, true).y(0x0F, false).expect(39, 0);
  // The factory settings are good ones.
  s.write(70, 1).write(59, 61).expect(29, 0x0040).expect(39, 59);
  s.save(2).expect(29, 0).expect(70, 500).y(0x0F, true).y(0x0F, false).expect(29, 0).expect(39, 0);
}

TEST(Rj71ErrorsEnd, BadSetting_KeepsLayer2Offline_UntilTheWordHasAGoodOne) {
  RecordProperty("spec", "RJ71-L2-010 RJ71-ERR-003 RJ71-L2-003");
  for (const Layer2Form& form : layer2_forms) {
    const std::uint16_t too_high = form.mode == 11 ? 0x0800 : 0x2000;
    struct Bad {
      module::BufferAddress address;
      std::uint16_t value, good;
    };
    for (const Bad& bad : {Bad{24, 99, 125}, Bad{6002, 5, 1}, Bad{6001, too_high, 0x6FFF}, Bad{8452, 9, 8},
                           Bad{form.mode == 11 ? 10000U : 10001U, too_high, 0x0010}, Bad{10002, 9, 7}}) {
      IntelligentScenario s(rj71cn91);
      s.power_on_layer2(form.mode);
      set_transmit(s, 1, 0x111);
      const std::uint16_t before = s.read(bad.address);
      s.write(bad.address, bad.value).expect(29, 0x0040).expect(39, static_cast<std::uint16_t>(bad.address));
      s.expect(bad.address, before);  // the module has put the last good one in its place
      const auto stays_offline = [&] {
        s.y(0x03, true).expect_x(0x03, false).expect(29, 0x0040).expect(37, 0).advance(1s).no_tx();
        EXPECT_EQ(error_codes(s), Codes{0x3000}) << bad.address;
        s.y(0x03, false);
      };
      stays_offline();
      s.y(0x0F, true).y(0x0F, false);
      stays_offline();
      s.write(bad.address, bad.good).expect(29, 0).y(0x03, true).expect_x(0x03, true).expect(29, 0);
      EXPECT_EQ(s.controller().sent.size(), 1U) << bad.address;
      s.ignore_tx();
    }
    // The function mode is no setting of Y3, nor is a slot's error code.
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    s.write(21, 7).write(5001, 1).expect(29, 0x0040).y(0x03, true).expect_x(0x03, true).ignore_tx();
  }
}

TEST(Rj71ErrorsEnd, SettingsThatDoNotGoTogether_WhenTheyDo) {
  RecordProperty("spec", "RJ71-BM-025 RJ71-L2TX-011");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_transmit(s, 1, 0x111);
    set_transmit(s, 2, 0x111);
    s.y(0x03, true).expect_x(0x03, false).expect(29, 0x0040);
    const std::uint16_t address = s.read(39);
    s.y(0x0F, true).expect(29, 0).y(0x0F, false).expect(29, 0x0040).expect(39, address);
    // The other slot of the two than G39 names.
    s.write(address == 10000 ? 10007 : 10000, 0x112).expect(29, 0).expect_x(0x0F, false);
    s.y(0x0F, true)
        .y(0x0F, false)
        .expect(29, 0)
        .y(0x03, false)
        .y(0x03, true)
        .expect_x(0x03, true)
        .ignore_tx();
  }
}

TEST(Rj71ErrorsEnd, WatchdogError_IsShown_AndNothingElseWorks) {
  RecordProperty("spec", "RJ71-BM-021 RJ71-IO-001 RJ71-IO-004");
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    IntelligentScenario s(rj71cn91);
    mode == 405 ? s.power_on_as(5) : s.power_on_layer2(mode);
    if (mode == 405) s.set_object(0x1017, 0, 100, 2).nmt(0x01, 5).ignore_tx();
    if (mode != 405) {
      set_transmit(s, 1, 0x111, 0x5FFF, 2);
      s.online();
    }
    s.plug_in().inject(module::ModuleFault::watchdog_error, s.now());
    const auto is_shown = [&] {
      s.expect(29, 0x0002).expect_x(0x0F, true).expect_x(0x00, false).expect_x(0x03, false);
      EXPECT_EQ(error_codes(s), Codes{0x3C02});
      EXPECT_EQ(s.plug_in().module_errors()[0].error_class, module::ErrorClass::major);
      EXPECT_EQ(led(s, "RUN"), module::LedPattern::off);
      EXPECT_EQ(led(s, "ERR"), module::LedPattern::off);
    };
    is_shown();
    // On the bus it is silent, words and requests are not taken, errors not cleared.
    s.advance(10s).rx(0x605, {0x40, 0, 0x10, 0, 0, 0, 0, 0}).rx(0x000, {0x82, 0x00}).advance(10s).no_tx();
    const std::uint16_t before = s.read(20);
    s.write(20, 0x1000).expect(20, before).write(1000, {0x0004, 0, 0x1000, 0});
    for (const unsigned number : {0x01U, 0x02U, 0x0FU, 0x17U, 0x1FU})
      s.y(number, true).advance(10s).expect_x(number, number == 0x0F).y(number, false);
    is_shown();
    s.cpu(module::CpuState::stop).cpu(module::CpuState::run).advance(10s).no_tx();
    s.supply_off().expect_x(0x0F, false);
    s.power_on();
    s.expect(29, 0).expect_x(0x00, true).expect_x(0x0F, false);
    EXPECT_EQ(error_codes(s), Codes{});
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_errors_end_test
