// The event history and the errors of module diagnostics [RJ71CN91 5.1, 5.2, 5.5, 5.6]: when each comes, what goes, what the
// LEDs show of it.

#include <algorithm>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/module/models/rj71cn91/event_table.hpp"

#include "scenarios/me3can1_q/concise_dcf.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario::rj71cn91_diagnostics_test {
namespace {

using module::ErrorClass;
using module::LedPattern;
using Codes = std::vector<std::uint16_t>;

/// Codes of the event history from entry `first` on.
Codes events(IntelligentScenario& s, std::size_t first = 0) {
  Codes codes;
  for (const auto& record : s.plug_in().event_history()) codes.push_back(record.code);
  codes.erase(codes.begin(), codes.begin() + static_cast<std::ptrdiff_t>(std::min(first, codes.size())));
  return codes;
}
Codes without(Codes codes, std::uint16_t code) {
  std::erase(codes, code);
  return codes;
}
std::size_t count(IntelligentScenario& s) { return s.plug_in().event_history().size(); }

Codes errors(IntelligentScenario& s) {
  Codes codes;
  for (const auto& record : s.plug_in().module_errors()) codes.push_back(record.code);
  return codes;
}

// The tables are the manual's.
TEST(Rj71Diagnostics, TablesAreThoseOfTheManual) {
  Codes event_codes, error_codes;
  for (const SpecRow& row : spec_rows("rj71cn91", "errors.csv")) {
    if (row["kind"] == "event") event_codes.push_back(static_cast<std::uint16_t>(row.number("code", 16)));
    if (row["kind"] == "module_error" && row["code"] != "2220H") {
      error_codes.push_back(static_cast<std::uint16_t>(*spec_number(row["code"])));
    }
  }
  Codes own_events, own_errors;
  for (const auto& row : module::rj71cn91::event_table) own_events.push_back(row.code);
  for (const auto& row : module::rj71cn91::error_table) {
    own_errors.push_back(row.code);
    for (const SpecRow& spec : spec_rows("rj71cn91", "errors.csv")) {
      if (spec["kind"] != "module_error" || spec_number(spec["code"]) != row.code) continue;
      EXPECT_TRUE(spec["meaning"].starts_with(module::name(row.error_class))) << spec.place;
    }
  }
  EXPECT_EQ(own_events, event_codes);
  EXPECT_EQ(own_errors, error_codes);
}

TEST(Rj71Events, Starts_InEachMode_AndRestarts) {
  RecordProperty("spec", "RJ71-MODE-008 RJ71-IO-003");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  EXPECT_EQ(events(s), (Codes{0x0415, 0x0400}));
  EXPECT_EQ(s.plug_in().event_history().front().detail, 0x7FU);
  std::size_t seen = count(s);
  s.write(70, 1);
  s.restart().expect(70, 500);
  EXPECT_EQ(without(events(s, seen), 0x0415), (Codes{0x0404, 0x0400}));
  for (const std::uint16_t mode : Words{11, 29}) {
    s.write(21, mode);
    s.save();
    seen = count(s);
    s.y(0x02, true).expect_bit(25, 7, true).advance(5900ms).expect_x(0x02, false);
    s.wait_x(0x02, true, 200ms).expect_bit(25, 7, false).y(0x02, false).expect_x(0x02, false);
    EXPECT_EQ(events(s, seen), (Codes{0x0404, static_cast<std::uint16_t>(mode == 11 ? 0x0401 : 0x0402)}));
    seen = count(s);
    s.supply_off().ignore_tx();
    s.power_on();
    EXPECT_EQ(events(s, seen), (Codes{static_cast<std::uint16_t>(mode == 11 ? 0x0401 : 0x0402)}));
  }
}

TEST(Rj71Events, Layer2_OnlineAndOffline) {
  RecordProperty("spec", "RJ71-L2-003 RJ71-L2-004");
  IntelligentScenario s(rj71cn91);
  s.power_on_layer2(11);
  const std::size_t seen = count(s);
  s.online();
  EXPECT_EQ(events(s, seen), (Codes{0x0405}));
  s.advance(1s);
  s.offline();
  EXPECT_EQ(events(s, seen), (Codes{0x0405, 0x0406}));
  s.write(6000, {0xFFFF, 0x5FFF}).y(0x03, true).expect_x(0x03, false);  // its CAN-ID is missing
  EXPECT_EQ(events(s, seen), (Codes{0x0405, 0x0406}));
}

TEST(Rj71Events, Clears_Saves_AndRestores) {
  RecordProperty("spec", "RJ71-BM-003 RJ71-BM-004 RJ71-EMCY-020 RJ71-IO-007");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  std::size_t seen = count(s);
  s.y(0x0F, true).y(0x0F, false);
  EXPECT_EQ(events(s, seen), (Codes{0x0408}));
  s.y(0x10, true).y(0x10, false);
  EXPECT_EQ(events(s, seen), (Codes{0x0408, 0x0409}));
  s.rx(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5}).expect_x(0x11, true);
  s.exchange().expect(750, 5).expect(751, 0x8130);
  s.y(0x11, true).expect_x(0x11, false).expect(750, Words(110, 0));
  s.rx(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5}).expect_x(0x11, false).y(0x11, false).expect_x(0x11, false);
  EXPECT_EQ(events(s, seen), (Codes{0x0408, 0x0409, 0x0410, 0x040A}));

  seen = count(s);
  s.write(70, 700).write(71, 800);
  s.save(1);  // X1F, G22 = 0
  EXPECT_EQ(events(s, seen), (Codes{0x040C}));
  s.write(70, 900);
  s.save(2).expect(70, 500).expect(71, 500).expect(27, 127);
  EXPECT_EQ(events(s, seen), (Codes{0x040C, 0x040D}));
  s.restart().expect(70, 700).expect(71, 800).expect(27, 1);  // the flash memory was left alone
  seen = count(s);
  s.save(3).expect(70, 500).expect(27, 127);
  EXPECT_EQ(events(s, seen), (Codes{0x040C, 0x040D}));
  s.restart().expect(70, 500).expect(71, 500).expect(27, 127);
  seen = count(s);
  s.save(0);
  EXPECT_EQ(events(s, seen), Codes{});
  s.ignore_tx();
}

TEST(Rj71Events, Objects_StoredAndRestored) {
  RecordProperty("spec", "RJ71-OD-001 RJ71-OD-002 RJ71-CM-008");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  std::size_t seen = count(s);
  s.set_object(0x1017, 0, 500, 2);
  s.expect_object(0x1010, 1, 1, 4);
  s.expect_object(0x1011, 1, 1, 4);
  s.cif({0x0002, 0, 0x1010, 1, 4, 0x7661, 0x6573}).expect(1000, 0x000F);  // "save" it is not
  EXPECT_EQ(events(s, seen), Codes{});
  s.store_objects();
  EXPECT_EQ(events(s, seen), (Codes{0x040C}));
  s.set_object(0x1017, 0, 0, 2);
  s.restart();
  s.expect_object(0x1017, 0, 500, 2).ignore_tx();
  // A concise DCF goes to the flash memory by itself.
  seen = count(s);
  EXPECT_EQ(write_concise_dcf(s, 5, write_of_1017(0x6400)), 0U);
  EXPECT_EQ(without(events(s, seen), 0x0415), (Codes{0x040C}));
  s.supply_off();
  s.power_on();
  s.cif({0x0004, 0, 0x1F22, 5}).expect(1000, 0x0005).expect(1004, 13).ignore_tx();
  seen = count(s);
  s.set_object(0x1011, 1, 0x64616F6C, 4);
  s.expect_object(0x1017, 0, 500, 2);
  EXPECT_EQ(without(events(s, seen), 0x0415), (Codes{0x040D}));
  s.restart();
  s.expect_object(0x1017, 0, 0, 2);
  s.cif({0x0004, 0, 0x1F22, 5}).ignore_tx();
  EXPECT_NE(s.read(1004), 13);
}

TEST(Rj71Events, ErrorCounters) {
  RecordProperty("spec", "RJ71-BM-013 RJ71-BM-014 RJ71-EMCY-023");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  const std::size_t seen = count(s);
  s.error_counters(95, 0).expect_bit(25, 1, false).no_tx();
  EXPECT_EQ(events(s, seen), Codes{});
  s.error_counters(0, 96).expect_bit(25, 1, true).no_tx();
  s.error_counters(127, 0).expect_bit(25, 1, true).expect(29, 0).no_tx();
  EXPECT_EQ(events(s, seen), (Codes{0x040E}));
  s.error_counters(128, 0).expect_bit(25, 1, false).expect(29, 0x4000).expect_x(0x0F, false);
  s.tx(0x081, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
  EXPECT_EQ(events(s, seen), (Codes{0x040E, 0x040F}));
  s.error_counters(127, 0).expect_bit(25, 1, true).expect(29, 0).no_tx();
  s.error_counters(0, 128)
      .expect_bit(25, 1, false)
      .expect(29, 0x4000)
      .tx(0x081, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0});
  EXPECT_EQ(events(s, seen), (Codes{0x040E, 0x040F, 0x040E, 0x040F}));
  s.error_counters(0, 95).expect_bit(25, 1, false).expect(29, 0).no_tx();
  s.error_counters(256, 0).expect(29, 0x0008).ignore_tx();
  s.error_counters(0, 0).expect(29, 0).no_tx();  // the return from bus-off is no message
}

TEST(Rj71Events, Emergencies) {
  RecordProperty("spec", "RJ71-EMCY-013 RJ71-EMCY-015");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(3);
  s.set_object(0x1028, 6, 0x80000086, 4);
  s.set_object(0x1028, 7, 0x80000087, 4).set_object(0x1028, 7, 0x00000200, 4);
  std::size_t seen = count(s);
  s.rx(0x085, {0x10, 0x81, 0x11, 1, 2, 3, 4, 5}).expect_x(0x11, true).expect(750, 0);
  s.rx(0x086, {0x10, 0x81, 0x11, 1, 2, 3, 4, 5}).rx(0x087, {0x10, 0x81, 0x11, 1, 2, 3, 4, 5});  // not theirs
  EXPECT_EQ(events(s, seen), (Codes{0x0410}));
  EXPECT_EQ(s.plug_in().event_history().back().detail, 5U);
  s.rx(0x200, {0x10, 0x81, 0x11, 1, 2, 3, 4, 5});
  EXPECT_EQ(s.plug_in().event_history().back().detail, 7U);
  s.y(0x11, true);
  seen = count(s);
  s.rx(0x085, {0x10, 0x81, 0x11, 1, 2, 3, 4, 5}).expect_x(0x11, false);
  EXPECT_EQ(events(s, seen), Codes{});
  s.y(0x11, false).rx(0x085, {0x10, 0x81, 0x11, 1, 2, 3, 4, 5}).expect_x(0x11, true);
  seen = count(s);
  s.cif({0x000A, 0xFF00, 0x0281, 0x0403, 0x0605}).tx(0x083, {0x00, 0xFF, 0x81, 2, 3, 4, 5, 6});
  EXPECT_EQ(events(s, seen), (Codes{0x0411}));
  s.nmt(0x02, 3);
  seen = count(s);
  s.cif({0x000A, 0xFF00, 0x0281, 0x0403, 0x0605}).expect(1000, {0x000C, 0x0002}).no_tx();
  EXPECT_EQ(events(s, seen), Codes{});
}

TEST(Rj71Events, NmtStates_Resets_AndErrorControl) {
  RecordProperty("spec", "RJ71-NMT-013 RJ71-NG-011");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(3);
  std::size_t seen = count(s);
  const auto states = [&] {
    std::vector<std::uint32_t> found;
    const auto history = s.plug_in().event_history();
    for (std::size_t i = seen; i < history.size(); ++i) {
      if (history[i].code == 0x0415) found.push_back(history[i].detail.value_or(0));
    }
    return found;
  };
  s.nmt(0x01);
  s.nmt(0x01);
  s.nmt(0x80);
  s.nmt(0x02);
  EXPECT_EQ(states(), (std::vector<std::uint32_t>{0x05, 0x7F, 0x04}));
  EXPECT_EQ(events(s, seen), (Codes{0x0415, 0x0415, 0x0415}));
  for (const std::uint8_t reset : Bytes{0x81, 0x82}) {
    seen = count(s);
    s.nmt(reset).advance(20ms).ignore_tx();
    Codes after = events(s, seen);
    EXPECT_EQ(std::ranges::count(after, 0x0414), 1);
    EXPECT_EQ(states().back(), 0x7FU);
  }
  // Life guarding: the own node is guarded, and not any more.
  s.set_object(0x100C, 0, 100, 2);
  s.set_object(0x100D, 0, 2, 1);
  seen = count(s);
  s.rx_remote(0x703, 1).ignore_tx().advance(150ms);
  EXPECT_EQ(events(s, seen), Codes{});
  s.advance(100ms).ignore_tx();
  EXPECT_EQ(events(s, seen), (Codes{0x0413}));
  s.expect_bit(403, 6, true).expect_x(0x10, true);
}

TEST(Rj71Events, FlyingMaster) {
  RecordProperty("spec", "RJ71-FLY-011 RJ71-FLY-010 RJ71-CPU-005");
  IntelligentScenario s(rj71cn91);
  s.plug_in().preset_node_id(2);
  s.plug_in().preset_object(0x1F80, 0, canopen::little_endian(0x21, 4));
  s.power_on();
  const std::size_t seen = count(s);
  EXPECT_EQ(std::ranges::count(events(s), 0x0416), 0);
  s.wait_bit(25, 15, true, 20s).ignore_tx();
  EXPECT_EQ(std::ranges::count(events(s, seen), 0x0416), 1);
  EXPECT_EQ(s.plug_in().event_history().back().detail.value_or(2), 2U);
  s.advance(2s);
  bool heartbeat = false;
  for (const can::Frame& frame : s.controller().sent) heartbeat = heartbeat || frame.identifier == 0x702;
  EXPECT_TRUE(heartbeat);
  s.ignore_tx();
  // STOP of the active master: no role, no heartbeat; another one takes over by that.
  s.cpu(module::CpuState::stop).tx(0x082, {0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x32});
  s.expect_bit(25, 15, false).advance(10s).no_tx();
  EXPECT_EQ(std::ranges::count(events(s, seen), 0x0416), 2);
  // RUN: it takes part again, and is the only one.
  s.cpu(module::CpuState::run).wait_bit(25, 15, true, 20s).ignore_tx();
  EXPECT_EQ(std::ranges::count(events(s, seen), 0x0416), 3);
}

// --- errors

TEST(Rj71Diagnostics, BadParameter_IsModerate_WithItsAddress) {
  RecordProperty("spec", "RJ71-ERR-003 RJ71-LED-001");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  EXPECT_EQ(led(s, "RUN"), LedPattern::on);
  EXPECT_EQ(led(s, "ERR"), LedPattern::off);
  s.write(24, 99);
  ASSERT_EQ(errors(s), (Codes{0x3000}));
  const auto error = s.plug_in().module_errors().front();
  EXPECT_EQ(error.error_class, ErrorClass::moderate);
  EXPECT_EQ(error.details[0].name, "Buffer memory address");
  EXPECT_EQ(error.details[0].value, 24U);
  s.expect(24, 250);  // overwritten by the module: as it was
  EXPECT_EQ(led(s, "RUN"), LedPattern::on);
  EXPECT_EQ(led(s, "ERR"), LedPattern::blinking);
  s.write(24, 250);
  EXPECT_EQ(errors(s), Codes{});
  EXPECT_EQ(led(s, "ERR"), LedPattern::off);

  // The worst one is shown: minor, moderate, major.
  s.controller().overflows = 1;
  s.write(20, 0).ignore_tx();
  EXPECT_EQ(errors(s), (Codes{0x1800}));
  EXPECT_EQ(led(s, "ERR"), LedPattern::on);
  s.write(27, 0);
  EXPECT_EQ(led(s, "ERR"), LedPattern::blinking);
  s.plug_in().inject(module::ModuleFault::hardware_error, s.now());
  EXPECT_EQ(led(s, "RUN"), LedPattern::off);
  EXPECT_EQ(errors(s), (Codes{0x1800, 0x3000, 0x3C00}));
  s.y(0x0F, true);
  EXPECT_EQ(errors(s), (Codes{0x3C00}));
  EXPECT_EQ(led(s, "RUN"), LedPattern::off);
  s.y(0x0F, false).ignore_tx();
  s.supply_off();
  s.power_on();
  EXPECT_EQ(errors(s), Codes{});
  EXPECT_EQ(led(s, "RUN"), LedPattern::on);
}

TEST(Rj71Diagnostics, ClearError_TakesMinorErrorsOnly) {
  RecordProperty("spec", "RJ71-DIAG-001");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.controller().overflows = 1;
  s.write(20, 0).ignore_tx();
  const std::size_t seen = count(s);
  EXPECT_EQ(led(s, "ERR"), LedPattern::on);
  EXPECT_TRUE(s.plug_in().clear_module_errors());
  EXPECT_EQ(led(s, "ERR"), LedPattern::off);
  EXPECT_EQ(errors(s), Codes{});
  EXPECT_EQ(count(s), seen);
  s.expect(29, 0x0100).expect_x(0x0F, true);  // the words stay
  s.write(27, 0);
  EXPECT_FALSE(s.plug_in().clear_module_errors());
  EXPECT_EQ(errors(s), (Codes{0x3000}));
}

TEST(Rj71Diagnostics, EachError_WithItsDetails) {
  RecordProperty("spec", "RJ71-BM-015 RJ71-ERR-002 RJ71-DIAG-003");
  const auto only = [](IntelligentScenario& s, std::uint16_t code, std::vector<std::uint32_t> details) {
    ASSERT_EQ(errors(s), (Codes{code}));
    const auto record = s.plug_in().module_errors().front();
    for (std::size_t i = 0; i < details.size(); ++i) {
      EXPECT_FALSE(record.details[i].name.empty()) << code;
      EXPECT_EQ(record.details[i].value, details[i]) << code;
    }
    s.y(0x0F, true).y(0x0F, false).ignore_tx();
  };
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.controller().overflows = 1;
  s.write(20, 0).expect(29, 0x0100).tx(0x081, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0});
  only(s, 0x1800, {});
  s.nmt(0x01).rx(0x201, {1, 2, 3, 4, 5, 6}).ignore_tx();
  ASSERT_EQ(errors(s), (Codes{0x1801}));
  EXPECT_EQ(s.plug_in().module_errors().front().details[1].value, 0x8210U);
  s.y(0x0F, true).y(0x0F, false).ignore_tx();
  s.rx(0x080, {1}).ignore_tx();
  only(s, 0x1802, {0x080, 0x8200});
  s.error_counters(256, 0).expect(29, 0x0008).expect(600 + 1, 0x7F);
  ASSERT_EQ(errors(s), (Codes{0x1804}));
  s.y(0x0F, true);
  EXPECT_EQ(errors(s), Codes{});
  s.y(0x0F, false);
  EXPECT_EQ(errors(s), (Codes{0x1804}));  // its cause is there
  s.restart();
  EXPECT_EQ(errors(s), Codes{});
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_diagnostics_test
