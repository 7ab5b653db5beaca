// Request NMT (1F82H), and what a master shows of its slaves' states [CiA 302-2; ME3CAN1-Q 4.8.8].

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test::request_nmt_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::uint32_t optional = 0x05;
constexpr std::uint32_t mandatory = 0x0D;

class ShownState : public MasterBench {};

// --- requests

struct Request {
  std::uint8_t value;
  const char* frame;  // with node 0
  const char* single;
  NmtState own;  // after the same to all
};
class RequestNmt : public MasterBench, public ::testing::WithParamInterface<Request> {};

TEST_P(RequestNmt, ToOneNode_SendsItsCommand) {
  object(0x1F80, 0, 0x01);
  switch_on();
  run_for(1s);
  sent();
  EXPECT_EQ(write(0x1F82, 2, GetParam().value, 1), AbortCode::none);
  EXPECT_THAT(sent(), ElementsAre(std::string("1000 ") + GetParam().single));
  EXPECT_EQ(node.state(), NmtState::operational);
}

TEST_P(RequestNmt, ToAllNodes_SendsItToNode0_AndChangesTheOwnStateUnlessExcluded) {
  object(0x1F80, 0, 0x05);  // not Operational by itself
  switch_on();
  run_for(1s);
  node.command(canopen::NmtCommand::start, now);
  run_for(0ms);
  sent();
  EXPECT_EQ(write(0x1F82, 0x80, GetParam().value, 1), AbortCode::none);
  EXPECT_EQ(sent().front(), std::string("1000 ") + GetParam().frame);
  EXPECT_EQ(node.state(), GetParam().own);
}

INSTANTIATE_TEST_SUITE_P(Values, RequestNmt,
                         ::testing::Values(Request{0x04, "000 02 00", "000 02 02", NmtState::stopped},
                                           Request{0x05, "000 01 00", "000 01 02", NmtState::operational},
                                           Request{0x06, "000 81 00", "000 81 02", NmtState::pre_operational},
                                           Request{0x07, "000 82 00", "000 82 02", NmtState::pre_operational},
                                           Request{0x7F, "000 80 00", "000 80 02", NmtState::pre_operational},
                                           Request{0x84, "000 02 00", "000 02 02", NmtState::operational},
                                           Request{0x85, "000 01 00", "000 01 02", NmtState::operational},
                                           Request{0x86, "000 81 00", "000 81 02", NmtState::operational},
                                           Request{0x87, "000 82 00", "000 82 02", NmtState::operational},
                                           Request{0x8F, "000 80 00", "000 80 02", NmtState::operational}),
                         [](const auto& row) { return "Value" + std::to_string(row.param.value); });

TEST_F(ShownState, RequestNmt_ReservedValues_AreRefused) {
  object(0x1F80, 0, 0x01);
  switch_on();
  sent();
  for (unsigned value = 0; value <= 0xFF; ++value) {
    const bool known = value == 0x04 || value == 0x05 || value == 0x06 || value == 0x07 || value == 0x7F ||
                       value == 0x84 || value == 0x85 || value == 0x86 || value == 0x87 || value == 0x8F;
    if (known) continue;
    EXPECT_EQ(write(0x1F82, 2, value, 1), AbortCode::invalid_value) << value;
  }
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(ShownState, RequestNmt_AsSlave_SendsNothing) {
  switch_on();
  sent();
  EXPECT_EQ(write(0x1F82, 2, 0x05, 1), AbortCode::device_state);
  EXPECT_EQ(write(0x1F82, 0x80, 0x05, 1), AbortCode::device_state);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(ShownState, CommandedState_IsShownWithoutErrorControl) {
  object(0x1F80, 0, 0x01);
  switch_on();
  EXPECT_EQ(read(0x1F82, 9), 0U);
  write(0x1F82, 9, 0x05, 1);
  EXPECT_EQ(read(0x1F82, 9), 5U);
  write(0x1F82, 9, 0x04, 1);
  EXPECT_EQ(read(0x1F82, 9), 4U);
  write(0x1F82, 9, 0x7F, 1);
  EXPECT_EQ(read(0x1F82, 9), 0x7FU);
}

TEST_F(ShownState, CommandToAll_SaysNothingOfNodesThatWereNeverSeen) {
  object(0x1F80, 0, 0x01);
  switch_on();
  receive(can::data_frame(0x709, {0x00}));
  write(0x1F82, 0x80, 0x85, 1);
  EXPECT_EQ(read(0x1F82, 9), 5U);
  EXPECT_EQ(read(0x1F82, 10), 0U);
}

TEST_F(ShownState, StateHeardByHeartbeat_IsShownInsteadOfTheCommandedOne) {
  object(0x1F80, 0, 0x01);
  object(0x1016, 1, 0x000905DC);
  switch_on();
  heartbeat(9, 0x04);
  write(0x1F82, 9, 0x05, 1);
  EXPECT_EQ(read(0x1F82, 9), 4U);
  heartbeat(9, 0x05);
  EXPECT_EQ(read(0x1F82, 9), 5U);
}

TEST_F(ShownState, OwnState_IsShownInItsOwnSubIndex) {
  object(0x1F80, 0, 0x05);
  switch_on();
  EXPECT_EQ(read(0x1F82, 1), 0x7FU);
  node.command(canopen::NmtCommand::start, now);
  EXPECT_EQ(read(0x1F82, 1), 5U);
  node.command(canopen::NmtCommand::stop, now);
  EXPECT_EQ(read(0x1F82, 1), 4U);
}

TEST_F(ShownState, SlaveStoppedByRequest_IsNotStartedAgainAfterItsNextBootUp) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, optional);
  slave(2);
  switch_on();
  run_until_ms(1000);
  write(0x1F82, 2, 0x04, 1);
  sent();
  receive(can::data_frame(0x702, {0x00}));
  run_for(5s);
  EXPECT_THAT(commands(), IsEmpty());
  write(0x1F82, 2, 0x05, 1);
  sent();
  receive(can::data_frame(0x702, {0x00}));
  run_for(5s);
  EXPECT_THAT(commands(), ElementsAre("6001 000 01 02"));
}

TEST_F(ShownState, ReservedBits_AreRefused) {
  switch_on();
  EXPECT_EQ(write(0x1F80, 0, 0x7F, 4), AbortCode::none);
  EXPECT_EQ(write(0x1F80, 0, 0x80, 4), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1F80, 0, 0x80000000, 4), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1F81, 2, 0xFFFFFF1D, 4), AbortCode::none);
  EXPECT_EQ(write(0x1F81, 2, 0xFFFFFFFD, 4), AbortCode::none);
  EXPECT_EQ(write(0x1F81, 2, 0x02, 4), AbortCode::invalid_value);
  master.options().assignment_bits = 0x1D;  // as the modules have it
  for (const std::uint32_t bit : {0x02U, 0x20U, 0x40U, 0x80U}) {
    EXPECT_EQ(write(0x1F81, 2, bit, 4), AbortCode::invalid_value) << bit;
  }
}

TEST_F(ShownState, MasterIgnoresForeignFrames) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  switch_on();
  run_for(1s);
  sent();
  receive(can::Frame{.identifier = 0x702, .extended = true, .dlc = 1});
  receive(can::remote_frame(0x702, 1));
  receive(can::data_frame(0x702, {0x05, 0x05}));
  receive(can::data_frame(0x582, {0x43, 0x00, 0x10, 0x00, 0, 0, 0, 0}));
  run_for(5s);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(master.node_state(2), 5);
}

}  // namespace
}  // namespace canopus::manager::test::request_nmt_test
