// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - RUN to STOP messages, command interface (S52, S53).

#include "scenarios/me3can1_q/layer2_frames.hpp"

namespace canopus::scenario::me3can1_q_layer2_messages_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2Messages);

TEST_P(Layer2Messages, S52_RunToStopMessages) {
  spec("ME3-L2-040 ME3-L2-041 ME3-L2-042", "RJ71-STOPMSG-001");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(8450, {0x0100, 0, 0x0001, 0x0055});
  s.online();
  s.cpu(module::CpuState::stop);
  s.tx(0x100, {0x55}).no_tx();
  s.cpu(module::CpuState::stop).cpu(module::CpuState::run).advance(1s);
  s.no_tx();  // only the edge from RUN to STOP
  s.cpu(module::CpuState::stop);
  s.tx(0x100, {0x55}).no_tx();
  s.cpu(module::CpuState::run);
  s.offline();
  s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
  s.no_tx();
  s.write(8452, 0x8001);
  s.expect(8452, 1).expect(29, 0x0040).expect(39, 8452);
  s.clear_errors();
  s.write(8450, {0x0400, 0, 8, 0x0201, 0x0403, 0x0605, 0x0807});
  s.write(8457, {0x0300, 0, 0});
  s.write(8471, {0x0001, 0, 2, 0x2211});
  s.online();
  s.cpu(module::CpuState::stop);
  s.tx(0x400, {1, 2, 3, 4, 5, 6, 7, 8}).tx(0x300).tx(0x001, {0x11, 0x22}).no_tx();
}

// One that waits for room when the module is restarted is gone.
TEST_P(Layer2Messages, RunToStopMessages_AreEndedByARestart) {
  spec("ME3-L2-040 ME3-IO-004", "RJ71-STOPMSG-001");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(8450, {0x0100, 0, 0x0001, 0x0055, 0, 0, 0, 0x0200, 0, 0x0001, 0x0066});
  s.save();
  s.online();
  s.controller().accepts = false;
  s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
  s.restart();
  s.controller().accepts = true;
  s.expect_x(0x03, true).advance(1s).no_tx();
  s.cpu(module::CpuState::stop);
  s.tx(0x100, {0x55}).tx(0x200, {0x66}).no_tx();
}

TEST(Me3Layer2Messages, S53_CifLayer2Send) {
  RecordProperty("spec", "ME3-CIF-027");
  IntelligentScenario s;
  s.power_on_layer2();
  s.online();
  s.cif({0x000C, 0x0321, 0, 0, 3, 0x0201, 0x0003});
  s.tx(0x321, {1, 2, 3}).expect(1000, {0x000D, 0, 0, 0, 0});
  s.cif({0x000C, 0x0321, 0, 1, 3});
  s.tx(remote(0x321, 3)).expect(1000, {0x000D, 0, 0, 0, 0});
  s.cif({0x000C, 0x07FF, 0, 0, 8, 0x0201, 0x0403, 0x0605, 0x0807});
  s.tx(0x7FF, {1, 2, 3, 4, 5, 6, 7, 8}).expect(1000, {0x000D, 0, 0, 0, 0});
  s.cif({0x000C, 0, 0, 0, 0, 0x1111});
  s.tx(0x000).no_tx();
  // Offline, bus-off and with a full buffer there is no sending.
  s.offline();
  s.cif({0x000C, 0x0321, 0, 0, 0});
  s.expect(1000, {0x000F, 0x0F0F}).no_tx();
  s.online();
  s.error_counters(256, 0);
  s.cif({0x000C, 0x0321, 0, 0, 0});
  s.expect(1000, {0x000F, 0xB0FF}).no_tx();
  s.error_counters(0, 0);
  s.controller().accepts = false;
  s.cif({0x000C, 0x0321, 0, 0, 0});
  s.expect(1000, {0x000F, 0x8FFF}).expect(29, 0x0100);
}

TEST_P(Layer2Messages, S34_LayerTwoSendIn405Mode_IsUnknown) {
  spec("ME3-CIF-027", "RJ71-L2CIF-001");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.cif({0x000C, 0x0321, 0, 0, 0});
  s.expect(1000, {0x000F, 0x0064}).no_tx();
}

TEST_P(Layer2Messages, S53_CifSettingError) {
  spec("ME3-CIF-028", "RJ71-L2CIF-002");
  const auto wrong = [](std::uint16_t mode, const Words& parameters, const std::vector<bool>& faults) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(mode);
    s.online();
    Words command{0x000C};
    command.insert(command.end(), parameters.begin(), parameters.end());
    s.cif(command);
    s.no_tx().expect(1000, 0xF00C).expect(29, 0);
    for (std::size_t i = 0; i < faults.size(); ++i) {
      EXPECT_EQ(s.read(1001 + static_cast<module::BufferAddress>(i)) != 0, faults[i]) << i;
    }
  };
  wrong(11, {0x0321, 0, 0, 9}, {false, false, false, true});
  wrong(11, {0x0321, 0, 2, 8}, {false, false, true, false});
  wrong(11, {0x0800, 0, 1, 8}, {true, false, false, false});
  wrong(11, {0x0321, 1, 0, 0}, {false, true, false, false});
  wrong(29, {0xFFFF, 0x2000, 0, 0}, {false, true, false, false});
  wrong(29, {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF}, {false, true, true, true});
  wrong(11, {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF}, {true, true, true, true});
  IntelligentScenario s(GetParam());
  s.power_on_layer2(29);
  s.online();
  s.cif({0x000C, 0xFFFF, 0x1FFF, 0, 0});
  s.tx(extended(0x1FFFFFFF, {})).expect(1000, 0x000D);
}

TEST_P(Layer2Messages, TransmitQueueOverflow_SetsG29Bit8) {
  spec("ME3-L2-014 ME3-IO-012", "RJ71-L2TX-002");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x5FFF, 0, 0x0000);
  s.controller().accepts = false;
  s.exchange();
  s.expect(29, 0x0100).expect_x(0x0F, true);
  s.controller().accepts = true;
  s.exchange();
  s.tx(0x123).no_tx();  // no emergency message in a Layer 2 mode
}

TEST(Me3Layer2Messages, DataExchange_WithAnyG20) {
  RecordProperty("spec", "ME3-DX-010");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 0, 0}).write(10000, {0x0123, 0, 2});
  s.write(6164, {0x0181, 0, 0, 0});
  s.online();
  for (const std::uint16_t g20 : Words{0x0000, 0x0100, 0x1000, 0x1100}) {
    s.write(20, g20);
    s.write(10003, static_cast<std::uint16_t>(g20 | 1U)).write(10289, 0);
    s.rx(0x181, {0xA1, static_cast<std::uint8_t>(g20 >> 8)});
    s.advance(1s);
    s.no_tx().expect_bit(10289, 9, false);
    s.y(0x01, true);
    s.write(10003, 0x7777);  // after the request: for the next one
    s.wait_x(0x01, true);
    s.tx(0x123, {0x01, static_cast<std::uint8_t>(g20 >> 8)}).no_tx();
    s.expect(10287, {0x0181, 0, 0x0302}).expect(20, 0);
    s.y(0x01, false);
    s.expect_x(0x01, false);
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_messages_test
