// Bytes of an object as `configure sdo-read` and the page show them.

#include "canopus/cli/module_settings/shown_data.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/client/domain_words.hpp"

namespace canopus::cli::shown_data_test {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

using Bytes = std::vector<std::uint8_t>;

TEST(ShownData, BytesThatAreNoText_AreDots) {
  const std::array<std::uint8_t, 8> ends{0x1F, 0x20, 'a', '~', 0x7E, 0x7F, 'Z', '.'};
  EXPECT_EQ(client::ascii_of(ends), ". a~~.Z.");
  for (const std::uint8_t byte : Bytes{0x00, 0x0A, 0x1B, 0x7F, 0x80, 0x9B, 0xC3, 0xFF}) {
    EXPECT_EQ(client::ascii_of(Bytes{byte}), ".") << int{byte};
  }
  EXPECT_EQ(client::ascii_of(Bytes{}), "");
}

TEST(ShownData, ShortData_AreNumbersToo) {
  EXPECT_THAT(shown_data(Bytes{0x00, 0x00, 0x80, 0xBF}),
              ElementsAre(Pair("hexadecimal", "0xBF800000"), Pair("decimal", "3212836864"),
                          Pair("floating point", "-1"), Pair("ASCII", "....")));
  EXPECT_THAT(shown_data(Bytes{'A', 0x1B}),
              ElementsAre(Pair("hexadecimal", "0x1B41"), Pair("decimal", "6977"), Pair("ASCII", "A.")));
}

TEST(ShownData, LongData_AreBytesAndText) {
  EXPECT_THAT(shown_data(Bytes{'\x1B', '[', '2', 'J', 0xFF, 0x00, 'e', 'n', 'd'}),
              ElementsAre(Pair("hexadecimal", "1B 5B 32 4A FF 00 65 6E 64"), Pair("ASCII", ".[2J..end")));
}

}  // namespace
}  // namespace canopus::cli::shown_data_test
