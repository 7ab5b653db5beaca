// Base64: the examples of RFC 4648, 10, and what is none.

#include "canopus/text/base64.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::text::base64_test {
namespace {

TEST(Base64, TheExamplesOfTheStandard_AreWrittenAndRead) {
  const std::vector<std::pair<std::string, std::string>> examples{{"", ""},
                                                                  {"f", "Zg=="},
                                                                  {"fo", "Zm8="},
                                                                  {"foo", "Zm9v"},
                                                                  {"foob", "Zm9vYg=="},
                                                                  {"fooba", "Zm9vYmE="},
                                                                  {"foobar", "Zm9vYmFy"},
                                                                  {"\xFF\xEF", "/+8="}};
  for (const auto& [bytes, shown] : examples) {
    const std::vector<std::uint8_t> octets(bytes.begin(), bytes.end());
    EXPECT_EQ(to_base64(octets), shown);
    EXPECT_EQ(from_base64(shown), bytes) << shown;
  }
  EXPECT_EQ(from_base64("Zg"), "f") << "without padding";
}

TEST(Base64, OtherCharacters_AreRefused) {
  for (const char* text : {"Zm9 v", "Zm=v", "Zm9v\n", "Zm9-", "\xFF\xFF"})
    EXPECT_FALSE(from_base64(text)) << text;
}

}  // namespace
}  // namespace canopus::text::base64_test
