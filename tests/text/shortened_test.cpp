#include "canopus/text/shortened.hpp"

#include <string>

#include <gtest/gtest.h>

namespace canopus::text::shortened_test {
namespace {

TEST(Shortened, ATextThatHasRoomStaysAsItIs) {
  EXPECT_EQ(shortened("", 0), "");
  EXPECT_EQ(shortened("drive", 5), "drive");
}

TEST(Shortened, ALongerTextIsCutAndSaysSo) {
  EXPECT_EQ(shortened("drive", 4), "driv... (cut, 5 bytes in all)");
  EXPECT_EQ(shortened("drive", 0), "... (cut, 5 bytes in all)");
  EXPECT_LT(shortened(std::string(2'000'000, 'x'), 100).size(), 150U);
}

TEST(Shortened, NoCharacterIsCutInHalf) {
  EXPECT_EQ(shortened("Ger\xC3\xA4t", 4), "Ger... (cut, 6 bytes in all)");
  EXPECT_EQ(shortened("Ger\xC3\xA4t", 5), "Ger\xC3\xA4... (cut, 6 bytes in all)");
  EXPECT_LT(shortened(std::string(1000, '\x80'), 100).size(), 150U) << "octets that are no UTF-8";
}

}  // namespace
}  // namespace canopus::text::shortened_test
