// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - saving and restoring.

#include "scenarios/me3can1_q/layer2_frames.hpp"

namespace canopus::scenario::me3can1_q_layer2_saving_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2Saving);

using module::LedPattern;
constexpr std::size_t can_run_led = 2;

TEST(Me3Layer2Saving, Save_KeepsModeRateParametersStopMessagesAndCanIds_NothingElse) {
  RecordProperty("spec", "ME3-SAVE-006 ME3-SAVE-007");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(24, 125);
  for (std::uint16_t slot = 0; slot < 42; ++slot) {
    s.write(6000 + 4U * slot, {0xFFFF, 0x5FFF, 4, static_cast<std::uint16_t>(slot + 1)});
    s.write(10000 + 7U * slot, {static_cast<std::uint16_t>(0x100 + slot), 0, 8, 1, 2, 3, 4});
  }
  for (std::uint16_t message = 0; message < 4; ++message) {
    s.write(8450 + 7U * message, {static_cast<std::uint16_t>(0x10 + message), 0, 8, 1, 2, 3, 4});
  }
  s.write(8400, {1, 1, 1});
  s.write(20, 0x100).write(1000, {0, 7, 8});
  s.save();
  s.supply_off().supply_on();
  s.wait_bit(25, 7, false);
  s.expect(21, 11).expect(24, 125).expect(37, 1250);
  for (std::uint16_t slot = 0; slot < 42; ++slot) {
    s.expect(6000 + 4U * slot, {0xFFFF, 0x5FFF, 4, static_cast<std::uint16_t>(slot + 1)});
    s.expect(10000 + 7U * slot, {static_cast<std::uint16_t>(0x100 + slot), 0, 0, 0, 0, 0, 0});
  }
  for (std::uint16_t message = 0; message < 4; ++message) {
    s.expect(8450 + 7U * message, {static_cast<std::uint16_t>(0x10 + message), 0, 8, 1, 2, 3, 4});
  }
  s.expect(8400, {0, 0, 0}).expect(8350, {0, 0, 0}).expect(5001, 0);
  s.expect(20, 0).expect(22, 0).expect(25, 0).expect(29, 0).expect(35, {0, 0}).expect(39, {0, 0});
  s.expect(1000, {0, 0, 0}).no_tx();
  // G22.1 puts them back to the defaults in the buffer memory, the flash memory keeps its content.
  s.save(2);
  s.expect(6000, {0xFFFF, 0xFFFF, 0, 0}).expect(10000, {0xFFFF, 0xFFFF}).expect(8450, {0xFFFF, 0xFFFF, 0, 0});
  s.expect(24, 250).expect(21, 405);
  s.restart();
  s.expect(6000, {0xFFFF, 0x5FFF, 4, 1}).expect(10000, {0x0100, 0}).expect(21, 11);
}

// G22.1 while online: the words get their defaults, the module goes on with what it went online with.
TEST(Me3Layer2Saving, RestoreWhileOnline_ActsOnTheWords_NotOnTheSlots) {
  RecordProperty("spec", "ME3-SAVE-002 ME3-SAVE-003 ME3-L2-008 ME3-L2-005 ME3-L2-040");
  for (const std::uint16_t bits : Words{2, 3}) {
    IntelligentScenario s;
    s.power_on_layer2();
    s.write(6000, {0xFFFF, 0x7FFF, 0, 0}).write(10000, {0x0123, 0, 1, 0x55});
    s.write(6004, {0x0181, 0, 0, 0});
    s.write(6008, {0xFFFF, 0x5FFF, 2, 10}).write(10014, {0x0124, 0, 1, 0x66});
    s.write(8450, {0x0100, 0, 1, 1}).write(8471, {0x0101, 0, 1, 2});
    s.online();
    s.save(bits);  // 100 ms
    s.tx(0x124, {0x66}).expect(6000, {0xFFFF, 0xFFFF, 0, 0, 0xFFFF, 0xFFFF}).expect(10000, {0xFFFF, 0xFFFF});
    s.expect(8450, {0xFFFF, 0xFFFF, 0, 0}).expect_x(0x03, true).expect(29, 0);
    s.write(10003, 0x77).rx(0x181, {0xA1});
    s.exchange();
    s.tx(0x123, {0x77}).expect(10007, {0x0181, 0, 0x0301, 0x00A1}).no_tx();
    s.rx_remote(0x123, 1).tx(0x123, {0x77});
    s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
    s.tx(0x100, {1}).tx(0x101, {2}).no_tx();
    s.offline().online();  // now with the defaults
    s.exchange();
    s.rx_remote(0x123, 1).cpu(module::CpuState::stop).advance(1s).no_tx();
  }
}

TEST(Me3Layer2Saving, FlagsAndErrorCodes_AreNotSaved) {
  RecordProperty("spec", "ME3-SAVE-007");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x6FFF, 4, 0}).write(10000, {0x0123, 0, 1});
  s.write(6004, {0x0181, 0, 0, 0});
  s.online();
  s.rx_remote(0x123, 1);
  for (int i = 0; i < 20; ++i) s.rx(0x181, {1});
  s.exchange();
  s.write(8400, {1, 1, 1});
  s.expect(8350, 1).expect(5002, 0x2000).expect(10009, 0x0701).expect(29, 0x8000);
  s.save();
  s.supply_off().supply_on();
  s.wait_bit(25, 7, false);
  s.expect(8350, {0, 0, 0}).expect(8400, {0, 0, 0}).expect(5001, {0, 0}).expect(10009, {0, 0}).expect(29, 0);
}

TEST(Me3Layer2Saving, UnsavedWords_OfCanopenModeStartAtTheirDefault) {
  RecordProperty("spec", "ME3-SAVE-007");
  IntelligentScenario s;
  s.power_on_as(1);
  s.write(20, 0x1000).write(50, {2, 20, 5, 6, 7, 8, 9}).write(58, 5).write(400, 3).write(13000, {1, 2});
  s.write(1000, {0, 7, 8});
  s.set_object(0x1016, 1, 0x00020064, 4);
  s.rx(0x702, {0x05}).rx(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5});
  s.write(20, 0);
  s.exchange();
  s.expect(750, 5);
  s.advance(1s);
  s.expect_bit(402, 7, true);
  s.save();
  s.supply_off().supply_on();
  s.wait_bit(25, 7, false);
  s.ignore_tx();
  s.expect(20, 0).expect(22, 0).expect(25, 0x0100).expect(29, 0).expect(35, {0, 0}).expect(39, {0, 0});
  s.expect(50, {1, 14, 8, 1, 0, 0, 0, 5, 0}).expect(400, 0).expect(750, 0).expect(751, 0);
  for (module::BufferAddress node = 1; node <= 127; ++node) s.expect(400 + node, 0);
  for (module::BufferAddress node = 2; node <= 126; ++node) s.expect(600 + node, 0);
  for (module::BufferAddress word = 1000; word <= 1066; ++word) s.expect(word, 0);
  s.expect(10000, {0, 0}).expect(13000, {0, 0});
}

TEST_P(Layer2Saving, PowerDownMessages_DoNotExist) {
  spec("ME3-L2-043", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(8450, {0x0100, 0, 1, 0x55});
  for (module::BufferAddress address = 8478; address < 8600; ++address) {
    s.write(address, 0x0101);
    s.expect(address, 0);
  }
  s.expect(29, 0);
  s.online();
  s.supply_off();
  s.no_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_saving_test
