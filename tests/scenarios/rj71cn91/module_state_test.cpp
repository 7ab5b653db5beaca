// Defaults, counters, hardware and flash memory, what the CPU is shown of them [RJ71CN91 5.1 to 5.6, App. 2].

#include "canopus/module/engine/module_settings.hpp"
#include "canopus/module/models/rj71cn91/buffer_table.hpp"
#include "canopus/module/storage/flash_memory.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_module_state_test {
namespace {

using namespace rj71cn91_presets;

using module::LedPattern;

TEST(Rj71Module, Start_BringsEveryWordToItsDefault_OrItsSavedValue) {
  RecordProperty("spec", "RJ71-BM-001 RJ71-BM-009");
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    IntelligentScenario s(rj71cn91);
    s.power_on();
    s.write(21, mode);
    s.save();
    s.restart();
    const module::Modes bit = mode == 405 ? 1 : mode == 11 ? 2 : 4;
    std::map<module::BufferAddress, std::uint16_t> before;
    for (const auto& row : module::rj71cn91::buffer_table) {
      if ((row.modes & bit) == 0) continue;
      for (auto address = row.first; address <= row.last; address += row.stride)
        before[address] = s.read(address);
    }
    EXPECT_EQ(before[38], 875);
    s.write(24, 500);
    if (mode == 405) s.write(70, 1234).write(59, 7);
    if (mode != 405) s.write(8450, 0x111);
    s.save();
    before[24] = 500;
    if (mode == 405) before[70] = 1234, before[59] = 7, before[37] = 5000;
    if (mode != 405) before[8450] = 0x111;
    unsigned changed = 0;
    for (const auto& [address, value] : before) {
      if (address == 22 || address == 21) continue;
      s.write(address, address == 24 ? 125 : address == 27 ? 5 : address == 50 ? 2 : 1);
      if (address == 38) s.expect(38, 875);  // shows, takes nothing
      changed += s.read(address) != value ? 1U : 0U;
    }
    EXPECT_GT(changed, mode == 405 ? 1000U : 250U);
    s.supply_off();
    s.controller().sent.clear();
    s.power_on();
    for (const auto& [address, value] : before) {
      if (address == 25) continue;
      EXPECT_EQ(s.read(address), value) << "mode " << mode << " G" << address;
    }
  }
}

TEST(Rj71Module, FlashMemory_WornAt100000Writes_Is1080H) {
  RecordProperty("spec", "RJ71-BM-006");
  IntelligentScenario s(rj71cn91);
  {  // one that has been written 99999 times
    module::FlashMemory flash(s.flash(), {module::ModuleSettings::objects_name});
    while (flash.writes() < 99'999) flash.write(module::ModuleSettings::objects_name, {});
  }
  s.power_on();
  EXPECT_EQ(s.plug_in().flash_writes(), 99'999U);
  s.store_objects();
  EXPECT_EQ(error_codes(s), (std::vector<std::uint16_t>{}));
  s.store_objects();
  ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x1080}));
  EXPECT_EQ(s.plug_in().module_errors()[0].error_class, module::ErrorClass::minor);
  EXPECT_EQ(led(s, "ERR"), LedPattern::on);
  s.expect(29, 0);
  s.set_object(0x1017, 0, 700, 2).store_objects();
  s.restart();
  s.expect_object(0x1017, 0, 700, 2).ignore_tx();  // it goes on
}

TEST(Rj71Module, DamagedFlash_IsG29_4_And3001H_UntilSavedAndRestarted) {
  RecordProperty("spec", "RJ71-BM-020");
  for (const bool by_words : {true, false}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(5);
    s.store_objects();
    s.supply_off();
    auto& blob = s.flash().blobs[std::string(by_words ? module::ModuleSettings::words_name
                                                      : module::ModuleSettings::objects_name)];
    blob.state = module::NonVolatileMemory::Content::State::damaged;
    s.controller().sent.clear();
    s.power_on();
    s.expect_bit(29, 4, true).expect_x(0x0F, true);
    ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x3001}));
    EXPECT_EQ(s.plug_in().module_errors()[0].error_class, module::ErrorClass::moderate);
    EXPECT_EQ(led(s, "ERR"), LedPattern::blinking);
    s.y(0x0F, true).expect(29, 0).y(0x0F, false).expect_bit(29, 4, true);  // its cause is there
    s.save();
    s.store_objects();
    s.restart();
    s.expect(29, 0).expect_x(0x0F, false);
    EXPECT_EQ(error_codes(s), (std::vector<std::uint16_t>{}));
  }
  IntelligentScenario s(rj71cn91);  // the supply goes off while it is written
  s.power_on();
  s.write(22, 1).y(0x1F, true).supply_off().y(0x1F, false);
  s.power_on();
  s.expect(29, 0x0010);
  EXPECT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x3001}));
}

TEST(Rj71Module, HardwareError_IsG29_1_3C00H_Watchdog_3C02H) {
  RecordProperty("spec", "RJ71-BM-021 RJ71-IO-001");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(5);
  s.expect_x(0x00, true);
  s.plug_in().inject(module::ModuleFault::hardware_error, s.now());
  s.expect(29, 0x0002).expect_x(0x0F, true).expect_x(0x00, false);
  ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x3C00}));
  EXPECT_EQ(s.plug_in().module_errors()[0].error_class, module::ErrorClass::major);
  EXPECT_EQ(s.plug_in().module_errors()[0].details[0].name, "Cause type code");
  s.y(0x0F, true).expect(29, 0x0002).y(0x0F, false).expect(29, 0x0002).ignore_tx();
  s.supply_off();
  s.power_on();
  s.expect(29, 0).expect_x(0x00, true);
  s.plug_in().inject(module::ModuleFault::watchdog_error, s.now());
  s.expect_x(0x00, false);
  EXPECT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x3C02}));
}

TEST(Rj71Module, CanErr_OneCauseAtATime) {
  RecordProperty("spec", "RJ71-LED-002");
  const auto shows = [](IntelligentScenario& s, LedPattern pattern) {
    EXPECT_EQ(led(s, "CAN ERR"), pattern);
  };
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  shows(s, LedPattern::off);
  s.error_counters(96, 0);
  shows(s, LedPattern::single_flash);
  s.error_counters(0, 0);
  s.write(27, 0);  // G29.6
  shows(s, LedPattern::blinking);
  s.write(27, 1);
  shows(s, LedPattern::off);
  s.set_object(0x1016, 1, 0x00050064, 4)
      .rx(0x705, {0x05})
      .advance(100ms)
      .ignore_tx();  // a heartbeat is missing
  shows(s, LedPattern::double_flash);
  s.y(0x10, true).y(0x10, false);
  shows(s, LedPattern::off);
  s.set_object(0x100C, 0, 100, 2).set_object(0x100D, 0, 2, 1).rx_remote(0x701, 1).advance(100ms).ignore_tx();
  shows(s, LedPattern::double_flash);  // the master's guarding
  s.y(0x10, true).y(0x10, false).error_counters(256, 0).ignore_tx();
  shows(s, LedPattern::on);
  s.supply_off();
  shows(s, LedPattern::off);
}

/// Counts on the bus itself: alone, and with faults that destroy what it sends and receives.
TEST(Rj71Module, ErrorCounters_UpBy8_DownBy1) {
  RecordProperty("spec", "RJ71-BM-012");
  can::Timeline timeline;
  sim::Bus bus("field", 500'000, timeline);
  sim::Port& own = bus.add_port("module");
  sim::Port& partner = bus.add_port("partner");
  RamMemory memory;
  const auto module = make_module(rj71cn91, own, memory);
  module->preset_bit_rate(500'000);
  module->preset_node_id(1);
  timeline.add(*module);
  own.connect(*module);
  struct Deaf : can::Listener {
    void receive(const can::Frame&, can::Time) override {}
  } deaf;
  partner.connect(deaf);
  module->power_on(timeline.now());
  const auto run = [&](can::Duration duration) { timeline.run_until(timeline.now() + duration); };
  const auto g = [&](module::BufferAddress address) { return module->program_read(address, timeline.now()); };
  const auto disturb = [&](const char* sender, unsigned count) {
    sim::Fault fault{.kind = sim::FaultKind::corrupt, .bit = 20};
    fault.sender = sender;
    if (fault.sender == "partner") fault.receiver = "module";
    fault.count = count;
    ASSERT_TRUE(bus.set_faults(count == 0 ? std::vector<sim::Fault>{} : std::vector{fault}, 1).has_value());
  };
  run(2s);
  EXPECT_EQ(g(35), 0);
  EXPECT_EQ(g(36), 0);
  disturb("partner", 1);
  partner.send(can::data_frame(0x300, Bytes{1}));
  run(10ms);
  const std::uint16_t after_one = g(36);
  EXPECT_EQ(after_one,
            8);  // 1 for what it saw, 8 for the answer to its error flag, less 1 for the repetition
  for (std::uint16_t good = 1; good <= after_one; ++good) {
    partner.send(can::data_frame(0x300, Bytes{1}));
    run(10ms);
    EXPECT_EQ(g(36), after_one - good);
  }
  // What it sends itself: 8 for each error, 1 less for each frame that arrives.
  disturb("module", 5);
  const auto read_own = [&](std::uint16_t node) {  // a request to a node that is not there: one frame
    module->write_word(1000, 0x0004, timeline.now());
    module->write_word(1001, node, timeline.now());
    module->write_word(1002, 0x1000, timeline.now());
    module->signals()->set_output(0x17, true, timeline.now());
    run(10ms);
  };
  read_own(9);
  EXPECT_EQ(g(35), 5 * 8 - 1);
  EXPECT_EQ(g(25) & 2, 0);
  disturb("module", 0);
  run(1s);  // the abort that ends the request is another good frame
  EXPECT_EQ(g(35), 5 * 8 - 2);
  module->signals()->set_output(0x17, false, timeline.now());
  // Without end: passive from 128 on; the counter stands at 256 when it is bus-off.
  disturb("module", 1'000'000);
  read_own(9);
  run(1s);
  EXPECT_EQ(g(35), 256);
  EXPECT_EQ(g(36), 256);
  EXPECT_EQ(g(29), 0x0008);
}

TEST(Rj71Diagnostics, EveryEvent_Comes_AndY10AndY11KeepTheirs) {
  RecordProperty("spec", "RJ71-DIAG-004");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x00050064, 4);
  s.write(400, 5).y(0x10, true);
  std::size_t seen = s.plug_in().event_history().size();
  s.rx(0x705, {0x05}).advance(100ms).ignore_tx().expect_x(0x10, false);
  EXPECT_EQ(event_codes(s, seen), (std::vector<std::uint16_t>{}));
  s.y(0x10, false).rx(0x705, {0x05}).ignore_tx();
  seen = s.plug_in().event_history().size();
  s.advance(100ms).ignore_tx();
  EXPECT_EQ(event_codes(s, seen), (std::vector<std::uint16_t>{0x0412}));
  s.y(0x11, true);
  seen = s.plug_in().event_history().size();
  s.rx(0x085, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0});
  EXPECT_EQ(event_codes(s, seen), (std::vector<std::uint16_t>{}));
  s.y(0x11, false).rx(0x085, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0});
  EXPECT_EQ(event_codes(s, seen), (std::vector<std::uint16_t>{0x0410}));
  for (const auto& record : s.plug_in().event_history()) EXPECT_FALSE(record.overview.empty()) << record.code;
  // It has room for 128; the oldest go.
  for (unsigned times = 0; times < 200; ++times) s.y(0x0F, true).y(0x0F, false);
  const auto codes = event_codes(s);
  EXPECT_EQ(codes.size(), 128U);
  EXPECT_EQ(codes.front(), 0x0408);
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_module_state_test
