// What the RJ71CN91 does otherwise than the ME3CAN1-Q in its Layer 2 modes [RJ71CN91 1.11, 1.12, App. 1 Y3, App. 2, App. 4].

#include "scenarios/me3can1_q/layer2_forms.hpp"

namespace canopus::scenario::rj71cn91_layer2_test {
namespace {

using Address = module::BufferAddress;

void set_receive(IntelligentScenario& s, unsigned slot, std::uint32_t identifier, std::uint32_t mask = 0) {
  s.write(6000 + 4 * (slot - 1),
          {static_cast<std::uint16_t>(identifier), static_cast<std::uint16_t>(identifier >> 16),
           static_cast<std::uint16_t>(mask), static_cast<std::uint16_t>(mask >> 16)});
}

/// X3 stays OFF, with this address.
void expect_stays_offline(IntelligentScenario& s, std::uint16_t address) {
  s.y(0x03, true).expect_x(0x03, false).expect(29, 0x0040).expect(39, address).no_tx().expect(37, 0);
  s.y(0x03, false);
}

TEST(Rj71Layer2, GoingOnline_SendsEveryTransmitSlotOnce_AndEmptiesReceiveSlots) {
  RecordProperty("spec", "RJ71-L2-003 RJ71-L2TX-007 RJ71-L2RX-009");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    for (std::uint16_t type = 0; type <= 4; ++type) {
      set_transmit(s, type + 1U, form.highest - type, 0x5FFF, type);
      s.write(10003 + 7U * type, static_cast<std::uint16_t>(0x1100 + type));
    }
    set_transmit(s, 42, 0x123, 0x7FFF, 4, 1);
    set_receive(s, 20, 0x321);
    s.write(10000 + 7 * 19, {0x777, 0});
    s.y(0x03, true).expect_x(0x03, true).expect(29, 0);
    for (std::uint8_t type = 0; type <= 4; ++type) s.tx(frame(form, form.highest - type, {type, 0x11}));
    s.tx(frame(form, 0x123, {0})).no_tx().expect(10000 + 7 * 19, {0, 0, 0, 0, 0, 0, 0});
    // Again with the next request: X3 alone says nothing of it.
    s.rx(frame(form, 0x321, {1, 2, 3})).y(0x01, true).wait_x(0x01, true).y(0x01, false).ignore_tx();
    s.expect(10000 + 7 * 19, {0x321, 0, 0x0303, 0x0201, 0x0003, 0, 0});
    s.y(0x03, false).expect_x(0x03, false).ignore_tx();
    s.y(0x03, true).expect(10000 + 7 * 19, {0, 0, 0, 0, 0, 0, 0}).ignore_tx();
    // Y4 sends a slot of every type, a remote frame the one with B = 7FFFH.
    s.write(8400, {0x001F, 0, 0}).y(0x04, true).expect_x(0x04, true).expect(8400, 0);
    for (std::uint8_t type = 0; type <= 4; ++type) s.tx(frame(form, form.highest - type, {type, 0x11}));
    s.y(0x04, false).rx(remote(form, 0x123, 1)).tx(frame(form, 0x123, {0}));
    s.ignore_tx();
  }
}

TEST(Rj71Layer2, Offline_NothingIsSentOrTaken_AndG37Is0) {
  RecordProperty("spec", "RJ71-L2-004 RJ71-BM-008");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_transmit(s, 1, 0x111, 0x7FFF, 2);
    set_receive(s, 2, 0x222);
    s.expect(37, 0)
        .expect(38, 875)
        .rx(frame(form, 0x222, {1}))
        .rx(remote(form, 0x111, 2))
        .advance(1s)
        .no_tx();
    s.online().expect(37, 2500).y(0x01, true).wait_x(0x01, true).y(0x01, false).expect(10007, Words(7, 0));
    s.advance(10ms).ignore_tx();
    s.offline()
        .ignore_tx()
        .expect(37, 0)
        .rx(frame(form, 0x222, {1}))
        .rx(remote(form, 0x111, 2))
        .advance(1s)
        .no_tx();
    s.online().y(0x01, true).wait_x(0x01, true).y(0x01, false).expect(10007, Words(7, 0)).ignore_tx();
  }
}

TEST(Rj71Layer2, BitRate_IsTakenOverByY3_WithoutARestart) {
  RecordProperty("spec", "RJ71-L2-007 RJ71-BM-008");
  IntelligentScenario s(rj71cn91);
  s.power_on_layer2(11);
  for (const std::uint16_t rate : Words{500, 10, 20, 50, 100, 125, 250, 800, 1000}) {
    s.write(24, rate).expect(24, rate).expect(37, 0);
    s.online().expect(37, static_cast<std::uint16_t>(rate * 10));
    EXPECT_EQ(s.controller().rate, rate * 1000U);
    s.write(24, 250).expect(24, rate).expect(29, 0).expect(37,
                                                           static_cast<std::uint16_t>(rate * 10));  // locked
    s.offline().expect(37, 0);
  }
  s.write(24, 300).expect(29, 0x0040).expect(39, 24).expect(24, 1000);
}

TEST(Rj71Layer2, BusOff_IsLeftByY3) {
  RecordProperty("spec", "RJ71-L2-008");
  IntelligentScenario s(rj71cn91);
  s.power_on_layer2(29);
  s.online().error_counters(256, 0).expect(29, 0x0008).expect(35, 256).expect(36, 256).expect_x(0x0F, true);
  s.advance(100s).expect(29, 0x0008);
  s.offline().expect_bit(29, 3, true);
  s.online().expect(29, 0).expect(35, 0).expect_x(0x0F, false);
  s.error_counters(256, 0).expect(29, 0x0008);
  s.restart().expect(29, 0).expect(35, 0);
}

TEST(Rj71Layer2, Online_SettingsAreLocked_AndWritesIgnored) {
  RecordProperty("spec", "RJ71-L2-006");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_transmit(s, 1, 0x111);
    set_receive(s, 42, 0x222);
    s.online();
    for (const Address address : {6000U, 6003U, 6167U, 8450U, 8452U, 8477U, 10000U, 10001U, 10002U, 24U}) {
      const std::uint16_t before = s.read(address);
      s.write(address, address == 24 ? 500 : 1).expect(address, before);
    }
    s.expect(29, 0).expect(39, 0).expect_x(0x0F, false);
    s.write(10003, {1, 2, 3, 4}).expect(10003, {1, 2, 3, 4});  // data of a transmit slot
    s.rx(frame(form, 0x222, {9})).y(0x01, true).wait_x(0x01, true).y(0x01, false).ignore_tx();
    s.expect(10287, {0x222, 0, 0x0301, 9}).write(10290, 5).expect(10290, 9);
    s.write(10289, 0x0200).expect(10289, 0x0201).write(10289, 0).expect(10289, 0x0001);
    s.offline().write(6000, 0x0123).expect(6000, 0x0123);
  }
}

TEST(Rj71Layer2, SaveWhileOnline_IsRefused) {
  RecordProperty("spec", "RJ71-L2-009");
  for (const std::uint16_t request : Words{1, 2, 3}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(11);
    set_transmit(s, 1, 0x111);
    s.save();
    s.online();
    const unsigned writes = s.flash().writes;
    s.write(22, request).y(0x1F, true).advance(10s).expect_x(0x1F, false).expect(22, request);
    s.expect(29, 0x0020).expect_x(0x0F, true).expect(6001, 0x5FFF).expect(10000, 0x111);
    EXPECT_EQ(s.flash().writes, writes);
    EXPECT_EQ(s.plug_in().module_errors().back().code, 0x1805);
    s.y(0x1F, false).expect(29, 0);  // its cause is gone
    s.offline().expect(29, 0);
    s.save(request);
    s.expect(6001, request == 1 ? 0x5FFF : 0xFFFF).ignore_tx();
  }
}

TEST(Rj71Layer2, Save_KeepsTheFirstThreeWords_OfTransmitSlotsOnly) {
  RecordProperty("spec", "RJ71-STOPMSG-003");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_transmit(s, 1, form.highest, 0x6FFF, 4, 0x1007);
    set_transmit(s, 42, 0x42, 0x5FFF, 0, 0x8001);
    set_receive(s, 2, 0x222, 0x3);
    s.write(10007, {0x1, 0}).write(10003, {1, 2, 3, 4}).write(8450, {0x321, 0, 8, 1, 2, 3, 4});
    s.write(8471, {0x322, 0, 0, 0, 0, 0, 5});
    s.save().supply_off().advance(1s);
    s.power_on();
    s.expect(6000, {0xFFFF, 0x6FFF, 4, 1, 0x222, 0, 3, 0}).expect(6164, {0xFFFF, 0x5FFF, 0, 1});
    s.expect(10000, {static_cast<std::uint16_t>(form.highest), static_cast<std::uint16_t>(form.highest >> 16),
                     0x1007, 0, 0, 0, 0});
    s.expect(10007, {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0}).expect(10287, {0x42, 0, 0x8001, 0, 0, 0, 0});
    s.expect(8450, {0x321, 0, 8, 1, 2, 3, 4}).expect(8471, {0x322, 0, 0, 0, 0, 0, 5});
    // The first message stays as it was on going online.
    s.online()
        .cpu(module::CpuState::stop)
        .tx(frame(form, 0x321, {1, 0, 2, 0, 3, 0, 4, 0}))
        .tx(frame(form, 0x322, {}))
        .no_tx();
  }
}

TEST(Rj71Layer2, TwoTransmitSlots_WithOneCanId) {
  RecordProperty("spec", "RJ71-L2TX-011 RJ71-CANID-006");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    for (const std::uint32_t identifier : {0U, 1U, form.highest - 1, form.highest}) {
      set_transmit(s, 3, identifier);
      s.online();
      s.offline().ignore_tx();
    }
    set_transmit(s, 42, form.highest);
    expect_stays_offline(s, 10287);
    s.write(10287, 0);
    s.clear_errors();
    s.online();
    s.offline().ignore_tx();
    set_receive(s, 5, form.highest);  // a receive slot may have it
    s.online().expect(29, 0).ignore_tx();
  }
}

TEST(Rj71Layer2, RemoteFrames_NeedB5FFFH_NoBit12_AndTypes0_2_4) {
  RecordProperty("spec", "RJ71-L2RTR-001 RJ71-L2RTR-002");
  for (const Layer2Form& form : layer2_forms) {
    for (std::uint16_t type = 0; type <= 4; ++type) {
      IntelligentScenario s(rj71cn91);
      s.power_on_layer2(form.mode);
      set_transmit(s, 2, 0x501, 0x5FFF, type, 0x8005);
      if (type == 1 || type == 3) {
        expect_stays_offline(s, 6006);
        continue;
      }
      s.y(0x03, true).expect_x(0x03, true).tx(remote(form, 0x501, 5)).no_tx().expect(29, 0);
      if (type == 0) s.y(0x01, true).wait_x(0x01, true).tx(remote(form, 0x501, 5)).no_tx();
      if (type == 2) s.advance(10ms).tx(remote(form, 0x501, 5)).no_tx();
      if (type == 4) s.write(8400, 2).y(0x04, true).tx(remote(form, 0x501, 5)).no_tx();
    }
    for (const std::uint16_t b : Words{0x6FFF, 0x7FFF}) {
      IntelligentScenario s(rj71cn91);
      s.power_on_layer2(form.mode);
      set_transmit(s, 2, 0x501, b);
      s.write(10009, 0x8002).expect(29, 0x0040).expect(39, 10009).expect(10009, 2);
    }
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_transmit(s, 2, 0x501, 0x7FFF);
    s.write(10009, 0x9002).expect(29, 0x0040).expect(39, 10009).expect(10009, 2);
    s.write(10009, 0x1002).expect(29, 0).expect(10009, 0x1002);
    set_transmit(s, 3, 0x502, 0x5FFF);
    // G29.6 had gone, so this error is the first one of those that are there.
    s.write(10016, 0x1002).expect(29, 0x0040).expect(39, 10016).expect(10016, 2);
  }
}

TEST(Rj71Layer2, The29thSlotThatAnswersRemoteFrames_LosesIt_AndIsReported) {
  RecordProperty("spec", "RJ71-L2RTR-008");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    for (unsigned slot = 1; slot <= 30; ++slot)
      set_transmit(s, slot, 0x100 + slot, slot % 2 == 0 ? 0x6FFF : 0x7FFF);
    s.y(0x03, true).expect_x(0x03, true).expect(29, 0x0040).expect(39, 6001 + 4 * 28).ignore_tx();
    s.expect(6001 + 4 * 26, 0x7FFF)
        .expect(6001 + 4 * 27, 0x6FFF)
        .expect(6001 + 4 * 28, 0x5FFF)
        .expect(6001 + 4 * 29, 0x5FFF);
    s.rx(remote(form, 0x11B, 2))
        .tx(frame(form, 0x11B, {0, 0}))
        .rx(remote(form, 0x11C, 2))
        .no_tx()
        .expect(8351, 0x0800);
    s.rx(remote(form, 0x11D, 2)).rx(remote(form, 0x11E, 2)).no_tx().expect(8351, 0x0800);
  }
}

TEST(Rj71Layer2, AutomaticResponse_DoesNotKeepASlotFromItsType) {
  RecordProperty("spec", "RJ71-L2RTR-010 RJ71-L2TX-008");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_transmit(s, 7, 0x501, 0x7FFF, 2);
    s.y(0x03, true).tx(frame(form, 0x501, {0, 0}));
    s.write(10000 + 42 + 3, 0x2211)
        .advance(10ms)
        .tx(frame(form, 0x501, {0, 0}));  // by its cycle, with the old data
    s.rx(remote(form, 0x501, 2)).tx(frame(form, 0x501, {0, 0}));
    s.write(8400, 1U << 6).y(0x04, true).tx(frame(form, 0x501, {0, 0})).y(0x04, false);
    s.y(0x01, true).wait_x(0x01, true).y(0x01, false).no_tx();
    s.advance(10ms)
        .tx(frame(form, 0x501, {0x11, 0x22}))
        .rx(remote(form, 0x501, 2))
        .tx(frame(form, 0x501, {0x11, 0x22}));
    s.write(8400, 1U << 6).y(0x04, true).tx(frame(form, 0x501, {0x11, 0x22})).no_tx();
  }
}

// --- receiving

TEST(Rj71Layer2, Flags_OfReceivedMessages) {
  RecordProperty("spec", "RJ71-L2RX-003 RJ71-L2RX-004 RJ71-L2RX-005");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(form.mode);
    set_receive(s, 42, 0x181);
    s.online();
    const auto exchange = [&s] { s.y(0x01, true).wait_x(0x01, true).y(0x01, false); };
    const auto clear = [&s] { s.write(10289, static_cast<std::uint16_t>(s.read(10289) & 0x00FF)); };
    exchange();
    s.expect(10289, 0);
    s.rx(frame(form, 0x181, {0xAA}));
    s.expect(10289, 0);  // by the exchange only
    exchange();
    s.expect(10287, {0x181, 0, 0x0301, 0xAA});
    clear();
    exchange();
    s.expect(10289, 0x0001);
    for (const std::uint8_t data : Bytes{0xBB, 0xCC, 0xDD}) s.rx(frame(form, 0x181, {data}));
    exchange();
    s.expect(10289, {0x0701, 0xDD});
    exchange();
    s.expect(10289, 0x0701);  // they stay as the program left them
    clear();
    s.rx(frame(form, 0x181, {0xDD}));  // the same again
    exchange();
    s.expect(10289, 0x0201);
    clear();
    for (unsigned times = 0; times < 3; ++times) s.rx(frame(form, 0x181, {0xDD}));
    exchange();
    s.expect(10289, 0x0201);  // no new data: none were lost
    clear();
    s.rx(frame(form, 0x181, {0xDD, 0})).rx(frame(form, 0x181, {0xDD, 0}));  // another length is new data
    exchange();
    s.expect(10289, 0x0702);
  }
}

// --- the CPU

TEST(Rj71Layer2, StopMessages_ThenOffline_IfTheCpuClearsY3) {
  RecordProperty("spec", "RJ71-STOPMSG-002 RJ71-CPU-006");
  for (const Layer2Form& form : layer2_forms) {
    for (const bool clears : {true, false}) {
      IntelligentScenario s(rj71cn91);
      s.power_on_layer2(form.mode);
      set_transmit(s, 1, 0x7F0, 0x7FFF);
      for (unsigned message = 0; message < 4; ++message) {
        s.write(8450 + 7 * message,
                {static_cast<std::uint16_t>(0x124 - message), 0, 1, static_cast<std::uint16_t>(message)});
      }
      s.online().cpu(module::CpuState::stop);
      if (clears) s.y(0x03, false);
      for (std::uint8_t message = 0; message < 4; ++message) s.tx(frame(form, 0x124U - message, {message}));
      s.advance(1s).no_tx().expect_x(0x03, !clears);
      s.rx(remote(form, 0x7F0, 2));
      if (!clears) s.tx(frame(form, 0x7F0, {0, 0}));
      s.no_tx().cpu(module::CpuState::run).advance(1s).no_tx().expect_x(0x03, !clears);
    }
  }
}

// --- command interface

TEST(Rj71Layer2, CifFrame_IsDoneWhenItWasSent_OrEndsAfterASecond) {
  RecordProperty("spec", "RJ71-CIF-011 RJ71-L2CIF-003");
  IntelligentScenario s(rj71cn91);
  s.power_on_layer2(11);
  s.online();
  s.cif({0x000C, 0x501, 0, 0, 3, 0x2211, 0x0033}).tx(0x501, {0x11, 0x22, 0x33}).expect(1000, 0x000D);
  // No partner: the frame stays in the controller.
  s.write(1000, {0x000C, 0x501, 0, 0, 1, 0x0044});
  s.controller().completes = false;
  s.y(0x17, true).advance(900ms).expect(1000, 0xFFFF).expect_x(0x17, false);
  s.wait_x(0x17, true, 1s).expect(1000, {0x000F, 0x000F, 0x2002, 0, 1}).y(0x17, false).ignore_tx();
  s.controller().completes = true;
  s.controller().accepts = false;
  s.cif({0x000C, 0x501, 0, 0, 1, 0x0044}).expect(1000, {0x000F, 0x000F, 0x2002, 0}).no_tx();
  s.controller().accepts = true;
  s.cif({0x000C, 0x501, 0, 0, 1, 0x0044}).tx(0x501, {0x44}).expect(1000, 0x000D);
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_layer2_test
