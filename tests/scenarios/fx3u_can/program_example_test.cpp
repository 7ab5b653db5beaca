// The program of the manual's chapter 13 as far as its list of labels and captions tells it, S170 and S172: the steps of a
// PLC program in their order [FX3U-CAN 12, 13].

#include "scenarios/fx3u_can/layer2_slots.hpp"

namespace canopus::scenario::fx3u_can_program_example_test {
namespace {

constexpr std::uint32_t station = 3;  // a MELSEC STlite

/// The station answers the write of an SDO.
void station_takes(BlockScenario& s, const Bytes& request, Where where = Where::current()) {
  s.wait_tx(0x600 + station, request, 1s, where);
  s.rx(0x580 + station, {0x60, request[1], request[2], request[3], 0, 0, 0, 0});
}

// CANopenInit, NMTMasterSettings, NMTSlaveSettings, the heartbeats, SDOWrite, PDOSetup four times, NMTRequestWrite, PDORead,
// PDOWrite, NMTStatus, HeartbeatStatus.
TEST(FxProgram, Chapter13_FromTheInitializationToTheCyclicPart) {
  RecordProperty("spec",
                 "FX3U-EX-001 FX3U-NODE-002 FX3U-CIF-011 FX3U-PDO-001 FX3U-HB-006 FX3U-HB-007 FX3U-BOOT-019");
  BlockScenario s;
  s.power_on().write(21, 405).write(24, 250).write(26, 0).write(27, 1).expect(29, 0).save().restart();
  s.expect(37, 2500).expect(601, 0x7F);
  // Master; bit 3: the program starts the slaves.
  s.set_object(0x1F80, 0, 0x09, 4).cif({0x8400, station, 0x05, 0, 0, 0xFFFF});
  station_takes(s, {0x2B, 0x0C, 0x10, 0, 0, 0, 0, 0});
  station_takes(s, {0x2F, 0x0D, 0x10, 0, 0, 0, 0, 0});
  s.expect(1000, {0x8401, 0, 0, 0, 0}).store_objects().restart();
  s.ignore_tx().rx(0x703, {0x00}).wait_tx(0x603, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  s.rx(0x583, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0}).advance(100ms).expect(25, 0x8201).no_tx();
  // Who watches whom.
  s.cif({0x7410, 0, 500, station, 200, 0xFFFF});
  station_takes(s, {0x2B, 0x17, 0x10, 0, 200, 0, 0, 0});
  s.expect(1000, 0x7411).cif({0x7400, 0, station, 1000, 0xFFFF}).expect(1000, 0x7401);
  s.rx(0x703, {0x7F}).expect(901, 0x0002).expect(603, 0x7F).ignore_tx();
  // 28 to 32: the station's analogue inputs.
  s.cif({0x0002, station, 0x6423, 0, 1, 1});
  station_takes(s, {0x2F, 0x23, 0x64, 0, 1, 0, 0, 0});
  s.expect(1000, {0x0003, station, 0x6423, 0});
  s.cif({0x0002, station, 0x6423, 0, 1, 1}).wait_tx(0x603, {0x2F, 0x23, 0x64, 0, 1, 0, 0, 0});
  s.rx(0x583, {0x80, 0x23, 0x64, 0, 0, 0, 2, 6})
      .expect_abort(0x0602'0000, station);  // counted, and not moved on from
  // The module's own PDOs, to and from the station.
  for (std::uint32_t i = 0; i < 4; ++i) {
    const bool receives = i < 2;
    const auto number = static_cast<std::uint16_t>(i % 2);
    const auto communication = static_cast<std::uint16_t>((receives ? 0x1400 : 0x1800) + number);
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    const std::uint32_t id = (receives ? 0x180U : 0x4000'0200U) + 0x100U * number + station;
    s.set_object(communication, 1, 0x8000'0000U | id, 4).set_object(communication, 2, 0xFE, 1);
    s.set_object(mapping, 0, 0, 1);
    for (std::uint8_t entry = 1; entry <= 4; ++entry) {
      const std::uint32_t place = (receives ? 0xA580'0010U : 0xA100'0010U) + ((4U * number + entry) << 8);
      s.set_object(mapping, entry, place, 4);
    }
    s.set_object(mapping, 0, 4, 1).set_object(communication, 1, id, 4);
  }
  s.ignore_tx()
      .cif({0x0002, 0, 0x1F82, 0x80, 1, 5})
      .expect(1000, {0x0003, 0, 0x1F82, 0x80})
      .tx(0x000, {0x01, 0});
  s.expect(25, 0x8201).rx(0x703, {0x05}).expect(601, 5).expect(603, 5);
  // The cyclic part.
  for (std::uint16_t cycle = 1; cycle <= 20; ++cycle) {
    const auto low = static_cast<std::uint8_t>(cycle);
    s.ignore_tx()
        .rx(0x183, {low, 1, 2, 3, 4, 5, 6, 7})
        .rx(0x283, {low, 9, 0, 0, 0, 0, 0, 0})
        .rx(0x703, {0x05});
    s.write(11000, {cycle, 2, 3, 4})
        .write(11004, {static_cast<std::uint16_t>(100 + cycle), 0, 0, 0})
        .exchange();
    s.tx(0x203, {low, 0, 2, 0, 3, 0, 4, 0})
        .tx(0x303, {static_cast<std::uint8_t>(100 + cycle), 0, 0, 0, 0, 0, 0, 0});
    s.expect(10000, {static_cast<std::uint16_t>(0x0100 | cycle), 0x0302, 0x0504, 0x0706});
    s.expect(10004, static_cast<std::uint16_t>(0x0900 | cycle))
        .advance(10ms)
        .expect(901, 0x0002)
        .expect(29, 0);
  }
  // The station is gone: HeartbeatStatus says so, and the program takes the error away (ErrorReset).
  s.advance(1s).expect_bit(901, 7, true).expect(29, 0x0401).ignore_tx().rx(0x703, {0x05}).ignore_tx();
  s.write(29, 0).expect(29, 0).expect(901, 0x0002);
}

// S172
TEST(FxProgram, Layer2_SlotsSavedThenRestartedThenOnline) {
  RecordProperty("spec", "FX3U-L2-001 FX3U-L2-005 FX3U-L2-016 FX3U-L2-014");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    s.power_on().write(21, form.mode).write(24, 500).write(26, 0).save().restart();
    send_slot(s, 1, 0x321, 0x5FFF, 1, 4);
    receive_slot(s, 2, 0x322);
    s.save().restart().expect(37, 5000).expect(25, 0).expect(1100, {0xFFFF, 0x5FFF, 1, 0, 0x322, 0, 0, 0});
    s.online().write(103, {0x2211, 0x4433}).rx(data(form, 0x322, {9})).exchange();
    s.tx(data(form, 0x321, {0x11, 0x22, 0x33, 0x44})).no_tx().expect(bfm_block(2), {0x322, 0, 0x0301, 9});
  }
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_program_example_test
