// What a refused entry of a concise DCF leads to, and the way of a file into 1F22H [RJ71CN91 1.2, 5.5, App. 3 1F22H, App. 5].

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_configuration_manager_test {
namespace {

using namespace rj71cn91_presets;

constexpr std::uint32_t optional = 0x05;   // 1F81H: NMT slave and boot slave
constexpr std::uint32_t mandatory = 0x0D;  // and mandatory

/// 1017:00 = 100 and 1015:00 = 9, and what is written of it.
const Bytes two_entries{2, 0, 0, 0, 0x17, 0x10, 0, 2, 0, 0, 0, 100, 0, 0x15, 0x10, 0, 2, 0, 0, 0, 9, 0};
const Bytes write_1017{0x2B, 0x17, 0x10, 0x00, 0x64, 0x00, 0, 0};
const Bytes written_1017{0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0};
const Bytes write_1015{0x2B, 0x15, 0x10, 0x00, 0x09, 0x00, 0, 0};
const Bytes written_1015{0x60, 0x15, 0x10, 0x00, 0, 0, 0, 0};

Bytes refused(std::uint8_t low, std::uint32_t code) {
  Bytes answer{0x80, low, 0x10, 0x00};
  for (const std::uint8_t byte : canopen::little_endian(code, 4)) answer.push_back(byte);
  return answer;
}

TEST(Rj71Configuration, RefusedEntry_OfAReadOnlyObjectToo_IsABootFailure) {
  RecordProperty("spec", "RJ71-CM-010 RJ71-STARTUP-007 RJ71-STARTUP-019");
  for (const std::uint32_t assignment : {optional, mandatory}) {
    for (const std::uint32_t code : {0x06010002U, 0x06090030U, 0x06020000U}) {
      for (const bool is_last : {false, true}) {
        IntelligentScenario s(rj71cn91);
        start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 126, assignment}});
        EXPECT_EQ(write_concise_dcf(s, 126, two_entries), 0U);
        s.restart();
        s.rx(0x77E, {0x00}).tx(0x67E, ask_1000).rx(0x5FE, is_0191).tx(0x67E, write_1017);
        if (is_last) s.rx(0x5FE, written_1017).tx(0x67E, write_1015);
        s.rx(0x5FE, refused(is_last ? 0x15 : 0x17, code)).no_tx();  // the entry behind it is not written
        const bool stops = assignment == mandatory;
        s.expect_bit(25, 11, stops).expect_bit(25, 13, !stops).expect_bit(25, 14, false);
        s.expect(601, stops ? 0x7F : 0x05).expect(726, 0x7F).expect(526, 0x0010).expect_x(0x10, true);
        EXPECT_EQ(error_codes(s), stops ? (std::vector<std::uint16_t>{0x1808, 0x1807})
                                        : (std::vector<std::uint16_t>{0x1808}));
        const auto error = s.plug_in().module_errors()[0];
        EXPECT_EQ(error.details[0].name, "Node ID");
        EXPECT_EQ(error.details[0].value, 126U);
        EXPECT_EQ(error.details[1].name, "NMT slave setting error cause");
        EXPECT_NE(error.details[1].value, 0U);
        s.advance(60s).no_tx().expect(726, 0x7F);  // not started
        if (stops) continue;
        // A slave that takes everything the next time is started.
        s.rx(0x77E, {0x00}).tx(0x67E, ask_1000).rx(0x5FE, is_0191).tx(0x67E, write_1017);
        s.rx(0x5FE, written_1017).tx(0x67E, write_1015).rx(0x5FE, written_1015);
        s.tx(0x000, {0x01, 0x7E}).no_tx().expect(726, 0x05).expect_bit(25, 13, false);
      }
    }
  }
}

TEST(Rj71Configuration, Request_EndsWithTheFirstRefusedEntry) {
  RecordProperty("spec", "RJ71-CM-003 RJ71-CM-010");
  IntelligentScenario s(rj71cn91);
  start_as(s, 1, {{0x1F80, 0, 1}});
  s.advance(1s).ignore_tx();
  EXPECT_EQ(write_concise_dcf(s, 5, two_entries), 0U);
  for (const bool refuses : {true, false}) {
    s.cif({0x0002, 0, 0x1F25, 5, 4, 0x6F63, 0x666E}).expect(1000, 0x0003).tx(0x605, write_1017);
    s.rx(0x585, refuses ? refused(0x17, 0x06010002) : written_1017);
    if (!refuses) s.tx(0x605, write_1015).rx(0x585, written_1015);
    s.advance(5s).no_tx();
  }
}

TEST(Rj71Configuration, File_IsNotSetByTheCommandInterface_ButReadAndDeleted) {
  RecordProperty("spec", "RJ71-CM-011 RJ71-CM-005");
  for (const std::uint8_t own : Bytes{1, 127}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(own);
    const Words file{13, 1, 0, 0x1017, 0x0200, 0, 0x6400, 0};
    const auto holds = [&](std::uint16_t bytes) {
      s.cif({0x0004, 0, 0x1F22, 2}).expect(1000, {0x0005, 0, 0x1F22, 2, bytes});
    };
    for (const std::uint16_t node : {std::uint16_t{0}, std::uint16_t{own}}) {
      for (const std::uint16_t sub : Words{2, 127}) {
        Words command{0x0002, node, 0x1F22, sub};
        command.insert(command.end(), file.begin(), file.end());
        s.cif(command).expect_abort(0x06010000, node).no_tx();
      }
      s.cif({0x0002, node, 0x1F22, 2, 4, 0, 0}).expect_abort(0x06010000, node).no_tx();
      s.cif({0x0002, node, 0x1F22, 2, 1, 1}).expect_abort(0x06010000, node).no_tx();
      // Among several, the others are written.
      s.cif({0x0006, node, 0x1F22, 2, 4, 0, 0, 0, 0, node, 0x1017, 0, 2, 77, 0, 0, 0, 0xFFFF});
      s.expect(1000, {0x00F7, static_cast<std::uint16_t>(0x0F00 | node), 0x1F22, 2});
      s.expect(1005, {0x0000, 0x0601}).expect(1009, {node, 0x1017, 0}).no_tx();
      s.expect_object(0x1017, 0, 77, 2).set_object(0x1017, 0, 0, 2).ignore_tx();
      holds(0);
    }
    EXPECT_EQ(write_concise_dcf(s, 2, one_entry), 0U);  // another node may
    holds(13);
    s.expect(1005, {0x0001, 0x0000, 0x1017, 0x0200, 0x0000, 0xE800, 0x0003});
    s.cif({0x0002, 0, 0x1F22, 2, 13, 1, 0, 0x1017, 0x0200, 0, 0x6400, 0}).expect_abort(0x06010000);
    holds(13);
    s.cif({0x0002, 0, 0x1F22, 2, 1, 0}).expect(1000, 0x0003).no_tx();
    holds(0);
    // 1F22H of another node is that node's business.
    s.write(1000, {0x0002, 5, 0x1F22, 2, 2, 7}).y(0x17, true).advance(1ms);
    s.tx(0x605, {0x2B, 0x22, 0x1F, 0x02, 0x07, 0x00, 0, 0}).rx(0x585, {0x60, 0x22, 0x1F, 0x02, 0, 0, 0, 0});
    s.expect(1000, 0x0003).y(0x17, false).no_tx();
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_configuration_manager_test
