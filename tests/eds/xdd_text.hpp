#pragma once
// Small XDD files [CiA 311] for tests.

#include <string>
#include <string_view>

namespace canopus::eds::test {

/// What surrounds the objects: lines 1 to 16 before them; the first object stands in line 17.
inline const std::string xdd_start =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<ISO15745ProfileContainer xmlns=\"http://www.canopen.org/xml/1.0\"\n"
    "    xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\">\n"
    "<ISO15745Profile>\n"
    "<ProfileBody xsi:type=\"ProfileBody_Device_CANopen\" fileName=\"a.xdd\" fileCreator=\"me\"\n"
    "    fileCreationDate=\"2025-12-31\" fileCreationTime=\"16:49:28.79+01:00\" fileVersion=\"3.1\">\n"
    "<DeviceIdentity><vendorName>Pumps &amp; Co</vendorName><vendorID>0x1</vendorID>\n"
    "<productName>P1</productName><productID>2</productID><orderNumber>P-1</orderNumber></DeviceIdentity>\n"
    "@PROCESS@\n"
    "</ProfileBody>\n"
    "</ISO15745Profile>\n"
    "<ISO15745Profile>\n"
    "<ProfileBody xsi:type=\"ProfileBody_CommunicationNetwork_CANopen\" fileName=\"a.xdd\">\n"
    "<ApplicationLayers>\n"
    "<CANopenObjectList>\n"
    "<!-- objects -->\n";
inline constexpr unsigned xdd_first_line = 17;

inline const std::string xdd_mandatory =
    "<CANopenObject index=\"1000\" name=\"Device type\" objectType=\"7\" dataType=\"0007\" accessType=\"ro\" "
    "defaultValue=\"0x191\" PDOmapping=\"no\"/>\n"
    "<CANopenObject index=\"1001\" name=\"Error register\" objectType=\"7\" dataType=\"0005\" "
    "accessType=\"ro\"/>\n"
    "<CANopenObject index=\"1018\" name=\"Identity\" objectType=\"9\" subNumber=\"2\">\n"
    "<CANopenSubObject subIndex=\"00\" name=\"Highest\" objectType=\"7\" dataType=\"0005\" accessType=\"ro\" "
    "defaultValue=\"1\"/>\n"
    "<CANopenSubObject subIndex=\"01\" name=\"Vendor\" objectType=\"7\" dataType=\"0007\" accessType=\"ro\" "
    "defaultValue=\"1\"/>\n"
    "</CANopenObject>\n";
inline constexpr unsigned xdd_mandatory_lines = 6;

inline const std::string xdd_end =
    "</CANopenObjectList>\n"
    "<dummyUsage><dummy entry=\"Dummy0005=1\"/><dummy entry=\"Dummy0006=0\"/></dummyUsage>\n"
    "</ApplicationLayers>\n"
    "<TransportLayers><PhysicalLayer><baudRate>\n"
    "<supportedBaudRate value=\"125 Kbps\"/><supportedBaudRate value=\"1000 Kbps\"/>\n"
    "</baudRate></PhysicalLayer></TransportLayers>\n"
    "<NetworkManagement>\n"
    "  <CANopenGeneralFeatures granularity=\"8\" nrOfRxPDO=\"0\" nrOfTxPDO=\"0\" bootUpSlave=\"true\" "
    "layerSettingServiceSlave=\"true\"/>\n"
    "  <CANopenMasterFeatures bootUpMaster=\"false\"/>\n"
    "</NetworkManagement>\n"
    "</ProfileBody>\n"
    "</ISO15745Profile>\n"
    "</ISO15745ProfileContainer>\n";

/// A device with these objects besides the mandatory ones, and this application process.
inline std::string xdd(std::string_view objects, std::string_view process = {}) {
  std::string start = xdd_start;
  start.replace(start.find("@PROCESS@"), 9, process);
  return start + xdd_mandatory + std::string(objects) + xdd_end;
}
/// The line of the first of these objects.
inline constexpr unsigned xdd_object_line = xdd_first_line + xdd_mandatory_lines;

}  // namespace canopus::eds::test
