#include "canopus/ascii/counted.hpp"

#include <gtest/gtest.h>

namespace canopus::ascii::counted_test {

TEST(Counted, ANumberOfThings_IsSingularForOneAlone) {
  EXPECT_EQ(counted(0, "byte"), "0 bytes");
  EXPECT_EQ(counted(1, "byte"), "1 byte");
  EXPECT_EQ(counted(2, "error frame"), "2 error frames");
  EXPECT_EQ(counted(1, "bus"), "1 bus");
  EXPECT_EQ(counted(2, "bus"), "2 buses");
  EXPECT_EQ(counted(2, "branch"), "2 branches");
  EXPECT_EQ(counted(2, "sub-index"), "2 sub-indexes");
}

}  // namespace canopus::ascii::counted_test
