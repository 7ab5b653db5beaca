// Device files of other networks, and other files that people open: refused by their names.

#include "canopus/eds/foreign_files.hpp"

#include <gtest/gtest.h>

#include "eds/reading.hpp"

namespace canopus::eds::foreign_files_test {
namespace {

using namespace canopus::eds;
using namespace canopus::eds::test;

struct Foreign {
  const char* name;
  std::string text;
  const char* kind;
};
void PrintTo(const Foreign& foreign, std::ostream* out) { *out << foreign.name; }

/// An EDS of CIP [CIP volume 1, chapter 7]; `more`: further sections.
std::string cip(const std::string& more) {
  return "$ Electronic Data Sheet\n[File]\n  DescText = \"Drive\";\n  CreateDate = 01-02-2020;\n[Device]\n  "
         "VendCode = 1;\n"
         "  ProdType = 2;\n  ProdCode = 3;\n" +
         more;
}
/// An ISO 15745 container of another network.
std::string iso15745(const std::string& identification, const std::string& type) {
  return "<?xml "
         "version=\"1.0\"?>\n<ISO15745ProfileContainer><ISO15745Profile><ProfileHeader><"
         "ProfileIdentification>" +
         identification + "</ProfileIdentification></ProfileHeader><ProfileBody xsi:type=\"" + type +
         "\"><ApplicationLayers/></ProfileBody></ISO15745Profile></ISO15745ProfileContainer>\n";
}

const Foreign foreign_files[] = {
    {"EtherNetIp", cip("[Device Classification]\n  Class1 = EtherNetIP;\n"), "an EtherNet/IP device file"},
    {"DeviceNet", cip("[IO_Info]\n  Default = 0x0001;\n"), "a DeviceNet device file"},
    {"DeviceNetByClass", cip("[Device Classification]\nClass1 = DeviceNet;\n"), "a DeviceNet device file"},
    {"CompoNet", cip("[Device Classification]\nClass1 = CompoNet;\n"), "a CompoNet device file"},
    {"Cip", cip(""), "a device file of a CIP network"},
    {"Gsd", "; comment\n#Profibus_DP\nGSD_Revision = 3\nVendor_Name = \"X\"\n", "a PROFIBUS GSD file"},
    {"Esi",
     "<?xml version=\"1.0\"?>\n<EtherCATInfo Version=\"1.6\"><Vendor><Id>1</Id></Vendor></EtherCATInfo>\n",
     "an EtherCAT device file (ESI)"},
    {"Iodd", "<IODevice xmlns=\"http://www.io-link.com/IODD/2010/10\"/>", "an IO-Link device file (IODD)"},
    {"Powerlink", iso15745("EPL_Device", "ProfileBody_CommunicationNetwork_Powerlink"),
     "an Ethernet POWERLINK device file (XDD)"},
    {"PowerlinkDevice", iso15745("x", "ProfileBody_Device_Powerlink_Modular_Head"),
     "an Ethernet POWERLINK device file (XDD)"},
    {"Profinet",
     "<ISO15745Profile><ProfileHeader><ProfileIdentification>PROFINET Device Profile</ProfileIdentification>"
     "</ProfileHeader><ProfileBody/></ISO15745Profile>",
     "a PROFINET device file (GSDML)"},
    {"Nodelist", "[Topology]\nNetName=Line\nNodes=1\nNode1Present=1\n",
     "a list of nodes (CiA 306), which canopus project reads,"},
    {"Dbc", "VERSION \"\"\n\nNS_ :\nBU_: A\n", "a CAN database (DBC)"},
    {"Zip", std::string("PK\x03\x04\x14\0\0\0", 8), "a ZIP archive; a device file may be in it"},
    {"WebPage", "<html><body>404</body></html>", "a web page"},
};

class ForeignFile : public testing::TestWithParam<Foreign> {};

TEST_P(ForeignFile, IsRefusedByItsName) {
  const ReadResult result = read_device_file(GetParam().text);
  EXPECT_EQ(result.file, nullptr);
  ASSERT_FALSE(result.problems.empty());
  EXPECT_EQ(result.problems.front().severity, Problem::Severity::error);
  EXPECT_EQ(result.problems.front().message, "this is " + std::string(GetParam().kind) +
                                                 " and no device file of CANopen (EDS, DCF, XDD or XDC)");
}

INSTANTIATE_TEST_SUITE_P(Kinds, ForeignFile, testing::ValuesIn(foreign_files),
                         [](const auto& instance) { return instance.param.name; });

TEST(ForeignFile, DeviceFileWithSuchWords_IsRead) {
  const ReadResult result = read_device_file(base + "[Device]\nVendCode=1\n[Topology]\nNetName=x\n");
  EXPECT_NE(result.file, nullptr) << all_problems(result);
}

}  // namespace
}  // namespace canopus::eds::foreign_files_test
