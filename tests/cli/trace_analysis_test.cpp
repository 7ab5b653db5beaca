// What a person sees of decoded messages, and which of them.

#include <chrono>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/trace/trace_options.hpp"
#include "canopus/trace/filter/message_filter.hpp"
#include "canopus/trace/print/message_printer.hpp"

#include "paths.hpp"

namespace canopus::cli::trace_analysis_test {
namespace {

using testing::HasSubstr;
using trace::Message;
using trace::Service;
using namespace std::chrono_literals;

Message pdo() {
  Message message{.time = can::Time(1'500'250us), .frame = can::data_frame(0x183, {0xD2, 0x04})};
  message.service = Service::pdo;
  message.kind = "TPDO";
  message.pdo = 1;
  message.node = 3;
  message.node_name = "encoder";
  message.data = {0xD2, 0x04};
  message.signals.push_back(
      {.index = 0x6004, .bits = 16, .name = "Position", .value = "1234", .number = 1234});
  message.text = "Position = 1234";
  return message;
}

std::string printed(const Message& message, trace::PrinterOptions options) {
  TextOutput out;
  trace::MessagePrinter printer(options, out);
  printer.set_zero(can::Time(1s));
  printer.print(message, "line1");
  return out.text();
}

TEST(MessagePrinter, Line_HasTimeChannelIdentifierServiceAndNode) {
  EXPECT_EQ(printed(pdo(), {}), "   0.500250  line1  183  TPDO1          3 (encoder)   Position = 1234\n");
  EXPECT_EQ(printed(pdo(), {.time = trace::TimeColumn::absolute}),
            "1.500250  line1  183  TPDO1          3 (encoder)   Position = 1234\n");
}

TEST(MessagePrinter, Frames_HaveTheirBytes) {
  EXPECT_THAT(printed(pdo(), {.frames = true}),
              HasSubstr("3 (encoder)   [2] D2 04                    Position = 1234\n"));
}

Message malformed() {
  Message message{.time = can::Time(1'500'250us), .frame = can::data_frame(0x585, {0x60, 0x01})};
  message.service = Service::sdo;
  message.kind = "malformed";
  message.node = 5;
  message.is_malformed = true;
  message.text = "2 bytes, expected 8: 60 01";
  return message;
}

TEST(MessagePrinter, MalformedMessage_IsMarked_InColourOnATerminal) {
  EXPECT_EQ(printed(malformed(), {}),
            "   0.500250  line1  585  SDO            5             malformed: 2 bytes, expected 8: 60 01\n");
  EXPECT_THAT(printed(malformed(), {.colour = true}),
              HasSubstr("\x1B[31mmalformed: 2 bytes, expected 8: 60 01\x1B[0m"));
  EXPECT_THAT(printed(malformed(), {.json = true}), HasSubstr("\"malformed\":true"));
  EXPECT_THAT(trace::searched_text(malformed(), "line1"), HasSubstr("malformed"));
}

TEST(MessagePrinter, Delta_CountsFromTheLineBefore) {
  TextOutput out;
  trace::MessagePrinter printer({.time = trace::TimeColumn::delta}, out);
  Message message = pdo();
  printer.print(message, "");
  out.clear();
  message.time += 10ms;
  printer.print(message, "");
  EXPECT_THAT(out.text(), HasSubstr("   0.010000  183  "));
}

TEST(MessagePrinter, HostileName_IsEscaped) {
  Message message = pdo();
  message.node_name = "\x1b[2J";
  message.text = "x\ny";
  EXPECT_THAT(printed(message, {}), HasSubstr("3 (\\x1B[2J)"));
  EXPECT_THAT(printed(message, {}), HasSubstr("x\\ny\n"));
}

TEST(MessagePrinter, Json_HasTheFieldsOfTheMessage) {
  EXPECT_EQ(printed(pdo(), {.json = true}),
            "{\"time\":1.50025,\"channel\":\"line1\",\"id\":\"183\",\"service\":\"pdo\",\"kind\":\"TPDO\","
            "\"node\":3,"
            "\"name\":\"encoder\",\"pdo\":1,\"data\":\"D204\",\"signals\":[{\"object\":\"6004:00\",\"name\":"
            "\"Position\","
            "\"value\":1234.0}],\"text\":\"Position = 1234\"}\n");
}

TEST(MessagePrinter, Json_HasAbortAndEndOfATransfer) {
  Message message{.frame = can::data_frame(0x583), .service = Service::sdo, .kind = "read"};
  message.index = 0x6000;
  message.sub = 9;
  message.abort_code = 0x06090011;
  message.is_transfer = true;
  message.end = trace::TransferEnd::aborted;
  message.frames = 2;
  message.duration = 500us;
  const auto json = trace::to_json(message, "");
  EXPECT_EQ(json["index"], "6000");
  EXPECT_EQ(json["sub"], 9);
  EXPECT_EQ(json["abort"], "06090011");
  EXPECT_EQ(json["abort_text"], "sub-index does not exist");
  EXPECT_EQ(json["end"], "aborted");
  EXPECT_EQ(json["duration_ms"], 0.5);
}

bool wants(const trace::FilterOptions& options, const Message& message = pdo(), can::Duration since = 1s) {
  TextOutput err;
  const auto filter = trace::MessageFilter::make(options, err);
  EXPECT_TRUE(filter.has_value()) << err.text();
  return filter && filter->wants(message, since);
}

TEST(MessageFilter, EachFilter_TakesWhatItNames) {
  EXPECT_TRUE(wants({}));
  EXPECT_TRUE(wants({.nodes = {"4", "3"}}));
  EXPECT_FALSE(wants({.nodes = {"4"}}));
  EXPECT_TRUE(wants({.services = {"sdo", "pdo"}}));
  EXPECT_FALSE(wants({.services = {"sdo"}}));
  EXPECT_TRUE(wants({.objects = {"6004"}}));
  EXPECT_TRUE(wants({.objects = {"6004:00"}}));
  EXPECT_FALSE(wants({.objects = {"6004:01"}}));
  EXPECT_TRUE(wants({.identifiers = {"0x183"}}));
  EXPECT_FALSE(wants({.identifiers = {"184"}}));
  EXPECT_FALSE(wants({.nodes = {"3"}, .services = {"sdo"}}));
}

TEST(MessageFilter, Times_CountFromTheFirstFrame) {
  EXPECT_TRUE(wants({.from = "1s", .to = "1s"}));
  EXPECT_FALSE(wants({.from = "1001ms"}));
  EXPECT_FALSE(wants({.to = "999ms"}));
}

TEST(MessageFilter, Mistakes_SayWhatWasExpected) {
  const auto mistake = [](const trace::FilterOptions& options) {
    TextOutput err;
    EXPECT_FALSE(trace::MessageFilter::make(options, err).has_value());
    return err.text();
  };
  EXPECT_EQ(mistake({.nodes = {"128"}}),
            "canopus: --node 128: expected a node-ID 1 to 127, 0 for all, or a name\n");
  EXPECT_THAT(mistake({.services = {"sdoo"}}),
              HasSubstr("canopus: --service sdoo: unknown service; did you mean \"sdo\"?"));
  EXPECT_THAT(mistake({.objects = {"x"}}), HasSubstr("canopus: --object: "));
  EXPECT_THAT(mistake({.identifiers = {"20000000"}}), HasSubstr("--can-id 20000000: expected an identifier"));
  EXPECT_EQ(mistake({.from = "2s", .to = "1s"}), "canopus: --from is later than --to\n");
  EXPECT_THAT(mistake({.from = "soon"}), HasSubstr("canopus: --from: "));
}

TEST(AnalysisNames, Plant_NamesModulesAndDevicesWithTheirPdos) {
  TextOutput err;
  const auto names =
      load_names({.of = {.plant = CANOPUS_SOURCE_DIR "/examples/first-plant/plant.toml"}}, err);
  ASSERT_TRUE(names.has_value()) << err.text();
  ASSERT_EQ(names->nodes().size(), 4U);
  EXPECT_EQ(names->nodes()[0].name, "ME3CAN1-Q U0");
  EXPECT_EQ(names->nodes()[2].name, "encoder");
  EXPECT_EQ(names->nodes()[2].bus, "line1");
  const trace::Setting heartbeat{0x1017, 0, 500};  // of the plant file, not of the device file
  EXPECT_THAT(names->nodes()[2].settings, testing::Contains(heartbeat));
}

TEST(AnalysisNames, WrongNode_SaysWhatWasExpected) {
  TextOutput err;
  EXPECT_FALSE(load_names({.device_files = {"200=x.eds"}}, err).has_value());
  EXPECT_THAT(err.text(), HasSubstr("--eds 200=x.eds: expected a node-ID 1 to 127, = and a device file"));
  err.clear();
  EXPECT_FALSE(load_names({.device_files = {"3=/nowhere.eds"}}, err).has_value());
  EXPECT_THAT(err.text(), HasSubstr("/nowhere.eds"));
}

}  // namespace
}  // namespace canopus::cli::trace_analysis_test
