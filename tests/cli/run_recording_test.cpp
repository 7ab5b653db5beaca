// Where a run records.

#include "canopus/cli/run/run_recording.hpp"

#include <gtest/gtest.h>

namespace canopus::cli {
namespace {

TEST(VcdPath, IsThatOfTheOptionWithTheBusInItsName) {
  EXPECT_EQ(vcd_path_of("wire.vcd", "line1"), "wire-line1.vcd");
  EXPECT_EQ(vcd_path_of("out/wire", "line1"), "out/wire-line1");
}

TEST(VcdPath, NeverLeavesTheFolderByTheNameOfABus) {
  EXPECT_EQ(vcd_path_of("out/wire.vcd", "/../../etc/x"), "out/wire-%2F%2E%2E%2F%2E%2E%2Fetc%2Fx.vcd");
  EXPECT_EQ(vcd_path_of("wire.vcd", "a\nb"), "wire-a%0Ab.vcd");
}

}  // namespace
}  // namespace canopus::cli
