// spec/me3can1-q/scenarios.md, section 10: configuration manager - requests to all, SDO channels shared with the start-up.

#include "scenarios/me3can1_q/concise_dcf.hpp"

namespace canopus::scenario::me3can1_q_configuration_request_test {
namespace {

CANOPUS_OF_BOTH_MODULES(ConfigurationRequest);
CANOPUS_OF_BOTH_MODULES(EmergencyInhibitTime);
CANOPUS_OF_BOTH_MODULES(SdoChannelInConciseDcf);

TEST_P(ConfigurationRequest, S79_RequestToAll_IsForEveryNodeWithData_FirstAndLast) {
  spec("ME3-CFG-012 ME3-CFG-008", "RJ71-CM-003");
  IntelligentScenario s(GetParam());
  s.power_on_as(9);
  s.set_object(0x1F80, 0, 0x0000000D, 4);
  s.store_objects().restart();
  s.advance(5s).ignore_tx().expect_bit(25, 15, true);
  for (const std::uint16_t node : Words{1, 9, 127}) {
    EXPECT_EQ(write_concise_dcf(s, node), 0U);
  }
  s.cif({0x0002, 0, 0x1F25, 0x80, 4, 0x6F63, 0x666E});
  s.expect(1000, 0x0003);
  const Bytes write_1017{0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0};
  s.tx(0x601, write_1017).tx(0x67F, write_1017).no_tx();
  s.rx(0x581, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0}).rx(0x5FF, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0}).no_tx();
}

// A slave that does not answer is asked for 1000H without end: that keeps no other from its file.
TEST_P(ConfigurationRequest, RequestToAll_LeavesOutASlaveThatIsBeingBooted) {
  spec("ME3-CFG-012", "RJ71-CM-003");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 0x0000000D, 4);
  s.set_object(0x1F81, 2, 0x05, 4);
  s.store_objects().restart();
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);
  EXPECT_EQ(write_concise_dcf(s, 3), 0U);
  s.advance(5s).ignore_tx();
  s.cif({0x0002, 0, 0x1F25, 0x80, 4, 0x6F63, 0x666E});
  s.expect(1000, 0x0003);
  s.tx(0x603, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0}).no_tx();
}

// A file for the module itself is never downloaded; 08000024H is for sub-indexes 01H to 7FH alone.
TEST_P(ConfigurationRequest, RequestToAll_WithAFileForTheOwnNodeAlone_DoesNothing) {
  spec("ME3-CFG-013 ME3-CFG-014", "RJ71-CM-003");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  const Words request_all{0x0002, 0, 0x1F25, 0x80, 4, 0x6F63, 0x666E};
  s.cif(request_all).expect(1000, 0x0003).no_tx();
  EXPECT_EQ(write_concise_dcf(s, 1), 0U);
  s.cif(request_all).expect(1000, 0x0003).no_tx();
  s.cif({0x0002, 0, 0x1F25, 2, 4, 0x6F63, 0x666E}).expect_abort(0x08000024);
}

TEST_P(ConfigurationRequest, ConfigurationRequest_NeedsTheActiveMaster) {
  spec("ME3-CFG-001", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  EXPECT_EQ(write_concise_dcf(s, 2), 0U);
  for (const std::uint16_t sub : Words{2, 0x80}) {
    s.cif({0x0002, 0, 0x1F25, sub, 4, 0x6F63, 0x666E}).expect_abort(0x08000022);
  }
  s.no_tx();
}

TEST_P(SdoChannelInConciseDcf, TakenByTheStartUp_FailsTheCommand) {
  spec("ME3-CIF-024", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 1, 4);
  s.set_object(0x1F81, 2, 0x05, 4);
  s.store_objects();
  s.restart();
  s.ignore_tx();
  s.wait_tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.cif({0x0004, 2, 0x1018, 1});
  s.expect_abort(0x060A0023, 2).expect_bit(25, 14, true).no_tx();
  s.rx(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
  s.wait_bit(25, 14, false);
  s.ignore_tx();
  s.write(1000, {0x0004, 2, 0x1018, 1});
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
  s.rx(0x582, {0x43, 0x18, 0x10, 0x01, 0x71, 0, 0, 0});
  s.expect(1000, {0x0005, 2, 0x1018, 1, 4, 0x0071});
}

TEST_P(EmergencyInhibitTime, CountsInWholeMilliseconds) {
  spec("ME3-EMCY-004", "RJ71-EMCY-014");
  const auto messages_after = [](std::uint16_t inhibit_time, can::Duration pause) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1015, 0, inhibit_time, 2);
    s.error_counters(130, 0);
    s.advance(pause);
    s.controller().overflows = 1;
    s.write(20, 0);
    const std::size_t count = s.controller().sent.size();
    s.ignore_tx();
    return count;
  };
  EXPECT_EQ(messages_after(0, 0us), 2U);
  EXPECT_EQ(messages_after(1, 950us), 1U);
  EXPECT_EQ(messages_after(9, 950us), 1U);
  EXPECT_EQ(messages_after(9, 1000us), 2U);
  EXPECT_EQ(messages_after(19, 1000us), 2U);
  EXPECT_EQ(messages_after(500, 49900us), 1U);
  EXPECT_EQ(messages_after(500, 50000us), 2U);
}

// An error within the inhibit time is told at its end, once, in the order of the errors; not in Stopped.
TEST_P(EmergencyInhibitTime, HoldsEmergenciesBack) {
  spec("ME3-EMCY-004 ME3-EMCY-011", "RJ71-EMCY-014");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1015, 0, 500, 2);
  s.error_counters(130, 0);
  s.tx(0x081, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.controller().overflows = 1;
  s.write(20, 0);
  s.cpu(module::CpuState::stop);
  s.advance(49900us).no_tx().advance(100us);
  s.tx(0x081, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.advance(49900us).no_tx().advance(100us);
  s.tx(0x081, {0x00, 0xFF, 0x91, 0x4D, 0x45, 0x30, 0x30, 0x32}).advance(10s).no_tx();
  s.cpu(module::CpuState::run);
  s.cpu(module::CpuState::stop);
  s.ignore_tx();
  s.error_counters(0, 0);
  s.error_counters(130, 0);
  s.nmt(0x02, 1).advance(1s).no_tx();
  s.nmt(0x80, 1).advance(1s).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_configuration_request_test
