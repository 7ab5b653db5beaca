// Frames of a WebSocket client, counted in its bytes. The bytes are those of RFC 6455 5.2.

#include "canopus/web/http/frame_count.hpp"

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace canopus::web::frame_count_test {
namespace {

unsigned count(WebFrameCount& counter, const std::string& bytes) {
  return counter.count({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

unsigned count(const std::string& bytes) {
  WebFrameCount counter;
  return count(counter, bytes);
}

const std::string mask(4, '\0');
const std::string text = "\x81\x83" + mask + "abc";
const std::string ping = "\x89\x80" + mask;
const std::string empty_part = std::string("\x00\x80", 2) + mask;

TEST(WebFrameCount, MessagesPingsAndSmallParts) {
  EXPECT_EQ(count(text), 1U);
  EXPECT_EQ(count(text + ping + ping + text), 4U);
  EXPECT_EQ(count("\x01\x81" + mask + "a" + empty_part + empty_part + "\x80\x80" + mask), 4U);
  EXPECT_EQ(count("\x81\x03"
                  "abc" +
                  ping),
            2U)
      << "without a mask";
}

TEST(WebFrameCount, LargePartsOfAMessage_AreNot) {
  const std::string part = std::string("\x00\xFE\x04\x00", 4) + mask + std::string(1024, 'x');
  const std::string smaller = std::string("\x00\xFE\x03\xFF", 4) + mask + std::string(1023, 'x');
  EXPECT_EQ(count("\x01\x80" + mask + part + part + ping), 2U);
  EXPECT_EQ(count("\x01\x80" + mask + smaller + ping), 3U);
  const std::string large = std::string("\x81\xFF\0\0\0\0\0\x01\0\0", 10) + mask + std::string(65536, 'x');
  EXPECT_EQ(count(large + text), 2U) << "a message is one, however long";
}

TEST(WebFrameCount, ByteByByte) {
  WebFrameCount counter;
  unsigned frames = 0;
  for (const char byte : text + ping + empty_part) frames += count(counter, std::string(1, byte));
  EXPECT_EQ(frames, 3U);
}

TEST(WebFrameCount, ALengthThatNobodyHas_IsNoTrouble) {
  WebFrameCount counter;
  EXPECT_EQ(count(counter, "\x82\xFF" + std::string(8, '\xFF') + mask), 1U);
  EXPECT_EQ(count(counter, std::string(100'000, '\x89')), 0U);
}

}  // namespace
}  // namespace canopus::web::frame_count_test
