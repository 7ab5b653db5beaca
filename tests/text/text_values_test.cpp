#include "canopus/text/text_values.hpp"

#include <gtest/gtest.h>

namespace canopus::text::text_values_test {
namespace {

using namespace std::chrono_literals;

TEST(TextValues, DurationsHaveAUnit) {
  EXPECT_EQ(parse_duration("10ms"), 10ms);
  EXPECT_EQ(parse_duration("1.5s"), 1500ms);
  EXPECT_EQ(parse_duration("2 min"), 2min);
  EXPECT_EQ(parse_duration("1h"), 1h);
  EXPECT_EQ(parse_duration("250us"), 250us);
  EXPECT_EQ(parse_duration("0s"), 0s);
}

TEST(TextValues, WhatIsNoDurationIsRefused) {
  for (const auto* text : {"", "10", "ms", "-1s", "1 year", "1e30s", "nan s", "inf s", "1s2"}) {
    EXPECT_FALSE(parse_duration(text)) << text;
  }
}

TEST(TextValues, ObjectsAreHexadecimal) {
  EXPECT_EQ(parse_object("6000:01"), (ObjectName{0x6000, 1}));
  EXPECT_EQ(parse_object("1A00:FF"), (ObjectName{0x1A00, 0xFF}));
  EXPECT_EQ(parse_object("0x1018:0x4"), (ObjectName{0x1018, 4}));
  EXPECT_EQ(parse_object("1018:04"), (ObjectName{0x1018, 4}));
  EXPECT_EQ(parse_object("1000"), (ObjectName{0x1000, 0}));
}

TEST(TextValues, WhatIsNoObjectIsRefused) {
  for (const auto* text : {"", ":", "6000:", ":01", "10000:00", "6000:100", "G25", "6000:01:02", "-1"}) {
    EXPECT_FALSE(parse_object(text)) << text;
  }
}

TEST(TextValues, BufferMemoryAddressesAreDecimal) {
  EXPECT_EQ(parse_buffer_address("G13000"), 13000U);
  EXPECT_EQ(parse_buffer_address("g0"), 0U);
  EXPECT_EQ(parse_buffer_address("G65535"), 65535U);
  for (const auto* text : {"G65536", "G", "13000", "G-1", "G1F"})
    EXPECT_FALSE(parse_buffer_address(text)) << text;
}

TEST(TextValues, AHostMayBeLeftOut) {
  EXPECT_EQ(parse_host_and_port("192.0.2.1:5007")->host, "192.0.2.1");
  EXPECT_EQ(parse_host_and_port(":5007")->host, "127.0.0.1");
  EXPECT_EQ(parse_host_and_port("5007")->port, 5007);
  for (const auto* text : {"", "host", "host:", "host:65536", "host:-1"})
    EXPECT_FALSE(parse_host_and_port(text)) << text;
}

}  // namespace
}  // namespace canopus::text::text_values_test
