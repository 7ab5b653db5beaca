// What the page says in words of a module's errors, of a value of many bytes and of the times of a flying master.

#include "canopus/web/state/node_detail_view.hpp"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/can/bus.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/cli/plc/module_command.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/plant/catalogue/error_history.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/serve/device_control.hpp"
#include "canopus/web/state/objects.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::web::node_detail_view_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using namespace std::chrono_literals;
using DetailsJson = nlohmann::ordered_json;

const std::string bus_and_encoder =
    "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n"
    "[[device]]\nnode = 3\nname = \"encoder\"\neds = \"" CANOPUS_SOURCE_DIR
    "/examples/devices/encoder.eds\"\n";

std::string with_module(const std::string& model, const std::string& rack = "",
                        const std::string& more = "head = 0\n") {
  return bus_and_encoder + "[[plc]]\n" + rack + "[[plc.module]]\nmodel = \"" + model + "\"\n" + more +
         "node = 1\nmaster = true\nslaves = \"all\"\n";
}

class WebDetails : public support::PlantFolder, public plant::PlantObserver {
 protected:
  void start(const std::string& text, can::Duration time = 5s) {
    plant_ = support::PlantFolder::load(text, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
    run(time);
  }
  void run(can::Duration time) { plant_->timeline().run_until(plant_->timeline().now() + time); }
  can::Time now() { return plant_->timeline().now(); }
  DetailsJson look(const std::string& wish) {
    const auto view = text::parse_json(wish).value();
    const std::string text = view.contains("errors")   ? errors_event(*plant_, view)
                             : view.contains("domain") ? domain_event(*plant_, view)
                                                       : objects_event(*plant_, view);
    return text.empty() ? DetailsJson() : DetailsJson::parse(text);
  }
  /// "errors now: G29 bit 6 | | buffer memory ...", a line each.
  std::vector<std::string> errors() {
    std::vector<std::string> lines;
    const DetailsJson event = look(R"({"errors": 0})");
    for (const DetailsJson& group : event["groups"]) {
      for (const DetailsJson& line : group["lines"]) {
        lines.push_back(group["title"].get<std::string>() + ": " + line["where"].get<std::string>() + " | " +
                        line["code"].get<std::string>() + " | " + line["meaning"].get<std::string>());
      }
    }
    return lines;
  }
  void write_word(std::uint32_t address, std::uint16_t value) {
    plant_->module(0).buffer_memory()->write_word(address, value, now());
  }
  /// From a node that is not of the plant.
  void send_emergency(std::uint8_t node, std::uint16_t code, std::uint8_t last) {
    if (port_ == nullptr) {
      port_ = &plant_->bus(0).add_port("stranger");
      port_->plug(true);
      run(10ms);
    }
    const auto low = static_cast<std::uint8_t>(code), high = static_cast<std::uint8_t>(code >> 8);
    ASSERT_TRUE(port_->send(can::data_frame(0x80U + node, {low, high, 0x11, 0, 0, 0, 0, last})));
    run(10ms);
  }
  /// What an SDO would write.
  void write_object(std::size_t place, std::uint16_t index, std::uint8_t sub,
                    const std::vector<std::uint8_t>& bytes) {
    auto& node = const_cast<canopen::Node&>(*node_at(*plant_, place));
    ASSERT_EQ(node.dictionary().write(index, sub, bytes, now()), canopen::AbortCode::none);
  }

  std::unique_ptr<plant::Plant> plant_;
  can::Port* port_ = nullptr;
};

TEST_F(WebDetails, Errors_OfAnMe3can1Q_AreBitsAddressesAndEmergencies_NewestFirst) {
  start(with_module("ME3CAN1-Q"));
  EXPECT_THAT(errors(), IsEmpty());
  write_word(27, 200);
  send_emergency(3, 0x8130, 0);
  send_emergency(4, 0x8F05, 'x');
  const auto lines = errors();
  EXPECT_THAT(
      lines,
      Contains("errors now: G29 bit 6 |  | buffer memory setting error: a value out of range was written"));
  EXPECT_THAT(lines, Contains("errors now: G39 |  | first value out of range was written to G27"));
  std::vector<std::string> emergencies;
  for (const std::string& line : lines)
    if (line.starts_with("emergencies received")) emergencies.push_back(line);
  ASSERT_THAT(emergencies, SizeIs(2));
  EXPECT_EQ(emergencies[0],
            "emergencies received: node 4 | 8F05H | guarding or heartbeat error of node 5; error register "
            "11H; data 00 00 00 00 78");
  EXPECT_THAT(emergencies[1], HasSubstr("node 3 | 8130H | "));
  EXPECT_THAT(emergencies[1], HasSubstr("eartbeat"));
}

TEST_F(WebDetails, Errors_OfAnRj71cn91_AreItsDiagnosisAndItsEvents_WithTheirTime) {
  start(with_module("RJ71CN91", "family = \"iQ-R\"\n"));
  write_word(21, 99);
  run(50ms);
  const DetailsJson event = look(R"({"errors": 0})");
  ASSERT_THAT(event["groups"], Not(IsEmpty())) << event;
  const DetailsJson& events = event["groups"].back();
  EXPECT_EQ(events["title"], "event history");
  ASSERT_THAT(events["lines"], Not(IsEmpty()));
  double before = 1e9;
  for (const DetailsJson& line : events["lines"]) {
    EXPECT_LE(line["t"].get<double>(), before) << "the newest first";
    before = line["t"];
  }
  EXPECT_THAT(events.dump(), HasSubstr(R"("code":"00400","meaning":"Start in CANopen 405 mode")"));
}

TEST_F(WebDetails, Errors_OfAnFx2n32Can_HasItsStack) {
  start(bus_and_encoder +
        "[[plc]]\nfamily = \"FX3\"\n[[plc.module]]\nmodel = \"FX2N-32CAN\"\nposition = 0\nnode = 1\nexchange "
        "= \"10ms\"\n");
  EXPECT_THAT(errors(), Not(Contains(HasSubstr("emergencies received"))));
  send_emergency(9, 0x1000, 0);
  EXPECT_THAT(errors(), Contains("emergencies received: node 9 | 1000H | generic error; error register 11H"));
  EXPECT_THAT(errors(), Contains("errors now: BFM #29 bit 13 |  | CANopen emergency"));
  write_word(1000, 0x1234);
  run(100ms);
  EXPECT_THAT(errors(), Contains("errors now: BFM #1000 | 000FH | last command: error, unknown command"));
}

TEST_F(WebDetails, Errors_OfAnAsFcopm_AreCodesOfItsNodes) {
  start(bus_and_encoder +
            "[[plc]]\nfamily = \"AS300\"\n[[plc.module]]\nmodel = \"AS-FCOPM\"\n[plc.module.download]\n"
            "[[plc.module.download.slave]]\nnode = 3\nheartbeat = \"100ms\"\n"
            "[[plc.module.download.slave]]\nnode = 7\neds = \"" CANOPUS_SOURCE_DIR
            "/examples/devices/drive.eds\"\n",
        8s);
  EXPECT_THAT(errors(), Contains("errors now: node 7, SR836 | 00E6H | the slave is not in the network"));
  send_emergency(3, 0x5000, 0);
  EXPECT_THAT(errors(), Contains(HasSubstr("emergencies received: node 3 | 5000H | ")));
}

TEST_F(WebDetails, Errors_OfAModuleThatIsNotThere) {
  start(with_module("ME3CAN1-Q"), 100ms);
  EXPECT_TRUE(look(R"({"errors": 1})").is_null());
}

/// What `words` of a model say, as `configure status` reads them.
std::vector<std::string> said_by(const char* model, std::uint16_t mode,
                                 const std::map<std::uint32_t, std::uint16_t>& words) {
  std::vector<std::string> lines;
  const auto read = [&](std::uint32_t address) {
    const auto found = words.find(address);
    return found == words.end() ? std::uint16_t{0} : found->second;
  };
  for (const auto& line : plant::errors_in_words(*plant::find_module(model)->errors, mode, read))
    lines.push_back(line.where + " | " + line.code + " | " + line.meaning);
  return lines;
}

TEST(ErrorsInWords, OfEveryKindOfWord) {
  EXPECT_THAT(
      said_by("FX3U-CAN", 405, {{29, 1U << 13 | 1}, {901, 0x8004}, {401, 0x2000}}),
      ElementsAre("BFM #29 bit 13 |  | emergency received from a slave",
                  "node 3, BFM #901 bit 2 |  | node guarding: one message missed, or toggle bit error",
                  "node 4, BFM #901 bit 15 |  | heartbeat missing"));
  EXPECT_THAT(said_by("FX3U-CAN", 11, {{901, 0x8004}, {402, 0x2000}, {403, 0x1234}}),
              ElementsAre("message 2, BFM #402 | 2000H | receive buffer overflow",
                          "message 3, BFM #403 | 1234H | not in the manual"))
      << "words of another function mode are none";
  EXPECT_THAT(
      said_by("RJ71CN91", 405, {{405, 1U << 7 | 3}, {1000, 0x000F}, {1001, 3}, {1002, 5}, {1004, 0x0602}}),
      ElementsAre(
          "node 5, G405 bit 7 |  | heartbeat time-out",
          "G1000 | 000FH | last command: error, SDO error of node 5: 06020000H object does not exist"));
  EXPECT_THAT(
      said_by("ME3CAN1-Q", 405, {{40, 21}, {1000, 0x000F}, {1001, 0x7777}}),
      ElementsAre("G40 |  | first refused write was to G21", "G1000 | 000FH | last command: error, 7777H"));
  EXPECT_THAT(said_by("ME3CAN1-Q", 405, {{1000, 0x0005}}), IsEmpty()) << "a command that succeeded";
  EXPECT_THAT(said_by("AS-FCOPM", 1, {{825, 0xF4}, {893, 0xE0}}),
              ElementsAre("SR825 | 00F4H | bus off", "node 64, SR893 | 00E0H | emergency from the slave"));
}

TEST_F(WebDetails, ModuleStatus_SaysTheSame) {
  start(with_module("ME3CAN1-Q"));
  write_word(27, 200);
  serve::DeviceControl control(*plant_);
  const std::string answer = control.answer(R"({"request": "modules"})");
  EXPECT_EQ(DetailsJson::parse(answer)["modules"][0]["history"], look(R"({"errors": 0})")["groups"]);
  text::TextOutput out;
  cli::print_modules(text::parse_json(answer).value(), out);
  EXPECT_THAT(out.text(),
              HasSubstr("  errors now\n    G29 bit 6  buffer memory setting error: a value out of range was "
                        "written\n    G39  first value out of range was written to G27\n"));
  text::TextOutput odd;
  cli::print_modules(
      text::parse_json(
          R"({"modules": [{"history": [7, {"lines": [3, {"t": "x"}]}, {"lines": 5}]}, {"history": 2}]})")
          .value(),
      odd);
}

TEST_F(WebDetails, ConciseDcfOfAModule_HasTheNamesOfTheSlavesOwnFile) {
  start(with_module("ME3CAN1-Q"));
  manager::ConciseDcfWriter writer;
  writer.add(0x1017, 0, 500, 2).add(0x6000, 0, 1, 2);
  EXPECT_EQ(look(R"({"domain": 0, "object": "1F22:03"})")["size"], 0);
  write_object(0, 0x1F22, 3, writer.file());
  const DetailsJson event = look(R"({"domain": 0, "object": "1F22:03"})");
  EXPECT_EQ(event["words"]["heading"], "concise DCF, 22 bytes, 2 entries");
  EXPECT_EQ(event["words"]["entries"][1]["name"], "Operating parameters");
  const DetailsJson row = look(R"({"objects": 0, "find": "1f22", "from": 3, "count": 1})")["rows"][0];
  EXPECT_EQ(row["object"], "1F22:03");
  EXPECT_EQ(row["bytes"], 22);
  const DetailsJson part = look(R"({"domain": 0, "object": "1F22:03", "part": 20})");
  EXPECT_EQ(part["hex"], "0100");
  EXPECT_FALSE(part.contains("words"));
  EXPECT_EQ(look(R"({"domain": 0, "object": "1F22:03", "part": 99})")["hex"], "");
}

TEST_F(WebDetails, BytesThatWereRead_AreSaidWithTheSlavesOwnNames) {
  start(with_module("ME3CAN1-Q"), 100ms);
  const auto said = [&](const std::string& bus, const std::string& object, const std::string& bytes) {
    return domain_in_words(*plant_, {{"bus", bus}, {"object", object}, {"bytes", bytes}});
  };
  const std::string file =
      "01000000"
      "0060"
      "00"
      "02000000"
      "0100";
  const auto words = said("line1", "1F22:03", file);
  ASSERT_TRUE(words) << words.error();
  EXPECT_EQ((*words)["entries"][0]["name"], "Operating parameters");
  EXPECT_EQ((*said("line1", "1F22:04", file))["entries"][0]["name"], "") << "no such node";
  EXPECT_EQ((*said("other", "1F22:03", file))["entries"][0]["name"], "");
  EXPECT_EQ((*said("line1", "2001:00", "414243"))["dump"].size(), 1U);
  EXPECT_THAT(said("line1", "1F22", file).error(), HasSubstr("object: expected"));
  for (const char* wrong : {"0", "0g", "+1", "-1", " 1"})
    EXPECT_THAT(said("line1", "1F22:03", wrong).error(), HasSubstr("bytes: expected")) << wrong;
  EXPECT_FALSE(domain_in_words(*plant_, text::Json::object()));
}

TEST_F(WebDetails, Domain_IsOneOfAnObjectOfVariableLength) {
  start(with_module("ME3CAN1-Q"), 100ms);
  for (const char* wish :
       {R"({"domain": 0, "object": "1017:00"})", R"({"domain": 0, "object": "2FFF:00"})",
        R"({"domain": 9, "object": "1008:00"})", R"({"domain": 0, "object": 7})", R"({"domain": 0})"})
    EXPECT_TRUE(look(wish).is_null()) << wish;
  EXPECT_THAT(look(R"({"domain": 1, "object": "1008:00"})")["words"]["dump"], Not(IsEmpty()));
}

TEST_F(WebDetails, TimesOfAFlyingMaster_ComeToASentence_AndAWarning) {
  start(with_module("ME3CAN1-Q", "", "head = 0\nobjects = { \"1F90:03\" = 2, \"1F90:04\" = 100 }\n"));
  const DetailsJson event = look(R"({"objects": 0, "find": "1f90", "count": 10})");
  ASSERT_THAT(event["rows"], SizeIs(7)) << event;
  const std::string words = event["rows"][4]["words"];
  EXPECT_THAT(words, HasSubstr("negotiation: 500 ms + 2 x 100 ms + 1 x 10 ms = 710 ms after a reset"));
  EXPECT_THAT(words, HasSubstr("it takes no part (1F80H bit 5)"));
  EXPECT_THAT(event["rows"][5]["warning"].get<std::string>(), HasSubstr("overlap"));
  EXPECT_FALSE(event["rows"][1].contains("words"));
  EXPECT_FALSE(look(R"({"objects": 0, "find": "1017", "count": 10})")["rows"][0].contains("words"));
}

}  // namespace
}  // namespace canopus::web::node_detail_view_test
