// PDO parameters over resets: what is the default is not read anew, and everything else is.

#include <utility>

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::pdo_reset_test {
namespace {

constexpr std::uint16_t reset_tpdo = 0x1800;
constexpr std::uint16_t reset_rpdo = 0x1400;

/// One PDO each way is valid by default; its event timer has the node-ID in it.
DictionaryBuilder with_default_pdos() {
  DictionaryBuilder b = standard_objects();
  b.sub(reset_tpdo, 1, {.value = little_endian(0x4000'0180, 4), .adds_node_id = true});
  b.sub(reset_tpdo, 2, {.type = DataType::unsigned8, .value = {0xFE}});
  b.sub(reset_tpdo, 5, {.type = DataType::unsigned16, .value = {10, 0}, .adds_node_id = true});
  b.sub(0x1A00, 0, {.type = DataType::unsigned8, .value = {1}});
  b.sub(0x1A00, 1, {.value = little_endian(0x6000'0108, 4)});
  b.sub(reset_rpdo, 1, {.value = little_endian(0x200, 4), .adds_node_id = true});
  b.sub(reset_rpdo, 2, {.type = DataType::unsigned8, .value = {0xFE}});
  b.sub(0x1600, 0, {.type = DataType::unsigned8, .value = {1}});
  b.sub(0x1600, 1, {.value = little_endian(0x6200'0108, 4)});
  for (const int index : {0x1010, 0x1011}) {
    b.uniform(static_cast<std::uint16_t>(index), ObjectCode::array, "store", 4,
              {.value = little_endian(1, 4)});
  }
  return b;
}

struct PdoResetTest : testing::Test, Conversation {
  PdoResetTest() : Conversation(with_default_pdos()) {}
  int output(std::uint8_t sub) { return node.dictionary().get<std::uint8_t>(0x6200, sub); }
  void map(std::uint16_t communication, std::uint32_t cob_id, std::uint32_t object) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    write(communication, 1, cob_id | CobId::invalid_bit, 4);
    write(mapping, 0, 0, 1);
    write(mapping, 1, object, 4);
    write(mapping, 0, 1, 1);
    EXPECT_EQ(write(communication, 1, cob_id, 4), AbortCode::none);
    bus.drain();
  }
  void map_others() {
    map(reset_tpdo, 0x4000'0185, 0x6401'0110);
    map(reset_rpdo, 0x205, 0x6200'0208);
  }
  /// After a reset of the communication and the start: what was said.
  std::string reset_and_start() {
    node.dictionary().set(0x6200, 1, std::uint8_t{0});
    node.dictionary().set(0x6200, 2, std::uint8_t{0});
    EXPECT_EQ(receive("000 82 05"), "705 00");
    return receive("000 01 05");
  }
};

TEST_F(PdoResetTest, Defaults_HoldAfterEveryReset) {
  for (int resets = 0; resets < 3; ++resets) {
    EXPECT_EQ(reset_and_start(), "185 00") << resets;
    const auto due = (now + 15ms).time_since_epoch() / 1ms;
    EXPECT_EQ(wait(20ms), std::to_string(due) + ": 185 00") << resets;
    receive("205 07");
    EXPECT_EQ(output(1), 7) << resets;
  }
}

TEST_F(PdoResetTest, WrittenParameters_GiveWayToTheDefaults) {
  for (int resets = 0; resets < 2; ++resets) {
    map_others();
    EXPECT_EQ(receive("000 01 05"), "185 00 00");
    receive("205 09");
    EXPECT_EQ(output(2), 9);
    EXPECT_EQ(reset_and_start(), "185 00");
    receive("205 07");
    EXPECT_EQ(output(1), 7);
    EXPECT_EQ(output(2), 0);
    receive("000 80 05");
  }
}

TEST_F(PdoResetTest, StoredParameters_AreTaken_AndGoneOnceRestored) {
  map_others();
  receive("605 23 10 10 01 73 61 76 65");
  for (int resets = 0; resets < 2; ++resets) {
    EXPECT_EQ(reset_and_start(), "185 00 00") << resets;
    receive("205 09");
    EXPECT_EQ(output(2), 9) << resets;
  }
  receive("605 23 11 10 01 6C 6F 61 64");
  EXPECT_EQ(reset_and_start(), "185 00");
  receive("205 07");
  EXPECT_EQ(output(1), 7);
  map_others();
  receive("605 23 10 10 01 73 61 76 65");
  receive("000 82 05");
  receive("605 23 11 10 01 6C 6F 61 64");
  EXPECT_EQ(reset_and_start(), "185 00");
}

TEST_F(PdoResetTest, StoredParametersOverDefaults_AreTaken) {
  struct Memory : ParameterStore {
    std::vector<std::uint8_t> load() override { return image; }
    AbortCode save(std::span<const std::uint8_t> bytes) override {
      image.assign(bytes.begin(), bytes.end());
      return AbortCode::none;
    }
    void found_damaged() override {}
    std::vector<std::uint8_t> image;
  } memory;
  node.set_parameter_store(&memory);
  map_others();
  receive("605 23 10 10 01 73 61 76 65");
  const auto kept = std::exchange(memory.image, {});
  EXPECT_EQ(reset_and_start(), "185 00");
  EXPECT_EQ(reset_and_start(), "185 00");
  memory.image = kept;  // without any write
  EXPECT_EQ(reset_and_start(), "185 00 00");
  receive("205 09");
  EXPECT_EQ(output(2), 9);
  node.set_parameter_store(nullptr);
}

TEST(PdoDefaults, AreToldFromOtherValues) {
  const auto description = with_default_pdos().build();
  ObjectDictionary dictionary(description, 5);
  EXPECT_TRUE(description->has_default_pdos(dictionary.block(), 5));
  EXPECT_FALSE(description->has_default_pdos(dictionary.block(), 6));
  dictionary.set(0x1017, 0, std::uint16_t{100});
  dictionary.set(0x6000, 1, std::uint8_t{1});
  EXPECT_TRUE(description->has_default_pdos(dictionary.block(), 5)) << "no PDO parameters";
  for (const int changed : {0x1400, 0x1600, 0x1603, 0x1800, 0x1A00, 0x1A03}) {
    dictionary.reset(5);
    const auto index = static_cast<std::uint16_t>(changed);
    const auto sub = static_cast<std::uint8_t>(index == 0x1603 || index == 0x1A03 ? 8 : 1);
    dictionary.set(index, sub, std::uint32_t{0x1234});
    EXPECT_FALSE(description->has_default_pdos(dictionary.block(), 5)) << index;
  }
}

TEST(PdoDefaults, WithAValueOfVariableLengthAmongThem_AreNotTold) {
  DictionaryBuilder b = with_default_pdos();
  b.variable(0x1BFF, {.name = "odd", .type = DataType::visible_string});
  const auto description = b.build();
  ObjectDictionary dictionary(description, 5);
  EXPECT_FALSE(description->has_default_pdos(dictionary.block(), 5));
}

}  // namespace
}  // namespace canopus::canopen::pdo_reset_test
