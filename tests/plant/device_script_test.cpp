// Scripts and playbacks of a plant file: what is read, what is wrong, and what a plant does with them.

#include "canopus/plant/device_script.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/process_value.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/serve/device_control.hpp"

#include "support/plant_folder.hpp"

namespace canopus::plant::device_script_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

/// Bus, and a device with an UNSIGNED8 of 0 to 200, an INTEGER16, a REAL32 and a BOOLEAN.
const std::string head =
    "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[device]]\nname = \"io\"\nnode = 2\neds = \"io.eds\"\n";
const std::string sections =
    "[2000]\nParameterName=Level\nDataType=5\nAccessType=ro\nLowLimit=0\nHighLimit=200\n"
    "[2001]\nParameterName=Offset, signed\nDataType=3\nAccessType=ro\n"
    "[2002]\nParameterName=Ratio\nDataType=8\nAccessType=ro\n"
    "[2003]\nParameterName=Switch\nDataType=1\nAccessType=ro\n"
    "[2004]\nParameterName=Twin\nDataType=5\nAccessType=ro\n"
    "[2005]\nParameterName=Twin\nDataType=5\nAccessType=ro\n"
    "[2006]\nParameterName=Label\nDataType=9\nAccessType=ro\nDefaultValue=x\n";

class DeviceScript : public support::PlantFolder, public PlantObserver {
 protected:
  DeviceScript() { support::PlantFolder::write("io.eds", support::device_file(sections)); }
  void start(std::string_view text) {
    plant_ = support::PlantFolder::load(text, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
  }
  void run_until(can::Duration time) { plant_->timeline().run_until(can::Time{time}); }
  void on(const Event& event) override {
    const auto microseconds = event.time.time_since_epoch() / 1us;
    if (const auto* forced = std::get_if<ObjectForced>(&event.what))
      events_.push_back(fmt::format("{} {}", microseconds, plant::describe(forced->object)));
    if (const auto* released = std::get_if<ObjectReleased>(&event.what)) {
      const ForcedObject& object = released->object;
      events_.push_back(fmt::format("{} {} released, {}", microseconds, object.object,
                                    show_value(object.type, object.value)));
    }
  }
  std::string script(std::string_view keys) const { return head + "[[device.script]]\n" + std::string(keys); }
  /// What `check` says of a CSV file with this text.
  std::vector<std::string> csv(std::string_view text, std::string_view keys = "") {
    support::PlantFolder::write("x.csv", text);
    return check(head + "[[device.playback]]\nfile = \"x.csv\"\n" + std::string(keys));
  }

  std::unique_ptr<Plant> plant_;
  std::vector<std::string> events_;
};

TEST_F(DeviceScript, StepsComeToTheMicrosecond) {
  start(
      script("at = \"5s\"\nset = { object = \"2000:00\", value = 3 }\nfor = \"200ms\"\n"
             "[[device.script]]\nwhen = \"Level >= 3\"\nset = { object = \"Offset, signed\", value = -7 }\n"
             "[[device.script]]\nat = \"5.25s\"\nrelease = \"all\"\n"
             "[[device.script]]\nat = \"6000001us\"\nset = { object = \"2003\", value = true }\n"));
  run_until(10s);
  EXPECT_THAT(events_, ElementsAre("5000000 line1 node 2 (io): 2000:00 (Level) forced to 3 until 5.200 s",
                                   "5000000 line1 node 2 (io): 2001:00 (Offset, signed) forced to -7",
                                   "5200000 2000:00 released, 0", "5250000 2001:00 released, 0",
                                   "6000001 line1 node 2 (io): 2003:00 (Switch) forced to true"));
  ASSERT_EQ(plant_->forced().size(), 1U);
  EXPECT_EQ(plant_->forced()[0].object, "2003:00");
}

TEST_F(DeviceScript, TwoRunsAreTheSame) {
  std::vector<std::string> first;
  for (int run = 0; run < 2; ++run) {
    events_.clear();
    start(head +
          "[[device.behaviour]]\nobject = \"2000:00\"\nkind = \"noise\"\nlow = 0\nhigh = 10\nperiod = "
          "\"100ms\"\n"
          "[[device.script]]\nwhen = \"2000:00 > 8\"\nset = { object = \"2001:00\", value = 1 }\nfor = "
          "\"50ms\"\n");
    plant_->bus(0).add_port("peer").plug(true);
    run_until(3s);
    if (run == 0) first = events_;
  }
  EXPECT_EQ(first, events_);
}

TEST_F(DeviceScript, EachMistakeIsSaidWithItsPlace) {
  const auto says = [&](std::string_view keys, std::string_view error) {
    EXPECT_THAT(check(script(keys)), ElementsAre(AllOf(HasSubstr("plant.toml:"), HasSubstr(error)))) << keys;
  };
  says("set = { object = \"2000\", value = 3 }\n",
       ":8:1: device.script: at is missing; expected at = \"5s\" or when");
  says("at = \"1s\"\nwhen = \"2000 > 1\"\nset = { object = \"2000\", value = 3 }\n",
       ":10:8: when = \"2000 > 1\": ");
  says("at = \"1s\"\n", ":8:1: device.script: set is missing; expected set = { object");
  says("at = \"1s\"\nrelease = \"2000\"\nfor = \"1s\"\n", ":11:7: for = \"1s\": expected with set alone");
  says("at = \"1s\"\nset = { object = \"2000\", value = 3 }\nfor = \"0s\"\n",
       "for = \"0s\": expected more than 0");
  says("at = \"1s\"\nset = { object = \"2000\" }\n", ":10:7: set: value is missing; expected a number");
  says("at = \"1s\"\nset = { object = \"2000\", value = 201 }\n",
       ":10:7: script: set: 201 is above the device file's HighLimit 200");
  says("at = \"1s\"\nset = { object = \"2001\", value = 40000 }\n",
       "script: set: 40000 does not fit INTEGER16; expected -32768 to 32767");
  says("at = \"1s\"\nset = { object = \"2001\", value = 1.5 }\n",
       "\"1.5\" is no whole number, as INTEGER16 needs");
  says("at = \"1s\"\nset = { object = \"2006\", value = 1 }\n", "is of type VISIBLE_STRING, not a number");
  says("at = \"1s\"\nset = { object = \"1018:01\", value = 1 }\n",
       "expected a process value, 2000H to FFFFH");
  says("at = \"1s\"\nset = { object = \"3000\", value = 1 }\n", "the device has no object 3000:00");
  says("at = \"1s\"\nset = { object = \"Lvel\", value = 1 }\n", "the device has no value \"Lvel\"");
  says("at = \"1s\"\nset = { object = \"twin\", value = 1 }\n",
       "\"twin\" is the name of more than one object; expected one of 2004:00, 2005:00");
  says("when = \"2000\"\nset = { object = \"2001\", value = 1 }\n",
       ":9:8: script: when: \"2000\" is no condition");
  says("when = \"2000 => 3\"\nset = { object = \"2001\", value = 1 }\n", "\"=>\" compares nothing");
  says("when = \"2000 >= 300\"\nset = { object = \"2001\", value = 1 }\n", "300 does not fit UNSIGNED8");
  says("at = \"1s\"\nset = { object = \"2000\", value = 3, x = 1 }\n",
       "set: unknown key x; expected one of object, value");
  says("at = \"1s\"\nsets = 1\nrelease = \"all\"\n", "device.script: unknown key sets");
}

TEST_F(DeviceScript, AFileIsPlayedBack) {
  support::PlantFolder::write(
      "x.csv",
      "\xEF\xBB\xBFtime;2000:00;\"Offset, signed\";Ratio;switch\r\n0;1;-5;0.5;true\r\n\r\n"
      "0.0000015;0xC8;;1e3;0\r\n2.5;0;7;-1;1\r\n");
  start(head + "[[device.playback]]\nfile = \"x.csv\"\n");
  const auto values = [&] {
    const canopen::ObjectDictionary& dictionary = plant_->device(0).device().node().dictionary();
    return fmt::format("{} {} {} {}", dictionary.get<unsigned>(0x2000, 0),
                       dictionary.get<std::int16_t>(0x2001, 0), dictionary.get<float>(0x2002, 0),
                       dictionary.get<unsigned>(0x2003, 0));
  };
  run_until(1499ns);
  EXPECT_EQ(values(), "1 -5 0.5 1");
  run_until(1500ns);
  EXPECT_EQ(values(), "200 -5 1000 0");
  run_until(3s);
  EXPECT_EQ(values(), "0 7 -1 1");
}

TEST_F(DeviceScript, ABadFileIsSaidWithLineAndColumn) {
  const auto says = [&](std::string_view text, std::string_view error) {
    EXPECT_THAT(csv(text), ElementsAre(HasSubstr(error))) << text;
  };
  says(
      "time,2000:00\n0,300\n",
      "plant.toml:9:8: playback: file = \"x.csv\": x.csv:2:3: 300 does not fit UNSIGNED8; expected 0 to 255");
  says("", "x.csv:1:1: the file is empty; expected a header row");
  says("\n\ntime\n", "x.csv:3:1: expected a header row: the time, then objects");
  says("time,2000:00\n", "x.csv:1:1: there is no row behind the header row");
  says("time,9999\n0,1\n", "x.csv:1:6: the device has no object 9999:00");
  says("time,2000,Level\n0,1,1\n", "x.csv:1:11: 2000:00 has a column already");
  says("time,2000\n0,1,2\n", "x.csv:2:5: 3 fields; expected 2, as the header row has");
  says("time,2000\n0\n", "x.csv:2:2: 1 fields; expected 2");
  says("time,2000\n-1,1\n", "x.csv:2:1: \"-1\" is no time; expected seconds");
  says("time,2000\nnan,1\n", "x.csv:2:1: \"nan\" is no time; expected seconds");
  says("time,2000\n1,1\n1,2\n", "x.csv:3:1: 1 s is not later than the row before");
  says("time,2000\n0,abc\n", "x.csv:2:3: \"abc\" is no whole number");
  says("time,2000\n0,\"1\n", "x.csv:2:3: the quote is not closed");
  says(std::string("time,2000\n0,\0\x1B\n", 15), "x.csv:2:3: ");
  EXPECT_THAT(csv("time,2000\n0,1\n", "repeat = true\n"),
              ElementsAre(HasSubstr("repeat = true needs two rows")));
  EXPECT_THAT(check(head + "[[device.playback]]\nfile = \"none.csv\"\n"),
              ElementsAre(HasSubstr("plant.toml:9:8: playback: file = \"none.csv\": No such file")));
  EXPECT_THAT(csv("time,2000\n0,1\n", "[[device.behaviour]]\nobject = \"2000:00\"\nkind = \"sine\"\n"),
              ElementsAre(HasSubstr("2000:00 moves already")));
}

TEST_F(DeviceScript, AFileHasALimit) {
  const auto device = support::PlantFolder::load(head, *this);
  const auto problem = [&](std::string_view text, const CsvLimits& limits) {
    const auto read = read_playback_csv(text, device->device(0).device(), limits);
    return read ? std::string("taken") : fmt::format("{}: {}", read.error().line, read.error().message);
  };
  EXPECT_EQ(problem("t,2000,2001\n0,1,1\n1,1,1\n2,1,1\n", {.values = 4}), "4: expected at most 4 values");
  EXPECT_EQ(problem("t,2000,2001\n0,1,1\n", {.columns = 1}), "1: 2 objects; expected at most 1");
  EXPECT_EQ(problem("t,2000\n0,1\n", {.bytes = 5}), "0: the file has 11 bytes; expected at most 5");
}

class DeviceControlTest : public DeviceScript {
 protected:
  std::string answer_to(std::string_view request) { return serve::DeviceControl(*plant_).answer(request); }
};

TEST_F(DeviceControlTest, AValueIsForcedLookedAtAndReleased) {
  start(head);
  run_until(1s);
  EXPECT_EQ(answer_to(R"({"request":"set","id":7,"device":"io","object":"2000:00","value":3,"for":"200ms"})"),
            R"({"id":7,"ok":true,"t":1.0,"bus":"line1","node":2,"name":"io","objects":[{"object":"2000:00",)"
            R"("name":"Level","type":"UNSIGNED8","value":3,"forced":true,"beneath":0,"until":1.2}]})"
            "\n");
  EXPECT_EQ(answer_to(R"({"request":"get","device":"2","object":"level"})"),
            R"({"ok":true,"t":1.0,"bus":"line1","node":2,"name":"io","objects":[{"object":"2000:00",)"
            R"("name":"Level","type":"UNSIGNED8","value":3,"forced":true,"beneath":0,"until":1.2}]})"
            "\n");
  EXPECT_THAT(answer_to(R"({"request":"list"})"),
              HasSubstr(R"("devices":[{"bus":"line1","node":2,"name":"io","state":)"));
  EXPECT_THAT(answer_to(R"({"request":"release","device":"line1:2"})"),
              HasSubstr(R"("value":0,"forced":false)"));
  EXPECT_THAT(answer_to(R"({"request":"set","device":"io","object":"2002","value":-0.5})"),
              HasSubstr(R"("value":-0.5)"));
  EXPECT_THAT(answer_to(R"({"request":"set","device":"io","object":"2003","value":true})"),
              HasSubstr(R"("value":true)"));
  EXPECT_THAT(answer_to(R"({"request":"set","device":"io","object":"2001","value":"-7"})"),
              HasSubstr(R"("value":-7)"));
  EXPECT_EQ(plant_->forced().size(), 3U);
}

TEST_F(DeviceControlTest, ATimedForceEndsByItself) {
  start(head);
  run_until(1s);
  answer_to(R"({"request":"set","device":"io","object":"2000:00","value":3,"for":"200ms"})");
  run_until(2s);
  EXPECT_THAT(events_, ElementsAre("1000000 line1 node 2 (io): 2000:00 (Level) forced to 3 until 1.200 s",
                                   "1200000 2000:00 released, 0"));
}

TEST_F(DeviceControlTest, EveryWrongRequestIsAnswered) {
  start(head +
        "[[device]]\nname = \"io\"\nnode = 3\neds = \"io.eds\"\n"
        "[[plc]]\nlisten = \"off\"\n[[plc.module]]\nname = \"rack1\"\nmodel = \"ME3CAN1-Q\"\nnode = 1\n");
  const auto says = [&](std::string_view request, std::string_view error) {
    const std::string answer = answer_to(request);
    EXPECT_THAT(answer, AllOf(HasSubstr(R"("ok":false)"), HasSubstr(error))) << request;
    EXPECT_EQ(std::count(answer.begin(), answer.end(), '\n'), 1) << answer;
  };
  says("", "this is no JSON object");
  says("[]", "this is no JSON object");
  says("\xFF\x00\x1B[2J", "this is no JSON object");
  says(std::string(4000, '['), "this is no JSON object");
  says(R"({"request":"list","id":)" + std::string(64, '[') + std::string(64, ']') + "}",
       "this is no JSON object");
  says("{}", "request is missing; expected a string");
  says(R"({"request":5})", "request: expected a string");
  says(R"({"request":"sett"})", R"(request: \"sett\" is unknown; did you mean \"set\"?)");
  says(R"({"request":"get"})", "device is missing");
  says(R"({"request":"get","device":"io"})",
       "more than one device \\\"io\\\"; expected one of line1:2, line1:3");
  says(R"({"request":"get","device":"rack1"})", "is a module: its values are words of its buffer memory");
  says(R"({"request":"get","device":"x\u001b[2Jy"})", "the plant has no device");
  says(R"({"request":"get","device":"3","object":7})", "object: expected a string");
  says(R"({"request":"set","device":"3","object":"2000"})", "value: expected a number");
  says(R"({"request":"set","device":"3","object":"2000","value":[1]})", "value: expected a number");
  says(R"({"request":"set","device":"3","object":"2000","value":999})", "value: 999 does not fit UNSIGNED8");
  says(R"({"request":"set","device":"3","object":"2000","value":1,"for":"1"})",
       "for: \\\"1\\\" is not a duration");
  says(R"({"request":"set","device":"3","object":"2000","value":1,"for":"0s"})", "for: expected more than 0");
  says(R"({"request":"set","device":"3","object":"2000","value":1,"until":1})",
       "\\\"until\\\" is no field of this request");
  says(R"({"request":"release","device":"3","object":"2000"})", "2000:00 is not forced");
  EXPECT_THAT(plant_->forced(), IsEmpty());
  EXPECT_EQ(answer_to(R"({"request":"get","device":"x\u001b"})").find('\x1B'), std::string::npos);
}

// [RJ71CN91 5.2] Module Information List: LEDs, function mode, baud rate ("-" while Layer 2 is offline), node-ID.
TEST_F(DeviceControlTest, ModulesAreShownAsModuleDiagnosticsShowThem) {
  RecordProperty("spec", "RJ71-DIAG-002");
  start(
      head +
      "[[plc]]\nname = \"a\"\nfamily = \"iQ-R\"\nlisten = \"off\"\n"
      "[[plc.module]]\nmodel = \"RJ71CN91\"\nnode = 7\nrestart_time = \"1s\"\n"
      "[[plc.module]]\nname = \"plain\"\nhead = 0x20\nmodel = \"RJ71CN91\"\nnode = 9\nrestart_time = \"1s\"\n"
      "buffer = { G21 = 29 }\n");
  run_until(2s);
  using Json = nlohmann::json;
  const auto modules = [&](std::string_view request = R"({"request":"modules"})") {
    return Json::parse(answer_to(request))["modules"];
  };
  Json all = modules();
  ASSERT_EQ(all.size(), 2U);
  const Json history = all[0]["history"];
  ASSERT_EQ(history.size(), 1U) << "no error, and none before: " << history;
  EXPECT_EQ(history[0]["title"], "event history");
  EXPECT_EQ(history[0]["lines"].front()["t"].get<double>() >= history[0]["lines"].back()["t"].get<double>(),
            true);
  all[0].erase("history");
  EXPECT_EQ(all[0], Json::parse(R"({"module":"RJ71CN91 U0","plc":"a","bus":"line1","on":true,
    "leds":[{"name":"RUN","pattern":"on"},{"name":"ERR","pattern":"off"},{"name":"CAN ERR","pattern":"off"}],
    "function_mode":405,"function_mode_name":"CANopen, CiA 405","bit_rate":250000,"node":7,"errors":[]})"));
  EXPECT_EQ(all[1]["module"], "plain");
  EXPECT_EQ(all[1]["function_mode"], 29);
  EXPECT_EQ(all[1]["function_mode_name"], "Layer 2, 29-bit identifiers");
  EXPECT_EQ(all[1]["bit_rate"], nullptr);  // offline
  EXPECT_EQ(all[1]["node"], nullptr);
  const auto write = [&](std::uint16_t place, std::uint32_t address, std::uint16_t value) {
    EXPECT_TRUE(plant_->rack(0).write_buffer(place, address, {&value, 1}, plant_->timeline().now()));
  };
  const auto y = [&](std::uint32_t number, std::uint8_t on) {
    EXPECT_TRUE(plant_->rack(0).write_bits(plc::Device::y, number, {&on, 1}, plant_->timeline().now()));
  };
  write(0x20, 24, 125);
  y(0x23, 1);
  write(0, 71, 1);
  run_until(2100ms);
  all = modules();
  EXPECT_EQ(all[1]["bit_rate"], 125000);
  EXPECT_EQ(all[0]["leds"][1], Json::parse(R"({"name":"ERR","pattern":"blinking"})"));
  EXPECT_EQ(all[0]["errors"], Json::parse(R"([{"code":"3000","class":"moderate",
    "overview":"The set parameter value is invalid","details":{"Buffer memory address":71}}])"));
  EXPECT_EQ(all[0]["history"][0]["title"], "errors now");
  const Json& now = all[0]["history"][0]["lines"];
  EXPECT_EQ(now[0]["code"], "3000H");
  EXPECT_EQ(now[1],
            Json::parse(R"({"where":"G29 bit 6","code":"","meaning":"buffer memory setting error"})"));
  EXPECT_EQ(now[2]["where"], "G39");
  y(0x23, 0);
  run_until(2200ms);
  EXPECT_EQ(modules(R"({"request":"modules","module":"plain"})")[0]["bit_rate"], nullptr);
  EXPECT_EQ(modules(R"({"request":"modules","module":"plain"})").size(), 1U);
  plant_->rack(0).power_off(plant_->timeline().now());
  for (const Json& module : modules()) {
    EXPECT_EQ(module.at("on"), false);
    EXPECT_TRUE(module.at("history").empty());
    for (const char* key : {"function_mode", "bit_rate", "node"}) EXPECT_EQ(module.at(key), nullptr) << key;
    for (const Json& led : module.at("leds")) EXPECT_EQ(led.at("pattern"), "off");
  }
  EXPECT_THAT(answer_to(R"({"request":"modules","module":"plane"})"),
              HasSubstr(R"(the plant has no module \"plane\"; did you mean \"plain\"?)"));
  EXPECT_THAT(answer_to(R"({"request":"modules","module":3})"), HasSubstr("module: expected a string"));
  EXPECT_THAT(answer_to(R"({"request":"modules","node":3})"), HasSubstr("is no field of this request"));
}

TEST_F(DeviceControlTest, TheKeyOfThePlantFileSaysWhereItListens) {
  EXPECT_THAT(
      check("[plant]\ncontrol = \"192.168.1.1:29540\"\n" + head),
      ElementsAre(HasSubstr("plant.toml:2:11: control: other machines can reach 192.168.1.1, and the control "
                            "server has no password here")));
  EXPECT_THAT(check("[plant]\ncontrol = \"192.168.1.1:29540\"\nallow = \"192.168.1.7\"\n" + head), IsEmpty());
  const PlantReading reading = read_plant("[plant]\ncontrol = \"127.0.0.1:29540\"\n" + head, "plant.toml");
  ASSERT_TRUE(reading.plant.control.has_value());
  EXPECT_EQ(reading.plant.control->port, 29540);
}

}  // namespace
}  // namespace canopus::plant::device_script_test
