// Conversations in Modbus TCP, byte by byte: each function, each exception, and what a map is.

#include "plc/plc_modbus.hpp"

namespace canopus::plc::modbus_test {
namespace {

TEST(Modbus, Header_IsThatOfTheRequest) {
  ModbusPlc plc;
  plc.word(Device::d, 0, 0x1234);
  EXPECT_EQ(shown(plc.raw_modbus(bytes("ab cd 00 00 00 06 07 03 00 00 00 01"))),
            "ab cd 00 00 00 05 07 03 02 12 34");
}

TEST(Modbus, HasRequest_FromTheLastByteOfARequestOn_OrWhereThereIsNoHeader) {
  const auto receive = [](ModbusPlc& plc, const std::string& received) {
    std::ranges::copy(received, plc.modbus->space().begin());
    plc.modbus->received(received.size());
  };
  ModbusPlc plc;
  for (const char byte : bytes("ab cd 00 00 00 06 07 03 00 00 00 01")) {
    EXPECT_FALSE(plc.modbus->has_request());
    receive(plc, std::string(1, byte));
  }
  EXPECT_TRUE(plc.modbus->has_request());
  EXPECT_EQ(plc.modbus->process(plc.now), 1U);
  EXPECT_FALSE(plc.modbus->has_request());
  receive(plc, bytes("ab cd 00 01 00 06"));
  EXPECT_TRUE(plc.modbus->has_request());
  EXPECT_EQ(plc.modbus->process(plc.now), 0U);
  EXPECT_FALSE(plc.modbus->has_request()) << "it is over";
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

}  // namespace
}  // namespace canopus::plc::modbus_test
