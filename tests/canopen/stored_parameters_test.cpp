#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::stored_parameters_test {
namespace {

DictionaryBuilder with_store(std::uint32_t capability = 1) {
  DictionaryBuilder b = standard_objects();
  for (const int index : {0x1010, 0x1011}) {
    b.uniform(static_cast<std::uint16_t>(index), ObjectCode::array, "store", 4,
              {.value = little_endian(capability, 4)});
  }
  b.variable(0x6600, {.type = DataType::unsigned16});
  return b;
}

struct Memory : ParameterStore {
  std::vector<std::uint8_t> load() override { return image; }
  AbortCode save(std::span<const std::uint8_t> bytes) override {
    if (fails) return AbortCode::hardware_error;
    image.assign(bytes.begin(), bytes.end());
    ++saves;
    return AbortCode::none;
  }
  void found_damaged() override { ++damages; }
  std::vector<std::uint8_t> image;
  int damages = 0;
  bool fails = false;
  int saves = 0;
};

struct StoredParametersTest : testing::Test, Conversation {
  StoredParametersTest() : Conversation(with_store()) { node.set_parameter_store(&memory); }
  int heartbeat() { return node.dictionary().get<std::uint16_t>(0x1017, 0); }
  int manufacturer() { return node.dictionary().get<std::uint16_t>(0x2005, 0); }
  int application() { return node.dictionary().get<std::uint16_t>(0x6600, 0); }
  void set_values(std::uint16_t value) {
    write(0x1017, 0, value, 2);
    write(0x2005, 0, value, 2);
    write(0x6600, 0, value, 2);
  }
  Memory memory;
};

TEST_F(StoredParametersTest, Save_KeepsValuesOverReset) {
  set_values(500);
  EXPECT_EQ(receive("605 23 10 10 01 73 61 76 65"), "585 60 10 10 01 00 00 00 00");
  set_values(600);
  receive("000 81 05");
  EXPECT_EQ(heartbeat(), 500);
  EXPECT_EQ(manufacturer(), 500);
  EXPECT_EQ(application(), 500);
  EXPECT_EQ(wait(1s), "500: 705 7F | 1000: 705 7F") << "the services start with the stored values";
}

TEST_F(StoredParametersTest, ReadingTellsTheCapability_NotTheSignature) {
  receive("605 23 10 10 01 73 61 76 65");
  EXPECT_EQ(receive("605 40 10 10 01 00 00 00 00"), "585 43 10 10 01 01 00 00 00");
  EXPECT_EQ(receive("605 40 11 10 01 00 00 00 00"), "585 43 11 10 01 01 00 00 00");
}

TEST_F(StoredParametersTest, WrongSignature_IsRefused) {
  EXPECT_EQ(receive("605 23 10 10 01 6C 6F 61 64"), "585 80 10 10 01 20 00 00 08");
  EXPECT_EQ(receive("605 23 11 10 01 73 61 76 65"), "585 80 11 10 01 20 00 00 08");
  EXPECT_EQ(memory.saves, 0);
}

TEST_F(StoredParametersTest, Groups_AreStoredApart) {
  set_values(500);
  receive("605 23 10 10 02 73 61 76 65");
  set_values(600);
  receive("605 23 10 10 03 73 61 76 65");
  receive("000 81 05");
  EXPECT_EQ(heartbeat(), 500);
  EXPECT_EQ(application(), 600);
  EXPECT_EQ(manufacturer(), 0);
}

TEST_F(StoredParametersTest, Restore_TakesEffectAtTheReset) {
  set_values(500);
  receive("605 23 10 10 01 73 61 76 65");
  EXPECT_EQ(receive("605 23 11 10 02 6C 6F 61 64"), "585 60 11 10 02 00 00 00 00");
  EXPECT_EQ(heartbeat(), 500);
  EXPECT_EQ(receive("605 23 10 10 01 73 61 76 65"), "585 80 10 10 01 22 00 00 08") << "before the reset";
  receive("000 82 05");
  EXPECT_EQ(heartbeat(), 0);
  receive("000 81 05");
  EXPECT_EQ(manufacturer(), 500);
  EXPECT_EQ(receive("605 23 10 10 01 73 61 76 65"), "585 60 10 10 01 00 00 00 00");
}

TEST_F(StoredParametersTest, MemoryThatFails_IsTold) {
  memory.fails = true;
  EXPECT_EQ(receive("605 23 10 10 01 73 61 76 65"), "585 80 10 10 01 00 00 06 06");
}

TEST_F(StoredParametersTest, DamagedImage_DoesNoHarm) {
  set_values(500);
  receive("605 23 10 10 01 73 61 76 65");
  const auto whole = memory.image;
  for (std::size_t length = 0; length < whole.size(); length += 3) {
    memory.image.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    receive("000 81 05");
  }
  memory.image.assign(100, 0xFF);
  EXPECT_EQ(receive("000 81 05"), "705 00");
  EXPECT_EQ(heartbeat(), 0);
}

TEST_F(StoredParametersTest, DamagedImage_IsReported_AndNothingOfItUsed) {
  set_values(500);
  receive("605 23 10 10 01 73 61 76 65");
  receive("000 81 05");
  EXPECT_EQ(memory.damages, 0);
  memory.image.pop_back();
  receive("000 81 05");
  EXPECT_EQ(memory.damages, 1);
  EXPECT_EQ(heartbeat(), 0);
  EXPECT_EQ(manufacturer(), 0);
  receive("605 23 10 10 02 73 61 76 65");  // 1000H to 1FFFH; of the rest nothing is left
  receive("000 81 05");
  EXPECT_EQ(memory.damages, 1);
}

// Index, sub-index, length and value, little-endian, in the order of the indices.
TEST(StoredParameters, Image_HasTheMarkedEntries) {
  DictionaryBuilder b = with_store();
  b.variable(0x2005, {.type = DataType::unsigned16, .stored = true});
  b.variable(0x2006, {.type = DataType::unsigned32, .stored = true});
  Conversation c(b);
  Memory memory;
  c.node.set_parameter_store(&memory);
  c.write(0x2005, 0, 1000, 2);
  c.write(0x2006, 0, 7, 4);
  c.write(0x1010, 1, 0x65766173, 4);
  EXPECT_EQ(memory.image,
            (std::vector<std::uint8_t>{0x05, 0x20, 0x00, 0x02, 0x00, 0x00, 0x00, 0xE8, 0x03,  //
                                       0x06, 0x20, 0x00, 0x04, 0x00, 0x00, 0x00, 7,    0,    0, 0}));
}

TEST(StoredParameters, ValueTooLongToBeStored_IsRefused_AndNothingSaved) {
  DictionaryBuilder b = with_store();
  b.variable(0x2007, {.type = DataType::octet_string});
  NodeOptions options;
  options.stored_length = StoredLength::two_bytes;
  Conversation c(b, options);
  Memory memory;
  c.node.set_parameter_store(&memory);
  const auto text = c.node.dictionary().description().find(0x2007, 0);
  c.node.dictionary().assign(text, std::vector<std::uint8_t>(65536, 1));
  EXPECT_EQ(c.receive("605 23 10 10 01 73 61 76 65"), "585 80 10 10 01 20 00 00 08");
  EXPECT_EQ(memory.saves, 0);
  c.node.dictionary().assign(text, std::vector<std::uint8_t>(65535, 1));
  EXPECT_EQ(c.receive("605 23 10 10 01 73 61 76 65"), "585 60 10 10 01 00 00 00 00");
}

// A device file was edited: the others count.
TEST(StoredParameters, ValueWhoseLengthHasChanged_IsLeftOut_AndReported) {
  Conversation c(with_store());
  Memory memory;
  c.node.set_parameter_store(&memory);
  memory.image = {0x17, 0x10, 0x00, 0x01, 0x00, 0x00, 0x00, 0xE8,  //
                  0x05, 0x20, 0x00, 0x02, 0x00, 0x00, 0x00, 0x07, 0x00};
  c.receive("000 81 05");
  EXPECT_EQ(c.node.dictionary().get<std::uint16_t>(0x1017, 0), 0);
  EXPECT_EQ(c.node.dictionary().get<std::uint16_t>(0x2005, 0), 7);
  EXPECT_EQ(memory.damages, 1);
}

TEST(StoredParameters, SaveBeforeTheReset_WhereTheOptionsAllowIt_TakesTheRestoreBack) {
  NodeOptions options;
  options.save_before_restored = true;
  Conversation c(with_store(), options);
  c.write(0x2005, 0, 7, 2);
  c.receive("605 23 10 10 01 73 61 76 65");
  EXPECT_EQ(c.receive("605 23 11 10 01 6C 6F 61 64"), "585 60 11 10 01 00 00 00 00");
  EXPECT_EQ(c.receive("605 23 10 10 01 73 61 76 65"), "585 60 10 10 01 00 00 00 00");
  c.receive("000 81 05");
  EXPECT_EQ(c.node.dictionary().get<std::uint16_t>(0x2005, 0), 7);
}

TEST(StoredParameters, WithoutAStore_TheNodeRemembersOverResets) {
  Conversation c(with_store());
  c.write(0x2005, 0, 7, 2);
  c.receive("605 23 10 10 01 73 61 76 65");
  c.receive("000 81 05");
  EXPECT_EQ(c.node.dictionary().get<std::uint16_t>(0x2005, 0), 7);
}

TEST(StoredParameters, Autonomously_SavesEveryWrite) {
  Conversation c(with_store(3));
  Memory memory;
  c.node.set_parameter_store(&memory);
  c.write(0x2005, 0, 7, 2);
  EXPECT_EQ(memory.saves, 1);
  c.write(0x6200, 1, 7, 1);
  EXPECT_EQ(memory.saves, 1) << "process data";
  EXPECT_EQ(c.receive("605 40 10 10 01 00 00 00 00"), "585 43 10 10 01 03 00 00 00");
}

TEST(StoredParameters, MarkedEntriesOnly_WhereTheDictionaryMarksSome) {
  DictionaryBuilder b = with_store();
  b.variable(0x2005, {.type = DataType::unsigned16, .stored = true});
  Conversation c(b);
  c.write(0x2005, 0, 7, 2);
  c.write(0x1017, 0, 7, 2);
  c.write(0x1010, 1, 0x65766173, 4);
  c.receive("000 81 05");
  EXPECT_EQ(c.node.dictionary().get<std::uint16_t>(0x2005, 0), 7);
  EXPECT_EQ(c.node.dictionary().get<std::uint16_t>(0x1017, 0), 0);
}

}  // namespace
}  // namespace canopus::canopen::stored_parameters_test
