// spec/me3can1-q/scenarios.md, section 10: the module as LSS master (S76) [ME3CAN1-Q 4.8.11].

#include <fstream>
#include <iterator>

#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/device/device.hpp"

#include "paths.hpp"
#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_lss_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Lss);

using module::Led;
using module::LedPattern;

constexpr std::uint32_t mandatory = 0x0D;  // 1F81H: assigned, boot slave, mandatory
constexpr unsigned lss_active = 10;        // bit of G25
constexpr unsigned start_up = 14;
constexpr unsigned nmt_master = 15;

enum Which : std::size_t { can_run = 2, can_error = 4 };

struct Object {
  std::uint16_t index;
  std::uint8_t sub;
  std::uint32_t value;
};

/// S76: node 5 is mandatory and its identity known; the boot time is 10 s.
const std::vector<Object> s76{{0x1F80, 0, 0x00000001}, {0x1F81, 5, mandatory},  {0x1F84, 5, 0x000F0191},
                              {0x1F85, 5, 0x00000071}, {0x1F86, 5, 0x0000ED63}, {0x1F87, 5, 0x00010000},
                              {0x1F88, 5, 0x12345678}, {0x1F89, 0, 10000}};

void preset(module::ModuleEngine& module, const std::vector<Object>& objects) {
  EXPECT_TRUE(module.preset_word(27, 1));
  for (const Object& object : objects) {
    EXPECT_EQ(module.preset_object(object.index, object.sub, canopen::little_endian(object.value, 4)),
              canopen::AbortCode::none);
  }
}

/// Node 1 with these objects: switched on, the network reset.
void boot(IntelligentScenario& s, const std::vector<Object>& objects, Where where = Where::current()) {
  preset(s.plug_in(), objects);
  s.supply_on().wait_tx(0x701, {0x00}, 20s, where).tx(0x000, {0x82, 0x00}, where);
}

std::vector<Object> without(std::vector<Object> objects, std::uint16_t index) {
  std::erase_if(objects, [&](const Object& object) { return object.index == index; });
  return objects;
}

const Bytes vendor{0x40, 0x71, 0, 0, 0, 0, 0, 0};
const Bytes product{0x41, 0x63, 0xED, 0, 0, 0, 0, 0};
const Bytes revision{0x42, 0, 0, 0x01, 0, 0, 0, 0};
const Bytes serial{0x43, 0x78, 0x56, 0x34, 0x12, 0, 0, 0};
const Bytes selected{0x44, 0, 0, 0, 0, 0, 0, 0};
const Bytes waiting_state{0x04, 0, 0, 0, 0, 0, 0, 0};

void asks_for_the_slave(IntelligentScenario& s, Where where = Where::current()) {
  s.wait_tx(0x7E5, vendor, 20s, where).wait_tx(0x7E5, product, 20s, where);
  s.wait_tx(0x7E5, revision, 20s, where).wait_tx(0x7E5, serial, 20s, where);
}

/// From the reset of the network to the first frame of the search.
void boot_time_passes(IntelligentScenario& s, can::Duration boot_time = 10s, Where where = Where::current()) {
  s.advance(boot_time - 1ms).ignore_tx().expect_bit(25, lss_active, false, where);
  s.expect_bit(25, start_up, true, where);
  s.advance(1ms);
}

Led led(IntelligentScenario& s, Which which) { return s.plug_in().leds(s.now())[which]; }

TEST_P(Lss, S76_MandatorySlaveMissing_IsSelectedByItsIdentity_AndGetsNodeIdAndBitRate) {
  spec("ME3-LSS-002 ME3-LSS-003 ME3-LSS-004", "RJ71-LSS-002 RJ71-LSS-003 RJ71-LSS-004");
  IntelligentScenario s(GetParam());
  boot(s, s76);
  boot_time_passes(s);
  s.expect_bit(25, lss_active, true).expect_bit(25, nmt_master, true);
  asks_for_the_slave(s);
  s.no_tx().rx(0x7E4, selected);
  s.tx(0x7E5, {0x11, 0x05, 0, 0, 0, 0, 0, 0}).no_tx().rx(0x7E4, {0x11, 0, 0, 0, 0, 0, 0, 0});
  s.tx(0x7E5, {0x13, 0x00, 0x03, 0, 0, 0, 0, 0}).no_tx();  // 250 kbit/s, the module's own
  s.rx(0x7E4, {0x13, 0, 0, 0, 0, 0, 0, 0});
  s.tx(0x7E5, {0x17, 0, 0, 0, 0, 0, 0, 0}).no_tx().rx(0x7E4, {0x17, 0, 0, 0, 0, 0, 0, 0});
  s.tx(0x7E5, waiting_state).expect_bit(25, lss_active, true).expect_bit(405, 4, false);
  s.advance(10ms).expect_bit(25, lss_active, false);
  // The start-up has failed [RJ71CN91 1.2 NMT start-up; notes B11]: a restart boots the slave.
  s.expect_bit(25, start_up, false).expect_bit(405, 4, true).expect_x(0x10, true);
  s.rx(0x705, {0x00}).advance(5s).no_tx();
  EXPECT_EQ(s.controller().rate, 250'000U);

  s.y(0x02, true).wait_x(0x02, true).y(0x02, false);
  s.ignore_tx().rx(0x705, {0x00}).tx(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.rx(0x585, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
  const std::uint32_t identity[] = {0x71, 0xED63, 0x00010000, 0x12345678};
  for (std::uint8_t sub = 1; sub <= 4; ++sub) {
    s.tx(0x605, {0x40, 0x18, 0x10, sub, 0, 0, 0, 0});
    Bytes answer{0x43, 0x18, 0x10, sub};
    for (const std::uint8_t byte : canopen::little_endian(identity[sub - 1], 4)) answer.push_back(byte);
    s.rx(0x585, answer);
  }
  if (is_rj71cn91()) s.no_tx().advance(500ms);  // G70
  s.tx(0x000, {0x01, 0x05}).expect_bit(25, 0, true).expect_bit(405, 4, false).no_tx();
}

TEST_P(Lss, S76_NotFoundAtTheOwnRate_TheOthersAreTried_AndTheFoundSlaveChangesOver) {
  spec("ME3-LSS-005 ME3-LSS-004", "RJ71-LSS-005 RJ71-LSS-004");
  IntelligentScenario s(GetParam());
  boot(s, s76);
  const can::Time reset = s.now();
  s.set_object(0x1017, 0, 50, 2);  // its heartbeat
  boot_time_passes(s, reset + 10s - s.now());
  s.ignore_tx();
  // 1 M, 800 k, 500 k: nobody. Off its network the module sends nothing but LSS.
  for (const std::uint32_t rate : {1'000'000U, 800'000U, 500'000U}) {
    for (int i = 0; i < 1000 && s.controller().rate != rate; ++i) s.advance(1ms).ignore_tx();
    ASSERT_EQ(s.controller().rate, rate);
    asks_for_the_slave(s);
    s.expect_bit(25, lss_active, true).expect(37, 2500);
    // What the controller meets there is no error of the module's own network.
    s.error_counters(256, 0).expect(29, 0).error_counters(130, 0).expect(29, 0).error_counters(0, 0);
    s.advance(90ms).no_tx();
  }
  for (int i = 0; i < 1000 && s.controller().rate != 125'000; ++i) s.advance(1ms);
  asks_for_the_slave(s);
  s.rx(0x7E4, selected).tx(0x7E5, {0x11, 0x05, 0, 0, 0, 0, 0, 0});
  s.rx(0x7E4, {0x11, 0, 0, 0, 0, 0, 0, 0}).tx(0x7E5, {0x13, 0x00, 0x03, 0, 0, 0, 0, 0});
  s.rx(0x7E4, {0x13, 0, 0, 0, 0, 0, 0, 0}).tx(0x7E5, {0x17, 0, 0, 0, 0, 0, 0, 0});
  s.rx(0x7E4, {0x17, 0, 0, 0, 0, 0, 0, 0}).tx(0x7E5, {0x15, 0x64, 0x00, 0, 0, 0, 0, 0});  // 100 ms
  EXPECT_EQ(s.controller().rate, 125'000U);
  s.advance(101ms).no_tx();  // the device waits as long from the end of the frame on
  EXPECT_EQ(s.controller().rate, 125'000U);
  s.advance(20ms);
  EXPECT_EQ(s.controller().rate, 250'000U);
  s.ignore_tx();  // its heartbeats are on the network again
  s.expect_bit(25, lss_active, true);
  for (int i = 0; i < 200 && (s.read(25) >> lss_active & 1) != 0; ++i) s.advance(1ms);
  s.expect_bit(25, lss_active, false).expect_bit(405, 4, true);
  EXPECT_EQ(s.controller().rate, 250'000U);
  s.ignore_tx();
}

TEST_P(Lss, S76_NowhereToBeFound_EveryOtherRateIsTriedOnce_AndTheOwnOneComesBack) {
  spec("ME3-LSS-005 ME3-STAT-008", "RJ71-LSS-005 RJ71-LSS-007");
  IntelligentScenario s(GetParam());
  boot(s, s76);
  boot_time_passes(s);
  std::vector<std::uint32_t> rates;
  unsigned asked = 0;
  while ((s.read(25) >> lss_active & 1) != 0 && s.now() < can::Time(60s)) {
    if (rates.empty() || rates.back() != s.controller().rate) rates.push_back(s.controller().rate);
    for (const can::Frame& frame : s.controller().sent) asked += frame.data[0] == 0x43 ? 1 : 0;
    s.ignore_tx().advance(1ms);
  }
  EXPECT_EQ(rates, (std::vector<std::uint32_t>{250'000, 1'000'000, 800'000, 500'000, 125'000, 50'000, 20'000,
                                               10'000}));
  EXPECT_EQ(asked, 8U);
  EXPECT_EQ(s.controller().rate, 250'000U);
  s.expect_bit(25, start_up, false).expect_bit(405, 4, true).expect_x(0x10, true);
  s.ignore_tx().advance(20s).no_tx();
  // Back on its network it answers, and its command interface asks.
  s.rx(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}).tx(0x581, {0x43, 0x00, 0x10, 0x00, 0x95, 0x01, 0, 0});
  s.write(1000, {0x0004, 3, 0x1000, 0}).y(0x17, true).advance(1ms);
  s.tx(0x603, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}).rx(0x583, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0});
  s.expect(1000, {0x0005, 3, 0x1000, 0, 4, 0x0191, 0x000F}).expect_x(0x17, true).no_tx();
}

TEST(Me3Lss, TheTwoLedsFlickerAlternately_AndG25_10_IsOn_OnlyWhileItSearches) {
  RecordProperty("spec", "ME3-LSS-006 ME3-STAT-008 ME3-LED-007");
  IntelligentScenario s;
  boot(s, s76);
  boot_time_passes(s);
  s.expect(25, 0xC500);
  EXPECT_EQ(led(s, can_run).pattern, LedPattern::flickering);
  EXPECT_EQ(led(s, can_error).pattern, LedPattern::flickering);
  for (int i = 0; i < 20; ++i) {
    EXPECT_NE(module::is_lit(led(s, can_run), s.now()), module::is_lit(led(s, can_error), s.now()));
    const bool was_lit = module::is_lit(led(s, can_run), s.now());
    s.advance(50ms);
    if ((s.read(25) >> lss_active & 1) == 0) break;
    EXPECT_NE(module::is_lit(led(s, can_run), s.now()), was_lit);
  }
  for (int i = 0; i < 5000 && (s.read(25) >> lss_active & 1) != 0; ++i) s.advance(1ms);
  s.expect(25, 0x8100);
  EXPECT_EQ(led(s, can_run).pattern, LedPattern::blinking);
  EXPECT_EQ(led(s, can_error).pattern, LedPattern::double_flash);  // G405.4: the start-up failed
  s.ignore_tx();
}

TEST_P(Lss, OneConditionMissing_NoSearch_TheStartUpFailsAtOnce) {
  spec("ME3-LSS-002 ME3-LSS-007 ME3-ID-003", "RJ71-LSS-002 RJ71-LSS-006");
  for (std::uint16_t index = 0x1F84; index <= 0x1F88; ++index) {
    SCOPED_TRACE(index);
    IntelligentScenario s(GetParam());
    boot(s, without(s76, index));
    s.advance(9999ms).ignore_tx().expect_bit(25, start_up, true).expect_bit(405, 4, false);
    s.advance(1ms).expect_bit(25, lss_active, false).expect_bit(25, start_up, false).expect_bit(405, 4, true);
    s.ignore_tx().advance(5s).no_tx();
    EXPECT_EQ(s.controller().rate, 250'000U);
  }
  // 1F81H/5 without bit 3: optional, asked for ever. Without bit 2: not booted. 1F89H = 0: no boot time.
  // Without bit 0: no slave at all.
  for (const auto& [index, sub, value] :
       {Object{0x1F81, 5, 0x05}, Object{0x1F81, 5, 0x09}, Object{0x1F81, 5, 0x0C}, Object{0x1F89, 0, 0}}) {
    SCOPED_TRACE(value);
    auto objects = without(s76, index);
    objects.push_back({index, sub, value});
    IntelligentScenario s(GetParam());
    boot(s, objects);
    for (int i = 0; i < 20; ++i) {
      s.advance(1s).expect_bit(25, lss_active, false);
      for (const can::Frame& frame : s.controller().sent) EXPECT_NE(frame.identifier, 0x7E5U);
      s.ignore_tx();
    }
  }
}

TEST_P(Lss, SerialNumberDeletedAfterwards_NoUnwantedStart) {
  spec("ME3-LSS-007", "RJ71-LSS-006");
  IntelligentScenario s(GetParam());
  boot(s, s76);
  s.advance(1s).ignore_tx();
  s.set_object(0x1F88, 5, 0, 4);
  s.advance(9s).ignore_tx().expect_bit(25, start_up, false).expect_bit(405, 4, true);
  s.expect_bit(25, lss_active, false).advance(5s).no_tx();

  IntelligentScenario found(
      GetParam());  // after a search that found it; stored, so that no later start searches
  boot(found, s76);
  boot_time_passes(found);
  asks_for_the_slave(found);
  found.rx(0x7E4, selected).rx(0x7E4, {0x11, 0, 0, 0, 0, 0, 0, 0});
  found.rx(0x7E4, {0x13, 0, 0, 0, 0, 0, 0, 0}).rx(0x7E4, {0x17, 0, 0, 0, 0, 0, 0, 0}).advance(10ms);
  found.ignore_tx().expect_bit(25, lss_active, false);
  found.set_object(0x1F88, 5, 0, 4);
  found.store_objects().restart();
  for (int second = 0; second < 30; ++second) {
    found.advance(1s).expect_bit(25, lss_active, false);
    for (const can::Frame& frame : found.controller().sent) EXPECT_NE(frame.identifier, 0x7E5U);
    found.ignore_tx();
  }
  found.expect_bit(405, 4, true);
}

TEST_P(Lss, SlaveThatAnswered_IsNotMissing) {
  spec("ME3-LSS-003", "RJ71-LSS-003");
  IntelligentScenario s(GetParam());
  auto objects = s76;
  objects.push_back({0x1016, 1, 0x000503E8});  // booted when its heartbeat comes: it does not
  boot(s, objects);
  s.rx(0x705, {0x00}).ignore_tx().rx(0x585, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
  s.advance(20s);
  for (const can::Frame& frame : s.controller().sent) EXPECT_NE(frame.identifier, 0x7E5U);
  s.expect_bit(25, lss_active, false).expect_bit(405, 4, true).ignore_tx();
}

TEST_P(Lss, MasterOnly_NeverAnswersAsASlave_AndSearchesOnlyAsTheActiveMaster) {
  spec("ME3-LSS-001", "RJ71-LSS-001");
  const auto receive_from_a_master = [](IntelligentScenario& s) {
    s.rx(0x7E5, {0x04, 0x01, 0, 0, 0, 0, 0, 0});
    s.rx(0x7E5, {0x5A, 0, 0, 0, 0, 0, 0, 0}).rx(0x7E5, {0x5E, 0, 0, 0, 0, 0, 0, 0});
    s.rx(0x7E5, {0x11, 0x20, 0, 0, 0, 0, 0, 0}).rx(0x7E5, {0x17, 0, 0, 0, 0, 0, 0, 0});
    s.rx(0x7E5, {0x04, 0x00, 0, 0, 0, 0, 0, 0});
    s.rx(0x7E5, {0x4C, 0, 0, 0, 0, 0, 0, 0}).rx(0x7E5, {0x51, 0, 0, 0, 0, 0x80, 0, 0});
    s.advance(1s).no_tx();
  };
  IntelligentScenario slave(GetParam());
  slave.power_on_as(1);
  receive_from_a_master(slave);
  EXPECT_EQ(slave.plug_in().node().node_id(), 1);

  IntelligentScenario not_active(GetParam());  // all of S76, but 1F80H bit 0 is 0
  preset(not_active.plug_in(), without(s76, 0x1F80));
  not_active.supply_on().wait_tx(0x701, {0x00});
  receive_from_a_master(not_active);
  not_active.advance(30s).no_tx().expect_bit(25, lss_active, false);
}

TEST_P(Lss, NmtResetOrRestartInTheMiddle_TheOwnRateComesBack) {
  spec("ME3-LSS-005", "RJ71-LSS-005");
  for (const bool restart : {false, true}) {
    IntelligentScenario s(GetParam());
    boot(s, s76);
    boot_time_passes(s);
    for (int i = 0; i < 1000 && s.controller().rate != 500'000; ++i) s.advance(1ms).ignore_tx();
    ASSERT_EQ(s.controller().rate, 500'000U);
    if (restart) {
      s.y(0x02, true).wait_x(0x02, true).y(0x02, false);
    } else {
      // 1F82H/01 = 07: reset communication of the own node, by the CIF
      s.cif({0x0002, 0, 0x1F82, 0x01, 1, 0x07, 0}).advance(100ms);
    }
    EXPECT_EQ(s.controller().rate, 250'000U);
    s.expect_bit(25, lss_active, false).expect_bit(25, start_up, true).ignore_tx();
  }
}

/// The module and devices on the simulated bus, nothing scripted.
class Me3LssOnBus : public ::testing::Test {
 protected:
  struct Seat {
    sim::Port* port;
    std::unique_ptr<sim::Device> device;
  };
  Me3LssOnBus() : module(bus.add_port("module"), memory), port(const_cast<sim::Port&>(*bus.ports()[0])) {
    timeline.add(module);
    port.connect(module);
  }
  virtual ~Me3LssOnBus() = default;
  Seat& device(std::uint32_t serial_number, std::uint32_t bit_rate) {
    std::ifstream stream(CANOPUS_SOURCE_DIR "/examples/devices/io-block.eds", std::ios::binary);
    auto file = eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {})).file;
    auto copy = std::make_shared<eds::DeviceFile>(*file);
    copy->dictionary = file->dictionary->with(std::vector<canopen::DictionaryDescription::Change>{
        {file->dictionary->find(0x1018, 1), canopen::little_endian(0x71, 4)},
        {file->dictionary->find(0x1018, 4), canopen::little_endian(serial_number, 4)}});
    Seat& seat = seats.emplace_back();
    seat.port = &bus.add_port("device");
    if (bit_rate != bus.bit_rate()) seat.port->restart(bit_rate);
    seat.device = std::make_unique<sim::Device>(copy, std::uint8_t{0xFF}, *seat.port);
    seat.device->enable_lss(*seat.port);
    timeline.add(*seat.device);
    seat.port->connect(*seat.device);
    seat.device->power_on({});
    return seat;
  }
  void power_on() { module.power_on(timeline.now()); }
  void run_for(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  std::uint16_t word(module::BufferAddress address) { return module.program_read(address, timeline.now()); }
  void y(unsigned number, bool on) { module.set_output(number, on, timeline.now()); }

  RamMemory memory;
  can::Timeline timeline;
  sim::Bus bus{"field", 250'000, timeline};
  module::me3can1_q::Me3can1Q module;
  sim::Port& port;
  std::deque<Seat> seats;
};

// One-to-one wiring, as the manual asks for: a device of another bit rate would destroy the frames of the others.
TEST_F(Me3LssOnBus, DevicesWithoutNodeIdPluggedInOneByOne_AreFoundAtAnyBitRate_AndBootAfterARestart) {
  RecordProperty("spec", "ME3-LSS-003 ME3-LSS-004 ME3-LSS-005");
  std::vector<Object> objects{{0x1F80, 0, 1}, {0x1F89, 0, 3000}};
  for (const std::uint8_t node : {std::uint8_t{5}, std::uint8_t{9}}) {
    objects.push_back({0x1F81, node, mandatory});
    objects.push_back({0x1F84, node, 0x000F0191});
    objects.push_back({0x1F85, node, 0x71});
    objects.push_back({0x1F86, node, 0x401});
    objects.push_back({0x1F87, node, 0x00010000});
    objects.push_back({0x1F88, node, 1000U + node});
  }
  preset(module, objects);
  Seat& five = device(1005, 250'000);
  Seat& nine = device(1009, 125'000);
  nine.port->plug(false);
  power_on();
  run_for(4050ms);
  EXPECT_EQ(word(25) >> lss_active & 1, 1);
  EXPECT_EQ(five.device->node().node_id(), 5);
  five.port->plug(false);
  nine.port->plug(true);
  run_for(6s);
  EXPECT_EQ(word(25) >> lss_active & 1, 0);
  five.port->plug(true);
  EXPECT_EQ(nine.device->node().node_id(), 9);
  EXPECT_EQ(five.port->bit_rate(), 250'000U);
  EXPECT_EQ(nine.port->bit_rate(), 250'000U);
  EXPECT_EQ(port.bit_rate(), 250'000U);
  EXPECT_EQ(word(405) >> 4 & 1, 1);
  y(0x02, true);
  run_for(6s);
  y(0x02, false);
  run_for(3s);
  EXPECT_EQ(word(605), 5);
  EXPECT_EQ(word(609), 5);
  EXPECT_EQ(word(25), 0x8201);
  EXPECT_EQ(word(29) & 0x4008, 0);  // neither bus-off nor error passive remain
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_lss_test
