// NMT slave and error control, CiA 301 7.2.8 and 7.3.2; SYNC, TIME and EMCY in each state.

#include "conformance/cia301/script.hpp"

namespace canopus::canopen::nmt_test {
namespace {

class Nmt : public testing::TestWithParam<Case> {};
TEST_P(Nmt, Conversation) {
  Conversation node;
  run(node, GetParam().script);
}

struct State {
  const char* name;
  const char* command;  // leads to it
  const char* answer;   // to the first guarding request
};
const State states[] = {{"PreOperational", "80", "7F"}, {"Operational", "01", "05"}, {"Stopped", "02", "04"}};
const std::pair<const char*, const char*> commands[] = {{"Start", "01"},
                                                        {"Stop", "02"},
                                                        {"EnterPreOperational", "80"},
                                                        {"ResetNode", "81"},
                                                        {"ResetCommunication", "82"}};

/// Every command in every state, addressed, to all, and to another node; asked for by node guarding.
std::vector<Case> transitions() {
  std::vector<Case> cases;
  for (const State& from : states) {
    const std::string enter = std::string("000 ") + from.command + " 05 ->\n";
    for (const auto& [name, command] : commands) {
      const bool is_reset = command[0] == '8' && command[1] != '0';
      std::string after = "7F";
      for (const State& to : states) {
        if (std::string(to.command) == command) after = to.answer;
      }
      const std::string guard = "705 R1 -> 705 ";
      const std::string boot_up = is_reset ? "705 00" : "";
      const std::string base = std::string(from.name) + "_" + name;
      cases.push_back({base, enter + "000 " + command + " 05 -> " + boot_up + "\n" + guard + after});
      cases.push_back(
          {base + "ToAll", enter + "000 " + command + " 00 -> " + boot_up + "\n" + guard + after});
      cases.push_back({base + "ToAnother", enter + "000 " + command + " 06 ->\n" + guard + from.answer});
    }
    for (const char* unknown : {"00", "03", "04", "7F", "83", "FF"}) {
      cases.push_back({std::string(from.name) + "_UnknownCommand" + unknown,
                       enter + "000 " + unknown + " 05 ->\n705 R1 -> 705 " + from.answer});
    }
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Transition, Nmt, testing::ValuesIn(transitions()), case_name);

const Case malformed[] = {
    {"NoData", "000 ->\n705 R1 -> 705 7F"},
    {"OneByte", "000 01 ->\n705 R1 -> 705 7F"},
    {"ThreeBytes", "000 01 05 00 ->\n705 R1 -> 705 7F"},
    {"EightBytes", "000 01 05 00 00 00 00 00 00 ->\n705 R1 -> 705 7F"},
    {"RemoteFrame", "000 R2 ->\n705 R1 -> 705 7F"},
    {"ExtendedFrame", "00000000 01 05 ->\n705 R1 -> 705 7F"},
    {"NodeId128", "000 01 80 ->\n705 R1 -> 705 7F"},
};
INSTANTIATE_TEST_SUITE_P(Malformed, Nmt, testing::ValuesIn(malformed), case_name);

/// Which services there are in which state.
const std::string sdo = "605 40 01 10 00 00 00 00 00 -> ";
const std::string heartbeat = "605 2B 17 10 00 64 00 00 00 -> 585 60 17 10 00 00 00 00 00\n";
const std::string sync_producer =
    "605 23 06 10 00 10 27 00 00 -> 585 60 06 10 00 00 00 00 00\n"
    "605 23 05 10 00 80 00 00 40 -> 585 60 05 10 00 00 00 00 00\n";
const Case services[] = {
    {"Sdo_PreOperational", sdo + "585 4F 01 10 00 00 00 00 00"},
    {"Sdo_Operational", "000 01 05 ->\n" + sdo + "585 4F 01 10 00 00 00 00 00"},
    {"Sdo_Stopped", "000 02 05 ->\n" + sdo},
    {"Sdo_TransferEndsInStopped",
     "605 40 08 10 00 00 00 00 00 -> 585 41 08 10 00 09 00 00 00\n000 02 05 ->\n000 80 05 ->\n"
     "605 60 00 00 00 00 00 00 00 -> 585 80 00 00 00 01 00 04 05"},
    {"Heartbeat_PreOperational", heartbeat + "+100ms -> 100: 705 7F"},
    {"Heartbeat_Operational", heartbeat + "000 01 05 ->\n+100ms -> 100: 705 05"},
    {"Heartbeat_Stopped", heartbeat + "000 02 05 ->\n+100ms -> 100: 705 04"},
    {"Heartbeat_AfterReset", heartbeat + "000 82 05 -> 705 00\n+1000ms ->"},
    {"Heartbeat_NewPeriodAtOnce",
     heartbeat + "+50ms ->\n605 2B 17 10 00 0A 00 00 00 -> 585 60 17 10 00 00 00 00 00\n+10ms -> 60: 705 7F"},
    {"Guarding_PreOperational", "705 R1 -> 705 7F\n705 R1 -> 705 FF\n705 R1 -> 705 7F"},
    {"Guarding_Operational", "000 01 05 ->\n705 R1 -> 705 05\n705 R1 -> 705 85"},
    {"Guarding_Stopped", "000 02 05 ->\n705 R1 -> 705 04\n705 R1 -> 705 84"},
    {"Guarding_DlcZero", "705 R -> 705 7F"},
    {"Guarding_ToggleAfterResetNode", "705 R1 -> 705 7F\n000 81 05 -> 705 00\n705 R1 -> 705 7F"},
    {"Guarding_ToggleOverStateChanges", "705 R1 -> 705 7F\n000 01 05 ->\n705 R1 -> 705 85"},
    {"Guarding_DataFrameIsNoRequest", "705 00 ->"},
    {"Guarding_OfAnotherNode", "706 R1 ->"},
    {"Guarding_WhileHeartbeat", heartbeat + "705 R1 ->"},
    {"SyncProducer_PreOperational", sync_producer + "+10ms -> 10: 080"},
    {"SyncProducer_Operational", sync_producer + "000 01 05 ->\n+10ms -> 10: 080"},
    {"SyncProducer_Stopped", sync_producer + "000 02 05 ->\n+100ms ->"},
    {"SyncProducer_PeriodZero",
     sync_producer + "605 23 06 10 00 00 00 00 00 -> 585 60 06 10 00 00 00 00 00\n+100ms ->"},
    {"SyncProducer_NewPeriod", sync_producer + "605 23 06 10 00 20 4E 00 00 -> 585 60 06 10 00 00 00 00 00\n"
                                               "+40ms -> 20: 080 | 40: 080"},
    {"SyncCounter_OneIsReserved", "605 2F 19 10 00 01 00 00 00 -> 585 80 19 10 00 30 00 09 06"},
    {"SyncCounter_Two", "605 2F 19 10 00 02 00 00 00 -> 585 60 19 10 00 00 00 00 00"},
    {"SyncCounter_240", "605 2F 19 10 00 F0 00 00 00 -> 585 60 19 10 00 00 00 00 00"},
    {"SyncCounter_241IsReserved", "605 2F 19 10 00 F1 00 00 00 -> 585 80 19 10 00 30 00 09 06"},
    {"SyncCounter_WhileAPeriodIsSet",
     "605 23 06 10 00 10 27 00 00 -> 585 60 06 10 00 00 00 00 00\n"
     "605 2F 19 10 00 02 00 00 00 -> 585 80 19 10 00 22 00 00 08"},
    {"SyncConsumer_DataWithoutCounter", "080 01 -> 085 40 82 11 00 00 00 00 00"},
    {"SyncConsumer_NoDataWithCounter",
     "605 2F 19 10 00 02 00 00 00 -> 585 60 19 10 00 00 00 00 00\n080 -> 085 40 82 11 00 00 00 00 00"},
    {"SyncConsumer_TwoBytesWithCounter",
     "605 2F 19 10 00 02 00 00 00 -> 585 60 19 10 00 00 00 00 00\n080 01 02 -> 085 40 82 11 00 00 00 00 00"},
    {"SyncConsumer_StoppedLooksAtNothing", "000 02 05 ->\n080 01 ->"},
    {"LifeGuarding_BeginsWithTheFirstRequest",
     "605 2B 0C 10 00 64 00 00 00 -> 585 60 0C 10 00 00 00 00 00\n"
     "605 2F 0D 10 00 02 00 00 00 -> 585 60 0D 10 00 00 00 00 00\n"
     "+1000ms ->\n705 R1 -> 705 7F\n+200ms -> 1200: 085 30 81 11 05 00 00 00 00"},
    {"LifeGuarding_FactorZero",
     "605 2B 0C 10 00 64 00 00 00 -> 585 60 0C 10 00 00 00 00 00\n705 R1 -> 705 7F\n+1000ms ->"},
    {"LifeGuarding_OneEventOnly",
     "605 2F 0D 10 00 02 00 00 00 -> 585 60 0D 10 00 00 00 00 00\n"
     "605 2B 0C 10 00 64 00 00 00 -> 585 60 0C 10 00 00 00 00 00\n"
     "705 R1 -> 705 7F\n+200ms -> 200: 085 30 81 11 05 00 00 00 00\n+1000ms ->\n"
     "705 R1 -> 705 FF | 085 00 00 00 00 00 00 00 00"},
    {"HeartbeatConsumer_Lost",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n"
     "709 05 ->\n+100ms -> 100: 085 30 81 11 09 00 00 00 00"},
    {"HeartbeatConsumer_NeverHeard",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n+1000ms ->"},
    {"HeartbeatConsumer_InTime",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n"
     "709 05 ->\n+99ms ->\n709 05 ->\n+99ms ->\n709 7F ->"},
    {"HeartbeatConsumer_TwoBytesAreNone",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n709 05 00 ->\n+1000ms ->"},
    {"HeartbeatConsumer_SwitchedOff",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n709 05 ->\n"
     "605 23 16 10 01 00 00 09 00 -> 585 60 16 10 01 00 00 00 00\n+1000ms ->"},
    {"HeartbeatConsumer_SameNodeTwice",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n"
     "605 23 16 10 02 64 00 09 00 -> 585 80 16 10 02 43 00 04 06"},
    {"HeartbeatConsumer_ReservedBits", "605 23 16 10 01 64 00 09 01 -> 585 80 16 10 01 30 00 09 06"},
    {"HeartbeatConsumer_EntryBeyondTheLast", "605 23 16 10 04 64 00 09 00 -> 585 80 16 10 04 11 00 09 06"},
    {"ErrorBehaviour_Three", "605 2F 29 10 01 03 00 00 00 -> 585 80 29 10 01 30 00 09 06"},
    {"ErrorBehaviour_LostHeartbeatStops",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n"
     "605 2F 29 10 01 02 00 00 00 -> 585 60 29 10 01 00 00 00 00\n"
     "000 01 05 ->\n709 05 ->\n+100ms -> 100: 085 30 81 11 09 00 00 00 00\n705 R1 -> 705 04"},
    {"ErrorBehaviour_LostHeartbeatChangesNothing",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n"
     "605 2F 29 10 01 01 00 00 00 -> 585 60 29 10 01 00 00 00 00\n"
     "000 01 05 ->\n709 05 ->\n+100ms -> 100: 085 30 81 11 09 00 00 00 00\n705 R1 -> 705 05"},
    {"ErrorBehaviour_LostHeartbeatLeavesOperational",
     "605 23 16 10 01 64 00 09 00 -> 585 60 16 10 01 00 00 00 00\n"
     "000 01 05 ->\n709 05 ->\n+100ms -> 100: 085 30 81 11 09 00 00 00 00\n705 R1 -> 705 7F"},
    {"Emcy_HistoryOtherThanZero", "605 2F 03 10 00 01 00 00 00 -> 585 80 03 10 00 30 00 09 06"},
    {"Emcy_HistoryEmpty", "605 40 03 10 01 00 00 00 00 -> 585 80 03 10 01 24 00 00 08"},
    {"Emcy_HistoryEntryIsReadOnly", "605 23 03 10 01 00 00 00 00 -> 585 80 03 10 01 02 00 01 06"},
    {"Emcy_HistoryAfterAnError",
     "080 01 -> 085 40 82 11 00 00 00 00 00\n"
     "605 40 03 10 01 00 00 00 00 -> 585 43 03 10 01 40 82 00 00\n"
     "605 40 01 10 00 00 00 00 00 -> 585 4F 01 10 00 11 00 00 00\n"
     "605 2F 03 10 00 00 00 00 00 -> 585 60 03 10 00 00 00 00 00\n"
     "605 40 03 10 00 00 00 00 00 -> 585 4F 03 10 00 00 00 00 00"},
    {"Emcy_InhibitTime",
     "605 2B 15 10 00 64 00 00 00 -> 585 60 15 10 00 00 00 00 00\n"
     "080 01 -> 085 40 82 11 00 00 00 00 00\n080 ->\n+10ms -> 10: 085 00 00 00 00 00 00 00 00"},
};
INSTANTIATE_TEST_SUITE_P(Service, Nmt, testing::ValuesIn(services), case_name);

}  // namespace
}  // namespace canopus::canopen::nmt_test
