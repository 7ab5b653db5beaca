#include "canopus/plant/module_network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"

namespace canopus::plant::module_network_test {
namespace {

using canopen::DataType;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::uint8_t> encoded(const text::Scalar& value, DataType type) {
  const auto bytes = text::encode(value, type);
  EXPECT_TRUE(bytes.has_value()) << (bytes ? "" : bytes.error());
  return bytes.value_or(std::vector<std::uint8_t>{});
}
std::string refused(const text::Scalar& value, DataType type) {
  const auto bytes = text::encode(value, type);
  return bytes ? "taken" : bytes.error();
}

TEST(Encode, NumbersTakeTheLengthOfTheirType) {
  EXPECT_THAT(encoded(std::int64_t{500}, DataType::unsigned16), ElementsAre(0xF4, 0x01));
  EXPECT_THAT(encoded(std::int64_t{-2}, DataType::integer24), ElementsAre(0xFE, 0xFF, 0xFF));
  EXPECT_THAT(encoded(true, DataType::boolean), ElementsAre(0x01));
  EXPECT_THAT(encoded(1.0, DataType::real32), ElementsAre(0x00, 0x00, 0x80, 0x3F));
  EXPECT_THAT(encoded(std::int64_t{1}, DataType::real32), ElementsAre(0x00, 0x00, 0x80, 0x3F));
  EXPECT_THAT(encoded(std::string("AB"), DataType::visible_string), ElementsAre('A', 'B'));
}

TEST(Encode, ANegativeNumberStandsForABitPattern) {
  EXPECT_THAT(encoded(std::int64_t{-1}, DataType::unsigned16), ElementsAre(0xFF, 0xFF));
}

TEST(Encode, WhatDoesNotFitIsRefusedInWords) {
  EXPECT_EQ(refused(std::int64_t{65536}, DataType::unsigned16), "65536 does not fit UNSIGNED16");
  EXPECT_EQ(refused(std::int64_t{-129}, DataType::integer8), "-129 does not fit INTEGER8");
  EXPECT_EQ(refused(1.5, DataType::unsigned8), "1.5 is not a whole number, as UNSIGNED8 needs");
  EXPECT_EQ(refused(std::string("x"), DataType::unsigned8),
            "\"x\" is a string, expected a number for UNSIGNED8");
  EXPECT_EQ(refused(std::int64_t{1}, DataType::visible_string), "expected a string for VISIBLE_STRING");
}

/// A module with nothing around it.
struct NewModule {
  struct Controller final : can::Controller {
    bool send(const can::Frame&) override { return true; }
    std::uint16_t transmit_error_counter() const override { return 0; }
    std::uint16_t receive_error_counter() const override { return 0; }
    can::ErrorState error_state() const override { return can::ErrorState::error_active; }
    std::uint32_t bit_rate() const override { return 250'000; }
    void restart(std::uint32_t) override {}
    std::uint32_t transmit_overflows() const override { return 0; }
  } controller;
  struct Memory final : module::NonVolatileMemory {
    Content read(std::string_view) override { return {}; }
    bool write(std::string_view, std::span<const std::uint8_t>) override { return true; }
    bool erase(std::string_view) override { return true; }
  } memory;
  module::me3can1_q::Me3can1Q module{controller, memory};

  /// Switched on, and through its initialization: now the settings are in force.
  void start() {
    module.power_on(can::Time{});
    for (can::Time now{}; module.node().state() == canopen::NmtState::initialising; now = module.deadline()) {
      ASSERT_LT(now, can::Time{std::chrono::seconds(10)});
      module.tick(now);
    }
  }
  std::uint32_t object(std::uint16_t index, std::uint8_t sub) const {
    return module.node().dictionary().get<std::uint32_t>(index, sub, 0xDEAD'BEEF);
  }
};

/// A device with one TPDO of `bytes` bytes, COB-ID 180H + node-ID, and 1018H.
eds::DeviceFile device(std::string_view pdo_cob_id = "$NODEID+0x180", unsigned entry_bits = 16,
                       unsigned entries = 2) {
  std::string text =
      "[DeviceInfo]\nVendorName=Test\n"
      "[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n2=0x1001\n3=0x1018\n"
      "[OptionalObjects]\nSupportedObjects=3\n1=0x1800\n2=0x1A00\n3=0x6000\n"
      "[1000]\nParameterName=Device type\nObjectType=7\nDataType=7\nAccessType=ro\nDefaultValue=0x30191\n"
      "[1001]\nParameterName=Error register\nObjectType=7\nDataType=5\nAccessType=ro\n"
      "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=2\n"
      "[1018sub0]\nParameterName=n\nObjectType=7\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
      "[1018sub1]\nParameterName=Vendor\nObjectType=7\nDataType=7\nAccessType=ro\nDefaultValue=0x71\n"
      "[1800]\nParameterName=TPDO\nObjectType=9\nSubNumber=2\n"
      "[1800sub0]\nParameterName=n\nObjectType=7\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
      "[1800sub1]\nParameterName=COB-ID\nObjectType=7\nDataType=7\nAccessType=rw\nDefaultValue=";
  text += std::string(pdo_cob_id) +
          "\n[1A00]\nParameterName=Mapping\nObjectType=9\nSubNumber=" + std::to_string(entries + 1) +
          "\n[1A00sub0]\nParameterName=n\nObjectType=7\nDataType=5\nAccessType=rw\nDefaultValue=" +
          std::to_string(entries) + "\n";
  for (unsigned i = 1; i <= entries; ++i) {
    text += "[1A00sub" + std::to_string(i) +
            "]\nParameterName=e\nObjectType=7\nDataType=7\nAccessType=rw\nDefaultValue=" +
            std::to_string(0x6000'0000U | i << 8 | entry_bits) + "\n";
  }
  text += "[6000]\nParameterName=In\nObjectType=8\nSubNumber=" + std::to_string(entries + 1) +
          "\n[6000sub0]\nParameterName=n\nObjectType=7\nDataType=5\nAccessType=ro\nDefaultValue=" +
          std::to_string(entries) + "\n";
  for (unsigned i = 1; i <= entries; ++i) {
    text += "[6000sub" + std::to_string(i) +
            "]\nParameterName=i\nObjectType=7\nDataType=" + (entry_bits == 8 ? "5" : "6") +
            "\nAccessType=ro\nPDOMapping=1\n";
  }
  const auto result = eds::read_device_file(text);
  EXPECT_NE(result.file, nullptr);
  return *result.file;
}

SlaveSection slave(std::optional<std::uint32_t> address = std::nullopt) {
  SlaveSection section{.node = 5};
  section.receive.push_back({.pdo = 1, .address = address});
  return section;
}

TEST(ModuleNetwork, AssignsIdentifiesAndConnectsASlave) {
  NewModule fresh;
  ModuleNetwork network(fresh.module, "U0");
  EXPECT_THAT(network.add_slave(slave(10020), device(), "io", true), IsEmpty());
  network.become_master();
  fresh.start();
  EXPECT_EQ(fresh.object(0x1F80, 0), 1U);
  EXPECT_EQ(fresh.object(0x1F81, 5), 0x0DU) << "slave, boot slave, mandatory";
  EXPECT_EQ(fresh.object(0x1F84, 5), 0x30191U);
  EXPECT_EQ(fresh.object(0x1F85, 5), 0x71U);
  EXPECT_EQ(fresh.object(0x1F86, 5), 0U) << "the file names no product code";
  EXPECT_EQ(fresh.object(0x1400, 1), 0x185U);
  EXPECT_EQ(fresh.object(0x1600, 0), 2U);
  EXPECT_EQ(fresh.object(0x1600, 1), 0xA580'1510U) << "G10020 is the 21st word";
  EXPECT_EQ(fresh.object(0x1600, 2), 0xA580'1610U);
  EXPECT_THAT(network.connections(), ElementsAre("U0\\G10020-G10021 <- TPDO1 of node 5 (io), 185H, 4 bytes"));
}

TEST(ModuleNetwork, AnOddByteIsMappedAsAByte) {
  NewModule fresh;
  ModuleNetwork network(fresh.module, "U0");
  EXPECT_THAT(network.add_slave(slave(), device("$NODEID+0x180", 8, 3), "io", true), IsEmpty());
  fresh.start();
  EXPECT_EQ(fresh.object(0x1600, 0), 2U);
  EXPECT_EQ(fresh.object(0x1600, 1), 0xA580'0110U) << "G10000, two bytes";
  EXPECT_EQ(fresh.object(0x1600, 2), 0xA4C0'0308U) << "low byte of G10001";
}

TEST(ModuleNetwork, WhatCannotBeConnectedIsToldWithItsReason) {
  NewModule fresh;
  ModuleNetwork network(fresh.module, "U0");
  const auto off = network.add_slave(slave(), device("$NODEID+0x80000180"), "io", true);
  ASSERT_EQ(off.size(), 1U);
  EXPECT_THAT(off[0].message, HasSubstr("TPDO1 of node 5: the device's file leaves this PDO switched off"));
  const auto beyond = network.add_slave(slave(11023), device(), "io", true);
  ASSERT_EQ(beyond.size(), 1U);
  EXPECT_THAT(beyond[0].message, HasSubstr("G11023 is no place for 2 words; expected G10000 to G11022"));
  SlaveSection second = slave();
  second.receive[0].pdo = 2;
  const auto missing = network.add_slave(second, device(), "io", true);
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_THAT(missing[0].message, HasSubstr("TPDO2 of node 5: the device has no such PDO"));
  EXPECT_THAT(network.add_slave(second, device(), "io", false), IsEmpty())
      << "slaves = \"all\" passes over it";
}

}  // namespace
}  // namespace canopus::plant::module_network_test
