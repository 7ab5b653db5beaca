// Objects of the communication profile that a file describes without a value: they get CiA 301's. COB-IDs
// with a CAN-ID that CiA 301 restricts: reported.

#include <gmock/gmock.h>

#include "eds/reading.hpp"

namespace canopus::eds::communication_defaults_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// A variable of the communication profile, with these lines in addition.
std::string variable(std::string_view index, std::string_view lines) {
  return base + "[" + std::string(index) + "]\nParameterName=X\nDataType=7\nAccessType=rw\n" +
         std::string(lines);
}

/// A record with COB-ID and, as sub-index 02H, what `second` says; `value` is the COB-ID's DefaultValue line.
std::string record(const std::string& index, const std::string& value,
                   const std::string& second = "DataType=5\n") {
  return base + "[" + index + "]\nParameterName=R\nObjectType=9\n[" + index +
         "sub0]\nParameterName=Highest\nDataType=5\nAccessType=const\nDefaultValue=2\n[" + index +
         "sub1]\nParameterName=COB-ID\nDataType=7\nAccessType=rw\n" + value + "[" + index +
         "sub2]\nParameterName=Second\nAccessType=rw\n" + second;
}

std::uint64_t number(const std::string& text, std::uint16_t index, std::uint8_t sub = 0) {
  return default_value(*read_device_file(text).file->dictionary, index, sub, 5).value_or(~0ULL);
}

TEST(CommunicationDefault, OfAnObjectWithoutValueIsTheStandards) {
  EXPECT_EQ(number(variable("1005", ""), 0x1005), 0x80U);
  EXPECT_EQ(number(variable("1005", "DefaultValue=\n"), 0x1005), 0x80U);
  EXPECT_EQ(number(variable("1012", ""), 0x1012), 0x100U);
  EXPECT_EQ(number(variable("1014", ""), 0x1014), 0x85U);
  EXPECT_EQ(number(variable("1014", "DefaultValue=none\n"), 0x1014), 0x85U);
  EXPECT_EQ(number(base + "[1015]\nParameterName=X\nDataType=6\nAccessType=rw\n", 0x1015), 0U);
}

TEST(CommunicationDefault, OfPdosIsThePredefinedConnectionSet) {
  const std::pair<const char*, std::uint64_t> cob_ids[] = {
      {"1400", 0x205},           {"1401", 0x305},           {"1402", 0x405},          {"1403", 0x505},
      {"1404", 1 << 31U | 0ULL}, {"1800", 0x185},           {"1801", 0x285},          {"1802", 0x385},
      {"1803", 0x485},           {"1804", 1 << 31U | 0ULL}, {"19FF", 1 << 31U | 0ULL}};
  for (const auto& [index, expected] : cob_ids) {
    const auto object = static_cast<std::uint16_t>(std::stoul(index, nullptr, 16));
    EXPECT_EQ(number(record(index, ""), object, 1), expected & 0xFFFF'FFFFU) << index;
    EXPECT_EQ(number(record(index, ""), object, 2), 0xFFU) << index;
  }
}

TEST(CommunicationDefault, OfSdoChannels) {
  const std::string second = "DataType=7\n";
  EXPECT_EQ(number(record("1200", "", second), 0x1200, 1), 0x605U);
  EXPECT_EQ(number(record("1200", "", second), 0x1200, 2), 0x585U);
  EXPECT_EQ(number(record("1201", "", second), 0x1201, 1), 0x8000'0000U);
  EXPECT_EQ(number(record("1280", "", second), 0x1280, 2), 0x8000'0000U);
}

TEST(CommunicationDefault, OfACompactObjectHoldsForAllOfIt) {
  const std::string text =
      base + "[1028]\nParameterName=C\nObjectType=8\nDataType=7\nAccessType=rw\nCompactSubObj=127\n";
  EXPECT_EQ(number(text, 0x1028, 1), 0x8000'0000U);
  EXPECT_EQ(number(text, 0x1028, 127), 0x8000'0000U);
}

TEST(CommunicationDefault, IsNoted) {
  EXPECT_THAT(all_problems(read_device_file(variable("1014", ""))),
              HasSubstr("note: 1014H has no value: taken as $NODEID+80H, the default of CiA 301"));
  EXPECT_THAT(all_problems(read_device_file(record("1804", ""))),
              HasSubstr("note: 1804:01 has no value: taken as 80000000H, the default of CiA 301"));
}

/// One sub-index of the communication profile that has no DataType.
canopen::DataType type_without(const std::string& index, std::uint8_t sub, bool is_variable = false) {
  std::string text = base + "[" + index + "]\nParameterName=X\n";
  const std::string keys = "AccessType=rw\n";
  if (is_variable) {
    text += "ObjectType=7\n" + keys;
  } else {
    text +=
        "ObjectType=9\nSubNumber=2\n[" + index + "sub" + std::to_string(sub) + "]\nParameterName=M\n" + keys;
  }
  const ReadResult result = read_device_file(text);
  EXPECT_FALSE(result.has_losses()) << all_problems(result);
  const auto number = static_cast<std::uint16_t>(std::stoul(index, nullptr, 16));
  return result.file->dictionary->find(number, sub).description->type;
}

// [CiA 301 7.5.2, CiA 302-2]
TEST(StandardType, OfAnObjectWithoutOneIsTheStandards) {
  using enum canopen::DataType;
  const std::pair<const char*, canopen::DataType> variables[] = {
      {"1002", unsigned32},     {"1005", unsigned32},     {"1006", unsigned32}, {"1007", unsigned32},
      {"1008", visible_string}, {"100A", visible_string}, {"100C", unsigned16}, {"100D", unsigned8},
      {"1014", unsigned32},     {"1015", unsigned16},     {"1017", unsigned16}, {"1019", unsigned8},
      {"1021", domain},         {"102A", unsigned16},     {"1F80", unsigned32}, {"1F89", unsigned32}};
  for (const auto& [index, type] : variables) EXPECT_EQ(type_without(index, 0, true), type) << index;
  struct Member {
    const char* index;
    std::uint8_t sub;
    canopen::DataType type;
  };
  const Member members[] = {{"1003", 1, unsigned32}, {"1010", 1, unsigned32}, {"1016", 3, unsigned32},
                            {"1029", 1, unsigned8},  {"1200", 1, unsigned32}, {"1280", 3, unsigned8},
                            {"1400", 1, unsigned32}, {"15FF", 2, unsigned8},  {"1800", 3, unsigned16},
                            {"1800", 5, unsigned16}, {"1800", 6, unsigned8},  {"1600", 1, unsigned32},
                            {"1A00", 8, unsigned32}, {"1F22", 2, domain},     {"1F81", 5, unsigned32},
                            {"1F82", 9, unsigned8},  {"1FA0", 1, unsigned32}, {"1FD0", 1, unsigned64}};
  for (const Member& member : members)
    EXPECT_EQ(type_without(member.index, member.sub), member.type) << member.index << ':' << int{member.sub};
}

TEST(StandardType, IsNoted_AndTheFilesOwnCounts) {
  const std::string error_register = "[1001]\nParameterName=E\nObjectType=7\nAccessType=ro\n";
  std::string text = base;
  const std::size_t at = text.find("[1001]");
  text.replace(at, text.find("[1018]") - at, error_register);
  const ReadResult result = read_device_file(text);
  EXPECT_EQ(value(result, 0x1001), (std::vector<std::uint8_t>{0}));  // one byte
  EXPECT_THAT(all_problems(result),
              HasSubstr("note: 1001:00 has no DataType: taken as UNSIGNED8, as CiA 301 has it"));
  EXPECT_EQ(value(read_device_file(variable("1015", "DefaultValue=7\n")), 0x1015).size(), 4U);  // DataType=7
}

TEST(StandardType, OfARecordThatHasAStructureAsItsType) {
  const std::string text = base +
                           "[1400]\nParameterName=R\nObjectType=9\nDataType=0x20\nSubNumber=3\n"
                           "[1400sub0]\nParameterName=N\nAccessType=ro\nDefaultValue=2\n"
                           "[1400sub1]\nParameterName=C\nAccessType=rw\nDefaultValue=$NODEID+0x200\n"
                           "[1400sub2]\nParameterName=T\nAccessType=rw\nDefaultValue=1\n";
  const ReadResult result = read_device_file(text);
  EXPECT_EQ(value(result, 0x1400, 1), (std::vector<std::uint8_t>{0x05, 0x02, 0, 0}));
  EXPECT_EQ(value(result, 0x1400, 2), (std::vector<std::uint8_t>{1}));
  EXPECT_FALSE(result.has_losses()) << all_problems(result);
}

TEST(PdoCobId, OfSeveralNumbers_StaysOff) {
  for (const char* const text :
       {"$NODEID+0x80000000+0x200", "0x80000000+0x200+$NODEID", "0x80000000 + $nodeid + 512",
        "$NODEID+0x80000280-0x80", "($NODEID+0x200)+0x80000000"}) {
    EXPECT_EQ(number(record("1400", std::string("DefaultValue=") + text + "\n"), 0x1400, 1), 0x8000'0205U)
        << text;
  }
}

TEST(PdoCobId, ThatCannotBeRead_StaysOff) {
  for (const char* const text : {"none", "$NODEID*2+0x200", "$NODEID+0x200+$NODEID", "0x200 or 0x300",
                                 "$NODEID+0x180000200", "-1", "%NODE%+0x200"}) {
    for (const char* const index : {"1400", "1803", "1405"}) {
      SCOPED_TRACE(std::string(index) + ' ' + text);
      const ReadResult result = read_device_file(record(index, std::string("DefaultValue=") + text + "\n"));
      const auto object = static_cast<std::uint16_t>(std::stoul(index, nullptr, 16));
      EXPECT_EQ(default_value(*result.file->dictionary, object, 1, 5), 0x8000'0000U);
      EXPECT_THAT(all_problems(result), HasSubstr(std::string("loss: DefaultValue=") + text + " of " + index +
                                                  ":01 is no COB-ID: the PDO is switched off, 80000000H"));
    }
  }
}

TEST(PdoCobId, OfAConfigurationThatCannotBeRead_DoesNotFallBackToItsDefault) {
  const std::string text = record("1400", "DefaultValue=$NODEID+0x200\nParameterValue=later\n");
  EXPECT_EQ(number(text, 0x1400, 1), 0x8000'0000U);
}

TEST(CommunicationDefault, DoesNotReplaceAValue) {
  EXPECT_EQ(number(variable("1005", "DefaultValue=0x81\n"), 0x1005), 0x81U);
  EXPECT_EQ(number(record("1800", "DefaultValue=0x40000281\n"), 0x1800, 1), 0x4000'0281U);
  EXPECT_EQ(number(record("1800", "", "DataType=5\nDefaultValue=0\n"), 0x1800, 2), 0U);
}

struct Restricted {
  const char* index;
  const char* value;
  const char* message;
};
const Restricted restricted[] = {
    {"1005", "0", "1005H is 00000000H: CiA 301 restricts CAN-ID 000H, SYNC is neither sent nor received"},
    {"1012", "0x80000180",
     "1012H is 80000180H: CiA 301 restricts CAN-ID 180H, TIME is neither sent nor received"},
    {"1014", "0", "1014H is 00000000H: CiA 301 restricts CAN-ID 000H, EMCY is not sent"},
    {"1014", "$NODEID+0x700", "1014H is $NODEID+700H: CiA 301 restricts such a CAN-ID, EMCY is not sent"},
};

TEST(RestrictedIdentifier, OfAVariableIsReported) {
  for (const Restricted& r : restricted) {
    const std::string text = variable(r.index, "DefaultValue=" + std::string(r.value) + "\n");
    EXPECT_EQ(problem(read_device_file(text), base_lines + 5), std::string("warning: ") + r.message);
  }
}

TEST(RestrictedIdentifier, OfAPdoOrSdoIsReported) {
  const auto problems = [](const char* index, const std::string& value) {
    return all_problems(read_device_file(record(index, "DefaultValue=" + value + "\n")));
  };
  EXPECT_THAT(problems("1800", "0"),
              HasSubstr("warning: 1800:01 is 00000000H: CiA 301 restricts CAN-ID 000H, TPDO1 is not sent"));
  EXPECT_THAT(problems("1405", "0x40000601"),
              HasSubstr("1405:01 is 40000601H: CiA 301 restricts CAN-ID 601H, RPDO6 is not received"));
  EXPECT_THAT(
      problems("1201", "0x605"),
      HasSubstr("1201:01 is 00000605H: CiA 301 restricts CAN-ID 605H, the SDO server does not exist"));
}

TEST(RestrictedIdentifier, ThatIsSwitchedOffOrAllowedIsNotReported) {
  const auto problems = [](const char* index, const std::string& value) {
    return all_problems(read_device_file(record(index, "DefaultValue=" + value + "\n")));
  };
  EXPECT_THAT(problems("1800", "0x80000000"), Not(HasSubstr("restricts")));
  EXPECT_THAT(problems("1800", "$NODEID+0x180"), Not(HasSubstr("restricts")));
  EXPECT_THAT(problems("1800", "0x20000001"), Not(HasSubstr("restricts")));  // 29 bits
  EXPECT_THAT(problems("1280", "0x605"), Not(HasSubstr("restricts")));       // a server's default channel
  EXPECT_THAT(problems("1200", "$NODEID+0x600"), Not(HasSubstr("restricts")));
  EXPECT_THAT(all_problems(read_device_file(variable("1012", "DefaultValue=0\n"))),
              Not(HasSubstr("restricts")));  // neither consumer nor producer
}

}  // namespace
}  // namespace canopus::eds::communication_defaults_test
