#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/app/command_line.hpp"

namespace canopus::cli::configure_mapping_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// What `canopus` writes for these words.
std::string written(const std::vector<std::string>& words, int expected_code) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_command_line(words), expected_code);
  const std::string out = testing::internal::GetCapturedStdout();
  return out + testing::internal::GetCapturedStderr();
}

TEST(ConfigureMapping, AMappedObject_IsThreeNumbersWithoutSigns) {
  const std::string file = (fs::path(testing::TempDir()) / "configure-mapping.xml").string();
  fs::remove(file);
  written({"configure", "new", file, "--module", "FX3U-CAN"}, 0);
  written({"configure", "set", file, "tpdo/1", "map=a100:1:8,A100:02:16 A100:03:16"}, 0);
  const std::string shown = written({"configure", "show", file, "tpdo"}, 0);
  EXPECT_THAT(shown, HasSubstr("A100:01:8 "));
  EXPECT_THAT(shown, HasSubstr("A100:02:16 "));
  EXPECT_THAT(shown, HasSubstr("A100:03:16 "));
  for (const char* const wrong :
       {"-1:01:16", "A100:-1:16", "+100:01:16", "0xA1:01:16", "A100:01:+8", "A100:01", "A100:01:16:1",
        "A1000:01:16", "A100:001:16", "A100:01:016", ":01:16", "A100::16"}) {
    EXPECT_THAT(written({"configure", "set", file, "tpdo/1", std::string("map=") + wrong}, 2),
                HasSubstr("\"" + std::string(wrong) +
                          "\" is no mapped object; expected INDEX:SUB:BITS, as A100:01:16"));
  }
  EXPECT_EQ(written({"configure", "show", file, "tpdo"}, 0), shown);
  fs::remove(file);
}

}  // namespace
}  // namespace canopus::cli::configure_mapping_test
