// MPDOs and the PDO tables of CANopen 417 mode [FX3U-CAN 5.6, 5.6.6].

#include <cctype>
#include <optional>
#include <set>
#include <string>

#include "canopus/module/models/fx3u_can/object_table.hpp"

#include "scenarios/fx3u_can/lift_scenario.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario::fx3u_can_lift_objects_test {
namespace {

// T417-50, T417-51
TEST(FxMpdo, ToThisNode_OrToAll_WritesItsObject) {
  RecordProperty(
      "spec",
      "FX3U-MPDO-001 FX3U-MPDO-002 FX3U-MPDO-003 FX3U-MPDO-004 FX3U-MPDO-005 FX3U-DRV-013 FX3U-PDO-019");
  BlockScenario s;
  start_lift_operational(s, 1, 5);
  s.rx(0x507, {0x85, 0x01, 0x63, 4, 0xFF, 0x1F, 0, 0})
      .expect(12053, 0xFFFF)
      .exchange(0x0100)
      .expect(12053, 0x1FFF);
  s.rx(0x507, {0x80, 0x01, 0x63, 4, 0xFF, 0x4F, 0, 0}).exchange(0x0100).expect(12053, 0x4FFF);
  for (const std::uint8_t other : Bytes{0x81, 0x84, 0x86, 0xFF, 0x05, 0x00})
    s.rx(0x507, {other, 0x01, 0x63, 4, 0, 0, 0, 0}).exchange(0x0100).expect(12053, 0x4FFF);
  s.rx(0x501, {0x85, 0x90, 0x63, 1, 0x64, 0, 0, 0}).exchange(0x0100).expect(12364, 0x0064);
  s.rx(0x57F, {0x85, 0x07, 0x64, 0, 1, 2, 3, 4}).exchange(0x0100).expect(12460, {0x0201, 0x0403});
  s.rx(0x540, {0x85, 0x82, 0x64, 2, 9, 0, 0, 0}).exchange(0x0100).expect(12525, 9);
  // Objects of six bytes have no room in one; a short frame is none.
  s.rx(0x507, {0x85, 0x10, 0x60, 0, 2, 1, 1, 3}).expect(12004, 0).no_tx();
  s.rx(0x507, {0x85, 0x90, 0x63, 1, 0x65}).exchange(0x0100).expect(12364, 0x0064).ignore_tx();
  s.expect_object(0x1401, 0, 2, 1).expect_object(0x1601, 0, 0xFF, 1);
}

// T417-52
TEST(FxMpdo, WithoutItsObject_IsReported) {
  RecordProperty("spec", "FX3U-MPDO-006 FX3U-MPDO-007");
  BlockScenario s;
  start_lift_operational(s);
  const auto expect_reported = [&s](std::uint16_t index, std::uint8_t sub) {
    s.rx(0x507,
         {0x81, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8), sub, 0, 0, 0, 0});
    ASSERT_EQ(s.controller().sent.size(), 1U);
    const can::Frame& emergency = s.controller().sent.front();
    EXPECT_EQ(emergency.identifier, 0x081U);
    EXPECT_EQ(emergency.data[0] | emergency.data[1] << 8, 0x8230);
    EXPECT_NE(emergency.data[2] & 0x10, 0);  // communication error
    s.ignore_tx();
    s.rx(0x507, {0x81, 0x90, 0x63, 1, 0x64, 0, 0, 0}).ignore_tx();  // one that is taken ends it
  };
  expect_reported(0x1234, 0);
  expect_reported(0x6301, 5);
  expect_reported(0x6300, 1);
  s.expect_object(0x6300, 1, 0xFFFF, 2);
}

// T417-53
TEST(FxMpdo, CanBeDisabled_AndCountsInOperational) {
  RecordProperty("spec", "FX3U-MPDO-008 FX3U-MPDO-010");
  BlockScenario s;
  start_lift_operational(s);
  for (std::uint32_t node = 1; node <= 127; ++node)
    s.expect_object(static_cast<std::uint16_t>(0x1400 + node), 1, 0x500 + node, 4);
  s.set_object(0x1407, 1, 0x80000507, 4).rx(0x507, {0x81, 0x90, 0x63, 1, 0x64, 0, 0, 0}).exchange(0x0100);
  s.expect(12364, 0).rx(0x508, {0x81, 0x90, 0x63, 1, 0x65, 0, 0, 0}).exchange(0x0100).expect(12364, 0x65);
  s.nmt(0x80)
      .rx(0x508, {0x81, 0x90, 0x63, 1, 0x66, 0, 0, 0})
      .nmt(0x01)
      .exchange(0x0100)
      .expect(12364, 0x65)
      .no_tx();
}

TEST(FxMpdo, ToBeSent_IsSetUp_ButNothingAsksForIt) {
  RecordProperty("spec", "FX3U-MPDO-009");
  BlockScenario s;
  start_lift_operational(s, 1, 5);
  s.expect_object(0x1801, 0, 2, 1).expect_object(0x1801, 1, 0x40000505, 4).expect_object(0x1801, 2, 0xFF, 1);
  s.expect_object(0x1A01, 0, 0xFF, 1)
      .write(13001, {1, 2, 3})
      .exchange()
      .tx(0x400, {1, 0, 2, 0, 3, 0})
      .no_tx();
}

// The manual's notation: "00000188h + 10h*(lift-1)".
std::optional<std::uint32_t> of_instance(const std::string& text, std::uint32_t instance,
                                         std::uint32_t number, std::uint8_t sub) {
  std::size_t digits = 0;
  if (text.empty() || !std::isxdigit(static_cast<unsigned char>(text[0]))) return std::nullopt;
  const bool is_hex = text.find('h') != std::string::npos;
  std::uint32_t value = static_cast<std::uint32_t>(std::stoul(text, &digits, is_hex ? 16 : 10));
  const std::size_t plus = text.find("+ ");
  if (plus == std::string::npos) return value;
  const std::string rest = text.substr(plus + 2);
  if (rest.starts_with("k*100h")) return value + sub * 0x100U;
  if (rest.starts_with("node-ID")) return value + 1;
  if (rest.starts_with("n")) return value + number;
  return value + static_cast<std::uint32_t>(std::stoul(rest, nullptr, 16)) * instance;
}

// T417-60, T417-61: every row of od-417-l2.csv.
TEST(FxLiftObjects, EveryPdo_IsAsTheTablesSay) {
  RecordProperty("spec",
                 "FX3U-OD417-001 FX3U-OD417-002 FX3U-OD417-003 FX3U-OD417-004 FX3U-OD417-005 FX3U-OD417-007");
  BlockScenario s;
  start_lift_operational(s);
  const auto& objects = s.plug_in().node().dictionary();
  std::set<std::uint16_t> named;
  unsigned checked = 0;
  for (const SpecRow& row : spec_rows("fx3u-can", "od-417-l2.csv")) {
    const unsigned first = row.number("index_first", 16), last = row.number("index_last", 16);
    if (first < 0x1400 || first >= 0x2000) continue;
    const unsigned sub_first = row.number("sub_first", 16), sub_last = row.number("sub_last", 16);
    const bool by_lift = row["notes"].find("stride 0010") != std::string::npos;
    if (row["access"] == "none") {
      for (unsigned index = first; index <= last && !by_lift && first != 0x1901; ++index)
        EXPECT_EQ(objects.find(static_cast<std::uint16_t>(index), 0).error(), canopen::AbortCode::no_object)
            << std::hex << index;
      continue;
    }
    for (unsigned index = first; index <= last; index += by_lift ? 0x10 : 1) {
      if (first == 0x1902 && last == 0x1978 && (index & 0xF) != 2 && (index & 0xF) != 4 && (index & 0xF) != 8)
        continue;
      named.insert(static_cast<std::uint16_t>(index));
      for (unsigned sub = sub_first; sub <= sub_last; ++sub) {
        const auto entry = objects.find(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub));
        ASSERT_TRUE(entry) << row.place << ' ' << std::hex << index << ':' << sub;
        std::string text = row["default"];
        if (first == 0x1681 && sub == 1) text = "60100030h";  // 6011H is the output [notes 1]
        if (first == 0x1800 && sub == 1) text = "C0000000h";  // bit 30 [notes 4]
        if (first == 0x1801 && sub == 1) text = "40000500h + node-ID";
        const std::uint32_t start = first == 0x1401 || first == 0x1601 ? 0x1400U
                                    : first == 0x1481                  ? 0x1480U
                                                                       : first;
        const auto value =
            of_instance(text, (index - first) / 0x10, index - start, static_cast<std::uint8_t>(sub));
        if (value) {
          EXPECT_EQ(objects.get<std::uint32_t>(*entry), *value)
              << row.place << ' ' << std::hex << index << ':' << sub;
          ++checked;
        }
        const bool writes = entry->description->access == canopen::Access::read_write;
        EXPECT_EQ(writes, row["access"] == "RW") << row.place << ' ' << std::hex << index << ':' << sub;
        if (row["access"] == "RW") {
          EXPECT_TRUE(entry->description->stored) << row.place;
        }
      }
    }
  }
  EXPECT_GT(checked, 2000U);
  for (const canopen::ObjectDescription& object : objects.description().objects()) {
    if (object.index >= 0x1400 && object.index < 0x1C00) {
      EXPECT_TRUE(named.contains(object.index)) << std::hex << object.index;
    }
  }
  for (const std::uint16_t index :
       Words{0x1480, 0x1502, 0x1504, 0x1508, 0x1510, 0x1582, 0x1802, 0x1901, 0x1903, 0x1979}) {
    s.cif({0x0004, 0, index, 0}).expect_abort(0x06020000);
    s.cif({0x0004, 0, static_cast<std::uint16_t>(index + 0x0200), 0}).expect_abort(0x06020000);
  }
  for (const std::uint16_t index : Words{0x1601, 0x1681, 0x1703, 0x17F1, 0x1A01, 0x1B00, 0x1B02, 0x1B78}) {
    const bool is_mpdo = index == 0x1601 || index == 0x1A01;
    if (!is_mpdo) s.cif({0x0002, 0, index, 1, 4, 0, 0}).expect_abort(0x06010002);
    s.cif({0x0002, 0, index, 0, 1, 0}).expect_abort(0x06010002);
  }
  s.set_object(0x1600, 0, 0, 1).set_object(0x1A00, 0, 0, 1);
  for (const std::uint16_t sub : Words{3, 4, 5}) s.cif({0x0004, 0, 0x1401, sub}).expect_abort(0x06090011);
  s.cif({0x0004, 0, 0x1501, 4}).expect_abort(0x06090011);
  // A COB-ID: not valid, another, valid.
  s.cif({0x0002, 0, 0x1503, 1, 4, 0x0283, 0}).expect_abort(0x06090030);
  s.set_object(0x1503, 1, 0x80000183, 4)
      .set_object(0x1503, 1, 0x80000283, 4)
      .set_object(0x1503, 1, 0x00000283, 4);
  s.rx(0x183, {1, 0, 0, 0, 0, 0, 0, 0}).exchange(0x0100).expect(12428, 0);
  s.rx(0x283, {1, 0, 0, 0, 0, 0, 0, 0}).exchange(0x0100).expect(12428, 1).ignore_tx();
}

// bfm-417-l2.csv: default and access of every word of the lift areas, with firmware 1.10 or later.
TEST(FxLiftObjects, EveryWord_HasItsDefault_AndItsAccess) {
  RecordProperty("spec", "FX3U-LIFT-016 FX3U-LIFT-017 FX3U-LIFT-018");
  BlockScenario s;
  start_lift_operational(s);
  unsigned checked = 0;
  for (const SpecRow& row : spec_rows("fx3u-can", "bfm-417-l2.csv")) {
    if ((';' + row["modes"] + ';').find(";417;") == std::string::npos || row["first"].empty()) continue;
    const unsigned first = row.number("first"), last = row.number("last"), stride = row.number("stride");
    const bool is_lift = (first >= 3000 && first <= 9999) || first >= 10000;
    const bool is_whole = row["bits"].empty() || row["bits"] == "0-15" || row["bits"] == "0-31";
    const std::string& access = row["access_plc"];
    if (!is_lift || access == "W") continue;
    if (access != "none" && (!is_whole || row["notes"].find("table 8.1 puts") != std::string::npos)) continue;
    const auto value = access == "none" ? std::optional<long>(0) : spec_number(row["default"]);
    if (!value) continue;
    const unsigned words = row["bits"] == "0-31" ? 2 : 1;
    for (unsigned address = first; address <= last && address < 32768; address += std::max(stride, 1U)) {
      for (unsigned word = 0; word < words; ++word) {
        // Where one side is reserved the other may not be.
        const bool is_side = row["notes"].find("side") != std::string::npos && address < 10000;
        if (is_side && access == "none") continue;
        const auto expected = static_cast<std::uint16_t>(static_cast<unsigned long>(*value) >> (16 * word));
        EXPECT_EQ(s.read(address + word), expected) << row.place << " #" << address + word;
        ++checked;
        if (access == "RW" || address < 10000) continue;  // TO of an older number is another word
        s.write(address + word, 0x1234);
        EXPECT_EQ(s.read(address + word), expected) << row.place << " #" << address + word;
      }
    }
  }
  EXPECT_GT(checked, 1000U);
  s.expect(29, 0).expect(39, 0).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_lift_objects_test
