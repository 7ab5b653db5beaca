// Updates of a slave's program with restarts in between, and the manager's 1F58H [CiA 302-2, 302-3].

#include "manager/program_download.hpp"

namespace canopus::manager::test::program_restart_test {
namespace {

// --- restarts

TEST_F(ProgramDownload, DeviceThatRestartsToTakeAProgram_IsNotDisturbed) {
  on_control = [this](std::uint8_t command) {
    if (command == 3) device().objects[control] = {2};
    if (command == 0) device().reset();  // its boot-up message comes 5 ms later
    return 0U;
  };
  device().answer_delay = 2ms;
  switch_on();
  run_for(2s);
  EXPECT_THAT(only(sent(), " 602 40 00 10 00"), ::testing::SizeIs(2));  // once, and after the start
  EXPECT_EQ(device().written.size(), 4U);
  EXPECT_EQ(record().step, BootStep::booted);
}

TEST_F(ProgramDownload, DeviceThatRestartsWithItsNewProgram_IsBootedAtItsBootUpMessage) {
  on_control = [this](std::uint8_t command) {
    if (command == 3) device().objects[control] = {2};
    if (command == 1) device().reset();
    return 0U;
  };
  device().boot_up_delay = 50ms;
  switch_on();
  run_for(65ms);
  sent();
  run_for(2s);
  // Not after the 100 ms of program_poll.
  EXPECT_THAT(sent(), ElementsAre("110 602 40 00 10 00 00 00 00 00", "111 602 40 56 1F 01 00 00 00 00",
                                  "112 000 01 02"));
}

TEST_F(ProgramDownload, SupplyFailsInTheMiddle_IsUpdatedAgain_ThreeTimesAtMost) {
  device().objects[flash] = {0x01, 0, 0, 0};
  switch_on();
  for (int again = 0; again < 3; ++again) {
    run_for(1s);
    EXPECT_EQ(record().step, BootStep::program_flash) << again;
    device().objects[version] = {0x11, 0, 0, 0};
    device().reset();
  }
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'I');
}

TEST_F(ProgramDownload, RestartDuringTheTransfer_IsUpdatedAgain) {
  programs[2].resize(5000);
  switch_on();
  run_for(15ms);
  ASSERT_EQ(record().step, BootStep::program_download);
  device().present = false;
  run_for(10ms);
  device().present = true;
  device().objects[version] = {0x11, 0, 0, 0};
  device().reset();
  run_for(10s);
  EXPECT_EQ(std::count(device().written.begin(), device().written.end(), std::pair{control, Bytes{3}}), 2);
  EXPECT_EQ(downloaded, programs[2]);
  EXPECT_EQ(record().step, BootStep::booted);
}

TEST_F(ProgramDownload, OptionalSlave_LeavesTheNetworkRunning) {
  object(0x1F81, 2, 0x65);
  programs.clear();
  switch_on();
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_FALSE(master.halted());
  EXPECT_EQ(node.state(), NmtState::operational);
}

// --- the manager's 1F58H

class ProgramManager : public ProgramDownload, public ConfigurationStore {
 public:
  ProgramManager() : configurations(node, master, this) {}
  bool store(std::uint8_t, std::span<const std::uint8_t>) override { return true; }
  bool store_program(std::uint8_t id, std::span<const std::uint8_t> program) override {
    kept[id].assign(program.begin(), program.end());
    return works;
  }
  ConfigurationManager configurations;
  std::map<std::uint8_t, Bytes> kept;
  bool works = true;
};

TEST_F(ProgramManager, ProgramWrittenTo1f58h_IsStored_ReadBack_AndDownloaded) {
  const Bytes program{1, 2, 3, 4, 5, 6, 7, 8, 9};
  device().objects[version] = {0x22, 0, 0, 0};
  switch_on();
  run_for(1s);
  EXPECT_EQ(node.dictionary().write(0x1F58, 2, program, now), AbortCode::none);
  EXPECT_EQ(kept[2], program);
  const auto read = node.dictionary().read(0x1F58, 2, now);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(Bytes(read->begin(), read->end()), program);
  device().objects[version] = {0x11, 0, 0, 0};
  device().reset();
  run_for(2s);
  EXPECT_EQ(downloaded, program);
}

TEST_F(ProgramManager, OneByte0_DeletesIt_AndWritesAreChecked) {
  switch_on();
  configurations.options().maximum_program_size = 8;
  EXPECT_EQ(node.dictionary().write(0x1F58, 3, Bytes(9, 1), now), AbortCode::length_mismatch);
  EXPECT_EQ(node.dictionary().write(0x1F58, 3, Bytes(8, 1), now), AbortCode::none);
  EXPECT_NE(configurations.open_program(3).bytes, nullptr);
  EXPECT_EQ(node.dictionary().write(0x1F58, 3, Bytes{0}, now), AbortCode::none);
  EXPECT_EQ(configurations.open_program(3).bytes, nullptr);
  works = false;
  EXPECT_EQ(node.dictionary().write(0x1F58, 3, Bytes(8, 1), now), AbortCode::hardware_error);
  EXPECT_EQ(configurations.open_program(3).bytes, nullptr);
}

TEST_F(ProgramManager, ProgramThatIsBeingDownloaded_CannotBeReplaced) {
  configurations.load_program(2, Bytes(5000, 7));
  switch_on();
  run_for(15ms);
  ASSERT_EQ(record().step, BootStep::program_download);
  EXPECT_EQ(node.dictionary().write(0x1F58, 2, Bytes(8, 1), now), AbortCode::device_state);
  EXPECT_EQ(node.dictionary().write(0x1F58, 3, Bytes(8, 1), now), AbortCode::none);
  run_for(2s);
  EXPECT_EQ(downloaded, Bytes(5000, 7));
}

}  // namespace
}  // namespace canopus::manager::test::program_restart_test
