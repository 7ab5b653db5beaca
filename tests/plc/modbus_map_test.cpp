// Which Modbus addresses a rack has: by a map of the plant file, or by its family.

#include "plc/plc_modbus.hpp"

namespace canopus::plc::modbus_map_test {
namespace {

TEST(ModbusMap, OverlappingRanges_AreRefused) {
  modbus::Map map;
  EXPECT_TRUE(map.add(Table::coils, {10, 10, {false, Device::m, 0, 0}}));
  EXPECT_TRUE(map.add(Table::coils, {20, 10, {false, Device::m, 0, 0}}));
  EXPECT_TRUE(map.add(Table::coils, {0, 10, {false, Device::m, 0, 0}}));
  EXPECT_EQ(map.add(Table::coils, {5, 2, {false, Device::y, 0, 0}}).error(), "coils 0 to 9 are M0 already");
  EXPECT_EQ(map.add(Table::coils, {29, 2, {false, Device::y, 0, 0}}).error(),
            "coils 20 to 29 are M0 already");
  EXPECT_TRUE(map.add(Table::discrete_inputs, {9, 2, {false, Device::y, 0, 0}}));
  EXPECT_FALSE(map.add(Table::coils, {65535, 2, {false, Device::y, 0, 0}}));
  EXPECT_FALSE(map.add(Table::coils, {100, 0, {false, Device::y, 0, 0}}));
  EXPECT_TRUE(map.add(Table::input_registers, {0, 65536, {false, Device::d, 0, 0}}));
}

TEST(ModbusMap, ARackWithoutAMap_HasItsOutputsInputsAndRegisters) {
  const modbus::Map map = modbus::default_map(r04cpu());
  EXPECT_EQ(map.ranges(Table::coils)[0].count, 12288U);
  EXPECT_EQ(map.ranges(Table::discrete_inputs)[0].at.device, Device::x);
  EXPECT_EQ(map.ranges(Table::holding_registers)[0].count, 18432U);
  EXPECT_EQ(map.ranges(Table::input_registers)[0].at.device, Device::sd);
}

TEST(ModbusMap, As300_HasItsDevicesAtTheirAddresses) {
  const modbus::Map map = modbus::as300_map(r04cpu());
  const auto at = [&](Table table, unsigned first) -> std::string {
    for (const modbus::Range& range : map.ranges(table))
      if (range.first == first) return to_text(range.at) + " x " + std::to_string(range.count);
    return "nothing";
  };
  EXPECT_EQ(at(Table::coils, 0x0000), "M0 x 8192");
  EXPECT_EQ(at(Table::coils, 0x4000), "SM0 x 4096");
  EXPECT_EQ(at(Table::coils, 0x6000), "X0 x 1024");
  EXPECT_EQ(at(Table::discrete_inputs, 0x6000), "X0 x 1024");
  EXPECT_EQ(at(Table::coils, 0xA000), "Y0 x 1024");
  EXPECT_EQ(at(Table::coils, 0xE000), "TS0 x 512");
  EXPECT_EQ(at(Table::holding_registers, 0x0000), "D0 x 18432");
  EXPECT_EQ(at(Table::holding_registers, 0x8000), "X0 x 64");
  EXPECT_EQ(at(Table::input_registers, 0x8000), "X0 x 64");
  EXPECT_EQ(at(Table::holding_registers, 0xA000), "Y0 x 64");
  EXPECT_EQ(at(Table::holding_registers, 0xF000), "CN0 x 512");
  const modbus::Map whole = modbus::as300_map(as300());
  EXPECT_EQ(whole.ranges(Table::coils).size(), 8U);              // M SM S X Y T C HC
  EXPECT_EQ(whole.ranges(Table::holding_registers).size(), 7U);  // D X Y SR T C HC
  EXPECT_EQ(whole.ranges(Table::holding_registers)[0].count, 30000U);
}

TEST(ModbusMap, As300_AddressesByDevice) {
  using modbus::as300_address;
  EXPECT_EQ(as300_address(Device::d, true, 29999), 29999);
  EXPECT_EQ(as300_address(Device::d, true, 30000), std::nullopt);
  EXPECT_EQ(as300_address(Device::sd, true, 7), 0xC007) << "SR7";
  EXPECT_EQ(as300_address(Device::x, false, 17), 0x6011) << "X1.1";
  EXPECT_EQ(as300_address(Device::x, true, 1), 0x8001);
  EXPECT_EQ(as300_address(Device::y, true, 63), 0xA03F);
  EXPECT_EQ(as300_address(Device::zr, true, 0), std::nullopt);
}

TEST(ModbusMap, As300_ValuesOfHcAreTwoRegistersAtOneAddress) {
  ModbusPlc plc({.map = modbus::as300_map(as300())}, WritePermission::always, as300());
  EXPECT_EQ(plc.pdu("10 fc 01 00 02 04 56 78 12 34"), "10 fc 01 00 02");
  EXPECT_EQ(plc.word(Device::hcn, 2), 0x5678);
  EXPECT_EQ(plc.word(Device::hcn, 3), 0x1234);
  EXPECT_EQ(plc.pdu("03 fc 00 00 04"), "03 08 00 00 00 00 56 78 12 34");
  EXPECT_EQ(plc.pdu("03 fc ff 00 02"), "03 04 00 00 00 00") << "HC255";
  EXPECT_EQ(plc.pdu("03 fc ff 00 04"), "83 02") << "HC256 is not there";
  EXPECT_EQ(plc.pdu("03 fc 00 00 01"), "83 02") << "half a value";
  EXPECT_EQ(plc.pdu("06 fc 00 00 01"), "86 02");
  EXPECT_EQ(plc.pdu("03 f1 ff 00 02"), "83 02") << "from C511 on there is a gap";
  EXPECT_EQ(plc.pdu("05 fc 01 ff 00"), "05 fc 01 ff 00");
  EXPECT_TRUE(plc.bit(Device::hcs, 1));
}

TEST(ModbusMap, As300_TakesItsOwnNumbersOfPoints) {
  ModbusPlc plc({.map = modbus::as300_map(r04cpu()), .limits = modbus::as300_limits()});
  EXPECT_EQ(plc.pdu("03 00 00 00 64").substr(0, 5), "03 c8");
  EXPECT_EQ(plc.pdu("03 00 00 00 65"), "83 03");
  EXPECT_EQ(plc.pdu("01 00 00 06 40").substr(0, 5), "01 c8");
  EXPECT_EQ(plc.pdu("01 00 00 06 41"), "81 03");
  EXPECT_EQ(plc.pdu("05 60 00 ff 00"), "85 02");  // inputs are not written
  EXPECT_EQ(plc.pdu("16 00 04 00 f2 00 25"), "96 01");
  EXPECT_EQ(plc.pdu("2b 0e 01 00"), "ab 01");
}

RC_GTEST_PROP(ModbusSession, AnyBytes_LeaveASessionThatAnswersOrIsOver, (const std::string& stream)) {
  ModbusPlc plc;
  (void)plc.raw_modbus(stream);
  RC_ASSERT(plc.modbus->over() || !plc.modbus->space().empty());
}

RC_GTEST_PROP(ModbusSession, AnyPdu_IsAnsweredOnceWithItsFunction, ()) {
  ModbusPlc plc;
  const auto size = *rc::gen::inRange<std::size_t>(1, 254);
  const auto pdu = *rc::gen::container<std::string>(size, rc::gen::arbitrary<char>());
  std::string request = bytes("12 34 00 00 00 00 ff") + pdu;
  request[5] = static_cast<char>(pdu.size() + 1);
  const std::string reply = plc.raw_modbus(request);
  RC_ASSERT(reply.size() >= 9U);
  RC_ASSERT((static_cast<unsigned char>(reply[7]) & 0x7FU) == (static_cast<unsigned char>(pdu[0]) & 0x7FU));
  RC_ASSERT(static_cast<unsigned char>(reply[4]) * 256U + static_cast<unsigned char>(reply[5]) ==
            reply.size() - 6);
}

RC_GTEST_PROP(ModbusMap, AnyRegisters_ComeBackAsTheyWereWritten, ()) {
  ModbusPlc plc;
  const auto words = *rc::gen::container<std::vector<std::uint16_t>>(*rc::gen::inRange<std::size_t>(1, 101),
                                                                     rc::gen::arbitrary<std::uint16_t>());
  const auto first = *rc::gen::inRange<unsigned>(0, 300 - static_cast<unsigned>(words.size()) + 1);
  const auto at = static_cast<std::uint16_t>(first);
  RC_ASSERT(plc.settings.map.write_words(plc.rack, at, words, plc.now) == modbus::Exception::none);
  std::vector<std::uint16_t> read(words.size());
  RC_ASSERT(plc.settings.map.read_words(plc.rack, Table::holding_registers, at, read, plc.now) ==
            modbus::Exception::none);
  RC_ASSERT(read == words);
}

}  // namespace
}  // namespace canopus::plc::modbus_map_test
