// Projects of a module: editing, checking, and their file.

#include "canopus/module_settings/module_project.hpp"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "canopus/module/models/fx3u_can/configuration_tool.hpp"
#include "canopus/module/models/rj71cn91/configuration_tool.hpp"

namespace canopus::module_settings::module_project_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::array<const module::ConfigurationTool*, 2> tools{&module::fx3u_can::configuration_tool,
                                                                &module::rj71cn91::configuration_tool};

class ModuleProjectTest : public testing::Test {
 protected:
  const Window& window(std::string_view word) { return *project_.window(word); }
  std::string set(std::string_view word, std::uint32_t key, std::string_view field, std::string_view text) {
    const auto done = project_.set(window(word), key, field, text);
    return done ? "" : done.error();
  }
  std::string add(std::string_view word, std::uint32_t key) {
    const auto done = project_.add(window(word), key);
    return done ? "" : done.error();
  }
  std::vector<std::string> findings() {
    std::vector<std::string> texts;
    for (const ProjectFinding& finding : project_.check())
      texts.push_back((finding.is_error ? "E " : "W ") + finding.text);
    return texts;
  }
  ModuleProject project_{module::fx3u_can::configuration_tool};
};

TEST_F(ModuleProjectTest, EveryFieldOfTheBasicSettingsIsSetAndRestored) {
  RecordProperty("spec", "FX3U-TOOL-001");
  EXPECT_EQ(set("basic", 0, "Module number", "7"), "");
  EXPECT_EQ(set("basic", 0, "Node ID", "2"), "");
  EXPECT_EQ(set("basic", 0, "Baud-Rate", "1000"), "");
  EXPECT_EQ(set("basic", 0, "FROM/TO Watchdog", "0"), "");
  EXPECT_EQ(set("basic", 0, "SDO timeout", "50"), "");
  EXPECT_THAT(project_.rows(window("basic")).at(0).values, ElementsAre(7, 405, 2, 1000, 0, 50));
  EXPECT_EQ(set("basic", 0, "Function mode", "417"), "basic: Function mode is shown, and cannot be set here");
  EXPECT_EQ(set("basic", 0, "Node ID", "0"), "basic: Node ID = 0: expected 1 to 127");
  EXPECT_EQ(set("basic", 0, "Node ID", "two"),
            "basic: Node ID = \"two\": expected 1 to 127, decimal or as 0x1F");
  EXPECT_THAT(set("basic", 0, "Node-ID", "2"),
              HasSubstr("has no field \"Node-ID\"; expected one of: Module number, Function mode"));
  EXPECT_EQ(project_.value("basic", "Node ID"), 2U) << "a refused value changes nothing";
  project_.restore_defaults(window("basic"));
  EXPECT_THAT(project_.rows(window("basic")).at(0).values, ElementsAre(0, 405, 127, 250, 200, 500));
}

TEST_F(ModuleProjectTest, APdoListTakesNumbers1To80) {
  RecordProperty("spec", "FX3U-TOOL-002");
  for (const char* list : {"tpdo", "rpdo"}) {
    for (std::uint32_t number = 1; number <= 80; ++number) EXPECT_EQ(add(list, number), "");
    EXPECT_EQ(add(list, 0), "PDO number = 0: expected 1 to 80");
    EXPECT_EQ(add(list, 81), "PDO number = 81: expected 1 to 80");
    EXPECT_EQ(add(list, 3), std::string(list) + " 3 is there already");
    EXPECT_TRUE(project_.remove(window(list), 3));
    EXPECT_FALSE(project_.remove(window(list), 3));
  }
}

TEST_F(ModuleProjectTest, APdosDetailsAreCanIdValidAndAtMost64Bits) {
  RecordProperty("spec", "FX3U-TOOL-003");
  ASSERT_EQ(add("tpdo", 5), "");
  EXPECT_EQ(project_.value("tpdo", "COB-ID", 5), 0xC0000000U);
  EXPECT_EQ(set("tpdo", 5, "CAN-ID (11-bit)", "0x57F"), "");
  EXPECT_EQ(project_.value("tpdo", "COB-ID", 5), 0xC000057FU);
  EXPECT_EQ(set("tpdo", 5, "valid", "Selected"), "");
  EXPECT_EQ(project_.value("tpdo", "COB-ID", 5), 0x4000057FU);
  EXPECT_EQ(set("tpdo", 5, "CAN-ID (11-bit)", "0x580"),
            "tpdo 5: CAN-ID (11-bit) = 0x580: expected 0x000 to 0x57F");
  EXPECT_EQ(set("tpdo", 5, "COB-ID", "0x40000580"),
            "tpdo 5: CAN-ID (11-bit) = 0x580: expected 0x000 to 0x57F");
  EXPECT_EQ(set("tpdo", 5, "COB-ID", "0x20000181"),
            "tpdo 5: COB-ID = 0x20000181: expected an 11-bit CAN-ID, and bits 30 and 31");
  EXPECT_EQ(set("tpdo", 5, "valid", "Not selected"), "");
  EXPECT_EQ(project_.value("tpdo", "COB-ID", 5), 0xC000057FU);
  EXPECT_TRUE(project_.set_mapping(window("tpdo"), 5, {0xA1C00120, 0xA1000310, 0xA0000708, 0xA0000808}));
  EXPECT_EQ(project_.set_mapping(window("tpdo"), 5, {0xA1C00120, 0xA1C00220, 0xA0000908}).error(),
            "tpdo 5: the mapped objects have 72 bits: expected at most 64");
  EXPECT_EQ(project_.set_mapping(window("tpdo"), 5, {0xA1000100}).error(),
            "tpdo 5: mapped object 0xA1000100: 0 bits; expected 8, 16, 32 and so on");
  EXPECT_EQ(project_.rows(window("tpdo")).at(5).mapping.size(), 4U) << "a refused mapping changes nothing";
}

TEST_F(ModuleProjectTest, OnlyAMasterAssignsSlavesAndAtMost126) {
  RecordProperty("spec", "FX3U-TOOL-004");
  EXPECT_EQ(add("slave", 3),
            "slave: only an NMT master assigns slaves; set master \"NMT master=Selected\" first");
  EXPECT_EQ(set("master", 0, "NMT master", "Selected"), "");
  for (std::uint32_t node = 1; node <= 126; ++node) EXPECT_EQ(add("slave", node), "");
  EXPECT_EQ(add("slave", 127), "slave: at most 126 rows");
  for (std::uint32_t node = 2; node <= 127; ++node) EXPECT_EQ(add("consumer", node), "");
  EXPECT_EQ(add("consumer", 1), "consumer: at most 126 rows");
  EXPECT_EQ(add("consumer", 128), "Node ID = 128: expected 1 to 127");
}

TEST_F(ModuleProjectTest, TheCheckFindsWhatValuesSayTogether) {
  RecordProperty("spec", "FX3U-TOOL-002 FX3U-TOOL-004");
  EXPECT_THAT(findings(), IsEmpty());
  ASSERT_EQ(set("basic", 0, "Node ID", "5"), "");
  ASSERT_EQ(set("master", 0, "NMT master", "Selected"), "");
  ASSERT_EQ(set("master", 0, "Priority time slot", "1270"), "");
  ASSERT_EQ(add("slave", 5), "");
  for (const std::uint32_t number : {1, 2, 5}) ASSERT_EQ(add("tpdo", number), "");
  ASSERT_EQ(set("tpdo", 2, "CAN-ID (11-bit)", "0x185"), "");
  ASSERT_EQ(set("tpdo", 5, "CAN-ID (11-bit)", "0x185"), "");
  ASSERT_EQ(set("tpdo", 1, "Transmission type", "0xF1"), "");
  ASSERT_TRUE(project_.set_mapping(window("tpdo"), 1, {0x60000108}));
  EXPECT_THAT(findings(), ElementsAre("W tpdo 1: Transmission type = 0xF1: 0xF1 to 0xFD are system-reserved",
                                      "W tpdo 1: mapped object 6000:01 with 8 bits is none of the module's",
                                      "E tpdo 2: CAN-ID 0x185 is sent by tpdo 1, too",
                                      "E slave 5: this is the module's own node-ID",
                                      "E master: Priority time slot = 1270: expected more than \"CANopen "
                                      "device time slot\" x 127 = 1270"));
}

TEST_F(ModuleProjectTest, TimesOfAFlyingMaster_InWords) {
  RecordProperty("spec", "FX3U-TOOL-004");
  ASSERT_EQ(set("basic", 0, "Node ID", "5"), "");
  EXPECT_THAT(project_.negotiation(),
              ::testing::StartsWith("negotiation: 500 ms + 1 x 1500 ms + 5 x 10 ms = 2.05 s after a reset"));
  EXPECT_THAT(project_.overlapping_slots(), IsEmpty());
  ASSERT_EQ(set("master", 0, "NMT master priority", "2"), "");
  ASSERT_EQ(set("master", 0, "Timeout", "70"), "");
  ASSERT_EQ(set("master", 0, "NMT master negotiation time delay", "20"), "");
  ASSERT_EQ(set("master", 0, "Priority time slot", "127"), "");
  ASSERT_EQ(set("master", 0, "CANopen device time slot", "1"), "");
  EXPECT_EQ(project_.negotiation(),
            "negotiation: 20 ms + 2 x 127 ms + 5 x 1 ms = 279 ms after a reset, and 70 ms more while it "
            "looks for an "
            "active master; asked for by another one: 259 ms");
  EXPECT_THAT(project_.overlapping_slots(), ::testing::HasSubstr("127 x 1 ms = 127 ms"));
}

TEST_F(ModuleProjectTest, TheFileBringsEverythingBack) {
  RecordProperty("spec", "FX3U-TOOL-010");
  ASSERT_EQ(set("basic", 0, "Node ID", "5"), "");
  ASSERT_EQ(set("master", 0, "NMT master", "Selected"), "");
  ASSERT_EQ(add("slave", 3), "");
  ASSERT_EQ(set("slave", 3, "Vendor-ID", "0x195"), "");
  ASSERT_EQ(add("tpdo", 7), "");
  ASSERT_TRUE(project_.set_mapping(window("tpdo"), 7, {0xA1000110, 0xA0000308}));
  const std::string text = to_xml(project_);
  EXPECT_THAT(text, HasSubstr("<canopus-module model=\"FX3U-CAN\" format=\"1\">"));
  EXPECT_THAT(text, HasSubstr("<field name=\"Vendor-ID\">0x00000195</field>"));
  EXPECT_THAT(text, HasSubstr("<object index=\"0xA000\" sub-index=\"0x03\" bits=\"8\" />"));
  const auto back = from_xml(text, tools);
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(to_xml(*back), text);
}

struct Bad {
  std::string text, error;
};

TEST(ModuleProjectFile, WhatIsWrongIsToldWithItsLine) {
  RecordProperty("spec", "FX3U-TOOL-010");
  const std::string head = "<?xml version=\"1.0\"?>\n<canopus-module model=\"FX3U-CAN\" format=\"1\">\n";
  const std::string tail = "\n</canopus-module>\n";
  for (const auto& [text, error] : {
           Bad{"", "1: there is no element in it"},
           Bad{"<a/>", "1: no <canopus-module>: this is no project of a module"},
           Bad{"<canopus-module model=\"FX3U-CAN\" format=\"2\"/>",
               "1: format \"2\": this version reads format 1; the file is newer"},
           Bad{"<canopus-module model=\"RJ71EN71\" format=\"1\"/>",
               "1: model \"RJ71EN71\": expected one of FX3U-CAN, RJ71CN91"},
           Bad{head + "<window name=\"tpdos\"/>" + tail,
               "3: <window name=\"tpdos\">: the FX3U-CAN has no such window"},
           Bad{head + "<window name=\"tpdo\" number=\"81\"/>" + tail, "3: PDO number = 81: expected 1 to 80"},
           Bad{head + "<window name=\"basic\">\n<field name=\"Node ID\">128</field></window>" + tail,
               "4: basic: Node ID = 128: expected 1 to 127"},
           Bad{head +
                   "<window name=\"tpdo\" number=\"1\"><object index=\"0xA100\" sub-index=\"1\"/></window>" +
                   tail,
               "3: <object>: expected index 0x0000 to 0xFFFF, sub-index 0x00 to 0xFF and bits 8 to 64"},
           Bad{head + "<window name=\"basic\"><fild/></window>" + tail, "3: <fild> is unknown here"},
       }) {
    const auto read = from_xml(text, tools);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error(), error);
  }
}

TEST(ModuleProjectFile, TooDeepOrTooLong_IsRefused) {
  std::string deep = "<canopus-module model=\"FX3U-CAN\" format=\"1\">\n";
  for (int i = 0; i < 100; ++i) deep += "<window>";
  for (int i = 0; i < 100; ++i) deep += "</window>";
  EXPECT_EQ(from_xml(deep + "</canopus-module>", tools).error(), "2: elements are nested more than 64 deep");
  EXPECT_EQ(from_xml("<canopus-module/>" + std::string(std::size_t{8} << 20, ' '), tools).error(),
            "1: the text has 8388625 bytes; expected at most 8388608");
}

TEST(ModuleProjectFile, AnyBytesAreAProjectOrAnError) {
  ModuleProject nodes(module::rj71cn91::configuration_tool);
  ASSERT_TRUE(nodes.add(*nodes.window("node"), 3));
  for (const std::string& good : {to_xml(ModuleProject(module::fx3u_can::configuration_tool)), to_xml(nodes)})
    rc::check([&] {
      std::string text = good;
      const auto changes = *rc::gen::inRange(0, 20);
      for (int i = 0; i < changes; ++i) {
        const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
        text[at] = *rc::gen::arbitrary<char>();
      }
      const auto read = from_xml(text, tools);
      if (read) RC_ASSERT(from_xml(to_xml(*read), tools).has_value());
    });
}

}  // namespace
}  // namespace canopus::module_settings::module_project_test
