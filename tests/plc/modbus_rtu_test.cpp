// Modbus RTU over TCP: frames with a CRC in place of a header, and what a client of the other framing gets.

#include "plc/plc_modbus.hpp"

namespace canopus::plc::modbus_rtu_test {
namespace {

modbus::Settings rtu(std::optional<std::uint8_t> unit = std::nullopt) {
  modbus::Settings settings = some_map();
  settings.framing = modbus::Framing::rtu;
  settings.unit = unit;
  return settings;
}

std::string ask(ModbusPlc& plc, const std::string& request) { return shown(plc.raw_modbus(bytes(request))); }

TEST(ModbusRtu, Requests_EndWhereTheirFunctionSays_AndAreAnsweredWithACrc) {
  ModbusPlc plc(rtu());
  plc.word(Device::d, 0, 0x1234);
  EXPECT_EQ(ask(plc, "01 03 00 00 00 02 c4 0b"), "01 03 04 12 34 00 00 be 85");
  EXPECT_EQ(ask(plc, "01 06 00 01 12 34 d5 7d"), "01 06 00 01 12 34 d5 7d");
  EXPECT_EQ(plc.word(Device::d, 1), 0x1234);
  EXPECT_EQ(ask(plc, "01 0f 00 00 00 0a 02 ff 03 e4 c9"), "01 0f 00 00 00 0a d5 cc");
  EXPECT_TRUE(plc.bit(Device::y, 9));
  EXPECT_EQ(ask(plc, "01 01 00 00 00 02 bd cb"), "01 01 01 03 11 89");
  EXPECT_EQ(ask(plc, "01 17 00 00 00 01 00 01 00 01 02 00 09 95 79"), "01 17 02 12 34 b0 c3");
  EXPECT_EQ(plc.word(Device::d, 1), 9);
}

TEST(ModbusRtu, RequestsOneBehindTheOther_AreAnsweredInOrder) {
  ModbusPlc plc(rtu());
  EXPECT_EQ(ask(plc, "01 10 00 00 00 02 04 00 01 00 02 23 ae 01 0f 00 00 00 0a 02 ff 03 e4 c9"),
            "01 10 00 00 00 02 41 c8 01 0f 00 00 00 0a d5 cc");
}

TEST(ModbusRtu, RequestInTwoPieces_WaitsForItsEnd) {
  ModbusPlc plc(rtu());
  EXPECT_EQ(ask(plc, "01 10 00 00 00 02 04"), "");
  EXPECT_TRUE(plc.modbus->half_request());
  EXPECT_EQ(ask(plc, "00 01 00 02 23 ae"), "01 10 00 00 00 02 41 c8");
}

TEST(ModbusRtu, FunctionThatIsNotThere_IsException01) {
  ModbusPlc plc(rtu());
  EXPECT_EQ(ask(plc, "01 07 41 e2"), "01 87 01 82 30");
  EXPECT_EQ(ask(plc, "01 03 27 10 00 01 8f 7b"), "01 83 02 c0 f1");
}

TEST(ModbusRtu, UnitThatIsNotMeant_StaysSilent_AndAllHaveNoReply) {
  ModbusPlc plc(rtu(1));
  EXPECT_EQ(ask(plc, "02 03 00 00 00 01 84 39"), "");
  EXPECT_EQ(ask(plc, "00 06 00 01 00 07 98 19"), "");
  EXPECT_EQ(plc.word(Device::d, 1), 7) << "unit 0 is all";
  EXPECT_EQ(ask(plc, "01 06 00 01 12 34 d5 7d"), "01 06 00 01 12 34 d5 7d");
  EXPECT_FALSE(plc.modbus->over());
}

TEST(ModbusRtu, WrongCrc_ChangesNothingAndEndsTheConversationWithAReason) {
  ModbusPlc plc(rtu());
  EXPECT_EQ(ask(plc, "01 06 00 01 12 34 d5 7e"), "");
  EXPECT_EQ(plc.word(Device::d, 1), 0);
  EXPECT_TRUE(plc.modbus->over());
  EXPECT_THAT(plc.modbus->refusal(), ::testing::HasSubstr("no RTU frame with a good CRC"));
}

TEST(ModbusRtu, ClientOfModbusTcp_IsToldWhatThePortTakes) {
  ModbusPlc plc(rtu());
  EXPECT_EQ(ask(plc, "00 01 00 00 00 06 01 03 00 00 00 01"), "");
  EXPECT_TRUE(plc.modbus->over());
  EXPECT_THAT(plc.modbus->refusal(), ::testing::HasSubstr("clients of Modbus TCP need another"));
}

TEST(ModbusRtu, ClientOfRtuOnAModbusTcpPort_IsToldWhatIsMissing) {
  for (const char* request :
       {"01 03 00 00 00 0a c5 cd", "01 10 00 00 00 02 04 00 01 00 02 23 ae", "01 07 41 e2"}) {
    ModbusPlc plc;
    EXPECT_EQ(ask(plc, request), "") << request;
    EXPECT_TRUE(plc.modbus->over()) << request;
    EXPECT_THAT(plc.modbus->refusal(), ::testing::HasSubstr("have no MBAP header")) << request;
    EXPECT_EQ(plc.word(Device::d, 0), 0);
  }
}

TEST(ModbusRtu, ClientOfModbusTcpThatOnceAsked_IsNeverTakenForRtu) {
  ModbusPlc plc;
  plc.word(Device::d, 0, 0x1234);
  EXPECT_EQ(ask(plc, "ab cd 00 00 00 06 07 03 00 00 00 01"), "ab cd 00 00 00 05 07 03 02 12 34");
  // The same 8 bytes as above are the beginning of a request with transaction 0103H.
  EXPECT_EQ(ask(plc, "01 03 00 00 00 0a c5 cd"), "");
  EXPECT_FALSE(plc.modbus->over());
}

RC_GTEST_PROP(ModbusRtuProperties, AnyBytes_InPiecesOfAnySize_GiveTheSameReplies, ()) {
  const auto words = *rc::gen::container<std::vector<std::string>>(
      rc::gen::element<std::string>("01 03 00 00 00 02 c4 0b", "01 07 41 e2", "00 06 00 01 00 07 98 19",
                                    "01 10 00 00 00 02 04 00 01 00 02 23 ae", "01 17", "ff"));
  std::string stream;
  for (const std::string& word : words) stream += bytes(word);
  ModbusPlc whole(rtu());
  ModbusPlc pieces(rtu());
  const std::string expected = whole.raw_modbus(stream);
  std::string found;
  for (std::size_t at = 0; at < stream.size();) {
    const auto size = *rc::gen::inRange<std::size_t>(1, 9);
    found += pieces.raw_modbus(std::string_view(stream).substr(at, size));
    at += size;
  }
  RC_ASSERT(found == expected);
}

}  // namespace
}  // namespace canopus::plc::modbus_rtu_test
