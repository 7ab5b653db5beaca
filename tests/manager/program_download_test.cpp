// Check and update of a slave's program while it is booted, and how it can end [CiA 302-2, 302-3].

#include "manager/program_download.hpp"

namespace canopus::manager::test::program_download_test {
namespace {

TEST_F(ProgramDownload, ExpectedVersion_IsLeftAlone) {
  device().objects[version] = {0x22, 0, 0, 0};
  switch_on();
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00", "5 602 40 00 10 00 00 00 00 00",
                                  "6 602 40 56 1F 01 00 00 00 00", "7 000 01 02"));
}

TEST_F(ProgramDownload, WithoutBit5_NothingIsAsked) {
  object(0x1F81, 2, 0x4D);
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " 1F "), IsEmpty());
  EXPECT_TRUE(master.boot_record(2).error == BootError::none);
}

TEST_F(ProgramDownload, OtherVersion_StopClearDownloadStatusVerifyStart_AndBootsFromTheBeginning) {
  int busy = 2;
  device().on_read = [&](const ScriptedSlave::Key& key) {
    if (key == flash) device().objects[flash] = {static_cast<std::uint8_t>(busy-- > 0 ? 1 : 0), 0, 0, 0};
  };
  switch_on();
  run_for(2s);
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00", "5 602 40 00 10 00 00 00 00 00",
                                  "6 602 40 56 1F 01 00 00 00 00",   // which version?
                                  "7 602 40 51 1F 01 00 00 00 00",   // does it run?
                                  "8 602 2F 51 1F 01 00 00 00 00",   // stop
                                  "9 602 2F 51 1F 01 03 00 00 00",   // clear
                                  "10 602 C6 50 1F 01 0A 00 00 00",  // download
                                  "11 602 01 30 31 32 33 34 35 36", "11 602 82 37 38 39 00 00 00 00",
                                  "12 602 D1 58 9C 00 00 00 00 00",
                                  "13 602 40 57 1F 01 00 00 00 00",  // busy
                                  "114 602 40 57 1F 01 00 00 00 00", "215 602 40 57 1F 01 00 00 00 00",
                                  "216 602 40 56 1F 01 00 00 00 00",  // the new version?
                                  "217 602 2F 51 1F 01 01 00 00 00",  // start
                                  "318 602 40 51 1F 01 00 00 00 00",  // does it run?
                                  "319 602 40 00 10 00 00 00 00 00", "320 602 40 56 1F 01 00 00 00 00",
                                  "321 000 01 02"));
  EXPECT_EQ(downloaded, programs[2]);
  EXPECT_EQ(record().step, BootStep::booted);
}

TEST_F(ProgramDownload, AnswersWithoutTheirSize_AreTheValuesOfTheirTypes) {
  device().indicates_size = false;  // 1F51H is UNSIGNED8, the others have four bytes
  device().objects[control] = {0};
  switch_on();
  run_for(2s);
  ASSERT_GE(device().written.size(), 1U);
  EXPECT_EQ(device().written[0], (std::pair{control, Bytes{3}})) << "the program was stopped already";
  EXPECT_EQ(record().step, BootStep::booted);
  EXPECT_EQ(downloaded, programs[2]);
}

TEST_F(ProgramDownload, StoppedProgram_IsNotStoppedAgain) {
  for (const std::uint8_t state : {std::uint8_t{0}, std::uint8_t{2}}) {
    device().objects[version] = {0x11, 0, 0, 0};
    device().objects[control] = {state};
    device().written.clear();
    switch_on();
    run_for(2s);
    ASSERT_GE(device().written.size(), 2U);
    EXPECT_EQ(device().written[0], (std::pair{control, Bytes{3}}));
    EXPECT_EQ(record().step, BootStep::booted);
    node.power_off();
    master.stop(now);
  }
}

TEST_F(ProgramDownload, SlaveWithoutBlocks_GetsItInSegments) {
  device().knows_blocks = false;
  switch_on();
  run_for(2s);
  EXPECT_THAT(only(sent(), " 602 "),
              ::testing::IsSupersetOf({"10 602 C6 50 1F 01 0A 00 00 00", "11 602 21 50 1F 01 0A 00 00 00",
                                       "12 602 00 30 31 32 33 34 35 36", "13 602 19 37 38 39 00 00 00 00"}));
  EXPECT_EQ(downloaded, programs[2]);
  EXPECT_EQ(record().step, BootStep::booted);
}

TEST_F(ProgramDownload, LargeProgram_IsReadPieceByPiece) {
  programs[2].resize(50'000);
  for (std::size_t i = 0; i < programs[2].size(); ++i) programs[2][i] = static_cast<std::uint8_t>(i * 7);
  switch_on();
  run_for(40ms);
  EXPECT_EQ(record().step, BootStep::program_download);
  EXPECT_EQ(record().size, 50'000U);
  EXPECT_GT(record().bytes, 1000U);
  EXPECT_LT(record().bytes, 50'000U);
  EXPECT_THAT(words(),
              HasSubstr("downloading its program, " + std::to_string(record().bytes) + " of 50000 bytes"));
  run_for(2s);
  EXPECT_EQ(downloaded, programs[2]);
  EXPECT_EQ(record().step, BootStep::booted);
}

// --- G

TEST_F(ProgramDownload, NoVersionExpected_EndsWithG) {
  object(0x1F55, 2, 0);
  switch_on();
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'G');
  EXPECT_TRUE(master.halted());
  EXPECT_THAT(words(), HasSubstr("(G, software version not described)"));
  EXPECT_THAT(words(), HasSubstr("1F55H holds no version"));
}

TEST_F(ProgramDownload, VersionCannotBeRead_EndsWithG) {
  device().aborts[version] = 0x06020000;
  switch_on();
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'G');
  EXPECT_THAT(words(), HasSubstr("1F56:01: abort 06020000H"));
}

// --- H

TEST_F(ProgramDownload, UpdateNotAllowed_EndsWithH) {
  object(0x1F81, 2, 0x2D);
  switch_on();
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'H');
  EXPECT_TRUE(device().written.empty());
  EXPECT_THAT(words(), HasSubstr("1F56:01 reads 00000011H, expected 00000022H. Set bit 6"));
}

TEST_F(ProgramDownload, SlaveThatIsToBeKeptAlive_EndsWithH) {
  object(0x1F81, 2, 0x7D);
  switch_on();
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'H');
  EXPECT_TRUE(device().written.empty());
}

TEST_F(ProgramDownload, KeptAliveAndOperational_IsNotEvenAsked) {
  object(0x1F81, 2, 0x7D);
  device().state = 0x05;
  device().boots_up = false;
  switch_on();
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'L');
  EXPECT_THAT(only(sent(), " 40 56 1F"), IsEmpty());
}

// --- I

TEST_F(ProgramDownload, NoProgram_EndsWithI) {
  programs.clear();
  switch_on();
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_THAT(words(), HasSubstr("(I, program download failed)"));
  EXPECT_THAT(words(), HasSubstr("no program for it in 1F58H"));
}

TEST_F(ProgramDownload, StateCannotBeRead_EndsWithI) {
  device().aborts[control] = 0x06020000;
  switch_on();
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_EQ(record().failed_step, BootStep::program_state);
  EXPECT_THAT(words(), HasSubstr("1F51:01: abort 06020000H"));
}

TEST_F(ProgramDownload, CommandRefused_EndsWithI) {
  const std::vector<std::pair<std::uint8_t, BootStep>> commands{{std::uint8_t{0}, BootStep::program_stop},
                                                                {std::uint8_t{3}, BootStep::program_clear},
                                                                {std::uint8_t{1}, BootStep::program_start}};
  for (const auto& [command, step] : commands) {
    device().objects[version] = {0x11, 0, 0, 0};
    device().objects[control] = {1};
    on_control = [refused = command](std::uint8_t value) { return value == refused ? 0x08000022U : 0U; };
    switch_on();
    run_for(2s);
    EXPECT_EQ(letter(record().error), 'I');
    EXPECT_EQ(record().failed_step, step);
    EXPECT_THAT(words(), HasSubstr("1F51:01: abort 08000022H"));
    node.power_off();
    master.stop(now);
  }
}

TEST_F(ProgramDownload, StopNotAnswered_GoesOn) {
  on_control = [this](std::uint8_t command) {
    if (command == 3) device().objects[control] = {2};
    return 0U;
  };
  device().on_read = [this](const ScriptedSlave::Key& key) {
    if (key == control && device().objects[control][0] == 1 && downloaded.empty())
      device().silences[control] = 1;
  };
  switch_on();
  run_for(7ms);
  sent();
  run_for(2s);
  const auto lines = sent();
  EXPECT_EQ(lines[0], "8 602 2F 51 1F 01 00 00 00 00");
  EXPECT_EQ(lines[1], "508 602 80 51 1F 01 00 00 04 05");  // time-out
  EXPECT_EQ(lines[2], "508 602 2F 51 1F 01 03 00 00 00");
  EXPECT_EQ(record().step, BootStep::booted);
}

TEST_F(ProgramDownload, ClearNotAnswered_IsTriedFourTimes) {
  on_control = [this](std::uint8_t command) {
    if (command == 0) device().silences[control] = 3;
    return 0U;
  };
  switch_on();
  run_for(20s);
  // 5 s for each, 100 ms between them.
  EXPECT_THAT(only(sent(), "2F 51 1F 01 03"),
              ElementsAre("9 602 2F 51 1F 01 03 00 00 00", "5109 602 2F 51 1F 01 03 00 00 00",
                          "10209 602 2F 51 1F 01 03 00 00 00", "15309 602 2F 51 1F 01 03 00 00 00"));
  EXPECT_EQ(record().step, BootStep::booted);
}

TEST_F(ProgramDownload, ClearNeverAnswered_EndsWithI) {
  on_control = [this](std::uint8_t command) {
    if (command == 0) device().silences[control] = 100;
    return 0U;
  };
  switch_on();
  run_until_ms(20308);
  EXPECT_EQ(record().step, BootStep::program_clear);
  run_until_ms(20309);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_EQ(record().failed_step, BootStep::program_clear);
  EXPECT_THAT(words(), HasSubstr("1F51:01: no answer"));
}

TEST_F(ProgramDownload, DownloadAborted_EndsWithI) {
  device().aborts[data] = 0x06060000;
  switch_on();
  run_for(2s);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_EQ(record().failed_step, BootStep::program_download);
  EXPECT_EQ(record().abort_code, AbortCode::hardware_error);
  EXPECT_THAT(words(), HasSubstr("1F50:01: abort 06060000H"));
}

TEST_F(ProgramDownload, FlashStatus_SaysWhatIsWrong) {
  device().objects[flash] = {0x06, 0, 0, 0};
  switch_on();
  run_for(2s);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_THAT(words(), HasSubstr("1F57:01 reads 00000006H: the program is damaged (format or CRC)"));
}

TEST_F(ProgramDownload, FlashMemoryBusyTooLong_EndsWithI) {
  device().objects[flash] = {0x01, 0, 0, 0};
  master.options().program_flash_limit = 3s;
  switch_on();
  run_until_ms(3000);
  EXPECT_EQ(record().step, BootStep::program_flash);
  run_until_ms(3200);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_THAT(words(), HasSubstr("busy for too long"));
}

TEST_F(ProgramDownload, SilentWhileTheFlashMemoryIsWritten_IsWaitedFor) {
  device().silences[flash] = 4;
  switch_on();
  run_for(4s);
  EXPECT_EQ(record().step, BootStep::booted);
}

TEST_F(ProgramDownload, DeviceWithoutFlashStatus_IsAskedForItsVersion) {
  device().objects.erase(flash);
  switch_on();
  run_for(2s);
  EXPECT_EQ(record().step, BootStep::booted);
}

TEST_F(ProgramDownload, AnotherVersionAfterTheDownload_EndsWithI) {
  new_version = 0x33;
  switch_on();
  run_for(2s);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_EQ(record().failed_step, BootStep::program_verify);
  EXPECT_THAT(words(), HasSubstr("1F56:01 reads 00000033H, expected 00000022H"));
}

TEST_F(ProgramDownload, ProgramDoesNotStart_EndsWithI) {
  on_control = [this](std::uint8_t command) {
    device().objects[control] = {static_cast<std::uint8_t>(command == 1 ? 0 : 2)};
    return 0U;
  };
  master.options().program_start_limit = 2s;
  switch_on();
  run_for(2s);
  EXPECT_EQ(record().step, BootStep::program_started);
  run_for(1s);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_EQ(record().failed_step, BootStep::program_started);
  EXPECT_THAT(words(), HasSubstr("does not start"));
}

TEST_F(ProgramDownload, StillAnotherVersionOnceItRuns_IsNotUpdatedWithoutEnd) {
  int started = 0;
  on_control = [&](std::uint8_t command) {
    if (command == 3) device().objects[control] = {2};
    if (command == 1) {
      ++started;
      device().objects[version] = {0x11, 0, 0, 0};
    }
    return 0U;
  };
  switch_on();
  run_for(30s);
  EXPECT_EQ(started, 1);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_THAT(words(), HasSubstr("It was updated and started, and yet reports another version"));
}

TEST_F(ProgramDownload, BootTimeOver_EndsWithI) {
  object(0x1F89, 0, 1000);
  device().objects[flash] = {0x01, 0, 0, 0};
  switch_on();
  run_until_ms(999);
  EXPECT_EQ(record().step, BootStep::program_flash);
  run_until_ms(1000);
  EXPECT_EQ(letter(record().error), 'I');
  EXPECT_TRUE(master.halted());
}

}  // namespace
}  // namespace canopus::manager::test::program_download_test
