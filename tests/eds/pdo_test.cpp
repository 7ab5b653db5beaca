// PDOs as a file describes them.

#include <gmock/gmock.h>

#include "eds/reading.hpp"

namespace canopus::eds::pdo_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// A TPDO1 that maps `entries`, and 6000H, an UNSIGNED8 that `access` and `mapping` describe.
std::string tpdo(const std::vector<std::string>& entries,
                 const std::string& object = "AccessType=ro\nPDOMapping=1\n") {
  std::string text =
      base +
      "[1800]\nParameterName=T\nObjectType=9\n[1800sub0]\nDataType=5\nAccessType=ro\nDefaultValue=2\n"
      "[1800sub1]\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x180\n"
      "[1800sub2]\nDataType=5\nAccessType=rw\nDefaultValue=255\n"
      "[6000]\nParameterName=Inputs\nDataType=5\n" +
      object + "[1A00]\nParameterName=M\nObjectType=9\n[1A00sub0]\nDataType=5\nAccessType=rw\nDefaultValue=" +
      std::to_string(entries.size()) + "\n";
  for (std::size_t i = 0; i < entries.size(); ++i) {
    text += "[1A00sub" + std::to_string(i + 1) + "]\nDataType=7\nAccessType=rw\nDefaultValue=" + entries[i] +
            "\n";
  }
  return text;
}

TEST(Mapping, OfAMissingObject_IsTold) {
  EXPECT_THAT(all_problems(read_device_file(tpdo({"0x60010008"}))),
              HasSubstr("loss: TPDO1 maps 6001:00, which does not exist"));
}

TEST(Mapping, WithTheWrongLength_IsTold) {
  EXPECT_THAT(all_problems(read_device_file(tpdo({"0x60000010"}))),
              HasSubstr("loss: TPDO1 maps 6000:00 with 16 bits, it has 8"));
}

TEST(Mapping, OfMoreThan64Bits_IsTold) {
  EXPECT_THAT(all_problems(read_device_file(tpdo(std::vector<std::string>(9, "0x60000008")))),
              HasSubstr("loss: TPDO1 maps 72 bits: a PDO holds 64"));
}

TEST(Mapping, ByDefault_MakesItsObjectMappable) {
  const auto result = read_device_file(tpdo({"0x60000008"}, "AccessType=rww\nPDOMapping=0\n"));
  EXPECT_TRUE(result.file->dictionary->find(0x6000, 0).description->tpdo_mappable);
  EXPECT_FALSE(result.file->dictionary->find(0x6000, 0).description->rpdo_mappable);
  EXPECT_THAT(all_problems(result),
              HasSubstr("warning: TPDO1 maps 6000:00 by default, but its PDOMapping and "
                        "AccessType (line 49) forbid it: allowed"));
}

TEST(Mapping, EntriesOf0AtTheEnd_AreNotCounted) {
  const auto result = read_device_file(tpdo({"0x60000008", "0", "0"}));
  EXPECT_THAT(value(result, 0x1A00, 0), ElementsAre(1));
  EXPECT_THAT(all_problems(result),
              HasSubstr("warning: TPDO1 maps 3 objects, but the mapping entries from 2 on "
                        "are 0: taken as 1"));
}

TEST(Mapping, WithoutACount_CountsItsEntries) {
  std::string text = tpdo({"0x60000008"});
  const std::string count = "[1A00sub0]\nDataType=5\nAccessType=rw\nDefaultValue=1\n";
  text.replace(text.find(count), count.size(), "[1A00sub0]\nDataType=5\nAccessType=rw\n");
  EXPECT_THAT(value(read_device_file(text), 0x1A00, 0), ElementsAre(1));
}

TEST(CobId, WithoutItsNodeId_GetsIt) {
  std::string text = tpdo({"0x60000008"});
  text.replace(text.find("$NODEID+0x180"), 13, "0x180");
  const auto result = read_device_file(text);
  EXPECT_THAT(value(result, 0x1800, 1), ElementsAre(0x85, 0x01, 0, 0));
  EXPECT_EQ(problem(result, 44),
            "warning: the COB-ID 1800:01 would be the same in every node: $NODEID is added");
}

TEST(CobId, OfOnesOwn_IsLeftAlone) {
  std::string text = tpdo({"0x60000008"});
  text.replace(text.find("$NODEID+0x180"), 13, "0x1A5");
  EXPECT_THAT(value(read_device_file(text), 0x1800, 1), ElementsAre(0xA5, 0x01, 0, 0));
}

std::string compact(const char* device_info) {
  std::string text = base;
  text.replace(text.find("VendorNumber=1"), 14, std::string("VendorNumber=1\n") + device_info);
  return text;
}

TEST(CompactPdo, AnnouncedPdos_AreMade) {
  const auto result = read_device_file(compact("NrOfRXPDO=5\nNrOfTXPDO=1\nCompactPDO=0x17"));
  EXPECT_EQ(count_pdos(*result.file->dictionary).rpdos, 5U);
  EXPECT_EQ(count_pdos(*result.file->dictionary).tpdos, 1U);
  EXPECT_THAT(value(result, 0x1400, 0), ElementsAre(5));
  EXPECT_THAT(value(result, 0x1401, 1), ElementsAre(0x05, 0x03, 0, 0));
  EXPECT_THAT(value(result, 0x1404, 1), ElementsAre(0, 0, 0, 0x80));
  EXPECT_THAT(value(result, 0x1800, 1), ElementsAre(0x85, 0x01, 0, 0));
  EXPECT_FALSE(result.file->dictionary->find(0x1400, 4));
  EXPECT_TRUE(result.file->dictionary->find(0x1600, 0x40));
  EXPECT_EQ(problem(result, 3), "note: 5 RPDOs made from CompactPDO | note: 1 TPDO made from CompactPDO");
}

TEST(CompactPdo, PdosThatAreDescribed_AreEnough) {
  std::string text = tpdo({"0x60000008"});
  text.replace(text.find("VendorNumber=1"), 14, "VendorNumber=1\nNrOfTXPDO=1\nCompactPDO=31");
  EXPECT_THAT(all_problems(read_device_file(text)), Not(HasSubstr("CompactPDO")));
}

TEST(PdoCount, ThatContradictsTheObjects_IsNoted) {
  EXPECT_EQ(problem(read_device_file(compact("NrOfRXPDO=4")), 5), "note: NrOfRXPDO=4, but 0 RPDOs described");
}

}  // namespace
}  // namespace canopus::eds::pdo_test
