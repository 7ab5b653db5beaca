// Where each word of the process data lies in the object dictionary [ME3CAN1-Q 3.5.19].

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_process_data_words_test {
namespace {

CANOPUS_OF_BOTH_MODULES(ProcessData);

// --- what lies where [3.5.19]

TEST_P(ProcessData, RpdoWords_ToNetworkVariables) {
  spec("ME3-PBUF-001 ME3-PBUF-002 ME3-PBUF-003", "RJ71-RPDO-010");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
  struct Row {
    std::uint16_t index;
    std::uint8_t sub;
    std::uint32_t value;
    unsigned length;
    module::BufferAddress word;
    Words expected;
  };
  // Rows of tables 3-21, 3-22 and 3-23.
  const std::vector<Row> rows{
      {0xA4C0, 0x01, 0x11, 1, 10000, {0x0011}},
      {0xA480, 0x02, 0x22, 1, 10000, {0x2211}},
      {0xA4C0, 0xFD, 0x33, 1, 10126, {0x0033}},
      {0xA4C0, 0xFE, 0x44, 1, 10126, {0x4433}},
      {0xA4C1, 0x01, 0x55, 1, 10127, {0x0055}},
      {0xA481, 0x02, 0x66, 1, 10127, {0x6655}},
      {0xA4C7, 0xFE, 0x77, 1, 11015, {0x7700}},
      {0xA4C8, 0x01, 0x12, 1, 11016, {0x0012}},
      {0xA4C8, 0x0F, 0x13, 1, 11023, {0x0013}},
      {0xA488, 0x10, 0x14, 1, 11023, {0x1413}},
      {0xA580, 0xFE, 0x1234, 2, 10253, {0x1234}},
      {0xA581, 0x01, 0x2345, 2, 10254, {0x2345}},
      {0xA541, 0xFE, 0x3456, 2, 10507, {0x3456}},
      {0xA584, 0x08, 0x4567, 2, 11023, {0x4567}},
      {0xA680, 0x01, 0x89ABCDEF, 4, 10000, {0xCDEF, 0x89AB}},
      {0xA640, 0xFE, 0x01234567, 4, 10506, {0x4567, 0x0123}},
      {0xA6C1, 0x01, 0x3F800000, 4, 10508, {0x0000, 0x3F80}},
      {0xA682, 0x04, 0xDEADBEEF, 4, 11022, {0xBEEF, 0xDEAD}},
  };
  for (const Row& row : rows) {
    s.set_object(row.index, row.sub, row.value, row.length);
    s.exchange();
    s.expect(row.word, row.expected);
  }
  s.no_tx();
}

// The rule of the tables, for every object there is.
struct Area {
  std::uint16_t index;
  unsigned bytes;
};

std::uint32_t pattern(unsigned number, unsigned bytes) {
  const std::uint32_t value = (number + 1) * 0x9E3779B1U;
  return bytes == 4 ? value : value >> 7 & ((1U << 8 * bytes) - 1);
}

std::uint16_t object_index(const Area& area, unsigned k) {
  return static_cast<std::uint16_t>(area.index + k / 254);
}
std::uint8_t object_sub(unsigned k) { return static_cast<std::uint8_t>(k % 254 + 1); }

// What 1024 words hold when object k of the area has the value pattern(k).
Words words_of(const Area& area) {
  Words words(1024);
  for (unsigned k = 0; k < 2048 / area.bytes; ++k) {
    const std::uint32_t value = pattern(k, area.bytes);
    if (area.bytes == 4) words[2 * k + 1] = static_cast<std::uint16_t>(value >> 16);
    std::uint16_t& word = words[k * area.bytes / 2];
    word = static_cast<std::uint16_t>(area.bytes == 1 && k % 2 == 1 ? word | value << 8 : value & 0xFFFF);
  }
  return words;
}

TEST_P(ProcessData, EveryRpdoObject_LiesWhereTheRuleSays) {
  spec("ME3-PBUF-001 ME3-PBUF-002 ME3-PBUF-003", "RJ71-RPDO-010");
  for (const Area& area : {Area{0xA480, 1}, Area{0xA4C0, 1}, Area{0xA540, 2}, Area{0xA580, 2},
                           Area{0xA640, 4}, Area{0xA680, 4}, Area{0xA6C0, 4}}) {
    IntelligentScenario s(GetParam());
    s.power_on_operational();
    for (unsigned k = 0; k < 2048 / area.bytes; ++k)
      s.set_object(object_index(area, k), object_sub(k), pattern(k, area.bytes), area.bytes);
    s.exchange();
    s.expect(10000, words_of(area)).no_tx();
  }
}

TEST_P(ProcessData, EveryTpdoObject_LiesWhereTheRuleSays) {
  spec("ME3-PBUF-004", "RJ71-TPDO-011");
  for (const Area& area : {Area{0xA000, 1}, Area{0xA040, 1}, Area{0xA0C0, 2}, Area{0xA100, 2},
                           Area{0xA1C0, 4}, Area{0xA200, 4}, Area{0xA240, 4}}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    for (std::uint16_t n = 0; n < 4; ++n)
      s.set_object(static_cast<std::uint16_t>(0x1800 + n), 1, 0xC0000000, 4);
    const unsigned in_a_pdo = 8 / area.bytes;
    for (unsigned n = 0; n < 256; ++n) {
      const auto mapping = static_cast<std::uint16_t>(0x1A00 + n);
      s.set_object(mapping, 0, 0, 1);
      for (unsigned i = 0; i < in_a_pdo; ++i) {
        const unsigned k = n * in_a_pdo + i;
        const std::uint32_t entry = static_cast<std::uint32_t>(object_index(area, k)) << 16 |
                                    static_cast<std::uint32_t>(object_sub(k)) << 8 | 8 * area.bytes;
        s.set_object(mapping, static_cast<std::uint8_t>(i + 1), entry, 4);
      }
      s.set_object(mapping, 0, in_a_pdo, 1);
    }
    s.nmt(0x01);
    s.write(13000, words_of(area));
    s.exchange();
    for (unsigned k = 0; k < 2048 / area.bytes; ++k)
      s.expect_object(object_index(area, k), object_sub(k), pattern(k, area.bytes), area.bytes);
    s.no_tx();
  }
}

TEST(Me3ProcessData, OutputVariable_WrittenByAnotherNode) {
  RecordProperty("spec", "ME3-PRO-003");
  IntelligentScenario s;
  s.power_on_as(1);
  const Bytes write{0x2B, 0x80, 0xA5, 0x01, 0x34, 0x12, 0, 0};
  const Bytes written{0x60, 0x80, 0xA5, 0x01, 0, 0, 0, 0};
  s.rx(0x601, write).tx(0x581, written);
  s.exchange();
  s.expect(10000, 0);  // Pre-operational
  s.nmt(0x01);
  s.ignore_tx();
  s.expect(10000, 0x1234);  // the exchange has waited
  s.rx(0x601, {0x2B, 0x80, 0xA5, 0x01, 0x78, 0x56, 0, 0}).tx(0x581, written);
  s.advance(1s);
  s.expect(10000, 0x1234);
  s.exchange();
  s.expect(10000, {0x5678, 0}).no_tx();
  // An input variable is not for the network to write.
  s.rx(0x601, {0x2B, 0x00, 0xA1, 0x01, 0x34, 0x12, 0, 0});
  s.tx(0x581, {0x80, 0x00, 0xA1, 0x01, 0x02, 0x00, 0x01, 0x06}).no_tx();
}

TEST_P(ProcessData, TpdoWords_ToNetworkVariables) {
  spec("ME3-PBUF-004", "RJ71-TPDO-011");
  struct Row {
    std::uint32_t mapping;
    module::BufferAddress word;
    Words written;
    std::uint32_t value;
    unsigned length;
  };
  // Rows of tables 3-24 to 3-26; the last row of 3-26 is misprinted and stands for 14022/14023.
  const std::vector<Row> rows{
      {0xA0400108, 13000, {0x2211}, 0x11, 1},
      {0xA0000208, 13000, {0x2211}, 0x22, 1},
      {0xA040FE08, 13126, {0x4433}, 0x44, 1},
      {0xA0410108, 13127, {0x6655}, 0x55, 1},
      {0xA0481008, 14023, {0x1413}, 0x14, 1},
      {0xA100FE10, 13253, {0x1234}, 0x1234, 2},
      {0xA1010110, 13254, {0x2345}, 0x2345, 2},
      {0xA0C40810, 14023, {0x4567}, 0x4567, 2},
      {0xA2000120, 13000, {0xCDEF, 0x89AB}, 0x89ABCDEF, 4},
      {0xA1C0FE20, 13506, {0x4567, 0x0123}, 0x01234567, 4},
      {0xA2410120, 13508, {0x0000, 0x3F80}, 0x3F800000, 4},
      {0xA2020420, 14022, {0xBEEF, 0xDEAD}, 0xDEADBEEF, 4},
  };
  for (const Row& row : rows) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1800, 1, 0xC0000181, 4);
    s.set_object(0x1A00, 0, 0, 1);
    s.set_object(0x1A00, 1, row.mapping, 4);
    s.set_object(0x1A00, 0, 1, 1);
    s.set_object(0x1800, 1, 0x40000181, 4);
    s.nmt(0x01);
    s.write(row.word, row.written);
    s.exchange();
    Bytes frame;
    for (unsigned i = 0; i < row.length; ++i)
      frame.push_back(static_cast<std::uint8_t>(row.value >> (8 * i)));
    s.tx(0x181, frame);
    s.expect_object(static_cast<std::uint16_t>(row.mapping >> 16),
                    static_cast<std::uint8_t>(row.mapping >> 8), row.value, row.length);
    s.ignore_tx();
  }
}

TEST_P(ProcessData, OverlappingObjects_AreNotKeptEqual) {
  spec("ME3-PBUF-005", "");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
  s.set_object(0xA580, 1, 0x1234, 2);
  s.set_object(0xA4C0, 1, 0x99, 1);
  s.exchange();
  s.expect(10000, 0x1299);
  s.expect_object(0xA580, 1, 0x1234, 2);
  s.expect_object(0xA4C0, 1, 0x99, 1);
  s.expect_object(0xA4C0, 2, 0, 1);
}

TEST_P(ProcessData, NetworkVariables_Exist_AsTheProfileSays) {
  spec("ME3-PRO-001 ME3-PRO-002 ME3-PRO-004", "RJ71-OD-005");
  IntelligentScenario s(GetParam());
  s.power_on();
  // First index, last index, sub-indexes of the last one.
  const std::vector<std::array<std::uint16_t, 3>> inputs{
      {0xA000, 0xA008, 0x10}, {0xA040, 0xA048, 0x10}, {0xA0C0, 0xA0C4, 0x08}, {0xA100, 0xA104, 0x08},
      {0xA1C0, 0xA1C2, 0x04}, {0xA200, 0xA202, 0x04}, {0xA240, 0xA242, 0x04}};
  const std::vector<std::array<std::uint16_t, 3>> outputs{
      {0xA480, 0xA488, 0x10}, {0xA4C0, 0xA4C8, 0x10}, {0xA540, 0xA544, 0x08}, {0xA580, 0xA584, 0x08},
      {0xA640, 0xA642, 0x04}, {0xA680, 0xA682, 0x04}, {0xA6C0, 0xA6C2, 0x04}};
  const auto check = [&](const auto& areas, bool writable) {
    for (const auto& [first, last, count] : areas) {
      const unsigned length = last - first == 8 ? 1 : last - first == 4 ? 2 : 4;
      s.expect_object(first, 0, 0xFE, 1);
      s.expect_object(last, 0, count, 1);
      s.expect_object(first, 0xFE, 0, length);
      s.expect_object(last, static_cast<std::uint8_t>(count), 0, length);
      s.cif({0x0004, 0, last, static_cast<std::uint16_t>(count + 1)});
      s.expect_abort(0x06090011);
      s.cif({0x0004, 0, static_cast<std::uint16_t>(last + 1), 0});
      s.expect_abort(0x06020000);
      s.cif({0x0002, 0, first, 1, static_cast<std::uint16_t>(length), 1});
      if (writable) {
        s.expect(1000, 0x0003);
      } else {
        s.expect_abort(0x06010002);
      }
    }
  };
  check(inputs, false);
  check(outputs, true);
  for (const std::uint16_t missing :
       Words{0xA080, 0xA140, 0xA180, 0xA280, 0xA400, 0xA500, 0xA5C0, 0xA600, 0xA700}) {
    s.cif({0x0004, 0, missing, 0});
    s.expect_abort(0x06020000);
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_process_data_words_test
