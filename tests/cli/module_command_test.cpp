#include "canopus/cli/plc/module_command.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/module/models/me3can1_q/me3can1_q.hpp"
#include "canopus/module/storage/flash_memory.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/store/file_memory.hpp"

namespace canopus::cli::module_command_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

Json info(const std::string& model) {
  TextOutput out, err;
  EXPECT_EQ(module_info(model, std::nullopt, true, out, err), 0) << err.text();
  return Json::parse(out.text());
}

TEST(ModuleInfo, Identity_OccupiedPoints_NoOnlineChange_ControlCpuOnly) {
  const Json sheet = info("me3can1-q");
  EXPECT_EQ(sheet["model"], "ME3CAN1-Q");
  EXPECT_EQ(sheet["type"], "Intelli.");
  EXPECT_EQ(sheet["series"], "Q");
  EXPECT_EQ(sheet["points"], 32);
  EXPECT_EQ(sheet["io_assignment"], "Intelligent 32 points");
  EXPECT_EQ(sheet["online_module_change"], false);
  EXPECT_THAT(std::string(sheet["multiple_cpu"]), HasSubstr("control CPU only"));
  EXPECT_EQ(sheet["modes"][0]["value"], "405");
  EXPECT_EQ(sheet["modes"][1]["value"], "11");
  EXPECT_EQ(sheet["modes"][2]["value"], "29");
}

TEST(ModuleInfo, Rj71cn91_WhatTheManualSaysOfCpusToolAndRefresh) {
  RecordProperty("spec",
                 "RJ71-VER-001 RJ71-PARAM-004 RJ71-PARAM-005 RJ71-TOOL-003 RJ71-TOOL-009 RJ71-TOOL-010");
  const Json sheet = info("rj71cn91");
  std::string text;
  for (const auto& [name, value] : sheet["properties"].items())
    text += name + ": " + std::string(value) + "\n";
  for (const std::string_view line :
       {"Safety, R00 to R02 CPU: from firmware version 02 on",
        "100 kbit/s in the tool: from firmware version 02 on, tool version 1.01B or 1.04E",
        "writes while the CPU is in STOP, to a Safety CPU with user authentication",
        "project and export files of a newer version are not opened by older ones",
        "while it writes nodes, no other program may write by SDO",
        "RnCPU, RnENCPU up to firmware 27, RnPCPU up to 11, RnSFCPU up to 13 (error 2220H); C Controller",
        "Refresh: for one module: RnCPU, RnENCPU firmware 28 to 34, RnPCPU 12 to 13",
        "Refresh: no limit: RnCPU, RnENCPU from firmware 35 on, RnPCPU, RnSFCPU from 14 on",
        "module label or RD: read 95.20 us, write 28.62 us, in all 123.82 us; device: see the CPU's "
        "manual"}) {
    EXPECT_THAT(text, HasSubstr(std::string(line)));
  }
}

TEST(ModuleStatus, LinesOfARunningPlant_WhateverTheServerSends) {
  RecordProperty("spec", "RJ71-DIAG-002");
  const auto shown = [](std::string_view answer) {
    TextOutput out;
    print_modules(text::parse_json(answer).value(), out);
    return out.text();
  };
  EXPECT_EQ(
      shown(R"({"ok":true,"t":1.0,"modules":[
    {"module":"RJ71CN91 U0","plc":"a","on":true,"leds":[{"name":"RUN","pattern":"on"},{"name":"ERR","pattern":"off"}],
     "function_mode":405,"function_mode_name":"CANopen, CiA 405","bit_rate":250000,"node":7,"errors":[]},
    {"module":"plain","plc":"","on":true,"leds":[],"function_mode":29,"function_mode_name":"Layer 2, 29-bit identifiers",
     "bit_rate":null,"node":null,"errors":[{"code":"1801","class":"minor","overview":"Wrong length",
     "details":{"PDO number":3,"PDO error cause":33296}}]}]})"),
      "RJ71CN91 U0, PLC a\n"
      "  LED information  RUN on, ERR off\n"
      "  Function mode    405 (CANopen, CiA 405)\n"
      "  Baud rate        250 kbit/s\n"
      "  Node ID          7\n"
      "\n"
      "plain\n"
      "  LED information  -\n"
      "  Function mode    29 (Layer 2, 29-bit identifiers)\n"
      "  Baud rate        -\n"
      "  Node ID          -\n"
      "  Error            1801H minor: Wrong length; PDO number 3 (3H), PDO error cause 33296 (8210H)\n");
  EXPECT_EQ(shown(R"({"ok":true,"modules":[]})"), "the plant has no module\n");
  EXPECT_EQ(shown("{}"), "the plant has no module\n");
  EXPECT_THAT(shown(R"({"modules":[7,{"leds":[1],"errors":[2,{"details":[]}],"bit_rate":"x","on":0}]})"),
              HasSubstr("Baud rate        -"));
}

TEST(ModuleInfo, Connector) {
  RecordProperty("spec", "ME3-SYS-015");
  const Json pins = info("ME3CAN1-Q")["pins"];
  ASSERT_EQ(pins.size(), 9U);
  const std::vector<Json> signals{nullptr, "CAN_L", "CAN_GND", nullptr, "CAN_SHLD",
                                  nullptr, "CAN_H", nullptr,   nullptr};
  for (std::size_t i = 0; i < signals.size(); ++i) {
    EXPECT_EQ(pins[i]["number"], i + 1);
    EXPECT_EQ(pins[i]["signal"], signals[i]) << i + 1;
  }
}

TEST(ModuleInfo, BusLengths) {
  RecordProperty("spec", "ME3-SYS-016");
  const Json sheet = info("ME3CAN1-Q");
  const std::vector<std::pair<int, int>> lengths{{1000, 25}, {800, 50},  {500, 100}, {250, 250}, {125, 500},
                                                 {100, 600}, {50, 1000}, {20, 2500}, {10, 5000}};
  ASSERT_EQ(sheet["bus_lengths"].size(), lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_EQ(sheet["bus_lengths"][i]["kbps"], lengths[i].first);
    EXPECT_EQ(sheet["bus_lengths"][i]["metres"], lengths[i].second);
  }
  EXPECT_THAT(std::string(sheet["properties"]["Terminating resistors"]), StartsWith("120 ohm at both ends"));
}

TEST(ModuleInfo, EmergencyCodesOfItsOwn_AndTheOneThatNothingCauses) {
  RecordProperty("spec", "ME3-EMCY-006");
  const Json properties = info("ME3CAN1-Q")["properties"];
  EXPECT_THAT(std::string(properties["Emergency codes"]),
              StartsWith("0000H 6200H 8110H 8120H 8200H 8210H 8220H 8250H 8F01H-8F7FH FF00H;"));
  EXPECT_THAT(std::string(properties["Emergency code 8250H"]), StartsWith("never occurs"));
  // Because no RPDO has one: its communication record ends at sub-index 2.
  const auto description = module::me3can1_q::object_dictionary();
  for (std::uint16_t index = 0x1400; index <= 0x14FF; ++index) {
    EXPECT_TRUE(description->find(index, 2) && !description->find(index, 3)) << std::hex << index;
  }
}

TEST(ModuleInfo, ModulesPerCpu) {
  RecordProperty("spec", "ME3-SYS-009");
  const Json sheet = info("ME3CAN1-Q");
  struct Row {
    std::string_view kind, models;
    Json modules;
  };
  // Tables 2-1 and 2-2, whole. "QnUD(E)" is the manual's "Q[]UD(E)CPU"; the models of the others stand without "CPU".
  const std::vector<Row> rows{
      {"Basic model QCPU", "Q00J", 16},
      {"Basic model QCPU", "Q00 Q01", 24},
      {"High performance model QCPU", "Q02 Q02H Q06H Q12H", 64},
      {"Process CPU", "Q02PH Q06PH Q12PH Q25PH", 64},
      {"Redundant CPU", "Q12PRH Q25PRH", nullptr},
      {"Universal model QCPU", "Q00UJ", 16},
      {"Universal model QCPU", "Q00U Q01U", 24},
      {"Universal model QCPU", "Q02U", 36},
      {"Universal model QCPU", "QnUD(E) Q50UDEH Q100UDEH", 64},
      {"Safety CPU", "QS001", nullptr},
      {"C Controller module", "Q06CCPU-V-H01 Q06CCPU-V Q06CCPU-V-B Q12DCCPU-V", 64},
      {"MELSECNET/H remote I/O head", "QJ72LP25-25 QJ72LP25G QJ72LP25GE QJ72BR15", 64}};
  ASSERT_EQ(sheet["modules_per_cpu"].size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Json& row = sheet["modules_per_cpu"][i];
    EXPECT_EQ(row["kind"], rows[i].kind);
    EXPECT_EQ(row["models"], rows[i].models);
    EXPECT_EQ(row["modules"], rows[i].modules) << rows[i].models;
  }
  EXPECT_EQ(sheet["properties"]["MELSECNET/H remote I/O"],
            "not with a Basic model QCPU or a C Controller module");
}

// [ME3CAN1-Q Tab. 6-3]
TEST(ModuleInfo, CableByLength) {
  RecordProperty("spec", "ME3-SYS-020");
  const Json properties = info("ME3CAN1-Q")["properties"];
  EXPECT_EQ(properties["Cable cross section"],
            "to 40 m 0.3 to 0.34 mm2, to 300 m 0.34 to 0.60 mm2, to 600 m 0.50 to 0.60 mm2, to 1000 m 0.75 "
            "to 0.80 mm2");
  EXPECT_EQ(properties["Cable resistance"],
            "to 40 m 70 mOhm/m, to 300 m below 60, to 600 m below 40, to 1000 m below 26");
}

TEST(ModuleInfo, Standards) {
  RecordProperty("spec", "ME3-SYS-019");
  const std::vector<std::pair<std::string, std::string>> standards{
      {"CiA 301", "4.2"}, {"CiA 302", "4.1"},   {"CiA 305", "2.2"},
      {"CiA 405", "2.0"}, {"CiA 303-1", "1.8"}, {"CiA 303-3", "1.4"}};
  const Json found = info("ME3CAN1-Q")["standards"];
  ASSERT_EQ(found.size(), standards.size());
  for (std::size_t i = 0; i < standards.size(); ++i) {
    EXPECT_EQ(found[i]["name"], standards[i].first);
    EXPECT_EQ(found[i]["version"], standards[i].second);
  }
}

TEST(ModuleInfo, Text_SaysTheSame) {
  TextOutput out, err;
  EXPECT_EQ(module_info("me3can1-q", std::nullopt, false, out, err), 0);
  for (const char* line :
       {"Model                     ME3CAN1-Q, Mitsubishi Electric\n",
        "Online module change      not supported\n", "Flash memory              10000 writes\n",
        "  7  CAN_H     dominant high\n", "  1000 kbps    25 m\n", "  CiA 303-3  V1.4  LEDs\n",
        "  Safety CPU                    QS001                                             not "
        "applicable\n"}) {
    EXPECT_THAT(out.text(), HasSubstr(line));
  }
}

TEST(ModuleInfo, UnknownModel_NamesThoseThereAre) {
  TextOutput out, err;
  EXPECT_EQ(module_info("me3can2-q", std::nullopt, false, out, err), 2);
  EXPECT_EQ(err.text(), "canopus: me3can2-q: no such module; did you mean \"ME3CAN1-Q\"?\n");
  err.clear();
  EXPECT_EQ(module_eds_file("nothing", "", out, err), 2);
  EXPECT_EQ(
      err.text(),
      "canopus: nothing: no such module; expected ME3CAN1-Q, RJ71CN91, FX3U-CAN, FX2N-32CAN or AS-FCOPM\n");
  EXPECT_EQ(out.text(), "");
}

TEST(ModuleInfo, Store_ShowsHowOftenTheFlashMemoryWasWritten) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "module-info-store";
  std::filesystem::remove_all(folder);
  TextOutput out, err;
  EXPECT_EQ(module_info("me3can1-q", folder, true, out, err), 2);
  EXPECT_THAT(err.text(), HasSubstr("no such folder"));
  store::FileMemory memory(folder);
  module::FlashMemory flash(memory, {"buffer-memory", "object-dictionary"});
  flash.write("buffer-memory", {});
  flash.write("object-dictionary", {});
  flash.write("buffer-memory", {});
  EXPECT_EQ(module_info("me3can1-q", folder, true, out, err), 0);
  const Json sheet = Json::parse(out.text());
  EXPECT_EQ(sheet["flash_writes"], 3);
  EXPECT_EQ(sheet["flash_endurance"], 10000);
  std::filesystem::remove_all(folder);
}

TEST(ModuleList, S03_OfAPlant_IsTheProductListOfItsPlcs) {
  RecordProperty("spec", "ME3-SYS-001");
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "module-list.toml";
  std::ofstream(path)
      << "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[plc]]\nname = \"plc1\"\nlisten = \"off\"\n"
         "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x00\nnode = 1\n"
         "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x40\nnode = 2\n";
  TextOutput out, err;
  ASSERT_EQ(module_list(path.string(), false, out, err), 0) << err.text();
  EXPECT_EQ(out.text(),
            "plc       slot  type      series  model        points  I/O No.  serial No         ver.\n"
            "plc1      0-0   Intelli.  Q       ME3CAN1-Q    32pt    0000     1203100000000000  B\n"
            "plc1      0-1   Intelli.  Q       ME3CAN1-Q    32pt    0040     1203100000000000  B\n");
  out.clear();
  ASSERT_EQ(module_list(path.string(), true, out, err), 0);
  const Json first = Json::parse(out.text().substr(0, out.text().find('\n')));
  EXPECT_EQ(first["io_number"], 0);
  EXPECT_EQ(first["serial_number"], "1203100000000000");
  EXPECT_EQ(first["version"], "B");
  out.clear();
  EXPECT_EQ(module_list(std::nullopt, false, out, err), 0);
  EXPECT_EQ(out.text(),
            "ME3CAN1-Q    Mitsubishi Electric, series Q, 32 points\n"
            "RJ71CN91     Mitsubishi Electric, series R, 32 points\n"
            "FX3U-CAN     Mitsubishi Electric, series FX, 8 points\n"
            "FX2N-32CAN   Mitsubishi Electric, series FX, 8 points\n"
            "AS-FCOPM     Delta Electronics, series AS, 0 points\n");
  EXPECT_EQ(module_list("/no/such/plant.toml", false, out, err), 2);
}

TEST(ModuleEds, OfEachCanopenMode) {
  RecordProperty("spec", "FX3U-SPEC-016");
  for (const unsigned mode : {405U, 417U}) {
    TextOutput out, err;
    ASSERT_EQ(module_eds_file("fx3u-can", "", out, err, mode), 0);
    const eds::ReadResult read = eds::read_device_file(out.text());
    ASSERT_NE(read.file, nullptr);
    for (const eds::Problem& problem : read.problems)
      ADD_FAILURE() << problem.line << ": " << problem.message;
    const canopen::ObjectDictionary objects(read.file->dictionary, 5);
    EXPECT_EQ(objects.get<std::uint32_t>(0x1000, 0), mode == 405 ? 0x195U : 0x1A1U);
    EXPECT_EQ(objects.get<std::uint32_t>(0x1902, 1), mode == 405 ? 0U : 0xC0000182U);
    EXPECT_EQ(read.file->device.rpdos, mode == 405 ? 80 : 1 + 127 + 64 + 8 * 13);
    EXPECT_EQ(read.file->device.tpdos, mode == 405 ? 80 : 2 + 1 + 8 * 3);
  }
  TextOutput out, err;
  EXPECT_EQ(module_eds_file("fx3u-can", "", out, err, 11U), 2);
  EXPECT_EQ(err.text(), "canopus: the FX3U-CAN has no objects in a function mode 11; expected 405, 417\n");
  EXPECT_EQ(out.text(), "");
}

// The file says of every object what the module's own dictionary says.
TEST(ModuleEds, DescribesTheObjectDictionary) {
  RecordProperty("spec", "ME3-SYS-017");
  TextOutput out, err;
  ASSERT_EQ(module_eds_file("me3can1-q", "", out, err), 0);
  const eds::ReadResult read = eds::read_device_file(out.text());
  ASSERT_NE(read.file, nullptr);
  for (const eds::Problem& problem : read.problems) ADD_FAILURE() << problem.line << ": " << problem.message;
  EXPECT_EQ(read.file->device.product_name, "ME3CAN1-Q");
  EXPECT_EQ(read.file->device.vendor_number, 0x71U);
  EXPECT_EQ(read.file->device.product_number, 0xED63U);
  EXPECT_EQ(read.file->device.revision_number, 0x10000U);
  EXPECT_EQ(read.file->device.rpdos, 256);
  EXPECT_EQ(read.file->device.tpdos, 256);
  EXPECT_FALSE(read.file->device.lss);

  const auto described = module::me3can1_q::object_dictionary();
  const auto& found = *read.file->dictionary;
  EXPECT_EQ(read.file->dummy_usage, 0x1FCU);  // 0002H to 0008H
  ASSERT_EQ(found.objects().size() + 7, described->objects().size());
  const canopen::ObjectDictionary own(described, 5), theirs(read.file->dictionary, 5);
  for (const canopen::ObjectDescription& object : described->objects()) {
    if (object.index < 0x1000) continue;  // a data type
    const canopen::ObjectDescription* other = found.find(object.index);
    ASSERT_NE(other, nullptr) << std::hex << object.index;
    EXPECT_EQ(other->highest_sub, object.highest_sub) << std::hex << object.index;
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const auto a = described->find(object, static_cast<std::uint8_t>(sub));
      const auto b = found.find(*other, static_cast<std::uint8_t>(sub));
      ASSERT_EQ(static_cast<bool>(a), static_cast<bool>(b)) << std::hex << object.index << ' ' << sub;
      if (!a) continue;
      EXPECT_EQ(a.description->type, b.description->type) << std::hex << object.index << ' ' << sub;
      if (sub != 0 || !object.uniform) {
        EXPECT_EQ(a.description->access, b.description->access) << std::hex << object.index << ' ' << sub;
      }
      EXPECT_TRUE(std::ranges::equal(own.bytes(a), theirs.bytes(b)))
          << std::hex << object.index << ' ' << sub;
    }
  }
}

}  // namespace
}  // namespace canopus::cli::module_command_test
