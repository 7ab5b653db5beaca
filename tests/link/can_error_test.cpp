#include "canopus/link/can_error.hpp"

#include <array>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::link {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view alone = "nobody acknowledges: no other node on this bus";

TEST(CanError, MissingAcknowledgementIsSaidHoweverTheDriverReportsIt) {
  EXPECT_EQ(describe_error_frame(0x020, {}), alone) << "CAN_ERR_ACK";
  const std::array<std::uint8_t, 8> location{0, 0, 0, 0x19, 0, 0, 128, 0};
  EXPECT_EQ(describe_error_frame(0x008, location), alone) << "CAN_ERR_PROT in the ACK slot";
  EXPECT_EQ(describe_error_frame(0x0A8, location), alone) << "with CAN_ERR_BUSERROR";
}

TEST(CanError, StateOfTheControllerIsSaid) {
  const std::array<std::uint8_t, 8> passive{0, 0x20, 0, 0, 0, 0, 128, 0};
  EXPECT_THAT(describe_error_frame(0x004, passive), HasSubstr("error passive: nobody acknowledges"));
  EXPECT_THAT(describe_error_frame(0x040, {}), StartsWith("the controller of this machine is bus-off"));
}

TEST(CanError, OtherErrorFramesAreNothingToSay) {
  const std::array<std::uint8_t, 8> warning{0, 0x08, 0, 0, 0, 0, 96, 0};
  EXPECT_EQ(describe_error_frame(0x004, warning), "");
  EXPECT_EQ(describe_error_frame(0x008, {}), "");
  EXPECT_EQ(describe_error_frame(0x100, {}), "") << "restarted";
  EXPECT_EQ(describe_error_frame(0, {}), "");
}

}  // namespace
}  // namespace canopus::link
