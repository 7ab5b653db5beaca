// Pictures, DBC files and Lua scripts, of plants with good names and with hostile ones.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/report/bus_model.hpp"
#include "canopus/trace/report/names_of_others.hpp"
#include "canopus/trace/report/trace_picture.hpp"

namespace canopus::trace::report_files_test {
namespace {

using can::data_frame;
using canopen::DataType;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

NodeDescription device(std::uint8_t node_id, std::string name, const std::string& object_name) {
  canopen::DictionaryBuilder builder;
  builder.object(0x1800, canopen::ObjectCode::record, "TPDO1")
      .sub(0x1800, 1, {.name = "COB-ID", .value = can::little_endian(0x180, 4), .adds_node_id = true});
  builder.object(0x1A00, canopen::ObjectCode::record, "Mapping")
      .sub(0x1A00, 0, {.type = DataType::unsigned8, .value = {3}})
      .sub(0x1A00, 1, {.value = can::little_endian(0x20000010, 4)})
      .sub(0x1A00, 2, {.value = can::little_endian(0x20010020, 4)})
      .sub(0x1A00, 3, {.value = can::little_endian(0x20000010, 4)});
  builder.variable(0x2000, {.name = object_name, .type = DataType::integer16});
  builder.variable(0x2001, {.name = "Level", .type = DataType::real32});
  return describe_node("line1", node_id, std::move(name), builder.build());
}

TEST(DbcFile, EachPdo_IsAMessageWithItsSignals) {
  Names names;
  names.add(device(3, "pump station", "Speed 1/s"));
  EXPECT_EQ(dbc_file(model_of(names, "line1")),
            "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_: pump_station\n\n"
            "BO_ 387 pump_station_TPDO1: 8 pump_station\n"
            " SG_ Speed_1_s : 0|16@1- (1,0) [0|0] \"\" Vector__XXX\n"
            " SG_ Level : 16|32@1- (1,0) [0|0] \"\" Vector__XXX\n"
            " SG_ Speed_1_s_2 : 48|16@1- (1,0) [0|0] \"\" Vector__XXX\n\n\n"
            "CM_ BU_ pump_station \"node 3 pump station\";\n"
            "CM_ BO_ 387 \"TPDO1 of node 3 pump station\";\n"
            "CM_ SG_ 387 Speed_1_s \"2000:00 Speed 1/s\";\n"
            "CM_ SG_ 387 Level \"2001:00 Level\";\n"
            "CM_ SG_ 387 Speed_1_s_2 \"2000:00 Speed 1/s\";\n"
            "SIG_VALTYPE_ 387 Level : 1;\n");
}

TEST(DbcFile, HostileNames_StayWithinTheirQuotes) {
  Names names;
  names.add(device(3, "a\";\nBO_ 1 x", "\x1b[2J\xff\"\\"));
  const std::string file = dbc_file(model_of(names, "line1"));
  EXPECT_THAT(file, HasSubstr("CM_ BU_ a_BO_1_x \"node 3 a';?BO_ 1 x\";\n"));
  EXPECT_THAT(file, Not(HasSubstr("\x1b")));
  EXPECT_THAT(file, HasSubstr("CM_ SG_ 387 _2J \"2000:00 ?[2J?''\";\n"));
}

TEST(LuaDissector, HostileNames_StayWithinTheirStrings) {
  Names names;
  names.add(device(3, "\"] = os.execute(\"x\") --\n]]", "\\"));
  const std::string script = lua_dissector(model_of(names, "line1"), "a\\\"");
  EXPECT_THAT(script, HasSubstr("local title = \"a\\\\\\\"\"\n"));
  EXPECT_THAT(script, HasSubstr("  [3] = \"\\\"] = os.execute(\\\"x\\\") --?]]\",\n"));
  EXPECT_THAT(script, HasSubstr("name = \"\\\\\", first = 0, bits = 16, kind = \"signed\""));
  EXPECT_THAT(script, HasSubstr("name = \"Level\", first = 16, bits = 32, kind = \"real\""));
}

TEST(Identifiers, AreWordsOfC_AndNoneComesTwice) {
  Identifiers identifiers;
  EXPECT_EQ(identifiers.make("Digital input 1", "x"), "Digital_input_1");
  EXPECT_EQ(identifiers.make("Digital-input-1", "x"), "Digital_input_1_2");
  EXPECT_EQ(identifiers.make("24V", "x"), "_24V");
  EXPECT_EQ(identifiers.make("\xC3\xA4\xC3\xB6", "object_2000_00"), "object_2000_00");
  EXPECT_EQ(identifiers.make("BO_", "x"), "BO");
  EXPECT_EQ(identifiers.make("FILTER", "x"), "FILTER_");
  const std::string longest(40, 'a');
  EXPECT_EQ(identifiers.make(longest, "x"), std::string(32, 'a'));
  EXPECT_EQ(identifiers.make(longest, "x"), std::string(30, 'a') + "_2");
}

TEST(NamesOfOthers, KeepGoodUtf8AndNothingElse) {
  EXPECT_EQ(plain_text("\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80"), "\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80");
  EXPECT_EQ(plain_text("a\xC3"), "a?");
  EXPECT_EQ(plain_text("\xC0\x80\xED\xA0\x80"), "?????");
  EXPECT_EQ(plain_text("\x01\x7F\xC2\x9B"), "????");
  EXPECT_EQ(xml_text("<a href=\"&\">"), "&lt;a href=&quot;&amp;&quot;&gt;");
}

class PictureTest : public testing::Test {
 protected:
  static Names names(const std::string& name) {
    Names all;
    all.add(device(3, name, "Speed"));
    return all;
  }
  void draw(const std::string& name, PictureOptions options = {}) {
    Decoder decoder(names(name), {.frames = true, .transfers = false});
    TracePicture picture(std::move(options));
    const auto receive = [&](can::Duration at, std::uint32_t identifier,
                             std::initializer_list<std::uint8_t> bytes) {
      decoder.receive({.time = can::Time(at), .frame = data_frame(identifier, bytes)}, "line1",
                      [&](const Message& message) { picture.message(message); });
    };
    receive(0ms, 0x703, {0x00});
    receive(500ms, 0x000, {0x01, 0x03});
    receive(600ms, 0x183, {10, 0, 0, 0, 0, 0, 0, 0});
    receive(700ms, 0x083, {0x10, 0x10, 1, 0, 0, 0, 0, 0});
    receive(1000ms, 0x183, {20, 0, 0, 0, 0, 0, 0, 0});
    missing = picture.missing();
    svg = picture.svg("t.log");
  }
  std::string svg;
  std::vector<PictureSignal> missing;
};

TEST_F(PictureTest, HasLoadSignalsAndStates) {
  draw("pump");
  EXPECT_THAT(svg, HasSubstr("load of the bus, kbit/s"));
  EXPECT_THAT(svg, HasSubstr("node 3 (pump) 2000:00 Speed"));
  EXPECT_THAT(svg, HasSubstr("node 3 (pump) 2001:00 Level"));
  EXPECT_THAT(svg, HasSubstr(">3 pump</text>"));
  // 140 is 0 s, 1076 is 1 s: booted at 0 s, started at 0.5 s.
  EXPECT_THAT(svg, HasSubstr("<rect class=\"pre-operational\" x=\"140.0\" y=\"518.0\" width=\"468.0\""));
  EXPECT_THAT(svg, HasSubstr("<rect class=\"operational\" x=\"608.0\" y=\"518.0\" width=\"468.0\""));
  EXPECT_THAT(svg, HasSubstr("<line class=\"emcy\" x1=\"795.2\""));
  // 10 and then 20; the object is mapped a second time, where it has another value.
  EXPECT_THAT(svg, HasSubstr("<path class=\"curve\" d=\"M701.6,322.0H701.6V322.0H1076.0V212.0H1076.0\"/>"));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
}

TEST_F(PictureTest, SignalsThatWereAskedFor_AreDrawnAlone) {
  draw("pump", {.bit_rate = 125'000, .signals = {{3, 0x2000, 0}, {3, 0x3000, 0}}});
  EXPECT_THAT(svg, HasSubstr("% of 125000 bit/s"));
  EXPECT_THAT(svg, HasSubstr("2000:00 Speed"));
  EXPECT_THAT(svg, Not(HasSubstr("2001:00")));
  EXPECT_THAT(missing, testing::ElementsAre(PictureSignal{3, 0x3000, 0}));
}

TEST_F(PictureTest, HostileName_IsText) {
  draw("</text><script>&\x1b");
  EXPECT_THAT(svg, Not(HasSubstr("<script>")));
  EXPECT_THAT(svg, HasSubstr("node 3 (&lt;/text&gt;&lt;script&gt;&amp;?)"));
}

TEST(TracePicture, Nothing_IsAPictureToo) { EXPECT_THAT(TracePicture({}).svg("x"), HasSubstr("</svg>")); }

TEST(TracePicture, LongTrace_DoesNotGrowWithItsLength) {
  TracePicture picture({});
  Message message{.service = Service::pdo, .kind = "TPDO", .node = 3};
  message.signals.push_back({.index = 0x6000, .bits = 8, .number = 1});
  for (int i = 0; i < 300'000; ++i) {
    message.time = can::Time(i * 1ms);
    message.signals[0].number = i % 7;
    picture.message(message);
  }
  EXPECT_LT(picture.svg("x").size(), 300'000U);
}

}  // namespace
}  // namespace canopus::trace::report_files_test
