// Every row of spec/me3can1-q/errors.csv against the running module: each error bit, code and LED pattern is
// made to appear, and to go as its row says.

#include <functional>
#include <set>

#include "scenarios/me3can1_q/scenario.hpp"
#include "scenarios/spec_table.hpp"

namespace canopus::scenario {
namespace {

std::vector<SpecRow> rows_of(const std::string& kind, std::size_t expected) {
  std::vector<SpecRow> rows;
  for (SpecRow& row : spec_rows("me3can1-q", "errors.csv")) {
    if (row["kind"] == kind) rows.push_back(std::move(row));
  }
  EXPECT_EQ(rows.size(), expected) << kind;
  return rows;
}

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

// --- emergencies

/// Codes of the emergencies sent since the last look.
std::vector<std::uint16_t> emergencies_sent(IntelligentScenario& s) {
  std::vector<std::uint16_t> codes;
  for (const can::Frame& frame : s.controller().sent) {
    if (frame.identifier == 0x081)
      codes.push_back(static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8));
  }
  s.ignore_tx();
  return codes;
}

const std::map<std::uint16_t, std::function<void(IntelligentScenario&)>> firmware_causes{
    {0x0000,
     [](IntelligentScenario& s) {
       s.nmt(0x01, 1).rx(0x201, {1}).ignore_tx();
       s.rx(0x201, {1, 2, 3, 4, 5, 6, 7, 8});
     }},
    {0x6200, [](IntelligentScenario& s) { s.y(0x02, true); }},
    {0x8110, [](IntelligentScenario& s) { ++s.controller().overflows, s.write(20, 0); }},
    {0x8120, [](IntelligentScenario& s) { s.error_counters(128, 0); }},
    {0x8200, [](IntelligentScenario& s) { s.rx(0x080, {1}); }},
    {0x8210,
     [](IntelligentScenario& s) {
       s.nmt(0x01, 1).rx(0x201, {1, 2, 3, 4, 5, 6, 7});
     }},
    {0x8220,
     [](IntelligentScenario& s) {
       s.set_object(0x1400, 1, 0x80000201, 4);
       s.set_object(0x1600, 0, 0, 1);
       s.set_object(0x1600, 0, 3, 1);
       s.set_object(0x1400, 1, 0x00000201, 4);
       s.nmt(0x01, 1).rx(0x201, {1, 2, 3, 4, 5, 6, 7});
     }},
    {0xFF00, [](IntelligentScenario& s) { s.cpu(module::CpuState::stop); }},
};

TEST(Me3ErrorTable, EveryEmergencyCode_ByItsCause_OrByTheCommandAlone) {
  RecordProperty("spec", "ME3-EMCY-006 ME3-EMCY-001 ME3-OD-008 ME3-OD-009 ME3-OD-010");
  unsigned by_firmware = 0;
  for (const SpecRow& row : rows_of("EMCY code", 36)) {
    const bool firmware = row["raised_when"].starts_with("Sent by firmware");
    EXPECT_TRUE(firmware || row["raised_when"].starts_with("Not sent by firmware")) << row.place;
    by_firmware += firmware ? 1U : 0U;
    if (row["code"] == "8F01-8F7FH") {
      for (std::uint16_t node = 2; node <= 127; ++node) {
        IntelligentScenario s;
        s.power_on_as(1);
        s.set_object(0x1016, 1, static_cast<std::uint32_t>(node) << 16 | 100, 4);
        s.rx(0x700U + node, {0x05}).advance(100ms);
        const auto code = static_cast<std::uint16_t>(0x8F00 + node);
        EXPECT_EQ(emergencies_sent(s), Words{code}) << row.place;
      }
      continue;
    }
    const auto code = static_cast<std::uint16_t>(*spec_number(row["code"]));
    if (firmware && code != 0x8250) {  // 8250H: nothing causes it, see `canopus module info`
      IntelligentScenario s;
      s.power_on_as(1);
      ASSERT_TRUE(firmware_causes.contains(code)) << row.place;
      firmware_causes.at(code)(s);
      EXPECT_EQ(emergencies_sent(s), Words{code}) << row.place;
    }
    // By command 000AH, any code; the history and the register go with 1003H:00 = 0.
    IntelligentScenario s;
    s.power_on_as(1);
    s.cif({0x000A, code, 0x2211, 0x4433, 0x6655});
    s.expect(1000, {0x000B, 0});
    s.tx(0x081, {static_cast<std::uint8_t>(code & 0xFF), static_cast<std::uint8_t>(code >> 8), 0x11, 0x22,
                 0x33, 0x44, 0x55, 0x66});
    if (code == 0) continue;
    s.cif({0x0004, 0, 0x1003, 1});
    s.expect(1005, code);
    s.expect_object(0x1001, 0, 0x11, 1);
    s.set_object(0x1003, 0, 0, 1);
    s.expect_object(0x1003, 0, 0, 1).ignore_tx();
    s.expect_object(0x1001, 0, 0, 1);
  }
  EXPECT_EQ(by_firmware, 10U);
  for (const SpecRow& row : rows_of("EMCY manufacturer code", 3)) {
    IntelligentScenario s;
    s.power_on_as(1);
    const std::string& text = row["code"];  // "FF00H + 4D45303031H"
    Bytes expected{static_cast<std::uint8_t>(std::stoul(text.substr(2, 2), nullptr, 16)),
                   static_cast<std::uint8_t>(std::stoul(text.substr(0, 2), nullptr, 16)), 0};
    for (std::size_t at = 8; at < 18; at += 2) {
      expected.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(at, 2), nullptr, 16)));
    }
    switch (expected[7]) {
      case '1':
        s.plug_in().cpu_failed(s.now());
        s.cpu(module::CpuState::stop);
        break;
      case '2': s.cpu(module::CpuState::stop); break;
      default: s.y(0x02, true);
    }
    ASSERT_EQ(s.controller().sent.size(), 1U) << row.place;
    Bytes sent(s.controller().sent.front().data.begin(), s.controller().sent.front().data.end());
    sent[2] = 0;  // the error register is not the row's
    EXPECT_EQ(sent, expected) << row.place;
    s.ignore_tx();
  }
}

TEST(Me3ErrorTable, EveryErrorRegisterBit_IsSetByTheCommand_AndClearedWithTheHistory) {
  RecordProperty("spec", "ME3-OD-008");
  for (const SpecRow& row : rows_of("Error register bit", 8)) {
    IntelligentScenario s;
    s.power_on_as(1);
    const auto bit = static_cast<std::uint16_t>(1U << row.number("code"));
    s.cif({0x000A, 0x1000, bit, 0, 0});
    s.ignore_tx();
    s.expect_object(0x1001, 0, bit | 1U, 1);  // and the generic one
    s.set_object(0x1003, 0, 0, 1);
    s.ignore_tx();
    s.expect_object(0x1001, 0, 0, 1);
  }
}

// --- SDO abort codes

TEST(Me3ErrorTable, EverySdoAbortCode_OfAnotherNode_IsShownUnchanged) {
  RecordProperty("spec", "ME3-DIAG-002 ME3-SDO-005");
  for (const SpecRow& row : rows_of("SDO abort", 33)) {
    const auto code = static_cast<std::uint32_t>(*spec_number(row["code"]));
    const Words shown{
        0x000F, 0x0003, 2, static_cast<std::uint16_t>(code & 0xFFFF), static_cast<std::uint16_t>(code >> 16),
        0};
    IntelligentScenario s;
    s.power_on_as(1);
    s.write(1000, {0x0004, 2, 0x1000, 0}).y(0x17, true).advance(1ms).ignore_tx();
    s.rx(0x582, {0x80, 0x00, 0x10, 0x00, static_cast<std::uint8_t>(code & 0xFF),
                 static_cast<std::uint8_t>(code >> 8 & 0xFF), static_cast<std::uint8_t>(code >> 16 & 0xFF),
                 static_cast<std::uint8_t>(code >> 24)});
    s.expect_x(0x17, true).expect(1000, shown).no_tx();
  }
}

// Those that its own dictionary answers, and those that it finds itself as a client.
TEST(Me3ErrorTable, SdoAbortCodesOfItsOwn) {
  RecordProperty(
      "spec", "ME3-OD-002 ME3-OD-003 ME3-OD-004 ME3-OD-005 ME3-OD-010 ME3-PDO-005 ME3-CIF-012 ME3-STO-001");
  const std::vector<std::pair<std::uint32_t, Words>> answers{
      {0x06010001, {0x0004, 0, 0x1F25, 1}},
      {0x06010002, {0x0002, 0, 0x1000, 0, 4, 0}},
      {0x06020000, {0x0004, 0, 0x2000, 0}},
      {0x06020000, {0x0004, 0, 0x0005, 0}},
      {0x06040041, {0x0002, 0, 0x1604, 1, 4, 0x0110, 0xA100}},
      {0x06070010, {0x0002, 0, 0x1017, 0, 0}},
      {0x06070012, {0x0002, 0, 0x1017, 0, 4, 0}},
      {0x06070013, {0x0002, 0, 0x1017, 0, 1, 0}},
      {0x06090011, {0x0004, 0, 0x1018, 4}},
      {0x06090030, {0x0002, 0, 0x1F81, 2, 4, 0x0003, 0}},
      {0x06090030, {0x0002, 0, 0x1003, 0, 1, 1}},
      {0x08000020, {0x0002, 0, 0x1010, 1, 4, 0x1234, 0}},
      {0x08000022, {0x0002, 0, 0x1F82, 2, 1, 5}},
      {0x50000000, {0x0004, 128, 0x1000, 0}},
      {0x50000000, {0x0004, 0xFFFF, 0x1000, 0}},  // the end of a list, but this is none
      {0x50000000, {0x0002, 0xFFFF, 0x1017, 0, 2, 1}},
  };
  IntelligentScenario s;
  s.power_on_as(1);
  s.set_object(0x1604, 0, 0, 1);
  for (const auto& [code, words] : answers) {
    s.cif(words);
    s.expect(1000, {0x000F, 0x0003, words[1], static_cast<std::uint16_t>(code & 0xFFFF),
                    static_cast<std::uint16_t>(code >> 16)})
        .no_tx();
  }
  // Too much is mapped.
  s.set_object(0x1604, 1, 0xA6800120, 4)
      .set_object(0x1604, 2, 0xA6800220, 4)
      .set_object(0x1604, 3, 0xA4C00108, 4);
  s.cif({0x0002, 0, 0x1604, 0, 1, 3});
  s.expect(1003, {0x0042, 0x0604});
  s.set_object(0x1604, 0, 2, 1);
  // As a client: silence, a wrong toggle bit, an unknown answer, too many bytes.
  const auto fails = [&](std::uint32_t code, Where where = Where::current()) {
    s.wait_x(0x17, true).y(0x17, false).ignore_tx();
    s.expect(1000,
             {0x000F, 0x0003, 2, static_cast<std::uint16_t>(code & 0xFFFF),
              static_cast<std::uint16_t>(code >> 16)},
             where);
  };
  const auto asks = [&] { s.write(1000, {0x0004, 2, 0x2000, 0}).y(0x17, true).advance(1ms).ignore_tx(); };
  asks();
  fails(0x05040000);
  asks();
  s.rx(0x582, {0x41, 0x00, 0x20, 0x00, 10, 0, 0, 0}).rx(0x582, {0x10, 1, 2, 3, 4, 5, 6, 7});
  fails(0x05030000);
  asks();
  s.rx(0x582, {0xE0, 0x00, 0x20, 0x00, 0, 0, 0, 0});
  fails(0x05040001);
  asks();
  s.rx(0x582, {0x41, 0x00, 0x20, 0x00, 125, 0, 0, 0});
  fails(0x60600000);
}

// --- LEDs

TEST(Me3ErrorTable, EveryLedRow_IsSeen) {
  RecordProperty("spec", "ME3-LED-001 ME3-LED-003 ME3-LED-006 ME3-LED-009");
  const std::map<std::string, std::function<void(IntelligentScenario&)>> shown_by{
      {"RUN ON", [](IntelligentScenario& s) { s.power_on(); }},
      {"RUN OFF",
       [](IntelligentScenario& s) {
         s.power_on();
         s.plug_in().inject(module::ModuleFault::watchdog_error, s.now());
       }},
      {"ERR. ON", [](IntelligentScenario& s) { s.power_on(), s.write(24, 300); }},
      {"CAN RUN ON", [](IntelligentScenario& s) { s.power_on_layer2(11), s.online(); }},
      {"CAN RUN flickering",
       [](IntelligentScenario& s) {
         s.power_on_as(1);
         for (const std::uint16_t index : Words{0x1F84, 0x1F85, 0x1F86, 0x1F87, 0x1F88})
           s.set_object(index, 5, 7, 4);
         s.set_object(0x1F80, 0, 1, 4);
         s.set_object(0x1F81, 5, 0x0D, 4);
         s.set_object(0x1F89, 0, 1000, 4);
         s.store_objects().restart();
         s.wait_bit(25, 10, true).ignore_tx();
       }},
      {"CAN RUN blinking", [](IntelligentScenario& s) { s.power_on(); }},
      {"CAN RUN single flash", [](IntelligentScenario& s) { s.power_on(), s.nmt(0x02); }},
      {"CAN RUN OFF", [](IntelligentScenario& s) { s.power_on_layer2(29); }},
      {"TX/RX ON", [](IntelligentScenario& s) { s.power_on(), s.rx(0x123, {1}); }},
      {"CAN ERR ON", [](IntelligentScenario& s) { s.power_on(), s.error_counters(256, 0); }},
      {"CAN ERR blinking", [](IntelligentScenario& s) { s.power_on(), s.write(24, 300); }},
      {"CAN ERR double flash",
       [](IntelligentScenario& s) {
         s.power_on();
         s.set_object(0x1016, 1, 0x00020064, 4);
         s.rx(0x702, {0x05}).advance(100ms);
       }},
      {"CAN ERR single flash", [](IntelligentScenario& s) { s.power_on(), s.error_counters(96, 0); }},
      {"CAN ERR OFF", [](IntelligentScenario& s) { s.power_on(); }},
  };
  for (const SpecRow& row : rows_of("LED", 15)) {
    const std::string& text = row["code"];
    IntelligentScenario s;
    const std::string key = text == "CAN ERR flickering" ? "CAN RUN flickering" : text;
    ASSERT_TRUE(shown_by.contains(key)) << row.place << ' ' << text;
    shown_by.at(key)(s);
    bool found = false;
    for (const module::Led& led : s.plug_in().leds(s.now())) {
      const std::string name(led.name);
      if (!text.starts_with(name + " ")) continue;
      found = true;
      std::string pattern = text.substr(name.size() + 1);
      if (pattern == "ON" || pattern == "OFF") pattern = pattern == "ON" ? "on" : "off";
      EXPECT_EQ(module::name(led.pattern), pattern) << row.place << ' ' << text;
    }
    EXPECT_TRUE(found) << text;
    s.ignore_tx();
    s.controller().sent.clear();
  }
}

// --- 1029H

TEST(Me3ErrorTable, EveryErrorBehavior_OnEveryCause) {
  RecordProperty("spec", "ME3-EB-001 ME3-EB-002 ME3-EB-003 ME3-EB-005 ME3-EB-006");
  const std::map<std::string, std::function<void(IntelligentScenario&)>> failures{
      {"bus-off", [](IntelligentScenario& s) { s.error_counters(256, 0); }},
      {"heartbeat",
       [](IntelligentScenario& s) {
         s.set_object(0x1016, 1, 0x00020064, 4);
         s.rx(0x702, {0x05}).advance(100ms);
       }},
      {"life guarding",
       [](IntelligentScenario& s) {
         s.set_object(0x100C, 0, 100, 2);
         s.set_object(0x100D, 0, 1, 1);
         s.rx_remote(0x701, 1).advance(100ms);
       }},
      {"internal failure",
       [](IntelligentScenario& s) { s.plug_in().inject(module::ModuleFault::hardware_error, s.now()); }},
      {"CPU stop", [](IntelligentScenario& s) { s.cpu(module::CpuState::stop); }},
  };
  for (const SpecRow& row : rows_of("Error behavior 1029H/01", 3)) {
    const auto value = static_cast<std::uint16_t>(row.number("code"));
    for (const auto& [name, fail] : failures) {
      for (const bool was_operational : {true, false}) {
        IntelligentScenario s;
        s.power_on_as(1);
        s.set_object(0x1029, 1, value, 1);
        if (was_operational) s.nmt(0x01, 1).expect(25, 0x0201);
        fail(s);
        const std::uint16_t unchanged = was_operational ? 0x0201 : 0x0100;
        const std::uint16_t after = value == 2                         ? 0x0000
                                    : value == 1 && name != "CPU stop" ? unchanged
                                                                       : 0x0100;
        EXPECT_EQ(s.read(25), after) << row.place << ' ' << name;
        // Start: refused only while the CPU is in STOP, and then only with 0 and 2.
        s.nmt(0x01, 1);
        EXPECT_EQ(s.read(25), name != "CPU stop" || value == 1 ? 0x0201 : after) << row.place << ' ' << name;
        s.ignore_tx();
      }
    }
  }
}

}  // namespace
}  // namespace canopus::scenario
