// Corners of the module as LSS master [ME3CAN1-Q 4.8.11; RJ71CN91 1.2]: it is no LSS slave by any service, and searches from
// any own bit rate.

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::me3can1_q_lss_corners_test {
namespace {

using namespace rj71cn91_presets;

CANOPUS_OF_BOTH_MODULES(LssCorners);

constexpr std::uint32_t to_slaves = 0x7E5;
constexpr unsigned lss_active = 10;  // bit of G25

Bytes command(std::uint8_t service, std::uint32_t value) {
  Bytes bytes{service};
  for (const std::uint8_t byte : canopen::little_endian(value, 4)) bytes.push_back(byte);
  bytes.resize(8, 0);
  return bytes;
}

TEST_P(LssCorners, ItsOwnIdentity_SelectsNothing) {
  spec("ME3-LSS-001", "RJ71-LSS-001");
  for (const bool is_master : {false, true}) {
    IntelligentScenario s(GetParam());
    start_as(s, 1, {{0x1F80, 0, is_master ? 1U : 0U}});
    s.advance(1s).ignore_tx();
    const canopen::ObjectDictionary& objects = s.plug_in().node().dictionary();
    const auto identity = [&](std::uint8_t sub) { return objects.get<std::uint32_t>(0x1018, sub); };
    const std::array parts{identity(1), identity(2), identity(3), 0U};
    ASSERT_NE(parts[0], 0U);
    const auto receive_select = [&](std::uint8_t first) {
      for (std::uint8_t i = 0; i < 4; ++i)
        s.rx(to_slaves, command(static_cast<std::uint8_t>(first + i), parts[i])).no_tx();
    };
    receive_select(0x40);  // switch state selective
    s.rx(to_slaves, {0x11, 0x20, 0, 0, 0, 0, 0, 0}).rx(to_slaves, {0x13, 0, 0, 0, 0, 0, 0, 0});
    s.rx(to_slaves, {0x15, 10, 0, 0, 0, 0, 0, 0}).rx(to_slaves, {0x17, 0, 0, 0, 0, 0, 0, 0});
    for (const std::uint8_t inquiry : Bytes{0x5A, 0x5B, 0x5C, 0x5D, 0x5E})
      s.rx(to_slaves, command(inquiry, 0));
    for (std::uint8_t i = 0; i < 2;
         ++i)  // identify remote slave: vendor, product, revision and serial from, to
      s.rx(to_slaves, command(static_cast<std::uint8_t>(0x46 + i), parts[i]));
    for (std::uint8_t i = 2; i < 6; ++i)
      s.rx(to_slaves, command(static_cast<std::uint8_t>(0x46 + i), i % 2 == 0 ? 0U : 0xFFFF'FFFFU));
    s.rx(to_slaves, command(0x4C, 0))
        .rx(to_slaves, {0x51, 0, 0, 0, 0, 0x80, 0, 0});  // non-configured, fastscan
    s.advance(5s).no_tx();
    EXPECT_EQ(s.plug_in().node().node_id(), 1);
    EXPECT_EQ(s.controller().rate, 250'000U);
  }
}

TEST_P(LssCorners, Search_FromEveryOwnBitRate_TriesTheOthersOfTheStandard) {
  spec("ME3-LSS-005", "RJ71-LSS-005 RJ71-LSS-004");
  constexpr std::array<std::uint32_t, 8> standard{1000, 800, 500, 250, 125, 50, 20, 10};
  constexpr std::array<std::uint8_t, 8> index{0, 1, 2, 3, 4, 6, 7, 8};
  constexpr std::uint8_t index_of_100 = 5;  // CiA 305 has taken it back
  for (const std::uint16_t own : Words{100, 10, 50, 125, 1000}) {
    SCOPED_TRACE(own);
    IntelligentScenario s(GetParam());
    ASSERT_TRUE(s.plug_in().preset_word(24, own));
    start_as(s, 1,
             {{0x1F80, 0, 1},
              {0x1F81, 5, 0x0D},
              {0x1F84, 5, 0x000F0191},
              {0x1F85, 5, 0x71},
              {0x1F86, 5, 0xED63},
              {0x1F87, 5, 0x10000},
              {0x1F88, 5, 0x12345678},
              {0x1F89, 0, 2000}});
    s.ignore_tx().wait_bit(25, lss_active, true).expect(37, static_cast<std::uint16_t>(10 * own));
    std::vector<std::uint32_t> wanted{own};
    for (const std::uint32_t rate : standard) {
      if (rate != own) wanted.push_back(rate);
    }
    std::vector<std::uint32_t> tried;
    for (int ms = 0; ms < 5000 && tried.size() < wanted.size(); ++ms) {
      for (const can::Frame& frame : s.controller().sent) {
        if (frame.identifier == to_slaves && frame.data[0] == 0x43)
          tried.push_back(s.controller().rate / 1000);
      }
      s.ignore_tx();
      if (tried.size() < wanted.size()) s.advance(1ms);
    }
    EXPECT_EQ(tried, wanted);
    // It is found at the last one, and gets the own rate.
    s.rx(0x7E4, {0x44, 0, 0, 0, 0, 0, 0, 0}).tx(to_slaves, {0x11, 0x05, 0, 0, 0, 0, 0, 0});
    const auto* const place = std::ranges::find(standard, own);
    const std::uint8_t wanted_index =
        place == standard.end() ? index_of_100 : index[static_cast<std::size_t>(place - standard.begin())];
    s.rx(0x7E4, {0x11, 0, 0, 0, 0, 0, 0, 0}).tx(to_slaves, {0x13, 0x00, wanted_index, 0, 0, 0, 0, 0});
    s.rx(0x7E4, {0x13, 0, 0, 0, 0, 0, 0, 0}).tx(to_slaves, {0x17, 0, 0, 0, 0, 0, 0, 0});
    s.rx(0x7E4, {0x17, 0, 0, 0, 0, 0, 0, 0}).tx(to_slaves, {0x15, 100, 0, 0, 0, 0, 0, 0});
    s.advance(1s).ignore_tx().expect_bit(25, lss_active, false);
    EXPECT_EQ(s.controller().rate, own * 1000U);
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_lss_corners_test
