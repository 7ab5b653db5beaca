// Corners of PDOs, of the command interface and of the Layer 2 modes that both manuals print.

#include "scenarios/me3can1_q/layer2_forms.hpp"
#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_data_corners_test {
namespace {

using namespace rj71cn91_presets;

CANOPUS_OF_BOTH_MODULES(DataCorners);

TEST_P(DataCorners, ReservedTransmissionTypes_AreRefused_InEveryPdo) {
  spec("ME3-PDO-010", "RJ71-TPDO-003 RJ71-TPDO-002");
  IntelligentScenario s(GetParam());
  s.power_on_as(5);
  for (const std::uint16_t index : Words{0x1400, 0x14FF, 0x1800, 0x18FF}) {
    for (std::uint16_t type = 0xF1; type <= 0xFD; ++type) {
      s.cif({0x0002, 0, index, 2, 1, type});
      s.expect_abort(0x06090030);
    }
    for (const std::uint16_t type : Words{0x00, 0x01, 0xEF, 0xF0, 0xFE}) {
      s.set_object(index, 2, type, 1).expect_object(index, 2, type, 1);
    }
  }
}

TEST_P(DataCorners, EventTimer_OnlyOfEventDrivenTypes_And0EndsIt) {
  spec("ME3-PDO-015", "RJ71-TPDO-006");
  IntelligentScenario s(GetParam());
  s.power_on_as(5);
  const auto set = [&](std::uint8_t type, std::uint16_t event_timer) {
    s.set_object(0x18FF, 1, 0xC0000185, 4).set_object(0x1800, 1, 0xC0000185, 4);
    s.set_object(0x18FF, 2, type, 1).set_object(0x18FF, 5, event_timer, 2);
    s.set_object(0x18FF, 1, 0x40000185, 4).ignore_tx();
  };
  const Bytes zeros(8, 0);
  for (const std::uint8_t type : Bytes{0, 1, 2, 240}) {
    set(type, 200);
    s.nmt(0x01, 5).advance(10s).no_tx();
    s.nmt(0x80, 5);
  }
  for (const std::uint8_t type : is_rj71cn91() ? Bytes{0xFE, 0xFF} : Bytes{0xFE}) {
    set(type, 200);
    s.nmt(0x01, 5)
        .ignore_tx()
        .wait_tx(0x185, zeros)
        .advance(199ms)
        .no_tx()
        .advance(1ms)
        .tx(0x185, zeros)
        .no_tx();
    set(type, 0);
    s.advance(10s).no_tx();
    s.nmt(0x80, 5);
  }
}

TEST_P(DataCorners, InhibitTimeOf0_LetsEveryChangeGo) {
  spec("ME3-PDO-014", "RJ71-TPDO-005");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
  for (const std::uint16_t inhibit_time : Words{10000, 0}) {
    s.set_object(0x1800, 1, 0xC0000181, 4).set_object(0x1800, 3, inhibit_time, 2);
    s.set_object(0x1800, 1, 0x40000181, 4).advance(2s).ignore_tx();
    for (std::uint8_t value = 1; value <= 5; ++value) {
      s.write(13000, static_cast<std::uint16_t>(value + inhibit_time));
      s.exchange();
    }
    EXPECT_EQ(s.controller().sent.size(), inhibit_time == 0 ? 5U : 1U);
    s.ignore_tx();
  }
}

TEST_P(DataCorners, MultiSdo_FailedRecordOfTheOwnNode_Is0f00h) {
  spec("ME3-CIF-019 ME3-CIF-020", "RJ71-SDO-006 RJ71-SDO-007");
  IntelligentScenario s(GetParam());
  s.power_on_as(5);
  s.cif({0x0006, 0, 0x1000, 0, 4, 1,      0, 0, 0,   5, 0x1018, 1, 4,
         1,      0, 0,      0, 0, 0x1017, 0, 2, 700, 0, 0,      0, 0xFFFF});
  s.no_tx().expect(1000, {0x00F7, 0x0F00, 0x1000, 0}).expect(1005, {0x0002, 0x0601});
  s.expect(1009, {0x0F05, 0x1018, 1}).expect(1013, {0x0002, 0x0601}).expect(1017, {0, 0x1017, 0});
  s.expect_object(0x1017, 0, 700, 2).ignore_tx();
  s.cif({0x0008, 0, 0x2222, 7, 0, 0, 0, 0, 0, 0, 0x1018, 9, 0, 0, 0, 0, 0, 0xFFFF});
  s.ignore_tx()
      .expect(1000, {0x00F9, 0x0F00, 0x2222, 7, 0, 0x0000, 0x0602})
      .expect(1009, {0x0F00, 0x1018, 9, 0, 0x0011, 0x0609});
}

// [ME3CAN1-Q Tab. 5-2, 5-4, 5-5, 5-8; RJ71CN91 1.3] The high byte of the sub-index's word is reserved, the low one counts.
TEST_P(DataCorners, ReservedHighByteOfTheSubIndex_DoesNotCount) {
  spec("ME3-CIF-029", "RJ71-SDO-001 RJ71-SDO-002 RJ71-SDO-003 RJ71-SDO-004");
  IntelligentScenario s(GetParam());
  s.power_on_as(5);
  s.cif({0x0004, 0, 0x1018, 0xAB01}).expect(1000, 0x0005).expect(1004, {4, either(0x0071, 0x01D0)});
  s.cif({0x0002, 0, 0x1016, 0xFF02, 4, 0x0064, 0x0009}).expect(1000, 0x0003);
  s.expect_object(0x1016, 2, 0x00090064, 4);
  const auto one_record = [](std::uint16_t code, const Words& record) {
    Words command(65, 0xFFFF);  // no node in the other seven
    command[0] = code;
    std::ranges::copy(record, command.begin() + 1);
    return command;
  };
  s.cif(one_record(0x0006, {0, 0x1016, 0x0103, 4, 0x0065, 0x000A, 0, 0})).expect(1000, 0x0007);
  s.expect_object(0x1016, 3, 0x000A0065, 4);
  s.cif(one_record(0x0008, {0, 0x1016, 0x8002})).expect(1000, 0x0009).expect(1004, {4, 0x0064, 0x0009});
  s.write(1000, {0x0004, 2, 0x2000, 0x7705}).y(0x17, true).advance(1ms);
  s.tx(0x602, {0x40, 0x00, 0x20, 0x05, 0, 0, 0, 0}).rx(0x582, {0x4F, 0x00, 0x20, 0x05, 0x2A, 0, 0, 0});
  s.expect(1000, 0x0005).expect(1004, {1, 0x002A}).no_tx();
}

TEST_P(DataCorners, CommandInterfaceOfLayer2_ShowsTheWrongValuesThemselves) {
  spec("ME3-CIF-028", "RJ71-L2CIF-002");
  const auto shows = [](std::uint16_t mode, const Words& parameters, const Words& shown) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(mode);
    s.online();
    s.ignore_tx();
    Words command{0x000C};
    command.insert(command.end(), parameters.begin(), parameters.end());
    s.cif(command).no_tx().expect(1000, 0xF00C).expect(1001, shown);
  };
  shows(11, {0x0321, 0, 0, 9}, {0, 0, 0, 9});
  shows(11, {0x0800, 0, 0, 8}, {0x0800, 0, 0, 0});
  shows(11, {0x0321, 7, 1, 0xFFFF}, {0, 7, 0, 0xFFFF});
  shows(29, {0x1234, 0x2000, 0, 255}, {0, 0x2000, 0, 255});
}

TEST_P(DataCorners, CycleOf0_IsOneOf10ms) {
  spec("ME3-L2-016 ME3-L2-019", "RJ71-L2TX-004 RJ71-L2TX-005");
  for (const Layer2Form& form : layer2_forms) {
    for (const std::uint16_t type : Words{2, 3}) {
      IntelligentScenario s(GetParam());
      s.power_on_layer2(form.mode);
      set_transmit(s, 42, 0x123, type == 2 ? 0x5FFF : 0x7FFF, type, 1, 0);
      s.online();
      s.ignore_tx();
      const can::Time online = s.now();
      for (std::uint8_t change = 1; change <= 5; ++change) {
        s.write(block(42) + 3, type == 3 ? change : std::uint16_t{0});
        if (type == 3) s.exchange();
        const can::Time due = online + change * 10ms;
        ASSERT_LT(s.now(), due);
        s.advance(due - s.now() - 1us).no_tx().advance(1us);
        s.tx(frame(form, 0x123, {type == 3 ? change : std::uint8_t{0}})).no_tx();
      }
    }
  }
}

TEST_P(DataCorners, ReceiveSlots_ExactAndMasked_InBothForms) {
  spec("ME3-L2-027 ME3-L2-028", "RJ71-L2RX-001 RJ71-L2RX-002");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(form.mode);
    const std::uint32_t own = form.highest - 5;
    s.write(parameters(1), {0x0040, 0, 0x000F, 0});
    s.write(parameters(42), {static_cast<std::uint16_t>(own), static_cast<std::uint16_t>(own >> 16), 0, 0});
    s.online();
    const auto accepted = [&](unsigned slot, const can::Frame& sent) {
      s.write(block(slot) + 2, 0).rx(sent);
      s.exchange();
      return (s.read(block(slot) + 2) & 0x0100) != 0;
    };
    for (std::uint32_t identifier = 0x30; identifier < 0x60; ++identifier) {
      EXPECT_EQ(accepted(1, frame(form, identifier, {1})), identifier / 16 == 4) << std::hex << identifier;
    }
    EXPECT_TRUE(accepted(42, frame(form, own, {1})));
    for (std::uint32_t bit = 1; bit <= form.highest; bit <<= 1U) {
      EXPECT_FALSE(accepted(42, frame(form, own ^ bit, {1}))) << std::hex << bit;
    }
    can::Frame other = frame(form, form.mode == 29 ? 0x45U : own, {1});  // the other kind of identifier
    other.extended = !other.extended;
    EXPECT_FALSE(accepted(form.mode == 29 ? 1 : 42, other));
    EXPECT_FALSE(accepted(42, remote(form, own, 1)));
  }
}

TEST_P(DataCorners, RemoteFrames_WithTheirHandlingOff_InBothForms) {
  spec("ME3-L2-012", "RJ71-L2RTR-005");
  for (const Layer2Form& form : layer2_forms) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(form.mode);
    for (const unsigned slot : {1U, 16U, 17U, 42U}) set_transmit(s, slot, form.highest - slot);
    s.online();
    s.ignore_tx();
    for (const unsigned slot : {1U, 16U, 17U, 42U}) s.rx(remote(form, form.highest - slot, 2));
    s.advance(1s).no_tx().expect(8350, {0, 0, 0}).expect(29, 0);
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_data_corners_test
