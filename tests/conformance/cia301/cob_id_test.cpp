// COB-ID rules, CiA 301 7.3.5 and the objects that have one: restricted identifiers, bits 11-28, changing one
// that is in use.

#include "conformance/cia301/script.hpp"

namespace canopus::canopen::cob_id_test {
namespace {

struct CobIdObject {
  const char* name;
  std::uint16_t index;
  std::uint8_t sub;
};
const CobIdObject objects[] = {
    {"Rpdo", 0x1400, 1}, {"Tpdo", 0x1800, 1},         {"Sync", 0x1005, 0},
    {"Time", 0x1012, 0}, {"EmcyConsumer", 0x1028, 9},
};
const std::uint32_t restricted[] = {0x000, 0x001, 0x07F, 0x101, 0x180, 0x581, 0x5FF, 0x601,
                                    0x67F, 0x6E0, 0x6FF, 0x701, 0x77F, 0x780, 0x7FF};
const std::uint32_t allowed[] = {0x080, 0x100, 0x181, 0x57F, 0x680, 0x6DF};

class CobIds : public testing::TestWithParam<Case> {};
TEST_P(CobIds, Conversation) {
  Conversation node;
  run(node, GetParam().script);
}

std::vector<Case> identifiers() {
  std::vector<Case> cases;
  for (const CobIdObject& object : objects) {
    const std::string address = hex(object.index, 2) + hex(object.sub, 1);
    const auto write = [&](std::uint32_t value) { return "605 23" + address + hex(value, 4) + " -> 585"; };
    const std::string refused = " 80" + address + " 30 00 09 06";
    const std::string accepted = " 60" + address + " 00 00 00 00";
    char digits[8];
    for (const std::uint32_t id : restricted) {
      std::snprintf(digits, sizeof digits, "%03X", id);
      cases.push_back({std::string(object.name) + "_Restricted" + digits, write(id) + refused});
    }
    for (const std::uint32_t id : allowed) {
      std::snprintf(digits, sizeof digits, "%03X", id);
      cases.push_back({std::string(object.name) + "_Allowed" + digits, write(id) + accepted});
    }
    cases.push_back({std::string(object.name) + "_Bit11WithoutBit29", write(0x0000'0985) + refused});
    cases.push_back({std::string(object.name) + "_Bit28WithoutBit29", write(0x1000'0185) + refused});
    cases.push_back({std::string(object.name) + "_ExtendedIdentifier", write(0x2000'0185) + accepted});
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Identifier, CobIds, testing::ValuesIn(identifiers()), case_name);

const Case changes[] = {
    {"Rpdo_ChangedWhileValid",
     "605 23 00 14 01 05 02 00 00 -> 585 60 00 14 01 00 00 00 00\n"
     "605 23 00 14 01 06 02 00 00 -> 585 80 00 14 01 30 00 09 06"},
    {"Rpdo_SameWhileValid",
     "605 23 00 14 01 05 02 00 00 -> 585 60 00 14 01 00 00 00 00\n"
     "605 23 00 14 01 05 02 00 00 -> 585 60 00 14 01 00 00 00 00"},
    {"Rpdo_ChangedWhileInvalid",
     "605 23 00 14 01 05 02 00 00 -> 585 60 00 14 01 00 00 00 00\n"
     "605 23 00 14 01 06 02 00 80 -> 585 60 00 14 01 00 00 00 00\n"
     "605 23 00 14 01 06 02 00 00 -> 585 60 00 14 01 00 00 00 00"},
    {"Rpdo_FrameFormatChangedWhileValid",
     "605 23 00 14 01 05 02 00 00 -> 585 60 00 14 01 00 00 00 00\n"
     "605 23 00 14 01 05 02 00 20 -> 585 80 00 14 01 30 00 09 06"},
    {"Tpdo_ChangedWhileValid",
     "605 23 00 18 01 85 01 00 40 -> 585 60 00 18 01 00 00 00 00\n"
     "605 23 00 18 01 86 01 00 40 -> 585 80 00 18 01 30 00 09 06"},
    {"Tpdo_ChangedWhileInvalid",
     "605 23 00 18 01 86 01 00 C0 -> 585 60 00 18 01 00 00 00 00\n"
     "605 23 00 18 01 86 01 00 40 -> 585 60 00 18 01 00 00 00 00"},
    {"Sync_ChangedWhileProducing",
     "605 23 05 10 00 80 00 00 40 -> 585 60 05 10 00 00 00 00 00\n"
     "605 23 05 10 00 81 00 00 40 -> 585 80 05 10 00 30 00 09 06"},
    {"Sync_ChangedWhileConsuming", "605 23 05 10 00 81 00 00 00 -> 585 60 05 10 00 00 00 00 00"},
    {"Sync_Bit31IsNotLookedAt", "605 23 05 10 00 80 00 00 80 -> 585 60 05 10 00 00 00 00 00"},
    {"Time_ChangedWhileConsuming",
     "605 23 12 10 00 00 01 00 80 -> 585 60 12 10 00 00 00 00 00\n"
     "605 23 12 10 00 81 01 00 80 -> 585 80 12 10 00 30 00 09 06"},
    {"Time_ChangedWhileProducing",
     "605 23 12 10 00 00 01 00 40 -> 585 60 12 10 00 00 00 00 00\n"
     "605 23 12 10 00 81 01 00 40 -> 585 80 12 10 00 30 00 09 06"},
    {"Emcy_ChangedWhileValid", "605 23 14 10 00 86 00 00 00 -> 585 80 14 10 00 30 00 09 06"},
    {"Emcy_SwitchedOff", "605 23 14 10 00 85 00 00 80 -> 585 60 14 10 00 00 00 00 00"},
    {"Emcy_ChangedWhileOff",
     "605 23 14 10 00 85 00 00 80 -> 585 60 14 10 00 00 00 00 00\n"
     "605 23 14 10 00 86 00 00 00 -> 585 60 14 10 00 00 00 00 00"},
    {"Emcy_RestrictedIdentifier",
     "605 23 14 10 00 85 00 00 80 -> 585 60 14 10 00 00 00 00 00\n"
     "605 23 14 10 00 01 07 00 00 -> 585 80 14 10 00 30 00 09 06"},
    {"EmcyConsumer_ChangedWhileValid",
     "605 23 28 10 09 89 00 00 00 -> 585 60 28 10 09 00 00 00 00\n"
     "605 23 28 10 09 8A 00 00 00 -> 585 80 28 10 09 30 00 09 06"},
};
INSTANTIATE_TEST_SUITE_P(Change, CobIds, testing::ValuesIn(changes), case_name);

}  // namespace
}  // namespace canopus::canopen::cob_id_test
