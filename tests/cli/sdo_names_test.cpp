// Nodes and objects of `canopus sdo` by number and by name, out of a plant, a project and a device file; and their values in
// words.

#include "canopus/cli/bus/sdo_names.hpp"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::cli::sdo_names_test {
namespace {

using canopen::DataType;
using client::SdoTarget;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Bytes = std::vector<std::uint8_t>;

const std::string drive_objects =
    "[6040]\nParameterName=Controlword\nDataType=6\nAccessType=rww\n"
    "[6041]\nParameterName=Statusword\nDataType=6\nAccessType=ro\n"
    "[6060]\nParameterName=Modes of operation\nDataType=2\nAccessType=rw\nLowLimit=-1\nHighLimit=10\n"
    "[6064]\nParameterName=Position actual value\nDataType=4\nAccessType=ro\n"
    "[606C]\nParameterName=Velocity actual value\nDataType=4\nAccessType=ro\n"
    "[6075]\nParameterName=Motor rated current\nDataType=7\nAccessType=rw\nHighLimit=5000\n"
    "[2001]\nParameterName=Limit\nDataType=5\nAccessType=rw\nLowLimit=10\n"
    "[2002]\nParameterName=Ratio\nDataType=8\nAccessType=rw\nLowLimit=0.5\nHighLimit=2\n"
    "[2003]\nParameterName=Twin\nDataType=5\nAccessType=rw\n"
    "[2004]\nParameterName=Twin\nDataType=5\nAccessType=rw\n"
    "[1017]\nParameterName=Producer heartbeat time\nDataType=6\nAccessType=rw\n";

std::string drive_file() {
  std::string file = support::device_file(drive_objects);
  const std::string type = "DefaultValue=0x191";
  return file.replace(file.find(type), type.size(), "DefaultValue=0x00020192");
}

class SdoNames : public support::PlantFolder {
 protected:
  SdoNames() {
    write("drive.eds", drive_file());
    write("io.eds", support::device_file(""));
    write("plant.toml",
          "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[bus]]\nname = \"line2\"\nbit_rate = 250_000\n"
          "[[device]]\nbus = \"line1\"\nname = \"servo\"\nnode = 5\neds = \"drive.eds\"\n"
          "[[device]]\nbus = \"line1\"\nname = \"inputs\"\nnode = 2\neds = \"io.eds\"\n"
          "[[device]]\nbus = \"line2\"\nname = \"inputs\"\nnode = 7\neds = \"io.eds\"\n"
          "[[device]]\nbus = \"line2\"\nname = \"valve\"\nnode = 2\neds = \"io.eds\"\n");
    names_.nodes.plant = path();
  }
  std::expected<SdoTarget, std::string> find(const std::string& node, const std::string& object,
                                             const std::string& type = "") const {
    return find_sdo_target(names_, node, object, type);
  }
  /// "5 6064:00 i32"
  std::string found(const std::string& node, const std::string& object, const std::string& type = "") const {
    const auto target = find(node, object, type);
    if (!target) return target.error();
    return std::to_string(target->node) + " " + target->object_text() + " " + target->type_name;
  }
  std::string shown(const std::string& object, const Bytes& bytes) const {
    const auto target = find("servo", object);
    return target ? target->object_title() + "  " + client::show_value(*target, bytes).value()
                  : target.error();
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  SdoNamesOptions names_;
};

TEST_F(SdoNames, NumbersInEveryNotation_AreTheObjectWithTheTypeOfTheFile) {
  for (const char* object : {"Position actual value", "position actual value", "0x6064", "6064:00", "6064",
                             "6064H", "6064:00", "0x6064:0x0"}) {
    EXPECT_EQ(found("servo", object), "5 6064:00 i32") << object;
  }
  EXPECT_EQ(found("5", "6064"), "5 6064:00 i32");
  EXPECT_EQ(found("0x05", "Statusword"), "5 6041:00 u16");
  EXPECT_EQ(found("SERVO", "1018:01"), "5 1018:01 u32");
}

TEST_F(SdoNames, Type_CountsBeforeThatOfTheFile) {
  EXPECT_EQ(found("servo", "6064", "u32"), "5 6064:00 u32");
  EXPECT_EQ(found("servo", "6064", "f33"), "--type: \"f33\" is not a type; did you mean \"f32\"?");
}

TEST_F(SdoNames, ObjectThatTheFileDoesNotHave_IsBytes) {
  EXPECT_EQ(found("servo", "3000:01"), "5 3000:01 ");
  EXPECT_EQ(found("servo", "3000:01", "u8"), "5 3000:01 u8");
}

TEST_F(SdoNames, AmbiguousNode_IsAnErrorThatNamesThem) {
  EXPECT_EQ(found("inputs", "1000"),
            "\"inputs\" is one of line1:2 (inputs), line2:7 (inputs); expected BUS:NODE");
  EXPECT_EQ(found("2", "1000"), "\"2\" is one of line1:2 (inputs), line2:2 (valve); expected BUS:NODE");
  EXPECT_EQ(found("line2:inputs", "1000"), "7 1000:00 u32");
  EXPECT_EQ(found("line2:2", "1000"), "2 1000:00 u32");
}

TEST_F(SdoNames, UnknownNode_IsAnErrorThatNamesTheNearest) {
  EXPECT_EQ(found("sevro", "1000"), "there is no node \"sevro\"; did you mean \"servo\"?");
  EXPECT_EQ(found("pump", "1000"), "there is no node \"pump\"; expected servo, inputs or valve");
  EXPECT_EQ(found("line9:servo", "1000"),
            "there is no node \"line9:servo\"; expected servo, inputs or valve");
}

TEST_F(SdoNames, UnknownObject_IsAnErrorThatNamesTheNearest) {
  EXPECT_EQ(found("servo", "Statuswrod"),
            "line1:5 (servo) has no object \"Statuswrod\"; did you mean 6041:00 (Statusword)?");
  EXPECT_EQ(found("servo", "actual value"),
            "line1:5 (servo) has no object \"actual value\"; did you mean 6064:00 (Position actual value), "
            "606C:00 (Velocity actual value)?");
  EXPECT_EQ(found("servo", "Twin"),
            "line1:5 (servo): \"Twin\" is the name of 2003:00 (Twin), 2004:00 (Twin)");
  EXPECT_THAT(found("servo", "xyz"), HasSubstr("expected index:sub-index in hexadecimal"));
}

TEST_F(SdoNames, DeviceFile_GivesTheTypesOfANodeThatNoPlantNames) {
  names_ = {.eds = file("drive.eds")};
  EXPECT_EQ(found("60", "Statusword"), "60 6041:00 u16");
  EXPECT_THAT(found("servo", "Statusword"),
              StartsWith("\"servo\" is not a node; expected a node-ID 1 to 127"));
  names_.eds = file("none.eds");
  EXPECT_THAT(found("60", "6041"), StartsWith("--eds: "));
}

TEST_F(SdoNames, DeviceFile_CountsBeforeThatOfThePlant) {
  names_.eds = file("drive.eds");
  EXPECT_EQ(found("valve", "Statusword"), "2 6041:00 u16");
}

TEST_F(SdoNames, Project_GivesNamesAndTypes) {
  write("drive.dcf", drive_file() + "[DeviceComissioning]\nNodeID=9\nNodeName=lifter\nBaudrate=250\n");
  write("nodelist.cpj", "[Topology]\nNodes=1\nNode9Present=1\nNode9Name=lifter\nNode9DCFName=drive.dcf\n");
  for (const std::string& project : {folder_.string(), file("nodelist.cpj")}) {
    names_ = {.nodes = {.project = project}};
    EXPECT_EQ(found("lifter", "Statusword"), "9 6041:00 u16");
    EXPECT_EQ(found("9", "606C"), "9 606C:00 i32");
  }
  names_ = {.eds = file("drive.dcf")};
  EXPECT_EQ(found("lifter", "Statusword"), "9 6041:00 u16") << "a DCF has the node's name";
  names_ = {.nodes = {.project = file("none")}};
  EXPECT_THAT(found("lifter", "Statusword"), StartsWith(file("none")));
}

TEST_F(SdoNames, WithoutAFile_NumbersAlone) {
  names_ = {};
  EXPECT_EQ(found("5", "6064"), "5 6064:00 ");
  EXPECT_THAT(found("5", "Statusword"), HasSubstr("or a name of its device file with --plant"));
  EXPECT_THAT(found("servo", "6064"), HasSubstr("or a name with --plant"));
  EXPECT_EQ(found("128", "6064"),
            "\"128\" is not a node; expected a node-ID 1 to 127, or a name with --plant, --network, "
            "--project or --eds");
}

TEST_F(SdoNames, NamesWithoutAnOption_AreThoseOfThePlantOfTheWorkingFolder) {
  names_ = {};
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_);
  EXPECT_EQ(found("servo", "Position actual value"), "5 6064:00 i32");
  EXPECT_EQ(found("5", "6064"), "5 6064:00 ") << "numbers need no file, and take none";
  std::filesystem::current_path(before);
}

TEST_F(SdoNames, ConciseDcf_HasTheNamesOfTheNodeThatItIsFor) {
  names_.nodes.plant = path();
  const auto of_plant = find("line1:2", "1F22:05");
  ASSERT_TRUE(of_plant);
  ASSERT_NE(of_plant->names, nullptr);
  EXPECT_NE(of_plant->names->find(0x6041), nullptr);
  names_ = {.eds = file("drive.eds")};
  const auto of_file = find("1", "1F22:03");
  ASSERT_TRUE(of_file);
  EXPECT_NE(of_file->names->find(0x6041), nullptr);
}

TEST_F(SdoNames, Values_HaveUnitAndWords) {
  EXPECT_EQ(shown("6041", {0x37, 0x06}),
            "6041:00 Statusword  1591  0637H  operation enabled (ready to switch on, switched on, "
            "voltage enabled, quick stop, remote, target reached)");
  EXPECT_EQ(shown("6060", {8}), "6060:00 Modes of operation  8  08H  cyclic synchronous position");
  EXPECT_EQ(shown("6075", {0xD0, 0x07, 0, 0}), "6075:00 Motor rated current  2000 mA  000007D0H");
  EXPECT_EQ(shown("1017", {0xF4, 0x01}), "1017:00 Producer heartbeat time  500 ms  01F4H");
  EXPECT_EQ(shown("1001", {0x11}), "1001:00 Error register  17  11H  generic, communication");
  EXPECT_EQ(shown("6064", {0xFF, 0xFF, 0xFF, 0xFF}), "6064:00 Position actual value  -1  FFFFFFFFH");
}

TEST_F(SdoNames, ValuesAsJson_HaveNameUnitStateAndBits) {
  EXPECT_EQ(client::row_of(*find("servo", "6041"), Bytes{0x21, 0x02}, {}).dump(),
            R"({"node":5,"object":"6041:00","bytes":"2102","type":"u16","value":545,"name":"Statusword",)"
            R"("state":"ready to switch on","bits":["ready to switch on","quick stop","remote"]})");
  EXPECT_EQ(
      client::row_of(*find("servo", "6075"), Bytes{1, 0, 0, 0}, {}).dump(),
      R"({"node":5,"object":"6075:00","bytes":"01000000","type":"u32","value":1,"name":"Motor rated current",)"
      R"("unit":"mA"})");
}

TEST_F(SdoNames, WrittenValues_AreWithinTheRangeOfTheFile) {
  const auto refusal = [this](const std::string& object, const std::string& value,
                              const std::string& type = "") {
    const auto bytes = client::bytes_of_value(*find("servo", object, type), value, false);
    return bytes ? std::string("written") : bytes.error();
  };
  EXPECT_EQ(refusal("6060", "10"), "written");
  EXPECT_EQ(refusal("6060", "11"), "11 is out of the range of 6060:00 Modes of operation: expected -1 to 10");
  EXPECT_EQ(refusal("6060", "-2"), "-2 is out of the range of 6060:00 Modes of operation: expected -1 to 10");
  EXPECT_EQ(refusal("Motor rated current", "5001"),
            "5001 is out of the range of 6075:00 Motor rated current: expected at most 5000");
  EXPECT_EQ(refusal("2001", "9"), "9 is out of the range of 2001:00 Limit: expected at least 10");
  EXPECT_EQ(refusal("2002", "2.5"), "2.5 is out of the range of 2002:00 Ratio: expected 0.5 to 2");
  EXPECT_EQ(refusal("2001", "300"), "300 does not fit u8: expected 0 to 255");
  EXPECT_EQ(refusal("2001", "9", "u16"), "written") << "another type than the file's";
}

RC_GTEST_PROP(SdoNamesProperties, AnyWords_AreATargetOrASentence,
              (const std::string& node, const std::string& object)) {
  const SdoNamesOptions file{.eds = CANOPUS_SOURCE_DIR "/examples/devices/drive.eds"};
  const auto target = find_sdo_target(file, node, object, "");
  const bool is_good = target ? target->node >= 1 && target->node <= 127 : !target.error().empty();
  RC_ASSERT(is_good);
}

}  // namespace
}  // namespace canopus::cli::sdo_names_test
