// Corners of rows that other files show the middle of, for both modules: the last bytes of a message, 29 bits, requests that
// meet each other, two errors at once.

#include "scenarios/me3can1_q/concise_dcf.hpp"
#include "scenarios/me3can1_q/layer2_forms.hpp"

namespace canopus::scenario::me3can1_q_corners_test {
namespace {

CANOPUS_OF_BOTH_MODULES(CornersOfLayer2);
CANOPUS_OF_BOTH_MODULES(CornersOfCanopen);

TEST_P(CornersOfLayer2, Changes_OfEveryByte_UpToTheEighth) {
  spec("ME3-L2-015 ME3-L2-017", "RJ71-L2TX-003 RJ71-L2TX-005");
  for (const Layer2Form& form : layer2_forms) {
    for (const std::uint16_t type : Words{1, 3}) {
      IntelligentScenario s(GetParam());
      s.power_on_layer2(form.mode);
      set_transmit(s, 42, form.highest, 0x5FFF, type, 8, 5);  // type 3: every 50 ms
      s.online();
      s.ignore_tx().advance(200ms).no_tx();
      Bytes data(8, 0);
      for (std::size_t byte = 0; byte < 8; ++byte) {
        data[byte] = 0x80;
        s.write(static_cast<module::BufferAddress>(block(42) + 3 + byte / 2),
                static_cast<std::uint16_t>(data[byte | 1U] << 8 | data[byte & ~std::size_t{1}]));
        s.advance(100ms).no_tx();  // comes in by Y01
        s.exchange();
        if (type == 3) s.advance(60ms);
        s.tx(frame(form, form.highest, data)).advance(200ms).no_tx();
        s.exchange();
        s.advance(60ms).no_tx();
      }
    }
  }
}

TEST_P(CornersOfLayer2, TwentyEightSlotsAnswerRemoteFrames_In29BitModeToo) {
  spec("ME3-L2-013", "RJ71-L2RTR-008");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(form.mode);
    for (unsigned slot = 1; slot <= 42; ++slot) {
      set_transmit(s, slot, form.highest - slot, slot % 2 == 0 ? 0x6FFF : 0x7FFF, 4, 1);
    }
    s.online();
    for (unsigned slot = 1; slot <= 42; ++slot) {
      s.expect(parameters(slot) + 1, slot > 28 ? 0x5FFF : slot % 2 == 0 ? 0x6FFF : 0x7FFF);
      s.rx(remote(form, form.highest - slot, 1));
      if (slot <= 28 && slot % 2 != 0) s.tx(frame(form, form.highest - slot, {0}));
      s.no_tx();
    }
    s.expect(8350, {0xAAAA, 0x0AAA, 0});
  }
}

TEST_P(CornersOfLayer2, CommandInterface_SendsRemoteFrames_AndAllBytes_InBothModes) {
  spec("ME3-CIF-027", "RJ71-L2CIF-001");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(form.mode);
    s.online();
    const auto low = static_cast<std::uint16_t>(form.highest),
               high = static_cast<std::uint16_t>(form.highest >> 16);
    for (std::uint8_t dlc = 0; dlc <= 8; ++dlc) {
      Bytes bytes{1, 2, 3, 4, 5, 6, 7, 8};
      bytes.resize(dlc);
      s.cif({0x000C, low, high, 0, dlc, 0x0201, 0x0403, 0x0605, 0x0807}).expect(1000, 0x000D);
      s.tx(frame(form, form.highest, bytes)).no_tx();
      s.cif({0x000C, low, high, 1, dlc, 0x0201})
          .expect(1000, 0x000D)
          .tx(remote(form, form.highest, dlc))
          .no_tx();
    }
  }
}

// RTR flags come at once, also between Y01 and X01, and no exchange takes them away.
TEST_P(CornersOfLayer2, RemoteFrame_WhileAnExchangeRuns) {
  spec("ME3-L2-024", "RJ71-L2RTR-004");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(form.mode);
    set_transmit(s, 17, 0x123, 0x6FFF, 4, 1);
    set_transmit(s, 42, 0x124, 0x7FFF, 4, 1);
    s.online();
    s.ignore_tx().write(block(42) + 3, 0x55).y(0x01, true).expect_x(0x01, false);
    s.rx(remote(form, 0x123, 1)).rx(remote(form, 0x124, 1)).tx(frame(form, 0x124, {0}));  // the data before
    s.expect(8350, {0, 0x0001, 0}).wait_x(0x01, true).expect(8350, {0, 0x0001, 0}).y(0x01, false).no_tx();
    s.rx(remote(form, 0x124, 1)).tx(frame(form, 0x124, {0x55})).expect(8350, {0, 0x0001, 0});
    s.write(8401, 1).y(0x04, true).wait_x(0x04, true).tx(frame(form, 0x123, {0})).expect(8350, {0, 0, 0});
  }
}

// Only the way from RUN to STOP sends them.
TEST_P(CornersOfLayer2, StopMessages_NotWhenGoingOnlineInStop) {
  spec("ME3-L2-040", "RJ71-STOPMSG-001");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(form.mode);
    s.write(8471, {0x124, 0, 1, 0x77});  // the fourth
    s.cpu(module::CpuState::stop).advance(1s).no_tx();
    s.online();
    s.advance(10s).no_tx().cpu(module::CpuState::run).advance(1s).no_tx();
    s.cpu(module::CpuState::stop).tx(frame(form, 0x124, {0x77})).no_tx();
    s.cpu(module::CpuState::stop).advance(1s).no_tx();
  }
}

TEST_P(CornersOfLayer2, FactorySettings_InMemoryAndFlash) {
  spec("ME3-SAVE-003", "RJ71-BM-004");
  for (const Layer2Form& form : layer2_forms) {
    for (const std::uint16_t g22 : Words{2, 3}) {
      IntelligentScenario s(GetParam());
      s.power_on_layer2(form.mode);
      s.write(24, 500).write(8450, 0x111);
      set_transmit(s, 42, 0x123, 0x5FFF, 2, 1, 7);
      s.save();
      s.write(10289, 2);
      s.save(g22);
      s.expect(21, 405).expect(24, 250).expect(8450, 0xFFFF).expect(6164, {0xFFFF, 0xFFFF, 0, 0});
      s.expect(10287, {0xFFFF, 0xFFFF});
      s.restart();
      s.expect(21, g22 == 3 ? 405 : form.mode).expect(24, g22 == 3 ? 250 : 500);
      if (g22 == 2) s.expect(8450, 0x111).expect(6164, {0xFFFF, 0x5FFF, 2, 7}).expect(10287, {0x123, 0});
      s.cif({0x0004, 0, 0x1000, 0}).expect(1000, g22 == 3 ? 0x0005 : 0x000F).ignore_tx();
    }
  }
}

TEST_P(CornersOfCanopen, MultiSdo_LastRecords_AndATimeOut) {
  spec("ME3-CIF-018 ME3-CIF-019 ME3-CIF-020", "RJ71-SDO-003 RJ71-SDO-004 RJ71-SDO-006 RJ71-SDO-007");
  IntelligentScenario s(GetParam());
  s.power_on();
  Words write{0x0006};
  for (std::uint16_t record = 1; record <= 8; ++record) {
    const Words words{0, 0x1016, record, 4, record, static_cast<std::uint16_t>(record), 0, 0};
    write.insert(write.end(), words.begin(), words.end());
  }
  s.cif(write).expect(1000, 0x0007).no_tx();
  Words read{0x0008};
  for (std::uint16_t record = 1; record <= 8; ++record) {
    const Words words{
        static_cast<std::uint16_t>(record == 7 ? 5 : 0), 0x1016, record, 9, 0xAAAA, 0xAAAA, 0xAAAA, 0xAAAA};
    read.insert(read.end(), words.begin(), words.end());
  }
  s.cif(read).ignore_tx().expect(1000, 0x00F9);  // node 5 does not answer
  for (std::uint16_t record = 1; record <= 8; ++record) {
    const auto first = static_cast<module::BufferAddress>(1001 + 8 * (record - 1));
    if (record == 7) {
      s.expect(first, {0x0F05, 0x1016, 7, 0, 0x0000, 0x0504});
    } else {
      s.expect(first, {0, 0x1016, record, 4, record, record, either(0, 0xAAAA), either(0, 0xAAAA)});
    }
  }
  write[1 + 8 * 7] = 6;  // the eighth to a node that is not there
  write[1 + 8 * 4 + 4] = 0x0099;
  s.cif(write)
      .ignore_tx()
      .expect(1000, 0x00F7)
      .expect(1057, {0x0F06, 0x1016, 8})
      .expect(1061, {0x0000, 0x0504});
  s.expect_object(0x1016, 5, 0x00050099, 4).expect_object(0x1016, 8, 0x00080008, 4);
}

TEST_P(CornersOfCanopen, EmergencyCommand_WithinTheInhibitTimeOfTheModulesOwn) {
  spec("ME3-CIF-022", "RJ71-EMCY-010");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1015, 0, 5000, 2);  // 500 ms
  s.rx(0x080, {1}).tx(0x081, {0x00, 0x82, 0x11, 0, 0, 0, 0, 0});
  s.advance(400ms);
  s.cif({0x000A, 0x1000, 0x0001, 0, 0}).expect(1000, {0x000C, 0x0001}).no_tx();
  s.advance(100ms);
  s.cif({0x000A, 0x1000, 0x0001, 0, 0}).expect(1000, {0x000B, 0x0000}).ignore_tx();
  s.cif({0x000A, 0x1000, 0x0001, 0, 0}).expect(1000, {0x000C, 0x0001}).no_tx();
}

TEST_P(CornersOfCanopen, EmergenciesAlone_LeaveTheObjectsAlone) {
  spec("ME3-DX-003", "RJ71-BM-002");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.nmt(0x01, 1).rx(0x201, {7, 0, 0, 0, 0, 0, 0, 0}).rx(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.write(20, 0x1000).write(13000, 9);
  s.exchange();
  s.no_tx().expect(10000, 0).expect(750, 5);
  s.expect_object(0xA100, 1, 0, 2).expect_object(0xA580, 1, 7, 2);
  s.write(20, 0x0100);
  s.exchange();
  s.tx(0x181, {9, 0, 0, 0, 0, 0, 0, 0}).expect(10000, 7);
  s.expect_object(0xA100, 1, 9, 2);
}

TEST_P(CornersOfCanopen, Y0F_TakesTwoLatchedErrorsAtOnce) {
  spec("ME3-IO-013", "RJ71-IO-005");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.controller().overflows = 1;
  s.write(27, 200).write(59, 100).ignore_tx().expect(29, 0x0140).expect(39, 27).expect_x(0x0F, true);
  s.y(0x0F, true).expect(29, 0).expect(39, 0).expect_x(0x0F, false).y(0x0F, false);
  if (!is_rj71cn91()) {
    s.expect(29, 0).no_tx();
    return;
  }
  s.expect(29, 0x0040).expect(39, 27).write(27, 1).expect(29, 0x0040).write(59, 0).expect(29, 0).no_tx();
}

TEST_P(CornersOfCanopen, Clock_OfAConsumer_IsCorrected) {
  spec("ME3-TIME-015", "RJ71-TIME-008");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.write(59, static_cast<std::uint16_t>(-30)).rx(0x100, {0, 0, 0, 0, 0x4D, 0x39});  // 2024-02-29
  s.advance(48h).ignore_tx().y(0x13, true).expect_x(0x13, true).y(0x13, false);
  s.expect(52, {3, 1, 23, 59, 0});  // 48 hours less one minute
}

TEST_P(CornersOfCanopen, HeartbeatOfAFlyingMaster_AfterAnNmtReset) {
  spec("ME3-FLY-009", "RJ71-FLY-005");
  IntelligentScenario s(GetParam());
  s.plug_in().preset_node_id(2);
  s.plug_in().preset_object(0x1F80, 0, canopen::little_endian(0x21, 4));
  s.power_on();
  s.expect_object(0x1017, 0, 1000, 2);
  s.wait_tx(0x073).rx(0x071, {0x01, 0x01}).rx(0x701, {0x05}).ignore_tx();  // it stands by
  s.set_object(0x1017, 0, 300, 2).nmt(0x82, 2).wait_bit(25, 7, false).ignore_tx();
  s.expect_object(0x1017, 0, 1000, 2);
  s.wait_tx(0x073).rx(0x071, {0x01, 0x01}).rx(0x701, {0x05}).ignore_tx();
  unsigned heartbeats = 0;
  for (unsigned step = 0; step < 5; ++step) {
    s.advance(1s).rx(0x701, {0x05});
    for (const can::Frame& sent : s.controller().sent) heartbeats += sent.identifier == 0x702 ? 1U : 0U;
    s.ignore_tx();
  }
  EXPECT_EQ(heartbeats, 5U);
}

TEST_P(CornersOfCanopen, ConciseDcf_NeitherTakenNorDeleted_WhileSettingsAreSaved) {
  spec("ME3-CFG-007 ME3-CFG-006", "RJ71-CM-007");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  EXPECT_EQ(write_concise_dcf(s, 5, write_of_1017(7)), 0U);
  s.advance(20s).ignore_tx();
  for (const bool deletes : {true, false}) {
    s.write(22, 1).y(0x1F, true).expect_x(0x1F, false);
    EXPECT_EQ(write_concise_dcf(s, deletes ? 5 : 6, deletes ? Bytes{0} : write_of_1017(7)), 0x06060000U);
    s.expect_x(0x1F, false).wait_x(0x1F, true).y(0x1F, false);
    s.cif({0x0004, 0, 0x1F22, 5}).expect(1004, 13);
  }
  EXPECT_EQ(write_concise_dcf(s, 5, {0}), 0U);
  EXPECT_EQ(write_concise_dcf(s, 6, write_of_1017(7)), 0x06060000U);  // the erasure takes its time
  s.advance(20s).ignore_tx();
}

TEST_P(CornersOfCanopen, ConfigurationRequest_EndsWithTheSlavesAbort) {
  spec("ME3-CFG-015", "RJ71-CM-003");
  IntelligentScenario s(GetParam());
  s.plug_in().preset_node_id(1);
  s.plug_in().preset_object(0x1F80, 0, canopen::little_endian(0x01, 4));
  s.plug_in().preset_object(0x1F81, 5, canopen::little_endian(0x01, 4));
  s.power_on();
  s.advance(1s).ignore_tx();
  // 1017:00 and 1015:00, 2 bytes each
  EXPECT_EQ(
      write_concise_dcf(s, 5, {2, 0, 0, 0, 0x17, 0x10, 0, 2, 0, 0, 0, 7, 0, 0x15, 0x10, 0, 2, 0, 0, 0, 9, 0}),
      0U);
  s.advance(20s).ignore_tx();
  s.write(1000, {0x0002, 0, 0x1F25, 5, 4, 0x6F63, 0x666E}).y(0x17, true).wait_x(0x17, true).y(0x17, false);
  s.expect(1000, 0x0003);  // the request is taken
  s.wait_tx(0x605, {0x2B, 0x17, 0x10, 0x00, 0x07, 0x00, 0, 0});
  s.rx(0x585, {0x80, 0x17, 0x10, 0x00, 0x30, 0x00, 0x09, 0x06})
      .advance(5s)
      .no_tx();  // the other entry is not written
}

TEST_P(CornersOfCanopen, GuardingAnswer_WithTheWrongToggleBit_DoesNotCount) {
  spec("ME3-NG-006", "RJ71-NG-002");
  IntelligentScenario s(GetParam());
  s.plug_in().preset_node_id(1);
  s.plug_in().preset_object(0x1F80, 0, canopen::little_endian(0x01, 4));
  s.plug_in().preset_object(0x1F81, 5, canopen::little_endian(0x00640301, 4));
  s.power_on();
  s.rx(0x705, {0x00}).ignore_tx().rx(0x705, {0x7F}).expect(405, 0x0001);
  // The same answer again and again: the life time runs from the last good one.
  s.advance(100ms).ignore_tx().rx(0x705, {0x7F}).expect(405, 0x0005).expect_x(0x10, true);
  s.advance(100ms).ignore_tx().rx(0x705, {0x7F}).advance(99ms).ignore_tx().expect_bit(405, 3, false);
  s.advance(1ms).expect_bit(405, 3, true).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_corners_test
