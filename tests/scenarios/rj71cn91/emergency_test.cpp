// Emergency messages: what the module sends by itself, the error register, the error history [RJ71CN91 1.7, App. 3 1001H,
// 1003H, 5.5].

#include <set>

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_emergency_test {
namespace {

using namespace rj71cn91_presets;

constexpr auto stop = module::CpuState::stop;

/// The emergency messages sent so far, by code, with the error register.
std::map<std::uint16_t, std::uint8_t> emergencies(IntelligentScenario& s, std::uint8_t node) {
  std::map<std::uint16_t, std::uint8_t> found;
  for (const can::Frame& frame : s.controller().sent) {
    if (frame.identifier != 0x080U + node) continue;
    EXPECT_EQ(frame.dlc, 8);
    found[static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8)] = frame.data[2];
  }
  s.ignore_tx();
  return found;
}

/// Makes the error of each code that the module sends by itself. False: there is no such way.
bool cause(IntelligentScenario& s, std::uint16_t code) {
  switch (code) {
    case 0x0000: s.cpu(stop).ignore_tx().cpu(module::CpuState::run); return true;
    case 0x6200: s.y(0x02, true).y(0x02, false); return true;
    case 0x8110:
      s.controller().overflows += 1;
      s.write(20, 0);
      return true;
    case 0x8120: s.error_counters(128, 0).error_counters(0, 0); return true;
    case 0x8200: s.rx(0x080, {1}); return true;
    case 0x8210: s.rx(0x201, {1}); return true;
    case 0x8220: s.rx(0x301, {1, 2, 3, 4, 5, 6, 7, 8}); return true;
    case 0xFF00: s.cpu(stop); return true;
    default: break;
  }
  if (code < 0x8F01 || code > 0x8F7F) return false;
  s.rx(0x700U + (code & 0x7FU), {0x05}).advance(100ms);
  return true;
}

void prepare(IntelligentScenario& s, std::uint16_t code) {
  s.power_on_as(1);
  s.set_object(0x1401, 1, 0x80000301, 4).set_object(0x1601, 0, 0, 1).set_object(0x1601, 0, 1, 1);
  s.set_object(0x1401, 1, 0x301, 4);
  if ((code & 0xFF80) == 0x8F00) s.set_object(0x1016, 127, std::uint32_t{code & 0x7FU} << 16 | 100, 4);
  s.nmt(0x01, 1).ignore_tx();
}

TEST(Rj71Emergency, CodesOfTheModuleItself_TheirRegister_TheirEntry) {
  RecordProperty("spec", "RJ71-EMCY-002 RJ71-EMCY-006 RJ71-EMCY-022 RJ71-EMCY-001");
  std::set<std::uint16_t> codes{0x0000, 0x6200, 0x8110, 0x8120, 0x8200, 0x8210, 0x8220, 0xFF00};
  for (std::uint16_t node = 2; node <= 0x7F; ++node) codes.insert(static_cast<std::uint16_t>(0x8F00 + node));
  for (const std::uint16_t code : codes) {
    IntelligentScenario s(rj71cn91);
    prepare(s, code);
    ASSERT_TRUE(cause(s, code)) << std::hex << code;
    const auto sent = emergencies(s, 1);
    ASSERT_EQ(sent.size(), 1U) << std::hex << code;  // one message for each error
    EXPECT_EQ(sent.begin()->first, code);
    // Bit 0 with every code above 00FFH, bit 4 communication, bit 7 manufacturer; no other.
    const std::uint8_t expected = code == 0 ? 0x00 : code == 0x6200 ? 0x01 : code == 0xFF00 ? 0x81 : 0x11;
    EXPECT_EQ(sent.begin()->second, expected) << std::hex << code;
    s.advance(10s);
    if (code != 0x6200) {
      s.no_tx();  // none until a new error
      s.expect_object(0x1001, 0, expected, 1).expect_object(0x1003, 0, code == 0 ? 0 : 1, 1);
      if (code != 0) s.cif({0x0004, 0, 0x1003, 1}).expect(1005, code);
    }
    s.ignore_tx();
  }
  // A guarded slave misses its master: its own number.
  IntelligentScenario slave(rj71cn91);
  prepare(slave, 0);
  slave.set_object(0x100C, 0, 100, 2)
      .set_object(0x100D, 0, 1, 1)
      .rx_remote(0x701, 1)
      .ignore_tx()
      .advance(100ms);
  EXPECT_EQ(emergencies(slave, 1), (std::map<std::uint16_t, std::uint8_t>{{0x8F01, 0x11}}));
}

// 8130H, 8140H, 8150H, 8240H, 8250H and the like: what would cause them elsewhere sends nothing, or another code.
TEST(Rj71Emergency, OtherCodes_AreNeverItsOwn) {
  RecordProperty("spec", "RJ71-EMCY-002");
  IntelligentScenario s(rj71cn91);
  prepare(s, 0);
  s.rx(0x181, {1, 2, 3, 4, 5, 6, 7, 8})
      .rx(0x081, {1, 0, 0, 0, 0, 0, 0, 0})
      .rx(0x701, {0x05})
      .no_tx();                                                                                   // CAN-IDs
  s.error_counters(256, 0).ignore_tx().advance(1s).error_counters(0, 0).advance(1s).ignore_tx();  // bus-off
  s.restart();
  s.advance(10s).no_tx();
  s.rx(0x080, {1}).tx(0x081, {0x00, 0x82, 0x11, 0, 0, 0, 0, 0}).no_tx();  // not 8240H
}

TEST(Rj71Emergency, History_The15Newest_NewestFirst_WithTheFirstTwoBytes) {
  RecordProperty("spec", "RJ71-EMCY-007 RJ71-EMCY-022 RJ71-EMCY-012");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.expect_object(0x1003, 0, 0, 1);
  s.cif({0x0004, 0, 0x1003, 1});
  s.expect_abort(0x08000024);
  s.cpu(stop).ignore_tx();
  s.expect_object(0x1003, 0, 1, 1).expect_object(0x1003, 1, 0x4D45FF00, 4);  // "ME"
  s.cif({0x000A, 0x1234, 0x0A02, 0x0C0B, 0x0E0D}).tx(0x081, {0x34, 0x12, 0x83, 0x0A, 0x0B, 0x0C, 0x0D, 0x0E});
  s.expect_object(0x1003, 0, 2, 1)
      .expect_object(0x1003, 1, 0x0A0B1234, 4)
      .expect_object(0x1003, 2, 0x4D45FF00, 4);
  for (std::uint16_t code = 0x2001; code <= 0x2010; ++code) s.cif({0x000A, code, 0, 0, 0}).ignore_tx();
  s.expect_object(0x1003, 0, 15, 1);
  for (std::uint8_t sub = 1; sub <= 15; ++sub) s.expect_object(0x1003, sub, 0x2011U - sub, 4);
  s.cif({0x0004, 0, 0x1003, 16});
  s.expect_abort(0x06090011);
  s.set_object(0x1003, 0, 0, 1).tx(0x081, no_error);
  s.cif({0x000A, 0x3001, 0, 0, 0}).ignore_tx();
  s.expect_object(0x1003, 1, 0x00003001, 4);
  s.cif({0x0004, 0, 0x1003, 2});  // where none is stored
  s.expect_abort(0x08000024).ignore_tx();
}

TEST(Rj71Emergency, Manual_BitsOfTheRegisterStay) {
  RecordProperty("spec", "RJ71-EMCY-012 RJ71-EMCY-006");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  std::uint16_t expected = 0;
  for (const std::uint16_t bit : Words{0x02, 0x04, 0x08, 0x20, 0x80, 0x10}) {
    expected = static_cast<std::uint16_t>(expected | bit | 0x01);
    s.cif({0x000A, 0x1000, bit, 0, 0}).expect(1000, {0x000B, 0x0000});
    s.tx(0x081, {0x00, 0x10, static_cast<std::uint8_t>(expected), 0, 0, 0, 0, 0});
    s.expect_object(0x1001, 0, expected, 1);
  }
  s.advance(1h);
  s.expect_object(0x1001, 0, expected, 1);  // they do not go by themselves
  s.set_object(0x1003, 0, 0, 1).expect_object(0x1001, 0, 0, 1).ignore_tx();
  s.cif({0x000A, 0x00FF, 0, 0, 0}).ignore_tx();
  s.expect_object(0x1001, 0, 0, 1);  // no code above 00FFH: no bit 0
  s.cif({0x000A, 0x0100, 0, 0, 0}).ignore_tx();
  s.expect_object(0x1001, 0, 1, 1);
}

TEST(Rj71Diagnostics, InvalidObject_1802H) {
  RecordProperty("spec", "RJ71-ERR-001");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.set_object(0x1005, 0, 0xA0, 4).rx(0x0A0, {1}).tx(0x081, {0x00, 0x82, 0x11, 0, 0, 0, 0, 0}).no_tx();
  ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x1802}));
  const auto error = s.plug_in().module_errors()[0];
  EXPECT_EQ(error.details[0].name, "COB-ID");
  EXPECT_EQ(error.details[0].value, 0x0A0U);
  EXPECT_EQ(error.details[1].name, "CANopen error cause");
  EXPECT_EQ(error.details[1].value, 0x8200U);
  EXPECT_EQ(error.error_class, module::ErrorClass::minor);
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_emergency_test
