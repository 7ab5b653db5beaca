// Conversations in Modbus TCP, byte by byte: each function, each exception, and what a map is.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/plc/modbus/as300_map.hpp"
#include "canopus/plc/modbus/session.hpp"

#include "plc/conversation.hpp"

namespace canopus::plc {
namespace {

using modbus::Table;
using testing::bytes;
using testing::shown;

modbus::Settings some_map() {
  modbus::Settings settings;
  const auto add = [&](Table table, modbus::Range range) { EXPECT_TRUE(settings.map.add(table, range)); };
  add(Table::coils, {0, 64, {false, Device::y, 0, 0}});
  add(Table::coils, {64, 64, {false, Device::m, 0, 0}});           // goes on behind the outputs
  add(Table::coils, {1000, 32, {true, Device::d, 0x30, 0}});       // bits of U3\G0 and U3\G1
  add(Table::coils, {2000, 8, {false, Device::m, 0, 100}, true});  // to be read only
  add(Table::discrete_inputs, {0, 64, {false, Device::x, 0, 0}});
  add(Table::holding_registers, {0, 200, {false, Device::d, 0, 0}});
  add(Table::holding_registers, {200, 100, {true, Device::d, 0x00, 10000}});
  add(Table::holding_registers, {300, 4, {false, Device::m, 0, 0}});      // 16 points each
  add(Table::holding_registers, {400, 600, {true, Device::d, 0x30, 0}});  // the module has 512 words
  add(Table::holding_registers, {5000, 1, {true, Device::d, 0x500, 0}});  // no module
  add(Table::input_registers, {0, 10, {false, Device::sd, 0, 200}});
  settings.identification.objects = {"Canopus", "R04CPU", "1.0", "", "PLC", "", ""};
  return settings;
}

struct ModbusPlc : testing::Plc {
  explicit ModbusPlc(modbus::Settings the_settings = some_map(),
                     WritePermission permission = WritePermission::always, const CpuModel& model = r04cpu())
      : Plc(model),
        settings(std::move(the_settings)),
        modbus(std::make_unique<modbus::Session>(rack, settings, permission)) {}

  std::string raw_modbus(std::string_view request) {
    std::string reply;
    while (!request.empty() && !modbus->over()) {
      const auto space = modbus->space();
      const std::size_t count = std::min(space.size(), request.size());
      std::copy_n(request.begin(), count, space.begin());
      modbus->received(count);
      request.remove_prefix(count);
      while (modbus->process(now) != 0 || !modbus->output().empty()) {
        const auto output = modbus->output();
        reply.append(output.begin(), output.end());
        modbus->sent(output.size());
      }
    }
    return reply;
  }
  /// Function and data in, function and data out, as hexadecimal text.
  std::string pdu(const std::string& text) {
    const std::string data = bytes(text);
    std::string request = bytes("12 34 00 00 00 00 ff") + data;
    request[4] = static_cast<char>((data.size() + 1) >> 8U);
    request[5] = static_cast<char>(data.size() + 1);
    const std::string reply = raw_modbus(request);
    if (reply.size() < 8) return shown(reply);
    EXPECT_EQ(shown(reply.substr(0, 4)), "12 34 00 00");
    EXPECT_EQ(static_cast<std::size_t>(static_cast<unsigned char>(reply[5])), reply.size() - 6);
    return shown(reply.substr(7));
  }

  modbus::Settings settings;
  std::unique_ptr<modbus::Session> modbus;
};

TEST(Modbus, Header_IsThatOfTheRequest) {
  ModbusPlc plc;
  plc.word(Device::d, 0, 0x1234);
  EXPECT_EQ(shown(plc.raw_modbus(bytes("ab cd 00 00 00 06 07 03 00 00 00 01"))),
            "ab cd 00 00 00 05 07 03 02 12 34");
}

TEST(Modbus, F1_ReadsCoils) {
  ModbusPlc plc;
  plc.bit(Device::y, 0, true);
  plc.bit(Device::y, 9, true);
  EXPECT_EQ(plc.pdu("01 00 00 00 0a"), "01 02 01 02");
  plc.bit(Device::m, 0, true);
  EXPECT_EQ(plc.pdu("01 00 3f 00 02"), "01 01 02");  // across two ranges
}

TEST(Modbus, F1_ReadsBitsOfWords) {
  ModbusPlc plc;
  plc.other_module.words[0] = 0x8000;
  plc.other_module.words[1] = 0x0001;
  EXPECT_EQ(plc.pdu("01 03 f7 00 02"), "01 01 03");  // coils 1015 and 1016
}

TEST(Modbus, F2_ReadsInputsAsTheModuleHasThem) {
  ModbusPlc plc;
  plc.module.x = 0x00010001;
  EXPECT_EQ(plc.pdu("02 00 00 00 11"), "02 03 01 00 01");
}

TEST(Modbus, F3_ReadsRegisters_AcrossRanges) {
  ModbusPlc plc;
  plc.word(Device::d, 199, 0x1234);
  plc.module.words[10000] = 0x5678;
  EXPECT_EQ(plc.pdu("03 00 c7 00 02"), "03 04 12 34 56 78");
  plc.word(Device::m, 16, 0xABCD);
  EXPECT_EQ(plc.pdu("03 01 2d 00 01"), "03 02 ab cd");
}

TEST(Modbus, F4_ReadsInputRegisters) {
  ModbusPlc plc;
  plc.rack.set_cpu_state(module::CpuState::stop, plc.now);
  EXPECT_EQ(plc.pdu("04 00 03 00 01"), "04 02 00 22");  // SD203: STOP by remote operation
}

TEST(Modbus, F5_WritesACoil) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("05 00 01 ff 00"), "05 00 01 ff 00");
  EXPECT_EQ(plc.module.y, 0x2U);
  EXPECT_EQ(plc.pdu("05 00 01 00 00"), "05 00 01 00 00");
  EXPECT_EQ(plc.module.y, 0U);
  EXPECT_EQ(plc.pdu("05 00 01 00 01"), "85 03");
}

TEST(Modbus, F6_WritesARegister) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("06 00 64 12 34"), "06 00 64 12 34");
  EXPECT_EQ(plc.word(Device::d, 100), 0x1234);
}

TEST(Modbus, F15_WritesCoils) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("0f 00 3e 00 04 01 0d"), "0f 00 3e 00 04");
  EXPECT_TRUE(plc.bit(Device::y, 62));
  EXPECT_FALSE(plc.bit(Device::y, 63));
  EXPECT_TRUE(plc.bit(Device::m, 0));
  EXPECT_TRUE(plc.bit(Device::m, 1));
}

TEST(Modbus, F15_WritesBitsOfWords_AndLeavesTheOthers) {
  ModbusPlc plc;
  plc.other_module.words[0] = 0x00FF;
  plc.other_module.words[1] = 0xF000;
  EXPECT_EQ(plc.pdu("0f 03 f7 00 02 01 03"), "0f 03 f7 00 02");
  EXPECT_EQ(plc.other_module.words[0], 0x80FF);
  EXPECT_EQ(plc.other_module.words[1], 0xF001);
}

TEST(Modbus, F16_WritesRegisters) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("10 00 c7 00 02 04 12 34 56 78"), "10 00 c7 00 02");
  EXPECT_EQ(plc.word(Device::d, 199), 0x1234);
  EXPECT_EQ(plc.module.words[10000], 0x5678);
}

TEST(Modbus, F22_MasksARegister_AsTheStandardsExample) {
  ModbusPlc plc;
  plc.word(Device::d, 4, 0x12);
  EXPECT_EQ(plc.pdu("16 00 04 00 f2 00 25"), "16 00 04 00 f2 00 25");
  EXPECT_EQ(plc.word(Device::d, 4), 0x17);
}

TEST(Modbus, F23_WritesBeforeItReads) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("17 00 03 00 02 00 04 00 01 02 12 34"), "17 04 00 00 12 34");
}

TEST(Modbus, F43_IdentifiesTheServer) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("2b 0e 01 00"),
            "2b 0e 01 82 00 00 03 00 07 43 61 6e 6f 70 75 73 01 06 52 30 34 43 50 55 02 03 31 2e 30");
  EXPECT_EQ(plc.pdu("2b 0e 04 01"), "2b 0e 04 82 00 00 01 01 06 52 30 34 43 50 55");
  EXPECT_EQ(plc.pdu("2b 0e 02 03"), "2b 0e 02 82 00 00 01 04 03 50 4c 43");
  EXPECT_EQ(plc.pdu("2b 0e 02 63").substr(0, 20), "2b 0e 02 82 00 00 04");  // an unknown object begins anew
  EXPECT_EQ(plc.pdu("2b 0e 04 03"), "ab 02");
  EXPECT_EQ(plc.pdu("2b 0e 05 00"), "ab 03");
  EXPECT_EQ(plc.pdu("2b 0d 01 00"), "ab 01");
}

TEST(Modbus, F43_LongNames_FollowInAnotherReply) {
  modbus::Settings settings = some_map();
  settings.identification.objects[6] = std::string(300, 'x');
  ModbusPlc plc(std::move(settings));
  EXPECT_EQ(plc.pdu("2b 0e 02 00").substr(0, 20), "2b 0e 02 82 ff 06 04");
  const std::string rest = plc.pdu("2b 0e 02 06");
  EXPECT_EQ(rest.substr(0, 26), "2b 0e 02 82 00 00 01 06 f4");
  EXPECT_EQ((rest.size() + 1) / 3, modbus::maximum_pdu);
}

TEST(Modbus, OtherFunctions_AreException1) {
  ModbusPlc plc;
  for (const char* function : {"00", "07", "08", "0b", "11", "14", "18", "5a"})
    EXPECT_EQ(plc.pdu(std::string(function) + " 00 00 00 01").substr(3), "01") << function;
}

TEST(Modbus, AddressesThatNobodyMapped_AreException2) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("01 00 80 00 01"), "81 02");
  EXPECT_EQ(plc.pdu("01 00 7f 00 02"), "81 02");
  EXPECT_EQ(plc.pdu("03 03 e8 00 01"), "83 02");
  EXPECT_EQ(plc.pdu("03 ff ff 00 02"), "83 02");  // beyond the last address
  EXPECT_EQ(plc.pdu("04 00 0a 00 01"), "84 02");
}

TEST(Modbus, MappedBeyondTheModule_IsException2) {
  ModbusPlc plc;  // register 912 would be U3\G512
  EXPECT_EQ(plc.pdu("03 03 8f 00 01"), "03 02 00 00");
  EXPECT_EQ(plc.pdu("03 03 90 00 01"), "83 02");
  EXPECT_EQ(plc.pdu("03 03 8f 00 02"), "83 02");
}

TEST(Modbus, ReadOnlyAddresses_AreException2WhenWritten) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("01 07 d0 00 01"), "01 01 00");
  EXPECT_EQ(plc.pdu("05 07 d0 ff 00"), "85 02");
}

TEST(Modbus, WrongNumbersAndLengths_AreException3) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("01 00 00 00 00"), "81 03");
  EXPECT_EQ(plc.pdu("01 00 00 07 d1"), "81 03");
  EXPECT_EQ(plc.pdu("03 00 00 00 7e"), "83 03");
  EXPECT_EQ(plc.pdu("03 00 00 00"), "83 03");
  EXPECT_EQ(plc.pdu("03 00 00 00 01 00"), "83 03");
  EXPECT_EQ(plc.pdu("06 00 00 01"), "86 03");
  EXPECT_EQ(plc.pdu("0f 00 00 00 09 01 ff"), "8f 03");
  EXPECT_EQ(plc.pdu("0f 00 00 00 08 01"), "8f 03");
  EXPECT_EQ(plc.pdu("0f"), "8f 03");
  EXPECT_EQ(plc.pdu("10 00 00 00 01 04 00 00 00 00"), "90 03");
  EXPECT_EQ(plc.pdu("10 00 00 00 00 00"), "90 03");
  EXPECT_EQ(plc.pdu("16 00 00 00 00"), "96 03");
  EXPECT_EQ(plc.pdu("17 00 00 00 7e 00 00 00 01 02 00 00"), "97 03");
  EXPECT_EQ(plc.pdu("17 00 00 00 01 00 00 00 00 00"), "97 03");
  EXPECT_EQ(plc.pdu("2b"), "ab 03");
}

TEST(Modbus, MappedToAModuleThatIsNotThere_IsException4) {
  EXPECT_EQ(ModbusPlc{}.pdu("03 13 88 00 01"), "83 04");
}

TEST(Modbus, WriteThatIsRefused_WritesNothing) {
  ModbusPlc plc;
  EXPECT_EQ(plc.pdu("10 01 2b 00 06 0c 00 01 00 02 00 03 00 04 00 05 00 06"), "90 02");  // 304 is not mapped
  EXPECT_TRUE(plc.module.writes.empty());
  EXPECT_EQ(plc.word(Device::m, 0), 0);
  EXPECT_EQ(plc.pdu("17 03 e8 00 01 00 04 00 01 02 12 34"), "97 02");  // what it would read is not there
  EXPECT_EQ(plc.word(Device::d, 4), 0);
}

TEST(Modbus, WhereWritingIsNotEnabled_WritesAreException1) {
  ModbusPlc plc(some_map(), WritePermission::in_stop);
  for (const char* request :
       {"05 00 01 ff 00", "06 00 64 12 34", "0f 00 3e 00 04 01 0d", "10 00 00 00 01 02 00 01",
        "16 00 04 00 f2 00 25", "17 00 03 00 02 00 04 00 01 02 12 34"})
    EXPECT_EQ(plc.pdu(request).substr(3), "01") << request;
  EXPECT_EQ(plc.module.y, 0U);
  plc.rack.set_cpu_state(module::CpuState::stop, plc.now);
  EXPECT_EQ(plc.pdu("06 00 64 12 34"), "06 00 64 12 34");
}

TEST(Modbus, UnitIdentifiers) {
  modbus::Settings settings = some_map();
  settings.unit = 5;
  ModbusPlc plc(std::move(settings));
  for (const char* unit : {"05", "00", "ff"})
    EXPECT_EQ(shown(plc.raw_modbus(bytes("00 01 00 00 00 06 " + std::string(unit) + " 03 00 00 00 01"))),
              "00 01 00 00 00 05 " + std::string(unit) + " 03 02 00 00");
  EXPECT_EQ(shown(plc.raw_modbus(bytes("00 01 00 00 00 06 06 03 00 00 00 01"))),
            "00 01 00 00 00 03 06 83 0b");
}

TEST(ModbusSession, HalfARequest_WaitsForTheRest) {
  ModbusPlc plc;
  const std::string request = bytes("00 01 00 00 00 06 ff 03 00 00 00 01");
  for (std::size_t i = 0; i + 1 < request.size(); ++i) {
    EXPECT_EQ(plc.raw_modbus(request.substr(i, 1)), "");
    EXPECT_TRUE(plc.modbus->half_request());
  }
  EXPECT_EQ(plc.raw_modbus(request.substr(request.size() - 1)).size(), 11U);
  EXPECT_FALSE(plc.modbus->half_request());
}

TEST(ModbusSession, RequestsOneBehindTheOther_AreAnsweredInOrder) {
  ModbusPlc plc;
  std::string requests;
  for (char transaction = 0; transaction < 100; ++transaction) {
    requests += bytes("00 00 00 00 00 06 ff 03 00 00 00 01");
    requests[requests.size() - 11] = transaction;
  }
  const std::string replies = plc.raw_modbus(requests);
  ASSERT_EQ(replies.size(), 1100U);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(static_cast<std::size_t>(replies[11 * i + 1]), i);
}

TEST(ModbusSession, WhatIsNoHeader_EndsTheSession) {
  for (const char* request :
       {"00 01 00 01 00 06 ff 03 00 00 00 01", "00 01 00 00 00 01 ff", "00 01 00 00 00 ff ff"}) {
    ModbusPlc plc;
    EXPECT_EQ(plc.raw_modbus(bytes(request)), "");
    EXPECT_TRUE(plc.modbus->over()) << request;
  }
}

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
}  // namespace canopus::plc
