// The command interface: SDO, frames, remote frames, errors [FX2N-32CAN 6, 9.2].

#include "scenarios/fx2n_32can/scenario.hpp"

namespace canopus::scenario::fx2n_32can_command_interface_test {
namespace {

// S-30
TEST(Fx2nCommand, ReadsAndWritesItself_WithoutTheBus) {
  RecordProperty("spec",
                 "FX2N-SDO-001 FX2N-SDO-002 FX2N-SDO-003 FX2N-SDO-005 FX2N-SDO-009 FX2N-CIF-001 FX2N-CIF-002 "
                 "FX2N-OD-010 FX2N-OD-007");
  Fx2nScenario s;
  s.start(5);
  for (const std::uint16_t own : Words{0, 5}) {
    s.cif({0x0004, own, 0x1000, 0}).expect(1000, {0x0005, own, 0x1000, 0, 4, 405, 0, 0});
    s.cif({0x0004, own, 0x1008, 0})
        .expect(1000, {0x0005, own, 0x1008, 0, 10, 0x5846, 0x4E32, 0x332D, 0x4332, 0x4E41, 0});
    s.cif({0x0004, own, 0x100B, 0}).expect(1004, {4, 5, 0}).expect(1064, {0, 0, 0});
    s.cif({0x0002, own, 0x1006, 0, 4, 0x1122, 0x3344}).expect(1000, {0x0003, own, 0x1006, 0, 4, 0, 0});
    s.cif({0x0004, own, 0x1006, 0}).expect(1004, {4, 0x1122, 0x3344});
  }
  s.no_tx().cif({0x0004, 9, 0x1006, 0}).is_silent(9);
}

// S-31, S-32
TEST(Fx2nCommand, ReadsAndWritesAnotherNode) {
  RecordProperty("spec",
                 "FX2N-SDO-002 FX2N-SDO-006 FX2N-SDO-007 FX2N-SDO-008 FX2N-SDO-003 FX2N-CIF-003 FX2N-CIF-004 "
                 "FX2N-CIF-001");
  Fx2nScenario s;
  s.start(1).cif({0x0004, 5, 0x1000, 0}).expect(1000, 0xFFFF).tx(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  s.rx(0x585, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0x00})
      .expect(1000, {0x0005, 5, 0x1000, 0, 4, 0x0191, 0x000F, 0});
  s.cif({0x0002, 5, 0x1017, 0, 2, 0x03E8})
      .tx(0x605, {0x2B, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0})
      .expect(1000, 0xFFFF);
  s.rx(0x585, {0x60, 0x17, 0x10, 0, 0, 0, 0, 0}).expect(1000, {0x0003, 5, 0x1017, 0, 2, 0});
  // 5 bytes, in segments.
  s.cif({0x0002, 5, 0x2000, 7, 5, 0x0201, 0x0403, 0x0005}).tx(0x605, {0x21, 0x00, 0x20, 7, 5, 0, 0, 0});
  s.rx(0x585, {0x60, 0x00, 0x20, 7, 0, 0, 0, 0}).tx(0x605, {0x05, 1, 2, 3, 4, 5, 0, 0});
  s.rx(0x585, {0x20, 0, 0, 0, 0, 0, 0, 0}).expect(1000, {0x0003, 5, 0x2000, 7, 5});
}

// S-33, S-34
TEST(Fx2nCommand, SaysWhyAnAccessFailed) {
  RecordProperty("spec", "FX2N-CERR-001 FX2N-CERR-007 FX2N-CERR-008 FX2N-CERR-009");
  Fx2nScenario s;
  s.start(1).cif({0x0004, 5, 0x5555, 0}).aborts(5, {0x40, 0x55, 0x55, 0, 0, 0, 0, 0}, 0x0602'0000);
  s.expect(1000, {0x000F, 3, 5, 0x0000, 0x0602, 0});
  for (const std::uint32_t code :
       {0x0503'0000U, 0x0504'0000U, 0x0504'0001U, 0x0601'0001U, 0x0606'0000U, 0x0800'0022U, 0x1234'5678U}) {
    s.cif({0x0004, 5, 0x1000, 0}).aborts(5, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}, code).expect_abort(code, 5);
  }
  s.cif({0x0004, 9, 0x1000, 0}).expect(1000, 0xFFFF).advance(498ms).expect(1000, 0xFFFF).advance(2ms);
  s.expect(1000, {0x000F, 3, 9, 0x0000, 0x5000}).ignore_tx();
  // An answer that is none, and a node-ID that is none.
  s.cif({0x0004, 5, 0x1000, 0}).ignore_tx().rx(0x585, {0x60, 0x00, 0x10, 0, 0, 0, 0, 0});
  s.ignore_tx().expect(1000, {0x000F, 3, 5, 0x0000, 0x5000});
  s.cif({0x0004, 128, 0x1000, 0}).expect_abort(0x5000'0000, 128).no_tx();
  // In Stopped there is no SDO; bus-off there is nothing.
  s.nmt(2).cif({0x0004, 5, 0x1000, 0}).expect_abort(0x5000'0000, 5).no_tx();
  s.cif({0x0004, 0, 0x1000, 0}).expect(1000, 0x0005);
  s.nmt(0x80).cif({0x0004, 5, 0x1000, 0}).ignore_tx().nmt(2).expect_abort(0x5000'0000, 5);
  s.nmt(0x80).cif({0x0004, 5, 0x1000, 0}).ignore_tx().error_counters(256, 0);
  s.expect_abort(0x5000'0000, 5).ignore_tx();
}

// S-35
TEST(Fx2nCommand, TakesValuesOfUpTo118Bytes) {
  RecordProperty("spec", "FX2N-SDO-004 FX2N-SDO-011 FX2N-SDO-012 FX2N-SDO-013 FX2N-SDO-009 FX2N-SDO-003");
  const auto upload = [](Fx2nScenario& s, unsigned length, bool says_size) {
    s.cif({0x0004, 5, 0x2000, 0}).ignore_tx();
    s.rx(0x585, {static_cast<std::uint8_t>(says_size ? 0x41 : 0x40), 0x00, 0x20, 0,
                 static_cast<std::uint8_t>(says_size ? length : 0), 0, 0, 0});
    unsigned sent = 0;
    for (std::uint8_t toggle = 0; sent < length && s.read(1000) == 0xFFFF; toggle ^= 0x10) {
      s.ignore_tx();
      const unsigned now = std::min(7U, length - sent);
      Bytes segment{static_cast<std::uint8_t>(toggle | (7 - now) << 1 | (sent + now == length ? 1 : 0))};
      for (unsigned i = 0; i < 7; ++i)
        segment.push_back(static_cast<std::uint8_t>(i < now ? sent + i + 1 : 0));
      sent += now;
      s.rx(0x585, segment);
    }
    s.ignore_tx();
  };
  Fx2nScenario s;
  s.start(1);
  for (const bool says_size : {true, false}) {
    upload(s, 118, says_size);
    s.expect(1000, {0x0005, 5, 0x2000, 0, 118, 0x0201, 0x0403}).expect(1063, {118 << 8 | 117, 0, 0, 0});
    upload(s, 119, says_size);
    s.expect_abort(says_size ? 0x6060'0000 : 0x0800'0020, 5);
  }
  Words command{0x0002, 5, 0x2000, 0, 118};
  for (std::uint16_t i = 0; i < 59; ++i) command.push_back(i);
  s.cif(command).tx(0x605, {0x21, 0x00, 0x20, 0, 118, 0, 0, 0}).write(1000, 0xFFFF).advance(1ms).ignore_tx();
  s.expect(1000, 0);
  s.cif({0x0002, 5, 0x2000, 0, 119}).expect_abort(0x0607'0010, 5).no_tx();
}

TEST(Fx2nCommand, AChannelInUse_IsAnErrorOfItsOwn) {
  RecordProperty("spec", "FX2N-SDO-013");
  Fx2nScenario s;
  s.start_as_manager().set_object(0x1F81, 5, 5, 4);
  s.advance(1ms).tx(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});  // the manager boots the slave
  s.cif({0x0004, 5, 0x1008, 0}).expect_abort(0x0800'0022, 5).ignore_tx();
}

// S-40
TEST(Fx2nCommand, KnowsTwelveCodes) {
  RecordProperty("spec", "FX2N-CERR-002 FX2N-CIF-005 FX2N-CERR-001");
  Fx2nScenario s;
  s.start(1);
  const Words known{0x0002, 0x0004, 0x000A, 0x000C, 0x8100, 0x8200, 0x8300,
                    0x8400, 0x8500, 0x8600, 0x8700, 0x8900, 0xFFFF};
  for (unsigned number = 0; number <= 0xFFFF; number += number < 0x100 || number >= 0xFF00 ? 1 : 16) {
    const auto code = static_cast<std::uint16_t>(number);
    s.cif({code, 0xFFFF, 0xFFFF});
    const bool unknown = s.read(1000) == 0x000F && s.read(1001) == 0x0064;
    ASSERT_EQ(unknown, std::ranges::find(known, code) == known.end()) << std::hex << code;
    s.ignore_tx();
  }
}

// S-41
TEST(Fx2nCommand, AWriteWhileBusy_LocksIt_UntilFFFFh) {
  RecordProperty("spec", "FX2N-CERR-004 FX2N-CERR-005 FX2N-CIF-003 FX2N-GEN-012 FX2N-CIF-001");
  for (const module::BufferAddress word : {1000U, 1002U, 1066U}) {
    Fx2nScenario s;
    s.start(1).cif({0x0004, 5, 0x1000, 0}).ignore_tx().write(word, 0x2000).expect(1000, {0x000F, 0xFFFF, 0});
    s.advance(2s).ignore_tx().write(1000, 4).advance(1ms).expect(1000, {0x000F, 0xFFFF}).no_tx();
    s.write(1000, 0xFFFF).advance(1ms).expect(1000, 0);
    // What was not written is as it was: node, index and sub-index still stand on the TO side.
    s.write(1000, 4).advance(1ms).tx(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
    s.rx(0x585, {0x43, 0x00, 0x10, 0, 1, 0, 0, 0}).expect(1000, {0x0005, 5, 0x1000, 0, 4, 1, 0});
    // The FROM side shows results alone.
    s.write(1001, {7, 8, 9}).expect(1000, {0x0005, 5, 0x1000, 0, 4, 1, 0});
  }
}

// S-42
TEST(Fx2nCommand, WithoutAQueue_NothingIsSent) {
  RecordProperty("spec", "FX2N-CERR-003 FX2N-ERR-007 FX2N-L2-005 FX2N-EMCY-011 FX2N-RTR-005");
  Fx2nScenario s;
  s.start_operational(1);
  s.controller().accepts = false;
  s.cif({0x000C, 0x333, 0, 0, 0}).expect(1000, {0x000F, 0x8FFF, 0}).expect(29, 0x0200);
  s.write(29, 0xFDFF)
      .expect(29, 0)
      .cif({0x000A, 0x1000})
      .expect(1000, {0x000F, 0x8FFF, 0})
      .expect(29, 0x0200);
  s.write(29, 0);
  for (const std::uint16_t pdo : Words{1, 0}) s.cif({0x8100, pdo}).expect(1000, 0x8FFF).expect(29, 0x0200);
  s.controller().accepts = true;
  s.cif({0x000C, 0x333, 0, 0, 0}).expect(1000, 0x000D).tx(0x333).write(29, 0).expect(29, 0);
  s.error_counters(256, 0).cif({0x000C, 0x333, 0, 0, 0}).expect(1000, {0x000F, 0x8FFF}).no_tx();
}

// S-50, S-51, S-52
TEST(Fx2nCommand, SendsAnyFrame) {
  RecordProperty(
      "spec",
      "FX2N-L2-001 FX2N-L2-002 FX2N-L2-003 FX2N-L2-004 FX2N-L2-005 FX2N-L2-006 FX2N-L2-007 FX2N-CIF-006 "
      "FX2N-CERR-006");
  Fx2nScenario s;
  s.start_operational(1);
  for (const std::uint8_t state : Bytes{1, 0x80, 2}) {
    s.nmt(state)
        .cif({0x000C, 0x333, 0, 0, 3, 0x2211, 0x0033})
        .expect(1000, 0x000D)
        .tx(0x333, {0x11, 0x22, 0x33});
  }
  s.nmt(1);
  s.write(1001, {0x333, 0, 0, 8})
      .write(1000, 0x000C)
      .expect(1000, 0xFFFF)
      .advance(1ms)
      .expect(1000, 0x000D)
      .ignore_tx();
  s.cif({0x000C, 0x123, 0, 0, 8, 0x0201, 0x0403, 0x0605, 0x0807}).tx(0x123, {1, 2, 3, 4, 5, 6, 7, 8});
  s.cif({0x000C, 0x7FF, 0, 0, 0, 0x0201}).tx(0x7FF);
  s.cif({0x000C, 0x185, 0, 1, 8}).expect(1000, 0x000D).tx(can::remote_frame(0x185, 8));
  s.cif({0x000C, 0, 0, 0, 2, 0x0001}).tx(0x000, {1, 0});
  // What cannot be on a bus: an internal error with the parameters.
  for (const Words& wrong : {Words{0x000C, 0x800, 0, 0, 0}, Words{0x000C, 0x100, 1, 0, 0},
                             Words{0x000C, 0x100, 0, 2, 0}, Words{0x000C, 0x100, 0, 0, 9, 0x55}}) {
    s.cif(wrong).no_tx().expect(1000, {0x000F, 0x00C8, 1, wrong[1], wrong[2], wrong[3], wrong[4]});
  }
}

// S-55, S-56
TEST(Fx2nCommand, AsksTheProducerOfAnRpdo) {
  RecordProperty("spec", "FX2N-RTR-001 FX2N-RTR-002 FX2N-RTR-006 FX2N-RTR-007 FX2N-RTR-008 FX2N-MAP-002");
  Fx2nScenario s;
  s.start_operational(1).cif({0x8100, 1}).expect(1000, {0x8101, 0}).tx(can::remote_frame(0x201, 8));
  s.rx(0x201, {7, 0, 0, 0, 0, 0, 0, 0}).write(20, 1).expect(0, 7).no_tx();
  for (const std::uint16_t pdo : Words{5, 7, 30, 31, 256, 0xFFFF})
    s.cif({0x8100, pdo}).no_tx().expect(1000, {0x81FF, pdo, 0});
  s.set_object(0x1406, 1, 0x345, 4)
      .cif({0x8100, 7})
      .expect(1000, {0x8101, 0})
      .tx(can::remote_frame(0x345, 8));
  s.set_object(0x1406, 1, 0x8000'0345, 4).set_object(0x1606, 0, 0, 1).set_object(0x1606, 0, 1, 1);
  s.set_object(0x1406, 1, 0x345, 4).cif({0x8100, 7}).expect(1000, 0x8101).tx(can::remote_frame(0x345, 2));
}

// S-57, S-58
TEST(Fx2nCommand, AsksAllProducers_OneAfterTheOther) {
  RecordProperty("spec", "FX2N-RTR-003 FX2N-RTR-004 FX2N-MAPA-001");
  Fx2nScenario s;
  s.start(1).cif({0x8200}).expect(1000, 0x8201);
  s.cif({0x8100, 0}).expect(1000, {0x8101, 0});
  for (std::uint32_t pdo = 0; pdo < 30; ++pdo)
    s.tx(can::remote_frame(0x181 + 0x100 * (pdo % 4) + pdo / 4, 8));
  s.no_tx();
  s.set_object(0x1401, 1, 0x8000'0000, 4)
      .cif({0x8100, 0})
      .tx(can::remote_frame(0x181, 8))
      .tx(can::remote_frame(0x381, 8));
  s.ignore_tx();
  // Each waits for the one before it.
  s.controller().completes = false;
  s.cif({0x8100, 0})
      .expect(1000, 0xFFFF)
      .tx(can::remote_frame(0x181, 8))
      .advance(1s)
      .expect(1000, 0xFFFF)
      .no_tx();
  s.write(1000, 0xFFFF).advance(1ms).expect(1000, 0);
  s.controller().completes = true;
  s.advance(1s).no_tx().cif({0x0004, 0, 0x1000, 0}).expect(1000, 0x0005);
  s.controller().completes = false;
  s.cif({0x8100, 0}).ignore_tx().error_counters(256, 0).expect(1000, 0x8FFF).no_tx();
}

// S-100
TEST(Fx2nCommand, SendsAnEmergencyMessage) {
  RecordProperty("spec", "FX2N-EMCY-010 FX2N-EMCY-011 FX2N-CIF-004");
  Fx2nScenario s;
  s.start(9)
      .cif({0x000A, 0x1000, 0x0001, 0, 0})
      .expect(1000, 0x000B)
      .tx(0x089, {0x00, 0x10, 1, 0, 0, 0, 0, 0});
  s.nmt(1).cif({0x000A, 0x0201, 0x0403, 0x0605, 0x0807}).tx(0x089, {1, 2, 3, 4, 5, 6, 7, 8});
  s.write(1001, {0, 0, 0, 0}).write(1000, 0x000A).expect(1000, 0xFFFF).advance(1ms).expect(1000, 0x000B);
  s.tx(0x089, Bytes(8, 0)).nmt(2).cif({0x000A, 0x1000}).expect(1000, {0x000F, 0x8FFF}).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx2n_32can_command_interface_test
