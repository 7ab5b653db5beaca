// The windows of the RJ71CN91's configuration tool, against the list of its items: printed names, ranges, defaults
// [RJ71CN91 3.1].

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/module/models/fx3u_can/configuration_tool.hpp"
#include "canopus/module/models/rj71cn91/configuration_tool.hpp"
#include "canopus/module_settings/module_project.hpp"

#include "paths.hpp"
#include "support/spec_table.hpp"

namespace canopus::module_settings::rj71cn91_windows_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::array<const module::ConfigurationTool*, 2> tools{&module::fx3u_can::configuration_tool,
                                                                &module::rj71cn91::configuration_tool};

const Window& rj71_window(std::string_view word) {
  const auto& all = module::rj71cn91::configuration_tool.windows;
  return *std::ranges::find(all, word, &Window::word);
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A field of the tool and what the manual says of it, as numbers.
struct ToolField {
  std::string_view window, item;  ///< of the list
  std::string_view word, name;    ///< here
  std::uint32_t lowest, highest, factory;
};
void PrintTo(const ToolField& field, std::ostream* out) { *out << field.window << ", " << field.item; }

constexpr std::uint32_t any_word = 65535, any_long = 4294967295;
const std::vector<ToolField> tool_fields{
    {"CANopen Configuration", "Module address", "basic", "Module address", 0, 0xFE0, 0},
    {"CANopen Configuration", "Node ID", "basic", "Node ID", 1, 127, 127},
    {"CANopen Configuration", "Baud-Rate", "basic", "Baud-Rate", 10, 1000, 250},
    {"CANopen Configuration", "SDO timeout", "basic", "SDO timeout", 50, 32767, 500},
    {"CANopen Configuration", "Node list: Download target", "node", "Download target", 0, 1, 0},
    {"CANopen node settings", "Download target", "node", "Download target", 0, 1, 0},
    {"PDO list (Transmit PDO / Receive PDO)", "Transmission type (TPDO)", "tpdo", "Transmission type", 0, 255,
     254},
    {"PDO list (Transmit PDO / Receive PDO)", "Transmission type (RPDO)", "rpdo", "Transmission type", 0, 255,
     254},
    {"PDO list (Transmit PDO / Receive PDO)", "Inhibit time", "tpdo", "Inhibit time", 0, any_word, 0},
    {"PDO list (Transmit PDO / Receive PDO)", "Event timer", "tpdo", "Event timer", 0, any_word, 0},
    {"TPDO details", "Transmission type", "tpdo", "Transmission type", 0, 255, 254},
    {"TPDO details", "Inhibit time", "tpdo", "Inhibit time", 0, any_word, 0},
    {"TPDO details", "Event timer", "tpdo", "Event timer", 0, any_word, 0},
    {"RPDO details", "Transmission type", "rpdo", "Transmission type", 0, 255, 254},
    {"NMT master / slave", "NMT master", "master", "NMT master", 0, 1, 0},
    {"NMT master / slave", "Start all nodes", "master", "Start all nodes", 0, 1, 0},
    {"NMT master / slave", "NMT master start", "master", "NMT master start", 0, 1, 0},
    {"NMT master / slave", "Start node", "master", "Start node", 0, 1, 0},
    {"NMT master / slave", "Reset all nodes", "master", "Reset all nodes", 0, 1, 0},
    {"NMT master / slave", "Stop all nodes", "master", "Stop all nodes", 0, 1, 0},
    {"NMT master / slave", "Flying master", "master", "Flying master", 0, 1, 0},
    {"NMT master / slave", "SYNC - Communication cycle period", "master", "SYNC - Communication cycle period",
     0, any_long, 0},
    {"NMT master / slave", "Boot time", "master", "Boot time", 0, any_long, 0},
    {"NMT master / slave", "Start all nodes delay", "master", "Start all nodes delay", 0, any_word, 500},
    {"NMT master / slave", "Timeout", "master", "Timeout", 0, any_word, 100},
    {"NMT master / slave", "NMT master negotiation time delay", "master", "NMT master negotiation time delay",
     0, any_word, 500},
    {"NMT master / slave", "NMT master priority", "master", "NMT master priority", 0, 2, 1},
    {"NMT master / slave", "Priority time slot", "master", "Priority time slot", 0, any_word, 1500},
    {"NMT master / slave", "CANopen device time slot", "master", "CANopen device time slot", 0, any_word, 10},
    {"NMT master / slave", "Multiple NMT master detect cycle time", "master",
     "Multiple NMT master detect cycle time", 0, any_word, 5270},
    {"NMT master / slave", "Guard time", "master", "Guard time", 0, any_word, 0},
    {"NMT master / slave", "Life time factor", "master", "Life time factor", 0, 255, 0},
    {"NMT slave assignment", "NMT slave", "slave", "NMT slave", 0, 1, 0},
    {"NMT slave assignment", "NMT boot slave", "slave", "NMT boot slave", 0, 1, 0},
    {"NMT slave assignment", "Mandatory", "slave", "Mandatory", 0, 1, 0},
    {"NMT slave assignment", "Reset communication", "slave", "Reset communication", 0, 1, 0},
    {"NMT slave assignment", "Retry factor", "slave", "Retry factor", 0, 255, 0},
    {"NMT slave assignment", "Guard time", "slave", "Guard time", 0, any_word, 0},
    {"NMT slave assignment", "Device type", "slave", "Device type", 0, any_long, 0},
    {"NMT slave assignment", "Vendor-ID", "slave", "Vendor-ID", 0, any_long, 0},
    {"NMT slave assignment", "Product code", "slave", "Product code", 0, any_long, 0},
    {"NMT slave assignment", "Revision number", "slave", "Revision number", 0, any_long, 0},
    {"NMT slave assignment", "Serial number", "slave", "Serial number", 0, any_long, 0},
    {"NMT slave", "NMT slave", "slave", "NMT slave", 0, 1, 0},
    {"NMT slave", "NMT boot slave", "slave", "NMT boot slave", 0, 1, 0},
    {"NMT slave", "Mandatory", "slave", "Mandatory", 0, 1, 0},
    {"NMT slave", "Reset communication", "slave", "Reset communication", 0, 1, 0},
    {"NMT slave", "Retry factor", "slave", "Retry factor", 0, 255, 0},
    {"NMT slave", "Guard time", "slave", "Guard time", 0, any_word, 0},
    {"NMT slave", "Device type", "slave", "Device type", 0, any_long, 0},
    {"NMT slave", "Vendor-ID", "slave", "Vendor-ID", 0, any_long, 0},
    {"NMT slave", "Product code", "slave", "Product code", 0, any_long, 0},
    {"NMT slave", "Revision number", "slave", "Revision number", 0, any_long, 0},
    {"NMT slave", "Serial number", "slave", "Serial number", 0, any_long, 0},
    {"Heartbeat", "Consumer heartbeat time", "consumer", "Consumer heartbeat time", 0, any_word, 0},
    {"Heartbeat", "Producer heartbeat time", "producer", "Producer heartbeat time", 0, any_word, 0},
};

class Rj71Field : public testing::TestWithParam<ToolField> {};

TEST_P(Rj71Field, HasThePrintedNameRangeAndDefault_AndRefusesTheRestWithItsRange) {
  const ToolField& tool = GetParam();
  const Window& window = rj71_window(tool.word);
  const auto field = std::ranges::find(window.fields, tool.name, &Field::name);
  ASSERT_NE(field, window.fields.end());
  EXPECT_EQ(why_not(*field, tool.lowest), "");
  EXPECT_EQ(why_not(*field, tool.highest), "");
  EXPECT_EQ(factory_value(window, *field, 0, 127), tool.factory);
  EXPECT_NE(field->description, "");
  const std::string expected = std::string(tool.name) + " = ";
  for (const std::uint64_t outside : {std::uint64_t{tool.lowest} - 1, std::uint64_t{tool.highest} + 1}) {
    if (outside > any_long) continue;
    const std::string refused = why_not(*field, static_cast<std::uint32_t>(outside));
    EXPECT_THAT(refused, HasSubstr(expected));
    EXPECT_THAT(refused, HasSubstr(": expected " + shown_range(*field)));
  }
}
INSTANTIATE_TEST_SUITE_P(Tool, Rj71Field, testing::ValuesIn(tool_fields));

TEST(Rj71Tool, EveryItemOfTheListIsAFieldOrStandsInThePage) {
  const std::string page = text_of(CANOPUS_SOURCE_DIR "/docs/configure-rj71cn91.md");
  const auto all = scenario::spec_rows("rj71cn91", "config-tool.csv");
  ASSERT_EQ(all.size(), 188U);
  std::string section;
  for (const scenario::SpecRow& item : all) {
    const std::string head = "\n## " + item["window"] + "\n";
    const std::size_t at = page.find(head);
    ASSERT_NE(at, std::string::npos) << item["window"];
    section = page.substr(at, page.find("\n## ", at + 1) - at);
    EXPECT_THAT(section, HasSubstr("\n| " + item["item"] + " | " + item["range"] + " | ")) << item["window"];
  }
  // Each field that is set in a project is one of those above.
  for (const ToolField& field : tool_fields) {
    EXPECT_TRUE(std::ranges::any_of(all,
                                    [&](const scenario::SpecRow& item) {
                                      return item["window"] == field.window && item["item"] == field.item;
                                    }))
        << field.window << ", " << field.item;
  }
}

class Rj71Project : public testing::Test {
 protected:
  std::string set(std::string_view word, std::uint32_t key, std::string_view field, std::string_view text) {
    const auto done = project_.set(*project_.window(word), key, field, text);
    return done ? "" : done.error();
  }
  std::string add(std::string_view word, std::uint32_t key) {
    const auto done = project_.add(*project_.window(word), key);
    return done ? "" : done.error();
  }
  std::vector<std::string> findings() {
    std::vector<std::string> texts;
    for (const ProjectFinding& finding : project_.check())
      texts.push_back((finding.is_error ? "E " : "W ") + finding.text);
    return texts;
  }
  ModuleProject project_{module::rj71cn91::configuration_tool};
};

TEST_F(Rj71Project, ModuleAddressIsIn16PointUnits) {
  EXPECT_EQ(set("basic", 0, "Module address", "0x30"), "");
  EXPECT_EQ(project_.unit_number(), 3U);
  EXPECT_EQ(set("basic", 0, "Module address", "0xFE0"), "");
  EXPECT_EQ(project_.unit_number(), 0xFEU);
  EXPECT_EQ(set("basic", 0, "Module address", "0xFF0"),
            "basic: Module address = 0xFF0: expected 0x0 to 0xFE0");
  EXPECT_EQ(set("basic", 0, "Module address", "0x38"),
            "basic: Module address = 0x38: expected steps of 0x10");
}

TEST_F(Rj71Project, PdoListsTakeNumbers1To256_WithTheCobIdsOfTheModule) {
  RecordProperty("spec", "RJ71-TOOL-004");
  for (const char* list : {"tpdo", "rpdo"}) {
    for (std::uint32_t number = 1; number <= 256; ++number) EXPECT_EQ(add(list, number), "");
    EXPECT_EQ(add(list, 0), "PDO number = 0: expected 1 to 256");
    EXPECT_EQ(add(list, 257), "PDO number = 257: expected 1 to 256");
  }
  EXPECT_EQ(project_.value("tpdo", "COB-ID", 4), 0x400004FFU);
  EXPECT_EQ(project_.value("tpdo", "COB-ID", 5), 0xC0000000U);
  EXPECT_EQ(project_.value("tpdo", "COB-ID", 256), 0xC0000000U);
  EXPECT_EQ(project_.value("rpdo", "COB-ID", 1), 0x0000027FU);
  EXPECT_EQ(project_.value("rpdo", "COB-ID", 256), 0x80000000U);
}

TEST_F(Rj71Project, SlavesAndConsumersAreAtMost126) {
  RecordProperty("spec", "RJ71-TOOL-005");
  EXPECT_EQ(add("slave", 1),
            "slave: only an NMT master assigns slaves; set master \"NMT master=Selected\" first");
  EXPECT_EQ(set("master", 0, "NMT master", "Selected"), "");
  for (std::uint32_t node = 1; node <= 126; ++node) {
    EXPECT_EQ(add("slave", node), "");
    EXPECT_EQ(add("consumer", node), "");
  }
  EXPECT_EQ(add("slave", 127), "slave: at most 126 rows");
  EXPECT_EQ(add("consumer", 127), "consumer: at most 126 rows");
}

TEST_F(Rj71Project, TheCpuModuleHoldsTheSettingsOf60Nodes_FurtherOnesAreTargetNodes) {
  RecordProperty("spec", "RJ71-TOOL-002");
  EXPECT_EQ(add("node", 127), "") << "the module itself, which does not count";
  for (std::uint32_t node = 1; node <= 61; ++node) EXPECT_EQ(add("node", node), "");
  EXPECT_EQ(project_.value("node", "Download target", 60), 0U);
  EXPECT_EQ(project_.value("node", "Download target", 61), 1U);
  EXPECT_EQ(set("node", 61, "Download target", "CPU module"),
            "node 61: Download target: the CPU module holds the settings of 60 nodes at most; expected "
            "Target node");
  EXPECT_EQ(set("node", 127, "Download target", "Target node"),
            "node 127: Download target: this module is written through the CPU module");
  EXPECT_EQ(set("node", 5, "Download target", "Target node"), "");
  EXPECT_EQ(set("node", 61, "Download target", "CPU module"), "");
  EXPECT_THAT(findings(), IsEmpty());
  // Another node-ID makes the module one of the 61.
  EXPECT_EQ(set("basic", 0, "Node ID", "61"), "");
  EXPECT_THAT(findings(), IsEmpty());
  EXPECT_EQ(set("basic", 0, "Node ID", "5"), "");
  EXPECT_THAT(findings(),
              testing::Contains("E node 5: Download target: this module is written through the CPU module"));
}

TEST_F(Rj71Project, ANodesNameHas1To256Characters) {
  EXPECT_EQ(add("node", 3), "");
  EXPECT_EQ(project_.rows(*project_.window("node")).at(3).name, "CANopen node");
  EXPECT_EQ(set("node", 3, "Node name", "Förderband <&> \"Ost\""), "");
  std::string two_bytes;
  for (int i = 0; i < 256; ++i) two_bytes += "ü";
  EXPECT_EQ(set("node", 3, "Node name", two_bytes), "");
  EXPECT_EQ(set("node", 3, "Node name", two_bytes + "x"),
            "node 3: Node name: 257 characters: expected 1 to 256");
  EXPECT_EQ(set("node", 3, "Node name", ""), "node 3: Node name: 0 characters: expected 1 to 256");
  EXPECT_EQ(set("node", 3, "Node name", "  "), "node 3: Node name: blanks alone are no name");
  EXPECT_EQ(set("node", 3, "Node name", "a\x1B[2J"), "node 3: Node name: character 2 cannot be in a name");
  EXPECT_EQ(set("node", 3, "Node name", "\xC3"), "node 3: Node name: character 1 cannot be in a name");
  EXPECT_EQ(set("node", 3, "Node name", "\xFF"), "node 3: Node name: character 1 cannot be in a name");
  EXPECT_EQ(project_.rows(*project_.window("node")).at(3).name, two_bytes)
      << "a refused name changes nothing";
}

TEST_F(Rj71Project, TheFileBringsEverythingBack) {
  RecordProperty("spec", "RJ71-TOOL-009");
  ASSERT_EQ(set("basic", 0, "Module address", "0x40"), "");
  ASSERT_EQ(add("node", 3), "");
  ASSERT_EQ(set("node", 3, "Node name", "  a <b> &amp; \"c\"  "), "");
  ASSERT_EQ(set("node", 3, "Download target", "Target node"), "");
  ASSERT_EQ(add("tpdo", 256), "");
  ASSERT_TRUE(project_.set_mapping(*project_.window("tpdo"), 256, {0xA1040810}));
  const std::string text = to_xml(project_);
  EXPECT_THAT(text, HasSubstr("<canopus-module model=\"RJ71CN91\" format=\"1\">"));
  const auto back = from_xml(text, tools);
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(to_xml(*back), text);
  EXPECT_EQ(back->rows(*back->window("node")).at(3).name, "  a <b> &amp; \"c\"  ");
  // A newer format is refused.
  std::string newer = text;
  newer.replace(newer.find("format=\"1\""), 10, "format=\"2\"");
  EXPECT_THAT(from_xml(newer, tools).error(), HasSubstr("the file is newer"));
  // The windows are the module's own.
  std::string other = text;
  other.replace(other.find("RJ71CN91"), 8, "FX3U-CAN");
  EXPECT_THAT(from_xml(other, tools).error(), HasSubstr("basic has no field \"Module address\""));
}

TEST_F(Rj71Project, TheCheckTellsWhatHasNoEffect) {
  ASSERT_EQ(set("master", 0, "NMT master", "Selected"), "");
  ASSERT_EQ(set("master", 0, "Reset all nodes", "Selected"), "");
  ASSERT_EQ(set("master", 0, "Stop all nodes", "Selected"), "");
  ASSERT_EQ(add("slave", 3), "");
  ASSERT_EQ(set("slave", 3, "Vendor-ID", "0x195"), "");
  EXPECT_THAT(findings(),
              ElementsAre("W slave 3: Vendor-ID is compared when NMT boot slave is selected",
                          "W master: Reset all nodes is without effect: Stop all nodes is selected"));
  ASSERT_EQ(set("slave", 3, "NMT boot slave", "Selected"), "");
  ASSERT_EQ(set("master", 0, "Stop all nodes", "Not selected"), "");
  EXPECT_THAT(findings(), IsEmpty());
}

TEST(Rj71Tool, MappedObjectsHaveTheNamesOfTheDetailsWindow) {
  const auto name = module::rj71cn91::configuration_tool.object_name;
  EXPECT_EQ(name(0xA1000110), "Buffer Memory Area Unsigned16, Un\\G13000");
  EXPECT_EQ(name(0xA100FE10), "Buffer Memory Area Unsigned16, Un\\G13253");
  EXPECT_EQ(name(0xA1010110), "Buffer Memory Area Unsigned16, Un\\G13254");
  EXPECT_EQ(name(0xA1040810), "Buffer Memory Area Unsigned16, Un\\G14023");
  EXPECT_EQ(name(0xA1040910), "");
  EXPECT_EQ(name(0xA100FF10), "");
  EXPECT_EQ(name(0xA0000108), "Buffer Memory Area Integer8, Un\\G13000 LByte");
  EXPECT_EQ(name(0xA0081008), "Buffer Memory Area Integer8, Un\\G14023 HByte");
  EXPECT_EQ(name(0xA0401008), "Buffer Memory Area Unsigned8, Un\\G13007 HByte");
  EXPECT_EQ(name(0xA0C00110), "Buffer Memory Area Integer16, Un\\G13000");
  EXPECT_EQ(name(0xA1C00120), "Buffer Memory Area Integer32, Un\\G13000-Un\\G13001");
  EXPECT_EQ(name(0xA2020420), "Buffer Memory Area Unsigned32, Un\\G14022-Un\\G14023");
  EXPECT_EQ(name(0xA2400220), "Buffer Memory Area Real32, Un\\G13002-Un\\G13003");
  EXPECT_EQ(name(0xA4800108), "Buffer Memory Area Integer8, Un\\G10000 LByte");
  EXPECT_EQ(name(0xA5800110), "Buffer Memory Area Unsigned16, Un\\G10000");
  EXPECT_EQ(name(0xA5840810), "Buffer Memory Area Unsigned16, Un\\G11023");
  EXPECT_EQ(name(0xA6C20420), "Buffer Memory Area Real32, Un\\G11022-Un\\G11023");
  EXPECT_EQ(name(0x00060010), "Dummy Unsigned 16 bit");
  EXPECT_EQ(name(0xA1000120), "");
  EXPECT_EQ(name(0x60000108), "");
}

}  // namespace
}  // namespace canopus::module_settings::rj71cn91_windows_test
