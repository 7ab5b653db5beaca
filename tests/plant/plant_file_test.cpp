

#include "plant/good_plant.hpp"

namespace canopus::plant::plant_file_test {
namespace {

TEST(PlantFile, TooDeep_IsRefusedWithItsLine) {
  std::string deep = "[plant]\nname = \"x\"\n[a";
  for (int i = 0; i < 40'000; ++i) deep += ".a";
  const PlantReading reading = read_plant(deep + "]\n", "plant.toml");
  ASSERT_EQ(reading.errors.size(), 1U);
  EXPECT_EQ(text::describe(reading.errors[0], "plant.toml"),
            "plant.toml:3:129: tables and arrays, or the parts of a key, are nested deeper than 64 levels; "
            "expected at most 64");
}

/// A plant of so many tables, each with a name of its own.
std::string many(std::size_t count, std::string_view table, std::string_view rest) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i)
    text += fmt::format("[[{}]]\nname = \"{}{}\"\n{}\n", table, table, i, rest);
  return text;
}

TEST(PlantFile, TooManyBusesOrPlcs_AreRefusedWithTheirNumber) {
  const auto errors = [](const std::string& text) {
    std::vector<std::string> lines;
    for (const text::FileError& error : read_plant(text, "p.toml").errors)
      lines.push_back(text::describe(error, "p.toml"));
    return lines;
  };
  EXPECT_THAT(errors(many(256, "bus", "bit_rate = 250_000")), IsEmpty());
  EXPECT_THAT(errors(many(20'000, "bus", "bit_rate = 250_000")),
              ElementsAre("p.toml:769:1: the plant has 20000 buses; expected at most 256"));
  EXPECT_THAT(errors(many(1, "bus", "bit_rate = 250_000") + many(257, "plc", "cpu = \"stop\"")),
              ElementsAre("p.toml:772:1: the plant has 257 PLCs; expected at most 256"));
}

TEST(PlantFile, EverythingThatIsWrittenIsRead) {
  const PlantReading reading = read_plant(good_plant, "plant.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  const PlantFile& plant = reading.plant;
  EXPECT_EQ(plant.name, "press line");
  EXPECT_EQ(plant.seed, 7U);
  ASSERT_EQ(plant.buses.size(), 1U);
  EXPECT_EQ(plant.buses[0].bit_rate, 250'000U);
  EXPECT_EQ(plant.buses[0].socketcand->port, 29536);

  ASSERT_EQ(plant.devices.size(), 1U);
  const DeviceSection& device = plant.devices[0];
  EXPECT_EQ(device.bus, "line1") << "the only bus is meant where none is named";
  EXPECT_EQ(device.start, 1500ms);
  EXPECT_FALSE(device.short_sdo_requests);
  ASSERT_EQ(device.objects.size(), 2U);
  EXPECT_EQ(device.objects[0].object, (text::ObjectName{0x1017, 0}));
  EXPECT_EQ(std::get<std::int64_t>(device.objects[0].value), 500);
  EXPECT_EQ(device.objects[1].object, (text::ObjectName{0x2000, 0x0A}));
  EXPECT_EQ(std::get<std::string>(device.objects[1].value), "text");
  ASSERT_EQ(device.behaviours.size(), 1U);
  EXPECT_EQ(device.behaviours[0].low, -10);
  EXPECT_EQ(device.behaviours[0].high, 4095.5);
  EXPECT_EQ(device.behaviours[0].period, 4s);

  ASSERT_EQ(plant.plcs.size(), 1U);
  EXPECT_EQ(plant.plcs[0].ports[0].listen.host, "127.0.0.1");
  EXPECT_EQ(plant.plcs[0].ports[0].listen.port, 5008);
  EXPECT_FALSE(plant.plcs[0].run);
  const ModuleSection& module = plant.plcs[0].modules.at(0);
  EXPECT_EQ(module.head, 0x30);
  EXPECT_TRUE(module.master);
  EXPECT_EQ(module.exchange, 20ms);
  EXPECT_TRUE(module.recover);
  EXPECT_EQ(module.restart_time, 100ms);
  EXPECT_EQ(module.buffer.at(0).address, 70U);
  EXPECT_EQ(module.buffer.at(0).value, 1000);
  EXPECT_THAT(module.watch, ElementsAre(25U, 10000U));
  const SlaveSection& slave = module.slaves.at(0);
  EXPECT_FALSE(slave.mandatory);
  ASSERT_EQ(slave.receive.size(), 2U);
  EXPECT_EQ(slave.receive[1].pdo, 2);
  EXPECT_EQ(slave.receive[1].address, 10020U);
  EXPECT_EQ(slave.send.size(), 1U);
}

TEST(PlantFile, AnErrorOfSyntaxHasItsLineAndColumn) {
  const auto errors = errors_of("[plant]\nname = \n");
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], HasSubstr("plant.toml:2:8: "));
}

struct WrongLine {
  std::string_view from;
  std::string_view to;
  std::string_view error;
};

class PlantFileWithOneMistake : public testing::TestWithParam<WrongLine> {};

TEST_P(PlantFileWithOneMistake, NamesPlaceFindingAndExpectation) {
  std::string text(good_plant);
  const std::size_t place = text.find(GetParam().from);
  ASSERT_NE(place, std::string::npos);
  text.replace(place, GetParam().from.size(), GetParam().to);
  EXPECT_THAT(errors_of(text), ElementsAre(std::string(GetParam().error)));
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, PlantFileWithOneMistake,
    testing::Values(
        WrongLine{"node = 3\nname", "node = 128\nname", "plant.toml:11:8: node = 128: a node-ID is 1 to 127"},
        WrongLine{
            "node = 3\nname", "node = \"none\"\nname",
            "plant.toml:11:8: node = \"none\": a node-ID is 1 to 127, or \"unconfigured\" for a device that "
            "gets it by LSS"},
        WrongLine{"node = 3\nname", "node = 3\nlss = 1\nname",
                  "plant.toml:12:7: lss = 1: expected true or false"},
        WrongLine{"bit_rate = 250_000", "bit_rate = 300_000",
                  "plant.toml:7:12: bit_rate = 300000: expected one of 10000, 20000, 50000, 100000, 125000, "
                  "250000, "
                  "500000, 800000, 1000000 bit/s"},
        WrongLine{"bit_rate = 250_000", "bit_rate = \"fast\"",
                  "plant.toml:7:12: bit_rate = \"fast\": expected a bit rate in bit/s, for example 250_000"},
        WrongLine{"kind = \"ramp\"", "kind = \"rampe\"",
                  "plant.toml:19:8: kind = \"rampe\": expected one of sine, ramp, counter, echo, noise"},
        WrongLine{"object = \"6004:00\"", "object = \"60040:00\"",
                  "plant.toml:18:10: object = \"60040:00\" is not an object; expected index:sub-index in "
                  "hexadecimal, "
                  "for example \"6000:01\""},
        WrongLine{
            "period = \"4s\"", "period = \"4\"",
            "plant.toml:22:10: period = \"4\" is not a duration; expected a number and a unit (ns, us, ms, "
            "s, min, "
            "h), for example \"10ms\""},
        WrongLine{"high = 4095.5", "high = -11", "plant.toml:21:8: high = -11: must not be below low = -10"},
        WrongLine{"low = -10", "low = nan", "plant.toml:20:7: low = nan: expected a number"},
        WrongLine{"high = 4095.5", "high = inf", "plant.toml:21:8: high = inf: expected a number"},
        WrongLine{"cpu = \"stop\"", "cpu = \"halt\"",
                  "plant.toml:27:7: cpu = \"halt\": expected \"run\" or \"stop\""},
        WrongLine{"head = 0x30", "head = 0x31",
                  "plant.toml:32:8: head = 49: a head I/O number is a multiple of 10H from 0 to 0FF0H"},
        WrongLine{"model = \"ME3CAN1-Q\"", "model = \"ME3CAN2\"",
                  "plant.toml:31:9: model = \"ME3CAN2\": expected one of \"ME3CAN1-Q\", \"RJ71CN91\", "
                  "\"FX3U-CAN\", \"FX2N-32CAN\", \"AS-FCOPM\""},
        WrongLine{"G70 = 1000", "G70 = 65536", "plant.toml:37:18: G70 = 65536: a word is -32768 to 65535"},
        WrongLine{"G70 = 1000", "X70 = 1000",
                  "plant.toml:37:12: \"X70\" is not a buffer memory address; expected G0 to G65535"},
        WrongLine{
            "send = 1", "send = 513",
            "plant.toml:45:8: send = 513: expected a PDO number 1 to 512, or { pdo = 1, at = \"G10000\" }"},
        WrongLine{"node = 3\nmandatory", "node = 1\nmandatory",
                  "plant.toml:42:8: slave: node 1 is the module itself; expected another node"},
        WrongLine{"master = true", "master = false", "plant.toml:30:1: slaves need master = true"},
        WrongLine{"serve = \"socketcand:", "serve = \"udp:",
                  "plant.toml:8:9: serve = \"udp:127.0.0.1:29536\" is not a way to serve a bus; expected "
                  "\"socketcand:127.0.0.1:29536\""},
        WrongLine{"listen = \":5008\"", "listen = \"127.0.0.300:80\"",
                  "plant.toml:26:10: listen: \"127.0.0.300\" is not an address; expected numbers such as "
                  "192.168.1.7 or fd00::7, or localhost"},
        WrongLine{
            "listen = \":5008\"", "listen = \"127.0.0.1:70000\"",
            "plant.toml:26:10: listen = \"127.0.0.1:70000\" has port 70000, and the highest port is 65535; "
            "expected for example \"127.0.0.1:5007\""},
        WrongLine{"listen = \":5008\"", "listen = \"here\"",
                  "plant.toml:26:10: listen = \"here\" is not host:port; expected for example "
                  "\"127.0.0.1:5007\""},
        WrongLine{"node = 1\nmaster", "node = 3\nmaster",
                  "plant.toml:30:1: module: node 3 of bus \"line1\" is taken already, in line 10"}));

TEST(PlantFile, AMisspeltKeyIsAMistakeWithTheNearestKeyOrAllThatExist) {
  const auto misspelt = [](const std::string& key) {
    return errors_of("[[bus]]\nname = \"a\"\nbit_rate = 250000\n" + key + " = 1\n");
  };
  EXPECT_THAT(misspelt("bitrate"),
              ElementsAre("plant.toml:4:1: bus: unknown key bitrate; did you mean bit_rate?"));
  EXPECT_THAT(misspelt("colour"),
              ElementsAre("plant.toml:4:1: bus: unknown key colour; expected one of allow, "
                          "announce, bit_rate, fault, line, link, name, project, project_network, serve"));
}

TEST(PlantFile, AllMistakesAreFoundAtOnceInTheOrderOfTheFile) {
  const auto errors = errors_of("[[bus]]\nname = \"a\"\nbit_rate = 1\n[[device]]\nnode = 0\n");
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_THAT(errors[0], HasSubstr("plant.toml:3:12: bit_rate"));
  EXPECT_THAT(errors[1], HasSubstr("plant.toml:4:1: device: eds is missing"));
  EXPECT_THAT(errors[2], HasSubstr("plant.toml:5:8: node = 0"));
}

TEST(PlantFile, DevicesThatGetTheirNodeIdByLss) {
  constexpr std::string_view bus = "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n";
  const std::string two = std::string(bus) +
                          "[[device]]\neds = \"x.eds\"\nnode = \"unconfigured\"\n"
                          "[[device]]\neds = \"x.eds\"\nnode = \"unconfigured\"\nlss = true\n"
                          "[[device]]\neds = \"x.eds\"\nnode = 5\nlss = false\n";
  const PlantReading reading = read_plant(two, "plant.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  EXPECT_EQ(reading.plant.devices[0].node, 0xFF);
  EXPECT_EQ(reading.plant.devices[0].lss, std::nullopt);
  EXPECT_EQ(reading.plant.devices[1].lss, true);
  EXPECT_EQ(reading.plant.devices[2].lss, false);
  EXPECT_THAT(
      errors_of(std::string(bus) + "[[device]]\neds = \"x.eds\"\nnode = \"unconfigured\"\nlss = false\n"),
      ElementsAre(
          "plant.toml:7:7: lss = false: a device without a node-ID gets one by LSS: true, or left out"));
}

TEST(PlantFile, WithSeveralBusesADeviceMustNameItsOwn) {
  const auto errors = errors_of(
      "[[bus]]\nname = \"a\"\nbit_rate = 250000\n[[bus]]\nname = \"b\"\nbit_rate = 250000\n"
      "[[device]]\nnode = 1\neds = \"x.eds\"\n");
  EXPECT_THAT(errors, ElementsAre("plant.toml:7:1: device: bus is missing; expected one of a, b"));
}

TEST(PlantFile, ModulesMustNotShareTheirPoints) {
  const auto errors = errors_of(
      "[[bus]]\nname = \"a\"\nbit_rate = 250000\n[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = "
      "0x00\n"
      "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x10\n");
  EXPECT_THAT(errors, ElementsAre("plant.toml:8:1: the module at head 010H overlaps the one in line 5"));
}

TEST(PlantFile, ModulesSideBySideAreNoMistake) {
  EXPECT_THAT(errors_of("[[bus]]\nname = \"a\"\nbit_rate = 250000\n[[plc]]\n"
                        "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x20\n"
                        "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x00\n"),
              IsEmpty());
}

TEST(PlantFile, AModelInSmallLettersIsTheSameModel) {
  const PlantReading reading = read_plant(
      "[[bus]]\nname = \"a\"\nbit_rate = 250000\n[[plc]]\n[[plc.module]]\nmodel = \"me3can1-q\"\nhead = 0\n",
      "plant.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  EXPECT_EQ(reading.plant.plcs[0].modules[0].model, "ME3CAN1-Q") << "as the store's folder is named";
}

TEST(PlantFile, OneObjectTwice_IsAMistakeHoweverItIsWritten) {
  const std::string head = "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n";
  const std::string device = head + "[[device]]\nnode = 1\neds = \"x.eds\"\n";
  EXPECT_THAT(errors_of(device + "[device.objects]\n\"1017:00\" = 1\n\"0x1017\" = 2\n"),
              ElementsAre("plant.toml:9:1: objects: 1017:00 is there already, in line 8"));
  EXPECT_THAT(errors_of(device + "[[device.behaviour]]\nobject = \"6000:01\"\nkind = \"sine\"\n"
                                 "[[device.behaviour]]\nobject = \"6000H:1\"\nkind = \"ramp\"\n"),
              ElementsAre("plant.toml:10:1: behaviour: 6000:01 moves already, by the one in line 7"));
  EXPECT_THAT(errors_of(head + "[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\n"
                               "buffer = { G70 = 1, g070 = 2 }\n"),
              ElementsAre("plant.toml:8:21: buffer: G70 is there already, in line 8"));
}

TEST(PlantFile, OneSlaveTwice_IsAMistake) {
  EXPECT_THAT(
      errors_of("[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[device]]\nnode = 3\neds = \"x.eds\"\n"
                "[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nmaster = true\n"
                "[[plc.module.slave]]\nnode = 3\n[[plc.module.slave]]\nnode = 3\n"),
      ElementsAre("plant.toml:15:8: slave: node 3 is assigned already, in another [[plc.module.slave]]"));
}

}  // namespace
}  // namespace canopus::plant::plant_file_test
