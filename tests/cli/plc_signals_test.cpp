// Signals of a plant by name: which words of which PLC, how a value lies in them, and what is refused.

#include "canopus/cli/plc/plc_signals.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/client/sdo_request.hpp"

#include "support/plant_folder.hpp"

namespace canopus::cli::plc_signals_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;

const std::string objects =
    "[6040]\nParameterName=Controlword\nDataType=6\nAccessType=rww\nPDOMapping=1\n"
    "[6041]\nParameterName=Statusword\nDataType=6\nAccessType=ro\nPDOMapping=1\n"
    "[6060]\nParameterName=Modes of operation\nDataType=2\nAccessType=rww\nPDOMapping=1\n"
    "[6064]\nParameterName=Position actual value\nDataType=4\nAccessType=ro\nPDOMapping=1\n"
    "[6075]\nParameterName=Motor rated current\nDataType=7\nAccessType=rw\nPDOMapping=1\n"
    "[2001]\nParameterName=Ready\nDataType=1\nAccessType=ro\nPDOMapping=1\n"
    "[1400]\nParameterName=RPDO1\nObjectType=9\nSubNumber=2\n"
    "[1400sub0]\nParameterName=n\nDataType=5\nAccessType=const\nDefaultValue=2\n"
    "[1400sub1]\nParameterName=COB-ID\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x200\n"
    "[1400sub2]\nParameterName=Type\nDataType=5\nAccessType=rw\nDefaultValue=255\n"
    "[1600]\nParameterName=Mapping\nObjectType=9\nSubNumber=3\n"
    "[1600sub0]\nParameterName=n\nDataType=5\nAccessType=rw\nDefaultValue=2\n"
    "[1600sub1]\nParameterName=1\nDataType=7\nAccessType=rw\nDefaultValue=0x60600008\n"
    "[1600sub2]\nParameterName=2\nDataType=7\nAccessType=rw\nDefaultValue=0x60400010\n"
    "[1800]\nParameterName=TPDO1\nObjectType=9\nSubNumber=2\n"
    "[1800sub0]\nParameterName=n\nDataType=5\nAccessType=const\nDefaultValue=2\n"
    "[1800sub1]\nParameterName=COB-ID\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x180\n"
    "[1800sub2]\nParameterName=Type\nDataType=5\nAccessType=rw\nDefaultValue=255\n"
    "[1A00]\nParameterName=Mapping\nObjectType=9\nSubNumber=4\n"
    "[1A00sub0]\nParameterName=n\nDataType=5\nAccessType=rw\nDefaultValue=3\n"
    "[1A00sub1]\nParameterName=1\nDataType=7\nAccessType=rw\nDefaultValue=0x20010001\n"
    "[1A00sub2]\nParameterName=2\nDataType=7\nAccessType=rw\nDefaultValue=0x60410010\n"
    "[1A00sub3]\nParameterName=3\nDataType=7\nAccessType=rw\nDefaultValue=0x60640020\n";

std::string drive_file() {
  std::string file = support::device_file(objects);
  const std::string type = "DefaultValue=0x191";
  return file.replace(file.find(type), type.size(), "DefaultValue=0x00020192");
}

class PlcSignals : public support::PlantFolder {
 protected:
  PlcSignals() {
    write("drive.eds", drive_file());
    write_plant("");
  }
  void write_plant(const std::string& plc_keys) const {
    write("plant.toml",
          "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[device]]\nname = \"drive\"\nnode = 4\neds = "
          "\"drive.eds\"\n[[plc]]\nname = \"plc1\"\nlisten = \"127.0.0.1:5107\"\n" +
              plc_keys +
              "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x20\nnode = 1\nmaster = true\nslaves = "
              "\"all\"\n");
  }
  std::expected<PlcSignal, std::string> find(const std::string& name) const {
    PlcArguments arguments;
    arguments.plant = path();
    arguments.address = name;
    return find_signal(arguments);
  }
  std::string place(const std::string& name) const {
    const auto signal = find(name);
    return signal ? signal->name + " " + signal->place : signal.error();
  }
  std::string shown(const std::string& name, const Words& words) const {
    const auto signal = find(name);
    if (!signal) return signal.error();
    const auto text = client::show_value(signal->target, value_in_words(*signal, words));
    return text ? *text : text.error();
  }
};

TEST_F(PlcSignals, ByNumberOrName_AreTheWordsOfTheirPdo) {
  EXPECT_EQ(place("drive.6041"), "drive.6041:00 U2\\G10000.1-G10001.0");
  EXPECT_EQ(place("drive.Statusword"), place("drive.6041"));
  EXPECT_EQ(place("DRIVE.statusword"), place("drive.6041"));
  EXPECT_EQ(place("4.6041:00"), place("drive.6041"));
  EXPECT_EQ(place("line1:drive.Position actual value"), "drive.6064:00 U2\\G10001.1-G10003.0");
  EXPECT_EQ(place("drive.Ready"), "drive.2001:00 U2\\G10000 bit 0");
  EXPECT_EQ(place("drive.6060"), "drive.6060:00 U2\\G13000 bits 0-7");
  EXPECT_EQ(find("drive.6041")->port, 5107);
}

/// Worked out by hand: a bit, then 16 bits from bit 1 of G10000 to bit 0 of G10001, then 32 from bit 1 of G10001 on.
TEST_F(PlcSignals, AValueIsTakenOutOfItsBits_AndShownInWords) {
  // Statusword 0637H << 1 | Ready 1 = 0C6FH, bit 16 is 0.
  EXPECT_EQ(shown("drive.6041", {0x0C6F, 0x0000}),
            "1591  0637H  operation enabled (ready to switch on, switched on, voltage enabled, quick stop, "
            "remote, target reached)");
  EXPECT_EQ(shown("drive.Ready", {0x0C6F}), "true");
  EXPECT_EQ(shown("drive.Ready", {0x0C6E}), "false");
  // -2 = FFFFFFFEH from bit 17 on: bits 18 to 48 are 1.
  EXPECT_EQ(shown("drive.6064", {0xFFFC, 0xFFFF, 0x0001}), "-2  FFFFFFFEH");
}

TEST_F(PlcSignals, AWrittenValue_LeavesTheOtherBitsOfItsWords) {
  const auto mode = find("drive.6060");
  ASSERT_TRUE(mode) << mode.error();
  EXPECT_TRUE(mode->at.is_output);
  EXPECT_THAT(words_with_value(*mode, {0xAB00}, {0x03}), ElementsAre(0xAB03));
  const auto control = find("drive.6040");
  ASSERT_TRUE(control) << control.error();
  EXPECT_THAT(words_with_value(*control, {0xFF03, 0x5500}, {0x0F, 0x80}), ElementsAre(0x0F03, 0x5580));
}

TEST_F(PlcSignals, WhatIsNotThere_IsRefusedWithWhatIsNear) {
  EXPECT_EQ(place("drvie.6041"), "there is no node \"drvie\"; did you mean \"drive\"?");
  EXPECT_THAT(place("drive.Statuswort"), HasSubstr("Statusword"));
  EXPECT_EQ(
      place("drive.6075"),
      "6075:00 (Motor rated current) of line1:4 (drive) is in no PDO that the module of a PLC exchanges; "
      "exchanged: 2001:00 (Ready), 6041:00 (Statusword), 6064:00 (Position actual value), 6060:00 (Modes of "
      "operation), 6040:00 (Controlword)");
  EXPECT_EQ(place("drive"), "\"drive\" is not a signal; expected NODE.OBJECT, for example drive.6041");
}

/// The CPU's refresh writes the words of TPDOs over whatever a client has written there: the devices count.
TEST_F(PlcSignals, WhatTheRefreshCopies_IsInTheDevicesOfTheCpu) {
  write("plant.toml",
        "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[device]]\nname = \"drive\"\nnode = 4\neds = "
        "\"drive.eds\"\n"
        "[[plc]]\nname = \"plc1\"\nlisten = \"127.0.0.1:5107\"\n[[plc.module]]\nmodel = \"RJ71CN91\"\nhead = "
        "0\nnode = "
        "1\nmaster = true\nslaves = \"all\"\n[plc.module.parameters]\ndata_exchange = \"refresh\"\nrefresh = "
        "{ G10000 = "
        "\"D1000\", G13000 = \"W20\" }\n");
  EXPECT_EQ(place("drive.6041"), "drive.6041:00 D1000.1-D1001.0");
  EXPECT_EQ(place("drive.6060"), "drive.6060:00 W20 bits 0-7");
}

TEST_F(PlcSignals, AnAddressIsNoSignal) {
  PlcArguments arguments;
  arguments.plant = path();
  for (const char* address : {"D100", "U0\\G25", "X1F"}) {
    arguments.address = address;
    EXPECT_FALSE(is_signal(arguments)) << address;
  }
  arguments.address = "drive.6041";
  EXPECT_TRUE(is_signal(arguments));
  arguments.at = "127.0.0.1:29540";  // a variable, then
  EXPECT_FALSE(is_signal(arguments));
}

}  // namespace
}  // namespace canopus::cli::plc_signals_test
