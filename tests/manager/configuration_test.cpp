// Concise DCF and the configuration of slaves while they are booted [CiA 302-3; ME3CAN1-Q 4.8.12].

#include <gmock/gmock.h>

#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/manager/configuration/configuration_manager.hpp"

#include "master_bench.hpp"
#include "two_entries.hpp"

namespace canopus::manager::test::configuration_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

TEST(ConciseDcf, Reader_DeliversEachEntry) {
  ConciseDcfReader reader(two_entries);
  const auto first = reader.next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->index, 0x1017);
  EXPECT_EQ(first->sub, 0);
  EXPECT_THAT(Bytes(first->data.begin(), first->data.end()), ElementsAre(0xE8, 0x03));
  const auto second = reader.next();
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(second->index, 0x1800);
  EXPECT_EQ(second->sub, 1);
  EXPECT_THAT(Bytes(second->data.begin(), second->data.end()), ElementsAre(0x81, 0x01, 0x00, 0x80));
  EXPECT_FALSE(reader.next().has_value());
  EXPECT_TRUE(reader.intact());
}

TEST(ConciseDcf, Reader_StopsWhereAnEntryReachesBeyondTheEnd) {
  for (std::size_t length = 5; length < two_entries.size(); ++length) {
    ConciseDcfReader reader(std::span<const std::uint8_t>(two_entries).first(length));
    while (reader.next()) {
    }
    EXPECT_FALSE(reader.intact()) << length;
  }
}

TEST(ConciseDcf, Reader_LengthOfAllOnes_IsNoOverflow) {
  const Bytes file{1, 0, 0, 0, 0x17, 0x10, 0, 0xFF, 0xFF, 0xFF, 0xFF, 1, 2};
  ConciseDcfReader reader(file);
  EXPECT_FALSE(reader.next().has_value());
  EXPECT_FALSE(reader.intact());
}

TEST(ConciseDcf, Check_SaysWhichEntryIsDamaged) {
  EXPECT_EQ(check_concise_dcf(two_entries).value(), 2U);
  const auto damaged = check_concise_dcf(std::span<const std::uint8_t>(two_entries).first(20));
  ASSERT_FALSE(damaged.has_value());
  EXPECT_THAT(damaged.error(), HasSubstr("entry 2 of 2, at byte 13"));
  EXPECT_FALSE(check_concise_dcf(Bytes{1, 2}).has_value());
}

TEST(ConciseDcf, EmptyFiles_HaveNoEntries) {
  for (const Bytes& file : {Bytes{}, Bytes{0}, Bytes{0, 0, 0, 0}, Bytes{0, 0, 0, 0, 1}}) {
    EXPECT_TRUE(is_empty_concise_dcf(file));
    EXPECT_EQ(check_concise_dcf(file).value(), 0U);
  }
  EXPECT_FALSE(is_empty_concise_dcf(two_entries));
}

TEST(ConciseDcf, Writer_MakesTheSameBytes) {
  ConciseDcfWriter writer;
  writer.add(0x1017, 0, 1000, 2).add(0x1800, 1, 0x80000181, 4);
  EXPECT_EQ(writer.file(), two_entries);
}

class Configuration : public MasterBench {
 public:
  Configuration() {
    object(0x1F80, 0, 0x01);
    object(0x1F81, 2, 0x0D);
    files[2] = two_entries;
    slave(2);
  }
  ScriptedSlave& device() { return slaves.front(); }
};

TEST_F(Configuration, WithoutExpectedDate_IsDownloadedInItsOrder_BeforeTheStart) {
  switch_on();
  run_for(1s);
  EXPECT_THAT(sent(),
              ElementsAre("0 701 00", "0 000 82 00", "5 602 40 00 10 00 00 00 00 00",
                          "6 602 2B 17 10 00 E8 03 00 00", "7 602 23 00 18 01 81 01 00 80", "8 000 01 02"));
}

TEST_F(Configuration, DateAndTimeAsExpected_IsNotDownloadedAgain) {
  object(0x1F26, 2, 0x1234);
  object(0x1F27, 2, 0x5678);
  device().objects[{0x1020, 1}] = {0x34, 0x12, 0, 0};
  device().objects[{0x1020, 2}] = {0x78, 0x56, 0, 0};
  switch_on();
  run_for(1s);
  EXPECT_THAT(sent(),
              ElementsAre("0 701 00", "0 000 82 00", "5 602 40 00 10 00 00 00 00 00",
                          "6 602 40 20 10 01 00 00 00 00", "7 602 40 20 10 02 00 00 00 00", "8 000 01 02"));
}

TEST_F(Configuration, OtherDate_IsDownloaded) {
  object(0x1F26, 2, 0x1234);
  object(0x1F27, 2, 0x5678);
  device().objects[{0x1020, 1}] = {0x35, 0x12, 0, 0};
  switch_on();
  run_for(1s);
  EXPECT_EQ(device().written.size(), 2U);
}

TEST_F(Configuration, OtherTime_IsDownloaded) {
  object(0x1F26, 2, 0x1234);
  object(0x1F27, 2, 0x5678);
  device().objects[{0x1020, 1}] = {0x34, 0x12, 0, 0};
  device().objects[{0x1020, 2}] = {0x79, 0x56, 0, 0};
  switch_on();
  run_for(1s);
  EXPECT_EQ(device().written.size(), 2U);
}

TEST_F(Configuration, DateNotReadable_IsDownloaded) {
  object(0x1F26, 2, 0x1234);
  object(0x1F27, 2, 0x5678);
  switch_on();
  run_for(1s);
  EXPECT_EQ(device().written.size(), 2U);
}

TEST_F(Configuration, OnlyTheDateExpected_IsDownloadedWithoutComparing) {
  object(0x1F26, 2, 0x1234);
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), "602 40 20 10"), IsEmpty());
  EXPECT_EQ(device().written.size(), 2U);
}

TEST_F(Configuration, ReadOnlyEntry_IsPassedOver_WhereTheModelSaysSo) {
  master.options().configuration_skips_read_only = true;
  device().aborts[{0x1017, 0}] = 0x06010002;
  switch_on();
  run_for(1s);
  ASSERT_EQ(device().written.size(), 1U);
  EXPECT_EQ(device().written[0].first, (ScriptedSlave::Key{0x1800, 1}));
  EXPECT_EQ(master.boot_record(2).error, BootError::none);
}

TEST_F(Configuration, ReadOnlyEntry_EndsIt) {
  device().aborts[{0x1017, 0}] = 0x06010002;
  switch_on();
  run_for(1s);
  EXPECT_TRUE(device().written.empty());
  EXPECT_EQ(master.boot_record(2).error, BootError::configuration);
  EXPECT_EQ(master.boot_record(2).abort_code, AbortCode::write_of_read_only);
  EXPECT_TRUE(master.halted());
}

TEST_F(Configuration, AnyOtherAbort_EndsIt) {
  device().aborts[{0x1017, 0}] = 0x06090030;
  switch_on();
  run_for(1s);
  EXPECT_TRUE(device().written.empty());
  EXPECT_EQ(master.boot_record(2).error, BootError::configuration);
  EXPECT_EQ(master.boot_record(2).abort_code, AbortCode::invalid_value);
  EXPECT_TRUE(master.halted());
  const std::string words = explain(master.boot_record(2), 2, now);
  EXPECT_THAT(words, HasSubstr("(J, configuration failed)"));
  EXPECT_THAT(words, HasSubstr("1017:00: abort 06090030H"));
}

TEST_F(Configuration, DamagedFile_EndsIt) {
  files[2].resize(20);
  switch_on();
  run_for(1s);
  EXPECT_EQ(master.boot_record(2).error, BootError::configuration);
  EXPECT_THAT(explain(master.boot_record(2), 2, now), HasSubstr("damaged"));
}

TEST_F(Configuration, LongValue_GoesInSegments) {
  files[2] = {1, 0, 0, 0, 0x00, 0x20, 0x03, 9, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  switch_on();
  run_for(1s);
  ASSERT_EQ(device().written.size(), 1U);
  EXPECT_THAT(device().written[0].second, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
}

/// A file with one value of so many bytes per entry.
Bytes file_with(std::initializer_list<std::size_t> lengths) {
  ConciseDcfWriter writer;
  std::uint8_t sub = 0;
  for (const std::size_t length : lengths) writer.add(0x2000, ++sub, Bytes(length, 0x5A));
  return writer.file();
}

TEST_F(Configuration, From22Bytes_GoesInBlocks) {
  files[2] = file_with({21, 22, 300});
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " 00 20 0"),
              ElementsAre("6 602 21 00 20 01 15 00 00 00", "10 602 C6 00 20 02 16 00 00 00",
                          "13 602 C6 00 20 03 2C 01 00 00"));
  ASSERT_EQ(device().written.size(), 3U);
  EXPECT_EQ(device().written[2].second, Bytes(300, 0x5A));
}

TEST_F(Configuration, SlaveWithoutBlocks_GetsSegments_AndIsAskedOnce) {
  device().knows_blocks = false;
  files[2] = file_with({22, 22});
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " 00 20 0"),
              ElementsAre("6 602 C6 00 20 01 16 00 00 00", "7 602 21 00 20 01 16 00 00 00",
                          "12 602 21 00 20 02 16 00 00 00"));
  EXPECT_EQ(device().written.size(), 2U);
  EXPECT_EQ(master.boot_record(2).error, BootError::none);
}

TEST_F(Configuration, SlaveThatDoesNotAnswerABlock_GetsSegments) {
  device().silences[{0x2000, 1}] = 1;
  files[2] = file_with({22});
  switch_on();
  run_for(2s);
  EXPECT_THAT(only(sent(), " 00 20 0"),
              ElementsAre("6 602 C6 00 20 01 16 00 00 00", "506 602 80 00 20 01 00 00 04 05",
                          "506 602 21 00 20 01 16 00 00 00"));
  EXPECT_EQ(master.boot_record(2).error, BootError::none);
}

TEST_F(Configuration, BlocksCanBeSwitchedOff) {
  master.options().block_from = 0;
  files[2] = file_with({300});
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " 00 20 0"), ElementsAre("6 602 21 00 20 01 2C 01 00 00"));
}

TEST_F(Configuration, ValueRefusedInABlock_IsNotTriedAgain) {
  device().aborts[{0x2000, 1}] = 0x06090030;
  files[2] = file_with({22});
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " 00 20 0"), ElementsAre("6 602 C6 00 20 01 16 00 00 00"));
  EXPECT_EQ(master.boot_record(2).error, BootError::configuration);
}

TEST_F(Configuration, WithoutTheBootSlaveBit_IsNotDownloaded) {
  object(0x1F81, 2, 0x01);
  switch_on();
  run_for(1s);
  EXPECT_TRUE(device().written.empty());
}

TEST_F(Configuration, Request_DownloadsWithoutRestartingTheSlave) {
  switch_on();
  run_for(1s);
  device().written.clear();
  sent();
  EXPECT_EQ(master.request_configuration(2, now), AbortCode::none);
  EXPECT_TRUE(master.configuring(2));
  run_for(1s);
  EXPECT_FALSE(master.configuring(2));
  EXPECT_THAT(sent(), ElementsAre("1000 602 2B 17 10 00 E8 03 00 00", "1001 602 23 00 18 01 81 01 00 80"));
  EXPECT_EQ(master.boot_record(2).step, BootStep::booted);
}

TEST_F(Configuration, Request_WithoutAFile_IsRefused) {
  switch_on();
  run_for(1s);
  EXPECT_EQ(master.request_configuration(3, now), AbortCode::no_data);
}

TEST_F(Configuration, Request_AsSlave_IsRefused) {
  object(0x1F80, 0, 0);
  switch_on();
  EXPECT_EQ(master.request_configuration(2, now), AbortCode::device_state);
}

TEST_F(Configuration, Request_ForTheOwnNode_DoesNothing) {
  files[1] = two_entries;
  switch_on();
  run_for(1s);
  sent();
  EXPECT_EQ(master.request_configuration(1, now), AbortCode::none);
  run_for(1s);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(Configuration, Restore_WritesLoad_ResetsTheSlave_ThenConfigures) {
  master.options().assignment_bits = 0x9D;
  object(0x1F81, 2, 0x8D);
  object(0x1F8A, 2, 1);
  files[2].clear();
  switch_on();
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00", "5 602 40 00 10 00 00 00 00 00",
                                  "6 602 23 11 10 01 6C 6F 61 64", "7 000 81 02", "12 000 01 02"));
}

TEST_F(Configuration, Restore_RefusedByTheSlave_Fails) {
  master.options().assignment_bits = 0x9D;
  object(0x1F81, 2, 0x8D);
  object(0x1F8A, 2, 1);
  device().aborts[{0x1011, 1}] = 0x06020000;
  switch_on();
  run_for(1s);
  EXPECT_EQ(master.boot_record(2).error, BootError::configuration);
  EXPECT_EQ(master.boot_record(2).failed_step, BootStep::restore);
}

}  // namespace
}  // namespace canopus::manager::test::configuration_test
