#include "canopus/master/dcf_download.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::master::dcf_download_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A device file with a PDO, a variable, a text and a command; `configured` goes behind the sections' heads.
std::shared_ptr<const eds::DeviceFile> device(const std::string& sections) {
  const std::string head =
      "[FileInfo]\nFileName=a.dcf\n[DeviceInfo]\nVendorName=a\nProductName=b\nGranularity=8\n"
      "[DeviceComissioning]\nNodeID=5\n"
      "[MandatoryObjects]\nSupportedObjects=2\n1=0x1000\n2=0x1001\n"
      "[1000]\nParameterName=Type\nDataType=7\nAccessType=ro\nDefaultValue=0\n"
      "[1001]\nParameterName=Register\nDataType=5\nAccessType=ro\n";
  return eds::read_device_file(head + sections).file;
}

Bytes download(const std::string& sections, std::vector<text::ObjectSetting> settings = {},
               std::uint8_t node = 5) {
  const auto file = device(sections);
  EXPECT_NE(file, nullptr);
  const auto bytes = concise_dcf_of(*file, settings, node);
  EXPECT_TRUE(bytes.has_value());
  return bytes.value_or(Bytes{});
}

TEST(DcfDownload, FileWithoutConfiguredValues_IsNothing) {
  EXPECT_EQ(download("[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n"
                     "[2000]\nParameterName=V\nDataType=6\nAccessType=rw\nDefaultValue=7\n"),
            Bytes{});
}

TEST(DcfDownload, ConfiguredValue_IsOneEntry) {
  EXPECT_EQ(
      download("[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n"
               "[2000]\nParameterName=V\nDataType=6\nAccessType=rw\nDefaultValue=7\nParameterValue=0x1234\n"),
      (Bytes{1, 0, 0, 0, 0x00, 0x20, 0x00, 2, 0, 0, 0, 0x34, 0x12}));
}

TEST(DcfDownload, TextAndReadOnlyAndCommands_AreKeptApart) {
  EXPECT_EQ(download("[OptionalObjects]\nSupportedObjects=1\n1=0x1011\n"
                     "[1011]\nParameterName=Restore\nObjectType=8\nSubNumber=2\n"
                     "[1011sub0]\nParameterName=N\nDataType=5\nAccessType=const\nDefaultValue=1\n"
                     "[1011sub1]\nParameterName=All\nDataType=7\nAccessType=rw\nParameterValue=1\n"
                     "[ManufacturerObjects]\nSupportedObjects=2\n1=0x2000\n2=0x2001\n"
                     "[2000]\nParameterName=V\nDataType=9\nAccessType=rw\nParameterValue=abc\n"
                     "[2001]\nParameterName=R\nDataType=5\nAccessType=ro\nParameterValue=1\n"),
            (Bytes{1, 0, 0, 0, 0x00, 0x20, 0x00, 3, 0, 0, 0, 'a', 'b', 'c'}));
}

TEST(DcfDownload, ObjectThatIsNotToBeDownloaded_IsLeftOut) {
  EXPECT_EQ(download("[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n"
                     "[2000]\nParameterName=V\nDataType=5\nAccessType=rw\nParameterValue=1\nObjFlags=1\n"),
            Bytes{});
}

const std::string pdo =
    "[OptionalObjects]\nSupportedObjects=2\n1=0x1800\n2=0x1A00\n"
    "[1800]\nParameterName=TPDO\nObjectType=9\nSubNumber=3\n"
    "[1800sub0]\nParameterName=N\nDataType=5\nAccessType=const\nDefaultValue=2\n"
    "[1800sub1]\nParameterName=COB\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x180\n"
    "[1800sub2]\nParameterName=Type\nDataType=5\nAccessType=rw\nDefaultValue=255\nParameterValue=1\n"
    "[1A00]\nParameterName=Map\nObjectType=9\nSubNumber=2\n"
    "[1A00sub0]\nParameterName=N\nDataType=5\nAccessType=rw\nDefaultValue=0\nParameterValue=1\n"
    "[1A00sub1]\nParameterName=1\nDataType=7\nAccessType=rw\nDefaultValue=0\nParameterValue=0x20000010\n"
    "[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n"
    "[2000]\nParameterName=V\nDataType=6\nAccessType=rw\nPDOMapping=1\n";

TEST(DcfDownload, DateAndTimeOfTheConfiguration_ComeLast) {
  EXPECT_EQ(download("[OptionalObjects]\nSupportedObjects=1\n1=0x1020\n"
                     "[1020]\nParameterName=Verify\nObjectType=8\nSubNumber=3\n"
                     "[1020sub0]\nParameterName=N\nDataType=5\nAccessType=const\nDefaultValue=2\n"
                     "[1020sub1]\nParameterName=Date\nDataType=7\nAccessType=rw\nParameterValue=11245\n"
                     "[1020sub2]\nParameterName=Time\nDataType=7\nAccessType=rw\nParameterValue=6\n"
                     "[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n"
                     "[2000]\nParameterName=V\nDataType=5\nAccessType=rw\nParameterValue=1\n"),
            (Bytes{3,    0,    0, 0,                                   //
                   0x00, 0x20, 0, 1, 0, 0, 0, 1,                       //
                   0x20, 0x10, 1, 4, 0, 0, 0, 0xED, 0x2B, 0x00, 0x00,  //
                   0x20, 0x10, 2, 4, 0, 0, 0, 0x06, 0x00, 0x00, 0x00}));
}

TEST(DcfDownload, Pdo_IsSwitchedOffWhileItIsChanged) {
  EXPECT_EQ(download(pdo), (Bytes{6,    0,    0,    0,                                   //
                                  0x00, 0x18, 0x01, 4, 0, 0, 0, 0x85, 0x01, 0x00, 0x80,  //
                                  0x00, 0x18, 0x02, 1, 0, 0, 0, 0x01,                    //
                                  0x00, 0x1A, 0x00, 1, 0, 0, 0, 0x00,                    //
                                  0x00, 0x1A, 0x01, 4, 0, 0, 0, 0x10, 0x00, 0x00, 0x20,  //
                                  0x00, 0x1A, 0x00, 1, 0, 0, 0, 0x01,                    //
                                  0x00, 0x18, 0x01, 4, 0, 0, 0, 0x85, 0x01, 0x00, 0x00}));
}

TEST(DcfDownload, Setting_ReplacesTheConfiguredValue) {
  const Bytes bytes = download(
      "[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n"
      "[2000]\nParameterName=V\nDataType=5\nAccessType=rw\nParameterValue=1\n",
      {{.place = {}, .object = {0x2000, 0}, .value = std::int64_t{9}}});
  EXPECT_EQ(bytes, (Bytes{1, 0, 0, 0, 0x00, 0x20, 0x00, 1, 0, 0, 0, 9}));
}

TEST(DcfDownload, OtherNodeId_IsInTheCobId) {
  const Bytes bytes = download(pdo, {}, 0x11);
  ASSERT_GT(bytes.size(), 11U);
  EXPECT_EQ(bytes[11], 0x91);
}

}  // namespace
}  // namespace canopus::master::dcf_download_test
