// Every emergency code and SDO abort code of spec/me3can1-q/errors.csv against the running module.

#include "scenarios/me3can1_q/error_table.hpp"

namespace canopus::scenario::me3can1_q_emergency_table_test {
namespace {

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
    // By command 000AH, any code; the history and the register go with 1003:00 = 0.
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

}  // namespace
}  // namespace canopus::scenario::me3can1_q_emergency_table_test
