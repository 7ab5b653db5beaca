// The device files of real vendors, quirks and all (shared/data/eds/INDEX.csv).

#include <filesystem>
#include <map>

#include <gtest/gtest.h>

#include "eds/reading.hpp"
#include "paths.hpp"

namespace canopus::eds::real_files_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;

const std::filesystem::path folder = CANOPUS_SOURCE_DIR "/../shared/data/eds";

ReadResult read_shared(const std::string& file) {
  const auto text = read_text(folder / file);
  return text ? read_device_file(*text) : ReadResult{};
}

#define SKIP_WITHOUT_FILES() \
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no device files in " << folder

/// Objects and device type as INDEX.csv has them, PDOs as counted in the files with grep.
struct Expected {
  const char* file;
  std::size_t objects;
  unsigned rpdos;
  unsigned tpdos;
  std::uint32_t device_type;
};
constexpr Expected accepted[] = {
    {"boheng_dsy-c.eds", 108, 4, 4, 131474},
    {"canfestival_ds401-slave.eds", 38, 2, 3, 983441},
    {"canopennode_demo-device.eds", 47, 4, 4, 0x000F0191},
    {"canopennode_demo-device.xdd", 48, 4, 4, 0x000F0191},
    {"canopennode_minimal-project.xdd", 10 + 2, 0, 0, 0},  // 1000H and 1018H made
    {"cyblogic_battery-module.eds", 17, 1, 1, 0x1A2},
    {"delta_asda-a3.eds", 639, 4, 4, 0x07020192},
    {"demaclenko_emecdrv5-07.eds", 31, 1, 2, 0x92020100},
    {"edsdcfnet_modular-device.dcf", 3, 0, 0, 0x191},
    {"edsdcfnet_sample-device.xdd", 10, 1, 1, 0x191},
    {"elmo_gold-drive.dcf", 166, 4, 4, 0x192},
    {"esacademy_cangineberry-401.eds", 34, 4, 4, 0x000F0191},
    {"example_e35-drive.eds", 211, 4, 4, 0x20192},
    {"faulhaber_cc-3150-51.eds", 75, 3, 3, 0x00020192},
    {"faulhaber_mcdc-3150-73.eds", 76, 3, 3, 0x00020192},
    {"frenzel-berg_canit20.eds", 57, 1, 2, 0x30191},
    {"frenzel-berg_co401mem02-cfg0.eds", 68, 8, 4, 0x00830191},
    {"ingenia_eve-xcr-c.eds", 524, 4, 4, 0x20192},
    {"kacanopen_cia406-encoder.eds", 70, 2, 2, 0},
    {"lely_pilz-master.dcf", 177, 18, 12, 0},
    {"maxon_epos-70-10.eds", 120, 4, 4, 0x00020192},
    {"nanotec_c5-e-1-09.eds", 222, 8, 8, 0x00060192},
    {"ngblume_simnode.eds", 14, 0, 2, 0xFF},
    {"pilz_prbt-joint.dcf", 94, 2, 4, 0},
    {"pirkan_pe552c-io-node.eds", 115, 5, 8, 0x00870191},
    {"python-canopen_datatypes.eds", 24 + 2, 0, 0, 0},  // 1000H and 1001H made
    {"python-canopen_sample.eds", 50, 4, 4, 0},
    {"roboteq_motor-controllers-v60.eds", 97, 4, 4, 0x000F0191},
    {"schunk_lwa4p-erb-0-63.dcf", 92, 2, 4, 0},
    {"schunk_prl120.eds", 73, 2, 4, 0x00020192},
    {"schwarzmueller_mixx-inverter.eds", 78, 1, 3, 0},
    {"sick_mls.eds", 27, 0, 1, 0},
    {"sick_ols10.eds", 23, 0, 2, 0},
    {"sick_ols20.eds", 26, 0, 2, 0},
    {"socanmatic_dsp402.eds", 61 + 3, 0, 0, 0},  // 1000H, 1001H and 1018H made
    {"systec_iox1-16di-8do.eds", 46, 2, 2, 0x30191},
    {"systec_iox4-8ai.eds", 40, 0, 4, 0x20194},
    {"systec_iox7-8tc.eds", 42, 0, 4, 0x20194},
    {"technosoft_ipos.eds", 175, 4, 4, 0x60192},
    {"technosoft_isd860.eds", 81, 4, 4, 0x60192},
    {"zeroerr_erob-driver-v1.5.eds", 92, 4, 4, 0x420192},
};

class AcceptedFile : public testing::TestWithParam<Expected> {};

TEST_P(AcceptedFile, File_BecomesTheDeviceItDescribes) {
  SKIP_WITHOUT_FILES();
  const ReadResult result = read_shared(GetParam().file);
  ASSERT_NE(result.file, nullptr) << all_problems(result);
  EXPECT_EQ(result.file->dictionary->objects().size(), GetParam().objects);
  EXPECT_EQ(count_pdos(*result.file->dictionary).rpdos, GetParam().rpdos);
  EXPECT_EQ(count_pdos(*result.file->dictionary).tpdos, GetParam().tpdos);
  EXPECT_EQ(identity(*result.file).device_type, GetParam().device_type);
}

INSTANTIATE_TEST_SUITE_P(Shared, AcceptedFile, testing::ValuesIn(accepted), [](const auto& instance) {
  std::string name = instance.param.file;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
});

TEST(RealFiles, Folder_HoldsNoFileThatIsNotExpected) {
  SKIP_WITHOUT_FILES();
  std::map<std::string, bool> known;
  for (const Expected& expected : accepted) known[expected.file] = true;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (extension != ".eds" && extension != ".dcf" && extension != ".xdd") continue;
    EXPECT_TRUE(known[entry.path().filename()]) << entry.path();
  }
}

struct Quirk {
  const char* file;
  unsigned line;
  const char* problem;
};
class KnownQuirk : public testing::TestWithParam<Quirk> {};

TEST_P(KnownQuirk, Quirk_IsToldInItsLine) {
  SKIP_WITHOUT_FILES();
  const ReadResult result = read_shared(GetParam().file);
  EXPECT_EQ(problem(result, GetParam().line), GetParam().problem);
}

INSTANTIATE_TEST_SUITE_P(
    Shared, KnownQuirk,
    testing::Values(
        Quirk{"maxon_epos-70-10.eds", 57,
              "note: key \"Supported Objects\" is written with a blank (and in 2 more places)"},
        Quirk{"elmo_gold-drive.dcf", 3033,
              "note: DefaultValue=0x3ED ; prevent homing of 6502:00: a comment behind the number"},
        Quirk{"elmo_gold-drive.dcf", 4492, "note: section [PreDefines] is not known here: skipped"},
        Quirk{"schunk_prl120.eds", 443,
              "note: 1600:00 has a ParameterValue, which counts, but the file has no [DeviceComissioning] "
              "(and in 3 "
              "more places)"},
        Quirk{"schunk_lwa4p-erb-0-63.dcf", 277,
              "note: DefaultValue=$NodeID + 0x80 of 1014:00: not written as $NODEID+number (and in 8 more "
              "places)"},
        Quirk{"schunk_lwa4p-erb-0-63.dcf", 53, "warning: 1000H (Device type) has no value: taken as 0"},
        Quirk{"pilz_prbt-joint.dcf", 2006, "note: 20A0H has SubNumber=8, but 1 sub-index described"},
        Quirk{"lely_pilz-master.dcf", 1, "note: there is no [FileInfo]"},
        Quirk{"technosoft_isd860.eds", 281,
              "note: DefaultValue=$NODEID +0x80 of 1014:00: not written as $NODEID+number (and in 10 more "
              "places)"},
        Quirk{"delta_asda-a3.eds", 716,
              "note: AccessType=RO of 1000:00 is in capitals (and in 751 more places)"},
        Quirk{"faulhaber_cc-3150-51.eds", 52, "note: bytes that are not UTF-8: read as Windows Latin text"},
        Quirk{"roboteq_motor-controllers-v60.eds", 5126,
              "note: section [VirtualDeviceDefinitions] is not known here: skipped"},
        Quirk{"demaclenko_emecdrv5-07.eds", 69,
              "warning: 1000H (Device type) names device profile 256, which CiA does not have; the value is "
              "kept"},
        Quirk{"frenzel-berg_canit20.eds", 175,
              "note: DefaultValue=\"CO4011B\" of 1008:00: quotes round a text"},
        Quirk{"pirkan_pe552c-io-node.eds", 4104,
              "note: AccessType=rO of 5700:02 is in capitals (and in 11 more places)"},
        Quirk{"example_e35-drive.eds", 116,
              "warning: [ManufacturerObjects] SupportedObjects=105, but 104 entries follow"},
        Quirk{"example_e35-drive.eds", 6775,
              "loss: 104=0x6505 in [OptionalObjects]: there is no section [6505]: left out"},
        Quirk{"example_e35-drive.eds", 6662, "warning: 2FFFH is in no object list: taken in all the same"},
        Quirk{"python-canopen_sample.eds", 314,
              "note: DefaultValue=1280+$NODEID of 1403:01: not written as $NODEID+number"},
        Quirk{"python-canopen_sample.eds", 835,
              "warning: [ManufacturerObjects] SupportedObjects=0, but 1 entry follows"},
        Quirk{"python-canopen_sample.eds", 194,
              "warning: 1400H is in no object list: taken in all the same (and in 42 more places)"},
        Quirk{"kacanopen_cia406-encoder.eds", 57,
              "warning: [OptionalObjects] SupportedObjects=64, but 67 entries follow"},
        Quirk{"socanmatic_dsp402.eds", 521,
              "warning: section [6092] was in line 492 before: only what is new in it counts (and in 4 more "
              "places)"},
        Quirk{"socanmatic_dsp402.eds", 53,
              "note: ObjectType=VAR in [6007]: a word instead of the object code (and in 61 more places)"},
        Quirk{"edsdcfnet_modular-device.dcf", 121,
              "loss: 1=0x6000 in [M1FixedObjects]: no section describes it: left out"}));

TEST(RealFiles, EveryProblem_HasALineOfItsFile) {
  SKIP_WITHOUT_FILES();
  for (const Expected& expected : accepted) {
    const auto text = read_text(folder / expected.file);
    const auto lines = std::ranges::count(*text, '\n') + 1;
    for (const Problem& found : read_device_file(*text).problems) {
      EXPECT_GE(found.line, 1U) << expected.file;
      EXPECT_LE(found.line, lines) << expected.file << ": " << found.message;
    }
  }
}

/// What one sub-index is, in words, so that a difference can be read.
std::string described(const DeviceFile& file, std::uint16_t index, std::uint8_t sub) {
  const canopen::Entry entry = file.dictionary->find(index, sub);
  if (!entry) return "missing";
  const auto& what = *entry.description;
  const canopen::Limits limits = file.dictionary->limits(entry);
  std::string text = std::string(file.dictionary->name(entry)) + ' ' + std::string(name(what.type)) + ' ' +
                     std::to_string(static_cast<int>(what.access)) + (what.rpdo_mappable ? " rpdo" : "") +
                     (what.tpdo_mappable ? " tpdo" : "") + (limits.low ? " low" : "") +
                     (limits.high ? " high" : "");
  if (what.length != 0) return text + ' ' + std::to_string(file.dictionary->default_value(entry, 5));
  for (const std::uint8_t byte : file.dictionary->default_slot(entry.offset))
    text += ' ' + std::to_string(byte);
  return text;
}

// The tool that wrote both left 1280H out of the EDS, because it is disabled, and has no word for a DOMAIN in an XDD.
TEST(RealFiles, XddAndEdsOfOneDevice_DifferWhereTheFilesDo) {
  SKIP_WITHOUT_FILES();
  const ReadResult eds = read_shared("canopennode_demo-device.eds");
  const ReadResult xdd = read_shared("canopennode_demo-device.xdd");
  std::string differences;
  for (unsigned index = 0x1000; index <= 0xFFFF; ++index) {
    for (unsigned sub = 0; sub <= 0xFF; ++sub) {
      const auto a = described(*eds.file, static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub));
      const auto b = described(*xdd.file, static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub));
      if (a != b && index != 0x1280) differences += std::to_string(index) + ": " + a + " | " + b + '\n';
    }
  }
  EXPECT_EQ(differences, "8482: Demo domain DOMAIN 2 | Demo domain OCTET_STRING 2\n");
  EXPECT_EQ(eds.file->dictionary->find(0x1280), nullptr);
  EXPECT_EQ(xdd.file->dictionary->find(0x1280)->highest_sub, 3);
  EXPECT_EQ(eds.file->device.bit_rates, xdd.file->device.bit_rates);
  EXPECT_EQ(eds.file->device.product_name, xdd.file->device.product_name);
  EXPECT_EQ(eds.file->dummy_usage, xdd.file->dummy_usage);
}

TEST(RealFiles, SemicolonInAParameterName_IsPartOfIt) {
  SKIP_WITHOUT_FILES();
  const ReadResult result = read_shared("schwarzmueller_mixx-inverter.eds");
  unsigned names = 0;
  const auto& dictionary = *result.file->dictionary;
  for (const auto& object : dictionary.objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const auto entry = dictionary.find(object, static_cast<std::uint8_t>(sub));
      if (entry && dictionary.name(entry).find(';') != std::string_view::npos) ++names;
    }
  }
  EXPECT_EQ(names, 3U);
}

TEST(RealFiles, CompactObjectsOfAMasterDcf_HaveTheirListedValues) {
  SKIP_WITHOUT_FILES();
  const ReadResult result = read_shared("lely_pilz-master.dcf");
  EXPECT_EQ(value(result, 0x1016, 6), (std::vector<std::uint8_t>{0x2C, 0x01, 0x08, 0x00}));
  EXPECT_EQ(value(result, 0x1016, 7), (std::vector<std::uint8_t>{0, 0, 0, 0}));
  EXPECT_EQ(value(result, 0x1600, 2), (std::vector<std::uint8_t>{0x08, 0x02, 0x00, 0x20}));
  EXPECT_EQ(result.file->commissioning->node_id, 1);
  EXPECT_EQ(result.file->commissioning->bit_rate, 1'000'000U);
}

TEST(RealFiles, EveryDataType_HasItsValue) {
  SKIP_WITHOUT_FILES();
  const ReadResult result = read_shared("python-canopen_datatypes.eds");
  EXPECT_EQ(value(result, 0x2008), (std::vector<std::uint8_t>{0x9A, 0x99, 0x99, 0x3F}));  // 1.2
  EXPECT_EQ(value(result, 0x200A), (std::vector<std::uint8_t>{0xAB, 0xCD}));
  EXPECT_EQ(value(result, 0x2010), (std::vector<std::uint8_t>{0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(value(result, 0x2012), (std::vector<std::uint8_t>{0xD8, 0xFF, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(value(result, 0x201B), (std::vector<std::uint8_t>{64, 0, 0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace canopus::eds::real_files_test
