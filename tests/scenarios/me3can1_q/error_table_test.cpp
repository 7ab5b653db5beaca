// Every row of spec/me3can1-q/errors.csv against the running module: each bit of a word and each result of a command comes, and goes as its row says.

#include "scenarios/me3can1_q/error_table.hpp"

namespace canopus::scenario::me3can1_q_error_table_test {
namespace {

// The kinds of rows, so that none is left out.
TEST(Me3ErrorTable, EveryKindOfRow_HasATest) {
  const std::set<std::string> tested{"G29 bit",
                                     "G25 bit",
                                     "Address display",
                                     "G401-G527 bit",
                                     "L2 slot error",
                                     "CIF result",
                                     "CIF error class",
                                     "EMCY send status",
                                     "EMCY code",
                                     "SDO abort",
                                     "LED",
                                     "EMCY manufacturer code",
                                     "Error register bit",
                                     "Error behavior 1029H/01"};
  for (const SpecRow& row : spec_rows("me3can1-q", "errors.csv")) {
    EXPECT_TRUE(tested.contains(row["kind"])) << row.place << ' ' << row["kind"];
  }
}

// --- G29, G25, G39, G40

void overflow_a_slot(IntelligentScenario& s) {
  for (int frame = 0; frame < 20; ++frame) s.rx(0x181, {1});
}

struct Cause {
  std::uint16_t mode;
  std::function<void(IntelligentScenario&)> come;
  std::function<void(IntelligentScenario&)> end;  ///< what ends it, for bits that follow their cause
};

const std::map<unsigned, Cause> causes{
    {1,
     {405, [](IntelligentScenario& s) { s.plug_in().inject(module::ModuleFault::hardware_error, s.now()); },
      [](IntelligentScenario& s) {
        s.supply_off();
        s.power_on();
      }}},
    {3,
     {405, [](IntelligentScenario& s) { s.error_counters(256, 0); },
      [](IntelligentScenario& s) { s.restart(); }}},
    {4,
     {405,
      [](IntelligentScenario& s) {
        s.save();
        s.flash().blobs["buffer-memory"].state = module::NonVolatileMemory::Content::State::damaged;
        s.restart();
      },
      [](IntelligentScenario& s) {
        s.save();
        s.restart();
      }}},
    {5, {11, [](IntelligentScenario& s) { s.write(6000, 0x0123); }, {}}},
    {6, {405, [](IntelligentScenario& s) { s.write(24, 300); }, {}}},
    {8,
     {405,
      [](IntelligentScenario& s) {
        ++s.controller().overflows;
        s.write(20, 0);
      },
      {}}},
    {14,
     {405, [](IntelligentScenario& s) { s.error_counters(128, 0); },
      [](IntelligentScenario& s) { s.error_counters(127, 0); }}},
    {15, {11, overflow_a_slot, {}}},
};

void start(IntelligentScenario& s, std::uint16_t mode) {
  if (mode == 405) {
    s.power_on_as(1);
    return;
  }
  s.power_on_layer2(mode);
  s.write(6000, {0x0181, 0, 0, 0});
  s.online();
}

TEST(Me3ErrorTable, EveryBitOfG29_ComesWithItsCause_AndGoesAsItSays) {
  RecordProperty("spec",
                 "ME3-ERR-001 ME3-ERR-002 ME3-ERR-003 ME3-ERR-004 ME3-ERR-005 ME3-ERR-006 ME3-ERR-007 "
                 "ME3-ERR-008 ME3-ERR-009 ME3-ERR-010 ME3-IO-012 ME3-IO-013");
  for (const SpecRow& row : rows_of("G29 bit", causes.size())) {
    const unsigned bit = row.number("code");
    const auto cause = causes.find(bit);
    ASSERT_NE(cause, causes.end()) << row.place;
    IntelligentScenario s;
    start(s, cause->second.mode);
    s.expect(29, 0).expect_x(0x0F, false);
    const auto value = static_cast<std::uint16_t>(1U << bit);
    const auto comes = [&] {
      cause->second.come(s);
      s.ignore_tx().expect(29, value).expect_x(0x0F, bit != 14);
    };
    const auto y0f = [&] { s.y(0x0F, true).y(0x0F, false); };
    comes();
    // A slot's code is a cause that stays: it goes first, and the latched bit stays until it is cleared.
    const auto cause_goes = [&] {
      if (bit == 15) s.expect_bit(5001, 13, true).write(5001, 0);
      s.advance(10s).ignore_tx().expect(29, value).expect_x(0x0F, true);
    };
    if (row["cleared_by"].find("(latched)") != std::string::npos) {
      cause_goes();
      y0f();
      s.expect(29, 0).expect_x(0x0F, false).expect(39, 0).expect(40, 0);
      comes();
      cause_goes();
      s.write(29, static_cast<std::uint16_t>(~value)).expect(29, 0).expect_x(0x0F, false);
      s.expect(39, 0).expect(40, 0);
      comes();
      s.write(29, 0xFFFF).expect(29, value);  // ones do nothing
    } else {
      y0f();
      s.expect(29, value);
      s.write(29, 0).expect(29, value).expect_x(0x0F, bit != 14);
      cause->second.end(s);
      s.ignore_tx().expect(29, 0).expect_x(0x0F, false);
    }
  }
}

TEST(Me3ErrorTable, AddressesAndStatusBits) {
  RecordProperty("spec", "ME3-ERR-011 ME3-ERR-012 ME3-STAT-003 ME3-STAT-004");
  for (const SpecRow& row : rows_of("Address display", 2)) {
    const bool setting = row["code"] == "G39";
    for (const bool by_y0f : {true, false}) {
      IntelligentScenario s;
      start(s, 11);
      const module::BufferAddress display = setting ? 39 : 40;
      const auto wrong = [&](module::BufferAddress address) { s.write(address, setting ? 101 : 0x0123); };
      wrong(setting ? 24 : 6008);
      wrong(setting ? 21 : 6004);  // the first one stays
      s.expect(display, setting ? 24 : 6008).expect(setting ? 40 : 39, 0);
      if (by_y0f) {
        s.y(0x0F, true).y(0x0F, false);
      } else {
        s.write(29, 0);
      }
      s.expect(display, 0);
      wrong(setting ? 21 : 6004);
      s.expect(display, setting ? 21 : 6004);
    }
  }
  for (const SpecRow& row : rows_of("G25 bit", 2)) {
    IntelligentScenario s;
    start(s, 405);
    const unsigned bit = row.number("code");
    s.expect_bit(25, bit, false);
    if (bit == 1) {
      for (const std::uint16_t counter : Words{95, 96, 127, 128}) {
        s.error_counters(counter, 0).expect_bit(25, 1, counter == 96 || counter == 127);
        s.error_counters(0, counter).expect_bit(25, 1, counter == 96 || counter == 127).ignore_tx();
      }
    } else {
      ASSERT_EQ(bit, 6U);
      s.nmt(0x82, 1).expect_bit(25, 6, false).wait_bit(25, 7, false).expect_bit(25, 6, true);
      s.write(25, 0xFFFF).expect_bit(25, 6, true).write(25, 0xFFBF).expect_bit(25, 6, false).ignore_tx();
    }
  }
}

TEST(Me3ErrorTable, EveryErrorControlBit_ComesWithItsCause_AndGoesWithY10) {
  RecordProperty(
      "spec",
      "ME3-NEC-005 ME3-NEC-006 ME3-NEC-007 ME3-NEC-008 ME3-NEC-009 ME3-NEC-010 ME3-NEC-011 ME3-IO-015 "
      "ME3-IO-016 ME3-IO-017");
  for (const SpecRow& row : rows_of("G401-G527 bit", 6)) {
    const unsigned bit = row.number("code");
    IntelligentScenario s;
    s.power_on_as(1);
    module::BufferAddress word = 402;
    if (bit == 6) {  // as slave
      word = 401;
      s.set_object(0x100C, 0, 100, 2);
      s.set_object(0x100D, 0, 3, 1);
      s.rx_remote(0x701, 1).advance(299ms).expect(word, 0).advance(1ms);
    } else if (bit == 7) {
      s.set_object(0x1016, 1, 0x00020064, 4);
      s.rx(0x702, {0x05}).advance(99ms).expect(word, 0x0002).advance(1ms);
    } else {  // as master; guarding every 100 ms, three times
      s.set_object(0x1F80, 0, 1, 4);
      s.set_object(0x1F81, 2, bit == 4 ? 0x0000000D : 0x00640301, 4);
      if (bit == 4) s.set_object(0x1F89, 0, 1000, 4);
      s.store_objects().restart();
      if (bit != 4) s.rx(0x702, {0x00}).rx(0x702, {0x7F});
      s.expect_bit(word, bit, false).ignore_tx();
      if (bit == 5) {  // it stays Pre-operational, although it was told to start
        s.cif({0x0002, 0, 0x1F82, 2, 1, 5});
        s.advance(100ms).expect(402, 0x0001).rx(0x702, {0xFF});
      }
      s.wait_bit(word, bit, true, 5s);
    }
    s.expect_bit(word, bit, true).expect_x(0x10, true);
    s.write(400, 3).y(0x10, true).expect_bit(word, bit, true).y(0x10, false);  // another node's
    s.write(400, static_cast<std::uint16_t>(word - 400)).y(0x10, true).expect_bit(word, bit, false);
    s.expect_x(0x10, false).y(0x10, false).ignore_tx();
  }
}

TEST(Me3ErrorTable, SlotErrors) {
  RecordProperty("spec", "ME3-L2-039 ME3-ERR-008");
  for (const SpecRow& row : rows_of("L2 slot error", 2)) {
    IntelligentScenario s;
    start(s, 11);
    const auto code = static_cast<std::uint16_t>(*spec_number(row["code"]));
    if (code != 0) overflow_a_slot(s);
    s.expect(5001, code).expect(5002, 0).expect_bit(29, 15, code != 0);
    s.write(5001, 0).expect(5001, 0);
  }
}

// --- command interface

TEST(Me3ErrorTable, EveryResultAndClassOfTheCommandInterface) {
  RecordProperty(
      "spec",
      "ME3-CIF-002 ME3-CIF-006 ME3-CIF-008 ME3-CIF-009 ME3-CIF-010 ME3-CIF-022 ME3-CIF-023 ME3-CIF-028");
  const std::map<std::string, Words> results{
      {"0003H", {0x0002, 0, 0x1015, 0, 2, 5}},
      {"0005H", {0x0004, 0, 0x1015, 0}},
      {"0007H", {0x0006, 0, 0x1015, 0, 2, 5, 0, 0, 0, 0xFFFF}},
      {"0009H", {0x0008, 0, 0x1015, 0, 0, 0, 0, 0, 0, 0xFFFF}},
      {"000BH", {0x000A, 0x1000, 1, 0, 0}},
      {"000DH", {0x000C, 0x123, 0, 0, 0}},
      {"000FH", {0x1234}},
      {"00F7H", {0x0006, 0, 0x1018, 1, 4, 5, 0, 0, 0, 0xFFFF}},
      {"00F9H", {0x0008, 0, 0x1018, 4, 0, 0, 0, 0, 0, 0xFFFF}},
      {"F00CH", {0x000C, 0x123, 0, 0, 9}},
      {"0000H", {0xFFFF}},
  };
  for (const SpecRow& row : rows_of("CIF result", 13)) {
    const std::string& code = row["code"];
    IntelligentScenario s;
    if (code == "FFFFH") {
      s.power_on();
      s.write(1000, {0x0004, 2, 0x1000, 0})
          .y(0x17, true)
          .expect(1000, 0xFFFF)
          .advance(100ms)
          .expect(1000, 0xFFFF);
      s.wait_x(0x17, true).ignore_tx();
    } else if (code == "000CH") {
      s.power_on();
      s.nmt(0x02)
          .write(1000, {0x000A, 0x1000, 1, 0, 0})
          .y(0x17, true)
          .wait_x(0x17, true)
          .expect(1000, 0x000C);
    } else {
      ASSERT_TRUE(results.contains(code)) << row.place;
      start(s, code == "000DH" || code == "F00CH" ? 11 : 405);
      s.cif(results.at(code));
      s.expect(1000, static_cast<std::uint16_t>(*spec_number(code))).ignore_tx();
      s.write(1000, 0x4321).expect(1000, 0x4321);  // until the next command
    }
  }
  for (const SpecRow& row : rows_of("CIF error class", 5)) {
    const auto code = static_cast<std::uint16_t>(*spec_number(row["code"]));
    IntelligentScenario s;
    s.power_on();
    switch (code) {
      case 0x0064: s.cif({0x1234}); break;
      case 0xFFFF: s.write(1000, {0x0004, 2, 0x1000, 0}).y(0x17, true).write(1005, 1); break;
      case 0x0003: s.cif({0x0004, 0, 0x1018, 4}); break;
      case 0xB0FF:
        s.error_counters(256, 0);
        s.cif({0x0004, 2, 0x1000, 0});
        break;
      case 0x0F0F:
        s.nmt(0x02);
        s.cif({0x0004, 2, 0x1000, 0});
        break;
      default: FAIL() << row.place;
    }
    s.expect(1000, {0x000F, code}).ignore_tx();
    if (code == 0xFFFF) s.y(0x17, false).wait_x(0x17, false).advance(1s).ignore_tx();
    s.cif({code == 0xFFFF ? std::uint16_t{0xFFFF} : std::uint16_t{0x0000}});
    s.expect(1000, 0x0000).ignore_tx();
  }
  for (const SpecRow& row : rows_of("EMCY send status", 2)) {
    const auto code = static_cast<std::uint16_t>(*spec_number(row["code"]));
    IntelligentScenario s;
    s.power_on();
    if (code == 1) s.set_object(0x1015, 0, 10000, 2);  // 1 s
    s.cif({0x000A, 0x1000, 1, 0, 0});
    s.tx(0x0FF, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0}).expect(1000, {0x000B, 0});
    if (code == 2) s.nmt(0x02);
    s.advance(900ms);
    s.cif({0x000A, 0x1000, 1, 0, 0});
    s.expect(1000, {0x000C, code}).no_tx();
    if (code == 2) s.nmt(0x80);
    s.advance(100ms);
    s.cif({0x000A, 0x1000, 1, 0, 0});
    s.tx(0x0FF, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0}).expect(1000, {0x000B, 0});
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_error_table_test
