// A device file in the other format and back: every object, value, limit, access and name. The XDD itself is judged by
// tests/interop (xdd) with readers that are not ours.

#include <filesystem>

#include <gtest/gtest.h>
// rapidcheck/gtest.h wants GoogleTest before it
#include <rapidcheck/gtest.h>

#include "canopus/eds/files/losses.hpp"
#include "canopus/eds/files/xdd_writer.hpp"
#include "canopus/eds/problems.hpp"

#include "eds/reading.hpp"
#include "eds/xdd_text.hpp"
#include "paths.hpp"

namespace canopus::eds::xdd_round_trip_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

/// Everything a dictionary and the facts beside it say of a sub-index.
std::string all_of(const DeviceFile& file, const canopen::ObjectDescription& object, std::uint8_t sub) {
  const canopen::Entry entry = file.dictionary->find(object, sub);
  if (!entry) return {};
  const auto& what = *entry.description;
  const canopen::Limits limits = file.dictionary->limits(entry);
  // An XDD has no word for rwr and rww where the object is in no PDO: the writer warns.
  const bool is_one_way =
      what.access == canopen::Access::read_write_input || what.access == canopen::Access::read_write_output;
  const canopen::Access access =
      is_one_way && !what.rpdo_mappable && !what.tpdo_mappable ? canopen::Access::read_write : what.access;
  std::ostringstream text;
  text << object_text(object.index, sub) << " " << name(what.type) << " access " << static_cast<int>(access)
       << (what.rpdo_mappable ? " rpdo" : "") << (what.tpdo_mappable ? " tpdo" : "")
       << (what.stored ? " stored" : "");
  if (limits.low) text << " low " << *limits.low;
  if (limits.high) text << " high " << *limits.high;
  if (what.length != 0) {
    text << " = " << file.dictionary->default_value(entry, 0) << ' '
         << file.dictionary->default_value(entry, 100);
  } else {
    for (const std::uint8_t byte : file.dictionary->default_slot(entry.offset)) text << ' ' << int{byte};
  }
  const EntryFacts* facts = file.find_facts(object.index, sub);
  if (facts != nullptr) {
    text << " flags " << facts->object_flags << " denotation " << facts->denotation;
    if (facts->configured) text << " configured, default " << facts->default_text;
  }
  text << " name " << file.dictionary->name(entry) << '\n';
  return text.str();
}

std::string all_of(const DeviceFile& file) {
  std::string text;
  for (const canopen::ObjectDescription& object : file.dictionary->objects()) {
    text += object_name(object.index) + ' ' + std::string(file.dictionary->name(object)) + ' ' +
            std::to_string(static_cast<int>(object.code)) + '\n';
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      text += all_of(file, object, static_cast<std::uint8_t>(sub));
    }
  }
  const Identity id = identity(file);
  text += "identity " + std::to_string(id.vendor_id.value_or(0)) + ' ' +
          std::to_string(id.product_code.value_or(0)) + ' ' + std::to_string(id.revision.value_or(0)) + '\n';
  text += file.device.vendor_name + ',' + file.device.product_name + ',' + file.device.order_code + ',' +
          std::to_string(file.device.lss) + std::to_string(file.device.simple_boot_up_master) +
          std::to_string(file.device.simple_boot_up_slave) + std::to_string(file.device.group_messaging) +
          ' ' + std::to_string(file.device.granularity) + ' ' + std::to_string(file.device.dynamic_channels) +
          ' ' + std::to_string(file.device.rpdos) + ' ' + std::to_string(file.device.tpdos) + '\n';
  for (const std::uint32_t rate : file.device.bit_rates) text += std::to_string(rate) + ' ';
  text += "dummies " + std::to_string(file.dummy_usage) + '\n';
  if (file.commissioning) {
    text += "node " + std::to_string(file.commissioning->node_id.value_or(0)) + ' ' +
            file.commissioning->node_name + ' ' + std::to_string(file.commissioning->bit_rate) + ' ' +
            std::to_string(file.commissioning->net_number) + ' ' + file.commissioning->network_name + ' ' +
            std::to_string(file.commissioning->canopen_manager) + '\n';
  }
  return text;
}

/// The two texts' first line that differs; texts of hundreds of objects are no message.
std::string difference(const std::string& before, const std::string& after) {
  if (before == after) return {};
  std::istringstream a(before);
  std::istringstream b(after);
  std::string line_a;
  std::string line_b;
  while (std::getline(a, line_a) && std::getline(b, line_b)) {
    if (line_a != line_b) return line_a + "\n  became\n" + line_b;
  }
  return "one has more lines: " + line_a + " | " + line_b;
}

std::string in_xdd(const DeviceFile& file) {
  const WrittenFile xdd = write_xdd(file);
  const ReadResult again = read_device_file(xdd.text);
  return again.file == nullptr ? all_problems(again) : difference(all_of(file), all_of(*again.file));
}

std::string in_xdd_and_eds(const DeviceFile& file) {
  const ReadResult xdd = read_device_file(write_xdd(file).text);
  if (xdd.file == nullptr) return all_problems(xdd);
  const ReadResult eds = read_device_file(write_eds(*xdd.file).text);
  return eds.file == nullptr ? all_problems(eds) : difference(all_of(file), all_of(*eds.file));
}

const std::string rich = with_object(
    "[2000]\nParameterName=All\nObjectType=9\nSubNumber=9\n"
    "[2000sub0]\nParameterName=Count\nDataType=5\nAccessType=const\nDefaultValue=12\n"
    "[2000sub1]\nParameterName=I16 "
    "<&\"'>\nDataType=3\nAccessType=rw\nDefaultValue=-5\nLowLimit=-10\nHighLimit=100\n"
    "[2000sub2]\nParameterName=R32\nDataType=8\nAccessType=rw\nDefaultValue=1.5\nLowLimit=0.1\nHighLimit=2."
    "5\nObjFlags=3\n"
    "[2000sub3]\nParameterName=R64\nDataType=0x11\nAccessType=rw\nDefaultValue=-2.25\nHighLimit=1e10\n"
    "[2000sub4]\nParameterName=Text\nDataType=9\nAccessType=rw\nDefaultValue=\" a & b \"\n"
    "[2000sub5]\nParameterName=Octets\nDataType=0xA\nAccessType=rw\nDefaultValue=01 FF 7\n"
    "[2000sub6]\nParameterName=Wide\nDataType=0xB\nAccessType=rw\nDefaultValue=K\xC3\xBChler\n"
    "[2000sub7]\nParameterName=In\nDataType=5\nAccessType=rwr\nPDOMapping=1\n"
    "[2000sub8]\nParameterName=Out\nDataType=5\nAccessType=rww\nPDOMapping=1\nParameterValue=7\nDefaultValue="
    "3\n"
    "Denotation=Speed\n"
    "[2000sub9]\nParameterName=Id\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x600\n"
    "[2000subA]\nParameterName=Time\nDataType=0xC\nAccessType=rw\nDefaultValue=3 4\n"
    "[2000subB]\nParameterName=I64\nDataType=0x15\nAccessType=rw\nDefaultValue=-"
    "9223372036854775808\nLowLimit=-3\n"
    "[2000subC]\nParameterName=U64\nDataType=0x1B\nAccessType=wo\nHighLimit=0xFFFFFFFFFFFFFFFE\n"
    "[2001]\nParameterName=Compact\nObjectType=8\nDataType=6\nAccessType=rw\nDefaultValue=3\nCompactSubObj="
    "200\n"
    "LowLimit=1\nHighLimit=9\n[2001Value]\nNrOfEntries=1\n12=4\n"
    "[2002]\nParameterName=File\nObjectType=2\nDataType=0xF\nAccessType=rw\nDefaultValue=0102\n"
    "[2003]\nParameterName=Uniform\nObjectType=8\nDataType=6\nAccessType=rw\nCompactSubObj=100\n"
    "[DummyUsage]\nDummy0005=1\nDummy0015=1\n");

TEST(XddRoundTrip, EverythingAFileCanSay_ComesBackFromAnXdd) {
  const ReadResult read = read_device_file(rich);
  ASSERT_NE(read.file, nullptr);
  EXPECT_EQ(in_xdd(*read.file), "");
  EXPECT_EQ(in_xdd_and_eds(*read.file), "");
  EXPECT_EQ(joined(write_xdd(*read.file).warnings),
            "the file has no date of its creation, which an XDD must have: 1970-01-01 is written\n");
}

TEST(XddRoundTrip, Configuration_ComesBackFromAnXdc) {
  const ReadResult read =
      read_device_file(rich +
                       "[DeviceComissioning]\nNodeID=5\nNodeName=P & Q\nBaudrate=250\nNetNumber=3\n"
                       "NetworkName=Line\nCANopenManager=1\n");
  ASSERT_NE(read.file, nullptr);
  EXPECT_EQ(in_xdd(*read.file), "");
  EXPECT_EQ(in_xdd_and_eds(*read.file), "");
}

TEST(EdsWriter, LimitsFlagsAndConfiguredValues_AreWritten) {
  const ReadResult read = read_device_file(rich);
  ASSERT_NE(read.file, nullptr);
  const WrittenFile eds = write_eds(*read.file);
  EXPECT_EQ(joined(eds.warnings), "");
  const auto section = [&](const std::string& title) {
    const std::size_t begin = eds.text.find('[' + title + "]\r\n");
    return eds.text.substr(begin, eds.text.find("\r\n\r\n", begin) - begin);
  };
  EXPECT_EQ(section("2000sub1"),
            "[2000sub1]\r\nParameterName=I16 <&\"'>\r\nObjectType=0x7\r\nDataType=0x0003\r\nAccessType=rw\r\n"
            "LowLimit=-10\r\nHighLimit=100\r\nDefaultValue=0xFFFB\r\nPDOMapping=0");
  EXPECT_EQ(section("2000sub8"),
            "[2000sub8]\r\nParameterName=Out\r\nObjectType=0x7\r\nDataType=0x0005\r\nAccessType=rww\r\n"
            "DefaultValue=3\r\nParameterValue=7\r\nPDOMapping=1\r\nDenotation=Speed");
  EXPECT_EQ(difference(all_of(*read.file), all_of(*read_device_file(eds.text).file)), "");
}

TEST(EdsWriter, DeviceOfCode_GetsItsLimits) {
  canopen::DictionaryBuilder builder;
  builder.variable(0x2000,
                   {.name = "V", .type = canopen::DataType::unsigned8, .limits = {.low = 2, .high = 200}});
  const std::string text = write_device_file({}, {}, *builder.build());
  EXPECT_NE(text.find("LowLimit=2\r\nHighLimit=0xC8\r\n"), std::string::npos) << text;
}

TEST(XddWriter, WhatAnXddCannotSay_IsAWarning) {
  const ReadResult read = read_device_file(
      with_object("[2000]\nParameterName=A\x01"
                  "B\nDataType=5\nAccessType=rwr\n"
                  "[2001]\nParameterName=C\nDataType=9\nAccessType=rw\nDefaultValue=a\xFC\n"
                  "[2002]\nParameterName=D\nObjectType=2\nDataType=0xF\nAccessType=rw\nUploadFile=x\n"
                  "[Comments]\nLines=1\nLine1=x\n"
                  "[DeviceComissioning]\nNodeName=x\nLSS_SerialNumber=7\n"));
  ASSERT_NE(read.file, nullptr);
  const std::string warnings = joined(write_xdd(*read.file).warnings);
  EXPECT_NE(warnings.find("2000H: name has characters that XML cannot say: ? is written\n"),
            std::string::npos);
  EXPECT_NE(warnings.find("2000H: rwr of an object that is in no PDO: rw is written\n"), std::string::npos);
  EXPECT_NE(warnings.find("2001H: defaultValue is no UTF-8 text"), std::string::npos);
  EXPECT_NE(warnings.find("2002H: the names of its files have no place"), std::string::npos);
  EXPECT_NE(warnings.find("the comments have no place"), std::string::npos);
  EXPECT_NE(warnings.find("LSS_SerialNumber has no place"), std::string::npos);
  EXPECT_NE(warnings.find("the file names no node-ID"), std::string::npos);
  EXPECT_NE(read_device_file(write_xdd(*read.file).text).file, nullptr);
}

TEST(XddWriter, WhatItWritesOtherwise_IsNamed) {
  const auto warnings_of = [](const std::string& info, const std::string& device) {
    std::string text = base;
    text.replace(text.find("[FileInfo]\n"), 11, "[FileInfo]\nCreationDate=12-31-2025\n" + info);
    text.replace(text.find("[DeviceInfo]\n"), 13, "[DeviceInfo]\n" + device);
    return joined(write_xdd(*read_device_file(text).file).warnings);
  };
  EXPECT_EQ(warnings_of("CreationTime=8:05AM\nModificationTime=04:49 PM\n", ""), "");
  EXPECT_EQ(warnings_of("ModificationTime=00:00PM\n", ""),
            "ModificationTime=00:00PM is written as 12:00:00\n");
  EXPECT_EQ(warnings_of("CreationTime=noon\nModificationDate=31.12.2025\n", ""),
            "CreationTime=noon is not as CiA 306 has it: left out\n"
            "ModificationDate=31.12.2025 is not as CiA 306 has it: left out\n");
  EXPECT_EQ(warnings_of("", "CompactPDO=3\n"), "CompactPDO=3 has no place in an XDD: its PDOs are written\n");
}

TEST(Losses, WhatADeviceFileHasNoPlaceFor_IsNamed) {
  EXPECT_EQ(joined(beyond_device_file(rich + "[Tools]\nItems=1\n[0005]\nParameterName=U8\nObjectType=5\n"
                                             "[2003ObjectLinks]\nObjectLinks=0\n[2004]\nParamRefd=x\n"
                                             "[M1ModuleInfo]\nProductName=x\n")),
            "[Tools] has no place in a file written anew: left out\n"
            "[0005] has no place in a file written anew: left out\n"
            "[2003ObjectLinks] has no place in a file written anew: left out\n"
            "objectlinks of 1 object has no place in a file written anew: left out\n"
            "paramrefd of 1 object has no place in a file written anew: left out\n");
  std::string text = xdd("",
                         "<ApplicationProcess><parameterList><parameter uniqueID=\"P\"><unit/></parameter>"
                         "</parameterList></ApplicationProcess>");
  text.insert(text.find("</DeviceIdentity>"), "<instanceName>x</instanceName>");
  EXPECT_EQ(joined(beyond_device_file(text)),
            "ApplicationProcess (units and groups of parameters, types of their own) has no place in "
            "other device files: left out\n"
            "instanceName of DeviceIdentity has no place in other device files: left out\n");
  EXPECT_EQ(joined(beyond_device_file(base)), "");
}

TEST(EdsWriter, LineEndsInNames_AreReplacedWithAWarning) {
  const ReadResult read =
      read_device_file(xdd("<CANopenObject index=\"2000\" name=\"A&#10;[1000]\" objectType=\"7\" "
                           "dataType=\"0005\" accessType=\"rw\"/>\n"));
  ASSERT_NE(read.file, nullptr);
  const WrittenFile eds = write_eds(*read.file);
  EXPECT_EQ(joined(eds.warnings), "ParameterName has a line end or the like in it: a blank is written\n");
  EXPECT_NE(eds.text.find("ParameterName=A [1000]\r\n"), std::string::npos);
}

TEST(EdsWriter, MappingAgainstTheAccess_IsNotSaid) {
  using canopen::Access;
  const auto is_said = [](Access access, bool rpdo, bool tpdo) {
    return is_said_to_be_mappable({.access = access, .rpdo_mappable = rpdo, .tpdo_mappable = tpdo});
  };
  for (const Access access : {Access::read_only, Access::constant, Access::read_write_input}) {
    EXPECT_TRUE(is_said(access, false, true));
    EXPECT_FALSE(is_said(access, true, true)) << "an RPDO of the file has it all the same";
    EXPECT_FALSE(is_said(access, true, false));
  }
  for (const Access access : {Access::write_only, Access::read_write_output}) {
    EXPECT_TRUE(is_said(access, true, false));
    EXPECT_FALSE(is_said(access, true, true));
    EXPECT_FALSE(is_said(access, false, true));
  }
  EXPECT_TRUE(is_said(Access::read_write, true, true));
  EXPECT_FALSE(is_said(Access::read_write, true, false));
  EXPECT_FALSE(is_said(Access::read_write, false, false));
}

TEST(XddWriter, DatesAndTimes_AreThoseOfXml) {
  EXPECT_EQ(xdd_date("12-31-2025"), "2025-12-31");
  EXPECT_EQ(xdd_date("31-12-2025"), "");
  EXPECT_EQ(xdd_date(""), "");
  EXPECT_EQ(xdd_time("04:49PM"), "16:49:00");
  EXPECT_EQ(xdd_time("12:00AM"), "00:00:00");
  EXPECT_EQ(xdd_time("12:00pm"), "12:00:00");
  EXPECT_EQ(xdd_time("8:05AM"), "08:05:00");
  EXPECT_EQ(xdd_time("04:49 PM"), "16:49:00");
  EXPECT_EQ(xdd_time("4:49"), "");
}

TEST(XddRoundTrip, FilesOfVendors_ComeBack) {
  const std::filesystem::path folder = CANOPUS_SOURCE_DIR "/../shared/data/eds";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no device files in " << folder;
  unsigned files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto text = read_text(entry.path());
    const ReadResult read = read_device_file(text.value_or(""));
    if (read.file == nullptr) continue;
    ++files;
    EXPECT_EQ(in_xdd(*read.file), "") << entry.path();
    EXPECT_EQ(in_xdd_and_eds(*read.file), "") << entry.path();
    EXPECT_EQ(difference(all_of(*read.file), all_of(*read_device_file(write_eds(*read.file).text).file)), "")
        << entry.path();
  }
  EXPECT_GE(files, 41U);
}

rc::Gen<canopen::EntrySpec> entry_spec() {
  return rc::gen::exec([] {
    using canopen::DataType;
    const DataType types[] = {DataType::boolean,       DataType::integer8,     DataType::integer24,
                              DataType::integer64,     DataType::unsigned8,    DataType::unsigned40,
                              DataType::unsigned64,    DataType::octet_string, DataType::time_of_day,
                              DataType::visible_string};
    canopen::EntrySpec spec;
    spec.type = *rc::gen::elementOf(std::vector<DataType>(std::begin(types), std::end(types)));
    const auto printable_text = rc::gen::container<std::string>(rc::gen::inRange<char>(' ', 127));
    spec.name = "N" + *printable_text + "N";
    spec.access = static_cast<canopen::Access>(*rc::gen::inRange(0, 6));
    const std::size_t length = canopen::byte_length(spec.type);
    if (spec.type == DataType::visible_string) {
      const std::string text = *printable_text;
      spec.value.assign(text.begin(), text.end());
    } else {
      spec.value = *rc::gen::container<std::vector<std::uint8_t>>(length == 0 ? 5 : length,
                                                                  rc::gen::arbitrary<std::uint8_t>());
      if (spec.type == DataType::boolean) spec.value[0] &= 1;
    }
    return spec;
  });
}

RC_GTEST_PROP(XddRoundTrip, AnyValueAndName_ComesBack, ()) {
  canopen::DictionaryBuilder builder;
  builder.variable(0x1000,
                   {.name = "Device type", .access = canopen::Access::read_only, .value = {1, 0, 0, 0}});
  builder.variable(0x1001,
                   {.name = "E", .type = canopen::DataType::unsigned8, .access = canopen::Access::read_only});
  builder.object(0x1018, canopen::ObjectCode::record, "I");
  builder.sub(0x1018, 1, {.name = "V", .access = canopen::Access::read_only});
  builder.variable(0x2000, *entry_spec());
  DeviceFile file;
  file.file.creation_date = "12-31-2025";
  file.dictionary = builder.build();
  const ReadResult read = read_device_file(write_eds(file).text);
  RC_ASSERT(read.file != nullptr);
  const auto bytes = [](const DeviceFile& device) {
    const canopen::Entry entry = device.dictionary->find(0x2000, 0);
    return entry.description->length == 0 ? device.dictionary->default_slot(entry.offset)
                                          : canopen::little_endian(device.dictionary->default_value(entry, 0),
                                                                   entry.description->length);
  };
  RC_ASSERT(bytes(*read.file) == bytes(file));
  const ReadResult again = read_device_file(write_xdd(*read.file).text);
  RC_ASSERT(again.file != nullptr);
  RC_ASSERT(bytes(*again.file) == bytes(file));
  RC_ASSERT(again.file->dictionary->name(again.file->dictionary->find(0x2000, 0)) ==
            file.dictionary->name(file.dictionary->find(0x2000, 0)));
}

// 254 sub-indexes in six lines: 1.4 MB would become half a gigabyte.
TEST(XddRoundTrip, FileOfTooManySubIndexes_IsNotWritten) {
  const auto device = [](int arrays) {
    std::string text =
        "[DeviceInfo]\nVendorName=x\n[1000]\nParameterName=Device "
        "type\nObjectType=7\nDataType=7\nAccessType=ro\n";
    for (int i = 0; i < arrays; ++i) {
      text += "[" + std::to_string(2000 + i) +
              "]\nParameterName=A\nObjectType=8\nDataType=5\nAccessType=rw\nCompactSubObj=254\n";
    }
    return read_device_file(text).file;
  };
  // 1000H, 1001H and 1018H have 7 sub-indexes, each array 255.
  EXPECT_EQ(too_much_to_write(*device(392)), "");
  EXPECT_EQ(
      too_much_to_write(*device(393)),
      "the file describes 100222 sub-indexes, and what is written describes each; expected at most 100000");
}

}  // namespace
}  // namespace canopus::eds::xdd_round_trip_test
