#include "canopus/store/parameter_file.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/canopen/node/node.hpp"

namespace canopus::store::parameter_file_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A folder that is gone after the test.
struct Folder {
  std::filesystem::path path = std::filesystem::path(testing::TempDir()) /
                               testing::UnitTest::GetInstance()->current_test_info()->name();
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::shared_ptr<const canopen::DictionaryDescription> description() {
  canopen::DictionaryBuilder builder;
  builder.variable(0x1000, {.name = "Device type"});
  builder.variable(0x1001, {.name = "Error register", .type = canopen::DataType::unsigned8});
  builder.object(0x1010, canopen::ObjectCode::array, "Store parameters");
  builder.sub(0x1010, 1, {.name = "Save all parameters"});
  builder.variable(
      0x1017, {.name = "Producer heartbeat time", .type = canopen::DataType::unsigned16, .stored = true});
  return builder.build();
}

struct Nowhere final : can::Sink {
  bool send(const can::Frame&) override { return true; }
};

TEST(ParameterFile, WhatANodeSavesIsThereAfterTheNextPowerOn) {
  const Folder folder;
  Nowhere nowhere;
  {
    ParameterFile file(folder.path, "node-005");
    canopen::Node node(description(), 5, nowhere);
    node.set_parameter_store(&file);
    node.power_on(can::Time{});
    EXPECT_EQ(node.dictionary().write(0x1017, 0, std::array<std::uint8_t, 2>{0xE8, 0x03}, can::Time{}),
              canopen::AbortCode::none);
    EXPECT_EQ(
        node.dictionary().write(0x1010, 1, std::array<std::uint8_t, 4>{'s', 'a', 'v', 'e'}, can::Time{}),
        canopen::AbortCode::none);
  }
  ParameterFile file(folder.path, "node-005");
  canopen::Node node(description(), 5, nowhere);
  node.set_parameter_store(&file);
  node.power_on(can::Time{});
  EXPECT_EQ(node.dictionary().get<std::uint16_t>(0x1017, 0), 1000);
}

TEST(ParameterFile, ADamagedFileCountsAsNone) {
  const Folder folder;
  ParameterFile file(folder.path, "node-005");
  ASSERT_EQ(file.save(std::array<std::uint8_t, 3>{1, 2, 3}), canopen::AbortCode::none);
  EXPECT_THAT(file.load(), ElementsAre(1, 2, 3));
  std::fstream bytes(folder.path / "node-005", std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekp(-1, std::ios::end);
  bytes.put('\x7F');
  bytes.close();
  EXPECT_THAT(file.load(), IsEmpty());
}

TEST(ParameterFile, AFolderThatCannotBeMadeIsAHardwareError) {
  const Folder folder;
  std::ofstream(folder.path).put('x');  // a file where the folder should be
  ParameterFile file(folder.path, "node-005");
  EXPECT_EQ(file.save(std::array<std::uint8_t, 1>{1}), canopen::AbortCode::hardware_error);
}

}  // namespace
}  // namespace canopus::store::parameter_file_test
