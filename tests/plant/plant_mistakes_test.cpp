// The mistakes that people make in their first plant files: what is written, and the whole message for it.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::plant::plant_mistakes_test {
namespace {

using testing::ElementsAreArray;

constexpr std::string_view bus = "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n";  // lines 1 to 3
constexpr std::string_view device = "[[device]]\nnode = 2\neds = \"io.eds\"\n";      // lines 4 to 6
constexpr std::string_view rack =
    "[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nnode = 1\n";  // lines 4 to 7

struct Mistake {
  std::string written;  // behind the bus
  std::vector<std::string> messages;
};

std::string with(std::string_view before, std::string_view line) {
  return std::string(before) + std::string(line) + "\n";
}

const Mistake mistakes[] = {
    // Quotes.
    {with("[[device]]\n", "name = io"), {"p.toml:5:9: text must be in quotes: name = \"io\""}},
    {with("[[device]]\n", "name = io-block # left"),
     {"p.toml:5:9: text must be in quotes: name = \"io-block\""}},
    {with("[[device]]\n", "name = 'io"), {"p.toml:5:11: the closing quote is missing: name = \"io\""}},
    {with("[[device]]\n", "name: \"io\""), {"p.toml:5:5: expected \"=\" after a key: name = \"io\""}},
    {with("[[device]]\n", "name ="), {"p.toml:5:7: name has no value"}},
    {with("[[device]]\n", "name = 5"),
     {"p.toml:4:1: device: eds is missing: the device file, or a node of the bus's project",
      "p.toml:5:8: name = 5: expected text in quotes"}},
    {with(device, "start = 20ms"), {"p.toml:7:11: a time must be in quotes: start = \"20ms\""}},
    {with(device, "[[device.behaviour]]\nkind = \"sine\"\nobject = 6000:01"),
     {"p.toml:9:12: an object must be in quotes: object = \"6000:01\""}},
    {with(device, "objects = { 1017:00 = 500 }"),
     {"p.toml:7:17: a key with \":\" must be in quotes: objects = { \"1017:00\" = ... }"}},
    // Units.
    {with(device, "start = 20"),
     {"p.toml:7:9: start = 20: expected a time with a unit in quotes, for example \"20ms\""}},
    {with(device, "start = \"20\""),
     {"p.toml:7:9: start = \"20\" is not a duration; expected a number and a unit (ns, us, ms, s, min, h), "
      "for example \"10ms\""}},
    {with(device, "bit_rate = 250k"),
     {"p.toml:7:15: bit_rate = 250k: expected a number without a unit, or text in quotes"}},
    {with(device, "bit_rate = \"250k\""),
     {"p.toml:7:12: bit_rate = \"250k\": expected a bit rate in bit/s, for example 250_000"}},
    {with(device, "bit_rate = 250"),
     {"p.toml:7:12: bit_rate = 250: expected one of 10000, 20000, 50000, 100000, 125000, 250000, 500000, "
      "800000, 1000000 bit/s"}},
    {with(rack, "exchange = 20"),
     {"p.toml:8:12: exchange = 20: expected a time with a unit in quotes, for example \"20ms\""}},
    // True and false.
    {with(device, "listen_only = yes"), {"p.toml:7:15: listen_only = yes: expected true or false"}},
    {with(device, "listen_only = \"true\""), {"p.toml:7:15: listen_only = \"true\": expected true or false"}},
    // Kinds of tables.
    {"[device]\nnode = 2\neds = \"io.eds\"\n",
     {"p.toml:4:1: [device] must be written [[device]]: there can be several"}},
    {"[plc]\nname = \"plc1\"\n", {"p.toml:4:1: [plc] must be written [[plc]]: there can be several"}},
    {with(device, "[[device.drive]]"),
     {"p.toml:7:1: [[device.drive]] must be written [device.drive]: there is only one"}},
    {with(device, "[device.behaviour]\nobject = \"6000:01\"\nkind = \"sine\""),
     {"p.toml:7:1: [device.behaviour] must be written [[device.behaviour]]: there can be several"}},
    {with(device, "objects = [ 1 ]"),
     {"p.toml:7:11: objects = an array: expected a table, for example { \"1017:00\" = 1000 }"}},
    {"[[module]]\nmodel = \"ME3CAN1-Q\"\n",
     {"p.toml:4:1: module must be written [[plc.module]], below its own table"}},
    {with(device, "[[behaviour]]\nobject = \"6000:01\"\nkind = \"sine\""),
     {"p.toml:7:1: behaviour must be written [[device.behaviour]], below its own table"}},
    // Names of keys.
    {with(device, "nmae = \"io\""), {"p.toml:7:1: device: unknown key nmae; did you mean name?"}},
    {with(device, "baudrate = 250_000"),
     {"p.toml:7:1: device: unknown key baudrate; did you mean bit_rate?"}},
    {with(device, "[[device.behavior]]\nobject = \"6000:01\"\nkind = \"sine\""),
     {"p.toml:7:10: device: unknown key behavior; did you mean behaviour?"}},
    {with("[[device]]\nnode_id = 2\n", "eds = \"io.eds\""),
     {"p.toml:5:1: device: unknown key node_id; did you mean node?"}},
    {with(rack, "position = 0"), {"p.toml:8:1: plc.module: unknown key position; did you mean head?"}},
    // Values that belong elsewhere.
    {with("[[device]]\nnode = \"2\"\n", "eds = \"io.eds\""),
     {"p.toml:5:8: node = \"2\": a node-ID is 1 to 127, or \"unconfigured\" for a device that gets it by "
      "LSS"}},
    {with(device, "[[device.behaviour]]\nobject = \"6000:01\"\nkind = \"sinus\""),
     {"p.toml:9:8: kind = \"sinus\": expected one of sine, ramp, counter, echo, noise"}},
    {"[[plc]]\n[[plc.module]]\nmodel = \"FX3U-CAN\"\nposition = 0\nnode = 1\n",
     {"p.toml:6:9: model = \"FX3U-CAN\": its [[plc]] needs family = \"FX3\" or \"FX5\"; this one has "
      "\"iQ-R\""}},
    {"[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1\"\nnode = 1\n",
     {"p.toml:6:9: model = \"ME3CAN1\": expected one of \"ME3CAN1-Q\", \"RJ71CN91\", \"FX3U-CAN\", "
      "\"FX2N-32CAN\", \"AS-FCOPM\""}},
    {with(rack, "master = true\n[[plc.module.slave]]\nnode = 2\nreceive = [{ pdo = 1, at = 10000 }]") +
         std::string(device),
     {"p.toml:11:28: at = 10000: expected \"G10000\""}},
    {with(device, "[[plc]]\nlisten = 5007"),
     {"p.toml:8:10: listen = 5007: expected an address in quotes, for example \"127.0.0.1:5007\""}},
};

TEST(PlantMistakes, EachHasItsMessage) {
  for (const Mistake& mistake : mistakes) {
    SCOPED_TRACE(mistake.written);
    std::vector<std::string> messages;
    for (const text::FileError& error : read_plant(std::string(bus) + mistake.written, "p.toml").errors)
      messages.push_back(text::describe(error, "p.toml"));
    EXPECT_THAT(messages, ElementsAreArray(mistake.messages));
  }
}

}  // namespace
}  // namespace canopus::plant::plant_mistakes_test
