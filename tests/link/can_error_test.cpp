#include <array>
#include <cstdint>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/link/controller_status.hpp"

namespace canopus::link::can_error_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view alone = "no acknowledgement: no other node on this bus";

TEST(CanError, MissingAcknowledgementIsSaidHoweverTheDriverReportsIt) {
  EXPECT_EQ(describe_error_frame(0x020, {}), alone) << "CAN_ERR_ACK";
  const std::array<std::uint8_t, 8> location{0, 0, 0, 0x19, 0, 0, 128, 0};
  EXPECT_EQ(describe_error_frame(0x008, location), alone) << "CAN_ERR_PROT in the ACK slot";
  EXPECT_EQ(describe_error_frame(0x0A8, location), alone) << "with CAN_ERR_BUSERROR";
}

TEST(CanError, StateOfTheControllerIsSaid) {
  const std::array<std::uint8_t, 8> passive{0, 0x20, 0, 0, 0, 0, 128, 0};
  EXPECT_THAT(describe_error_frame(0x004, passive),
              HasSubstr("error passive: its frames are not acknowledged"));
  EXPECT_THAT(describe_error_frame(0x040, {}), StartsWith("the controller of this machine is bus-off"));
}

TEST(CanError, OtherErrorFramesAreNothingToSay) {
  const std::array<std::uint8_t, 8> warning{0, 0x08, 0, 0, 0, 0, 96, 0};
  EXPECT_EQ(describe_error_frame(0x004, warning), "");
  EXPECT_EQ(describe_error_frame(0x008, {}), "");
  EXPECT_EQ(describe_error_frame(0x100, {}), "") << "restarted";
  EXPECT_EQ(describe_error_frame(0, {}), "");
}

ControllerStatus after(std::uint32_t error_class, std::span<const std::uint8_t> data,
                       ControllerStatus status = {}) {
  update_status(status, error_class, data);
  return status;
}

TEST(CanError, StateAndCountersAreTakenFromAnErrorFrame) {
  const std::array<std::uint8_t, 8> passive{0, 0x20, 0, 0, 0, 0, 128, 7};
  EXPECT_EQ(after(0x204, passive), (ControllerStatus{.state = can::ErrorState::error_passive,
                                                     .transmit_errors = 128,
                                                     .receive_errors = 7,
                                                     .counters_known = true}));
  const std::array<std::uint8_t, 8> active{0, 0x40, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(after(0x004, active, {.state = can::ErrorState::error_passive}), ControllerStatus{});
  EXPECT_EQ(after(0x040, {}), ControllerStatus{.state = can::ErrorState::bus_off});
}

TEST(CanError, RestartedController_HasItsCountersAtZeroAndKeepsItsBitRate) {
  const ControllerStatus off{.state = can::ErrorState::bus_off, .transmit_errors = 256, .bit_rate = 250'000};
  EXPECT_EQ(after(0x100, {}, off), ControllerStatus{.bit_rate = 250'000});
}

}  // namespace
}  // namespace canopus::link::can_error_test
