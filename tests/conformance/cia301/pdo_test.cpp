// PDO, CiA 301 7.2.2: parameters, changing a mapping, transmission types, lengths.

#include "conformance/cia301/script.hpp"

namespace canopus::canopen::pdo_test {
namespace {

class Pdo : public testing::TestWithParam<Case> {};
TEST_P(Pdo, Conversation) {
  Conversation node;
  run(node, GetParam().script);
}

std::vector<Case> transmission_types() {
  std::vector<Case> cases;
  const auto add = [&cases](const char* name, const char* address, unsigned type, bool accepted) {
    char digits[4];
    std::snprintf(digits, sizeof digits, "%02X", type);
    const std::string written = std::string("605 2F ") + address + hex(type, 1) + " 00 00 00 -> 585";
    cases.push_back(
        {std::string(name) + "_Type" + digits, accepted ? written + " 60 " + address + " 00 00 00 00"
                                                        : written + " 80 " + address + " 30 00 09 06"});
  };
  for (const unsigned type : {0x00U, 0x01U, 0x02U, 0x7FU, 0xEFU, 0xF0U}) {
    add("Tpdo", "00 18 02", type, true);
    add("Rpdo", "00 14 02", type, true);
  }
  for (unsigned type = 0xF1; type <= 0xFB; ++type) {
    add("Tpdo", "00 18 02", type, false);
    add("Rpdo", "00 14 02", type, false);
  }
  for (const unsigned type : {0xFCU, 0xFDU}) {
    add("Tpdo", "00 18 02", type, true);
    add("Rpdo", "00 14 02", type, false);
  }
  for (const unsigned type : {0xFEU, 0xFFU}) {
    add("Tpdo", "00 18 02", type, true);
    add("Rpdo", "00 14 02", type, true);
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(TransmissionType, Pdo, testing::ValuesIn(transmission_types()), case_name);

const Case parameters[] = {
    {"Rpdo_HighestSubIndexIsConstant", "605 2F 00 14 00 02 00 00 00 -> 585 80 00 14 00 02 00 01 06"},
    {"Tpdo_HighestSubIndexIsConstant", "605 2F 00 18 00 02 00 00 00 -> 585 80 00 18 00 02 00 01 06"},
    {"Tpdo_ReservedSubIndex", "605 2F 00 18 04 00 00 00 00 -> 585 80 00 18 04 11 00 09 06"},
    {"Rpdo_NoSyncStartValue", "605 2F 00 14 06 00 00 00 00 -> 585 80 00 14 06 11 00 09 06"},
    {"Rpdo_InhibitTimeHasNoRule",
     "605 23 00 14 01 05 02 00 00 -> 585 60 00 14 01 00 00 00 00\n"
     "605 2B 00 14 03 0A 00 00 00 -> 585 60 00 14 03 00 00 00 00"},
    {"Tpdo_InhibitTimeWhileInvalid", "605 2B 00 18 03 0A 00 00 00 -> 585 60 00 18 03 00 00 00 00"},
    {"Tpdo_InhibitTimeWhileValid",
     "605 23 00 18 01 85 01 00 40 -> 585 60 00 18 01 00 00 00 00\n"
     "605 2B 00 18 03 0A 00 00 00 -> 585 80 00 18 03 30 00 09 06"},
    {"Tpdo_EventTimerWhileValid",
     "605 23 00 18 01 85 01 00 40 -> 585 60 00 18 01 00 00 00 00\n"
     "605 2B 00 18 05 0A 00 00 00 -> 585 60 00 18 05 00 00 00 00"},
    {"Tpdo_SyncStartValue240", "605 2F 00 18 06 F0 00 00 00 -> 585 60 00 18 06 00 00 00 00"},
    {"Tpdo_SyncStartValue241", "605 2F 00 18 06 F1 00 00 00 -> 585 80 00 18 06 30 00 09 06"},
    {"Tpdo_SyncStartValueWhileValid",
     "605 23 00 18 01 85 01 00 40 -> 585 60 00 18 01 00 00 00 00\n"
     "605 2F 00 18 06 01 00 00 00 -> 585 80 00 18 06 30 00 09 06"},
    {"Tpdo_RtrTypeWithBit30",
     "605 23 00 18 01 85 01 00 C0 -> 585 60 00 18 01 00 00 00 00\n"
     "605 2F 00 18 02 FD 00 00 00 -> 585 80 00 18 02 30 00 09 06"},
    {"Tpdo_Bit30WithRtrType",
     "605 2F 00 18 02 FC 00 00 00 -> 585 60 00 18 02 00 00 00 00\n"
     "605 23 00 18 01 85 01 00 40 -> 585 80 00 18 01 30 00 09 06"},
    {"Pdo5_IsNotThere", "605 40 04 14 01 00 00 00 00 -> 585 80 04 14 01 00 00 02 06"},
};
INSTANTIATE_TEST_SUITE_P(Parameter, Pdo, testing::ValuesIn(parameters), case_name);

const Case mapping[] = {
    {"Procedure",
     "605 23 00 18 01 85 01 00 C0 -> 585 60 00 18 01 00 00 00 00\n"
     "605 2F 00 1A 00 00 00 00 00 -> 585 60 00 1A 00 00 00 00 00\n"
     "605 23 00 1A 01 08 01 00 60 -> 585 60 00 1A 01 00 00 00 00\n"
     "605 23 00 1A 02 10 01 01 64 -> 585 60 00 1A 02 00 00 00 00\n"
     "605 2F 00 1A 00 02 00 00 00 -> 585 60 00 1A 00 00 00 00 00\n"
     "605 23 00 18 01 85 01 00 40 -> 585 60 00 18 01 00 00 00 00\n"
     "000 01 05 -> 185 00 00 00"},
    {"CountWhileValid",
     "605 23 00 18 01 85 01 00 40 -> 585 60 00 18 01 00 00 00 00\n"
     "605 2F 00 1A 00 00 00 00 00 -> 585 80 00 1A 00 22 00 00 08"},
    {"EntryWhileValid",
     "605 23 00 18 01 85 01 00 40 -> 585 60 00 18 01 00 00 00 00\n"
     "605 23 00 1A 01 08 01 00 60 -> 585 80 00 1A 01 22 00 00 08"},
    {"EntryWhileSwitchedOn",
     "605 23 00 1A 01 08 01 00 60 -> 585 60 00 1A 01 00 00 00 00\n"
     "605 2F 00 1A 00 01 00 00 00 -> 585 60 00 1A 00 00 00 00 00\n"
     "605 23 00 1A 01 08 02 00 60 -> 585 80 00 1A 01 00 00 01 06"},
    {"NoObject", "605 23 00 1A 01 08 01 FF 5F -> 585 80 00 1A 01 00 00 02 06"},
    {"NoSubIndex", "605 23 00 1A 01 08 09 00 60 -> 585 80 00 1A 01 11 00 09 06"},
    {"NotMappable", "605 23 00 1A 01 08 00 04 20 -> 585 80 00 1A 01 41 00 04 06"},
    {"OutputInTpdo", "605 23 00 1A 01 08 01 00 62 -> 585 80 00 1A 01 41 00 04 06"},
    {"InputInRpdo", "605 23 00 16 01 08 01 00 60 -> 585 80 00 16 01 41 00 04 06"},
    {"LengthOfAnotherType", "605 23 00 1A 01 10 01 00 60 -> 585 80 00 1A 01 41 00 04 06"},
    {"LengthZero", "605 23 00 1A 01 00 01 00 60 -> 585 80 00 1A 01 41 00 04 06"},
    {"EntryZeroIsUnused", "605 23 00 1A 01 00 00 00 00 -> 585 60 00 1A 01 00 00 00 00"},
    {"CountOverAnUnusedEntry", "605 2F 00 1A 00 01 00 00 00 -> 585 80 00 1A 00 00 00 02 06"},
    {"CountBeyondTheEntries", "605 2F 00 1A 00 09 00 00 00 -> 585 80 00 1A 00 42 00 04 06"},
    {"Count41h", "605 2F 00 1A 00 41 00 00 00 -> 585 80 00 1A 00 30 00 09 06"},
    {"CountFdh", "605 2F 00 1A 00 FD 00 00 00 -> 585 80 00 1A 00 30 00 09 06"},
    {"MoreThan64Bits",
     "605 23 00 1A 01 40 00 00 65 -> 585 60 00 1A 01 00 00 00 00\n"
     "605 23 00 1A 02 08 01 00 60 -> 585 60 00 1A 02 00 00 00 00\n"
     "605 2F 00 1A 00 02 00 00 00 -> 585 80 00 1A 00 42 00 04 06"},
    {"Exactly64Bits",
     "605 23 00 1A 01 40 00 00 65 -> 585 60 00 1A 01 00 00 00 00\n"
     "605 2F 00 1A 00 01 00 00 00 -> 585 60 00 1A 00 00 00 00 00"},
    {"DummyBoolean", "605 23 00 16 01 01 00 01 00 -> 585 60 00 16 01 00 00 00 00"},
    {"DummyInteger8", "605 23 00 16 01 08 00 02 00 -> 585 60 00 16 01 00 00 00 00"},
    {"DummyInteger16", "605 23 00 16 01 10 00 03 00 -> 585 60 00 16 01 00 00 00 00"},
    {"DummyInteger32", "605 23 00 16 01 20 00 04 00 -> 585 60 00 16 01 00 00 00 00"},
    {"DummyUnsigned8", "605 23 00 16 01 08 00 05 00 -> 585 60 00 16 01 00 00 00 00"},
    {"DummyUnsigned16", "605 23 00 16 01 10 00 06 00 -> 585 60 00 16 01 00 00 00 00"},
    {"DummyUnsigned32", "605 23 00 16 01 20 00 07 00 -> 585 60 00 16 01 00 00 00 00"},
    {"DummyOfAnotherLength", "605 23 00 16 01 10 00 05 00 -> 585 80 00 16 01 41 00 04 06"},
    {"DummyInTpdo", "605 23 00 1A 01 08 00 05 00 -> 585 80 00 1A 01 41 00 04 06"},
    {"DummyReal32IsNone", "605 23 00 16 01 20 00 08 00 -> 585 80 00 16 01 00 00 02 06"},
    {"ValidWithEmptyMapping",
     "605 23 00 18 01 85 01 00 40 -> 585 60 00 18 01 00 00 00 00\n"
     "000 01 05 ->"},  // allowed, but there is nothing to send
};
INSTANTIATE_TEST_SUITE_P(Mapping, Pdo, testing::ValuesIn(mapping), case_name);

/// RPDO1 with 6200:01-02 and type FEH; TPDO1 with 6500H and type 1: what arrives in the one leaves in the
/// other.
class PdoTraffic : public testing::TestWithParam<Case> {};
TEST_P(PdoTraffic, Conversation) {
  Conversation node;
  node.set_up(0x1400, {0x62000108, 0x62000208}, 0xFE);
  node.set_up(0x1401, {0x65000040}, 0x01);
  node.set_up(0x1800, {0x65000040}, 0x01);
  run(node, GetParam().script);
}
const std::string read_output = "605 40 00 62 01 00 00 00 00 -> 585 4F 00 62 01";
const Case traffic[] = {
    {"PreOperational_RpdoIsIgnored", "205 11 22 ->\n" + read_output + " 00 00 00 00"},
    {"PreOperational_TpdoIsSilent", "080 ->"},
    {"Stopped_RpdoIsIgnored", "000 02 05 ->\n205 11 22 ->\n000 80 05 ->\n" + read_output + " 00 00 00 00"},
    {"Stopped_TpdoIsSilent", "000 02 05 ->\n080 ->"},
    {"Operational_RpdoIsTaken", "000 01 05 ->\n205 11 22 ->\n" + read_output + " 11 00 00 00"},
    {"Operational_TpdoAnswersSync", "000 01 05 ->\n080 -> 185 00 00 00 00 00 00 00 00"},
    {"BackToPreOperational_TpdoIsSilent", "000 01 05 ->\n000 80 05 ->\n080 ->"},
    {"TooShort", "000 01 05 ->\n205 11 -> 085 10 82 11 00 00 00 00 00\n" + read_output + " 00 00 00 00"},
    {"NoDataAtAll", "000 01 05 ->\n205 -> 085 10 82 11 00 00 00 00 00"},
    {"TooLong", "000 01 05 ->\n205 11 22 33 -> 085 20 82 11 00 00 00 00 00\n" + read_output + " 11 00 00 00"},
    {"RemoteFrameForAnRpdo", "000 01 05 ->\n205 R2 ->\n" + read_output + " 00 00 00 00"},
    {"ExtendedFrameOfTheSameNumber", "000 01 05 ->\n00000205 11 22 ->\n" + read_output + " 00 00 00 00"},
    {"RemoteFrameWithBit30", "000 01 05 ->\n185 R8 ->"},
    {"OwnTpdoIdentifierReceived", "000 01 05 ->\n185 11 22 ->"},
    {"SynchronousRpdo_IsSentBackOneSyncLater",
     "000 01 05 ->\n305 01 02 03 04 05 06 07 08 ->\n"
     "080 -> 185 00 00 00 00 00 00 00 00\n080 -> 185 01 02 03 04 05 06 07 08"},
    {"SynchronousRpdo_TheLastOneCounts",
     "000 01 05 ->\n305 01 02 03 04 05 06 07 08 ->\n305 11 12 13 14 15 16 17 18 ->\n"
     "080 -> 185 00 00 00 00 00 00 00 00\n080 -> 185 11 12 13 14 15 16 17 18"},
    {"SynchronousRpdo_IsForgottenOnLeavingOperational",
     "000 01 05 ->\n305 01 02 03 04 05 06 07 08 ->\n000 80 05 ->\n000 01 05 ->\n"
     "080 -> 185 00 00 00 00 00 00 00 00\n080 -> 185 00 00 00 00 00 00 00 00"},
};
INSTANTIATE_TEST_SUITE_P(Traffic, PdoTraffic, testing::ValuesIn(traffic), case_name);

/// TPDO type n answers every n-th SYNC, for every n.
class CyclicTpdo : public testing::TestWithParam<int> {};
TEST_P(CyclicTpdo, IsSentAtEveryNthSync) {
  Conversation node;
  const int n = GetParam();
  node.set_up(0x1800, {0x60000108}, static_cast<std::uint8_t>(n));
  node.start();
  for (int sync = 1; sync <= 3 * n; ++sync) {
    ASSERT_EQ(node.receive("080"), sync % n == 0 ? "185 00" : "") << "SYNC " << sync;
  }
}
INSTANTIATE_TEST_SUITE_P(Period, CyclicTpdo, testing::Values(1, 2, 3, 7, 16, 127, 128, 239, 240));

}  // namespace
}  // namespace canopus::canopen::pdo_test
