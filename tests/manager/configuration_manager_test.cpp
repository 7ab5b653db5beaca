// The configuration manager: 1F22H and 1F25H [CiA 302-3; ME3CAN1-Q 4.8.12].

#include "canopus/manager/configuration/configuration_manager.hpp"

#include <gmock/gmock.h>

#include "canopus/manager/boot/concise_dcf.hpp"

#include "master_bench.hpp"
#include "two_entries.hpp"

namespace canopus::manager::test::configuration_manager_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

// --- configuration manager: 1F22H, 1F25H

class Manager : public MasterBench, public ConfigurationStore {
 public:
  Manager() : configurations(node, master, this) {
    object(0x1F80, 0, 0x01);
    configurations.options() = {.maximum_files = 60,
                                .maximum_size = 65531,
                                .delete_first = true,
                                .check_files = false,
                                .write_time = 100ms,
                                .erase_time = 2s};
  }
  bool store(std::uint8_t id, std::span<const std::uint8_t> file) override {
    if (!works) return false;
    kept[id].assign(file.begin(), file.end());
    ++writes;
    return true;
  }
  AbortCode put(std::uint8_t id, const Bytes& file) { return node.dictionary().write(0x1F22, id, file, now); }
  AbortCode conf(std::uint8_t id) { return write(0x1F25, id, 0x666E6F63, 4); }

  ConfigurationManager configurations;
  std::map<std::uint8_t, Bytes> kept;
  unsigned writes = 0;
  bool works = true;
};

TEST_F(Manager, File_IsStored_AndReadBack) {
  switch_on();
  EXPECT_EQ(put(2, two_entries), AbortCode::none);
  EXPECT_EQ(kept[2], two_entries);
  const auto read = node.dictionary().read(0x1F22, 2, now);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(Bytes(read->begin(), read->end()), two_entries);
  EXPECT_EQ(configurations.files(), 1U);
}

TEST_F(Manager, FileOutlivesAResetOfTheNode) {
  switch_on();
  put(2, two_entries);
  node.command(canopen::NmtCommand::reset_node, now);
  run_for(1s);
  const auto read = node.dictionary().read(0x1F22, 2, now);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->size(), 24U);
}

TEST_F(Manager, UsedPlace_MustBeDeletedFirst) {
  switch_on();
  put(2, two_entries);
  run_for(1s);
  EXPECT_EQ(put(2, two_entries), AbortCode::write_of_read_only);
  EXPECT_EQ(put(2, {0}), AbortCode::none);
  EXPECT_TRUE(kept[2].empty());
  EXPECT_EQ(configurations.files(), 0U);
  run_for(2s);
  EXPECT_EQ(put(2, two_entries), AbortCode::none);
}

TEST_F(Manager, WhileTheStoreIsBusy_WritesAreRefused) {
  switch_on();
  put(2, two_entries);
  EXPECT_EQ(put(3, two_entries), AbortCode::hardware_error);
  run_for(100ms);
  EXPECT_EQ(put(3, two_entries), AbortCode::none);
  run_for(100ms);
  EXPECT_EQ(put(2, {0}), AbortCode::none);
  run_for(1999ms);
  EXPECT_EQ(put(2, two_entries), AbortCode::hardware_error);
  run_for(1ms);
  EXPECT_EQ(put(2, two_entries), AbortCode::none);
}

TEST_F(Manager, Size_UpTo65531Bytes) {
  switch_on();
  Bytes file(65532, 0x55);
  EXPECT_EQ(put(2, file), AbortCode::length_mismatch);
  file.pop_back();
  EXPECT_EQ(put(2, file), AbortCode::none);
}

TEST_F(Manager, SixtyFiles_NotMore) {
  switch_on();
  for (std::uint8_t id = 2; id < 62; ++id) {
    EXPECT_EQ(put(id, two_entries), AbortCode::none);
    run_for(100ms);
  }
  EXPECT_EQ(put(100, two_entries), AbortCode::out_of_memory);
  EXPECT_EQ(writes, 60U);
}

TEST_F(Manager, StoreFails_NothingIsChanged) {
  switch_on();
  works = false;
  EXPECT_EQ(put(2, two_entries), AbortCode::hardware_error);
  EXPECT_EQ(configurations.files(), 0U);
}

TEST_F(Manager, CheckedFiles_MustBeConciseDcfs) {
  configurations.options().check_files = true;
  switch_on();
  EXPECT_EQ(put(2, Bytes(20, 0x55)), AbortCode::invalid_value);
  EXPECT_EQ(put(2, two_entries), AbortCode::none);
}

TEST_F(Manager, FileFromPowerOn_IsDownloadedAtBoot_WithoutBeingStoredAgain) {
  object(0x1F81, 2, 0x0D);
  ScriptedSlave& device = slave(2);
  configurations.load(2, two_entries);
  switch_on();
  run_for(1s);
  EXPECT_EQ(device.written.size(), 2U);
  EXPECT_EQ(writes, 0U);
}

TEST_F(Manager, Request_ConfiguresTheNodeNow) {
  ScriptedSlave& device = slave(2);
  switch_on();
  put(2, two_entries);
  EXPECT_EQ(conf(2), AbortCode::none);
  run_for(1s);
  EXPECT_EQ(device.written.size(), 2U);
}

TEST_F(Manager, Request_Refusals) {
  switch_on();
  EXPECT_EQ(conf(2), AbortCode::no_data);
  EXPECT_EQ(conf(0x80), AbortCode::none);  // nothing to do
  EXPECT_EQ(conf(1), AbortCode::none);     // own node
  put(2, two_entries);
  EXPECT_EQ(write(0x1F25, 2, 0x666E6F64, 4), AbortCode::cannot_store);
}

TEST_F(Manager, Request_NotAsSlave) {
  object(0x1F80, 0, 0);
  switch_on();
  put(2, two_entries);
  EXPECT_EQ(conf(2), AbortCode::device_state);
  EXPECT_EQ(conf(0x80), AbortCode::device_state);
}

TEST_F(Manager, RequestToAll_ConfiguresEachNodeThatHasAFile) {
  ScriptedSlave& second = slave(2);
  ScriptedSlave& third = slave(3);
  ScriptedSlave& fourth = slave(4);
  configurations.load(1, two_entries);
  configurations.load(2, two_entries);
  configurations.load(4, two_entries);
  switch_on();
  EXPECT_EQ(conf(0x80), AbortCode::none);
  run_for(1s);
  EXPECT_EQ(second.written.size(), 2U);
  EXPECT_EQ(third.written.size(), 0U);
  EXPECT_EQ(fourth.written.size(), 2U);
}

TEST_F(Manager, RequestToAll_OfTheOwnFileAlone_DoesNothing) {
  configurations.load(1, two_entries);
  switch_on();
  EXPECT_EQ(conf(0x80), AbortCode::none);
  run_for(1s);
  EXPECT_THAT(only(sent(), " 60"), IsEmpty());
}

// A slave that is not there is asked for 1000H without end; that must not keep the others from their files.
TEST_F(Manager, RequestToAll_WhileASlaveIsBooted_ConfiguresTheOthers) {
  object(0x1F81, 2, 0x05);
  ScriptedSlave& third = slave(3);
  configurations.load(2, two_entries);
  configurations.load(3, two_entries);
  switch_on();
  run_for(5s);
  EXPECT_EQ(conf(2), AbortCode::device_state);
  EXPECT_EQ(conf(0x80), AbortCode::none);
  run_for(1s);
  EXPECT_EQ(third.written.size(), 2U);
}

TEST_F(Manager, RequestForTheOwnNode_DoesNothing_AlsoAsSlave) {
  object(0x1F80, 0, 0);
  switch_on();
  put(1, two_entries);
  EXPECT_EQ(conf(1), AbortCode::none);
}

TEST_F(Manager, EmptyFile_Deletes) {
  switch_on();
  put(2, two_entries);
  run_for(1s);
  EXPECT_EQ(put(2, {0, 0, 0, 0}), AbortCode::none);
  EXPECT_EQ(configurations.files(), 0U);
}

TEST_F(Manager, FileInUse_CannotBeReplacedMeanwhile) {
  configurations.options().delete_first = false;
  slave(2).answer_delay = 50ms;
  switch_on();
  put(2, two_entries);
  run_for(200ms);
  EXPECT_EQ(conf(2), AbortCode::none);
  EXPECT_EQ(put(2, {0}), AbortCode::device_state);
  configurations.options().in_download = AbortCode::hardware_error;
  EXPECT_EQ(put(2, {0}), AbortCode::hardware_error);
  run_for(1s);
  EXPECT_EQ(put(2, {0}), AbortCode::none);
}

}  // namespace
}  // namespace canopus::manager::test::configuration_manager_test
