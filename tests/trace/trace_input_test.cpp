#include "canopus/trace/file/trace_input.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace canopus::trace::trace_input_test {
namespace {

TEST(TraceInputTest, LineWithoutEnd_EndsWhenNoMoreIsWanted) {
  int reads = 0;
  auto input = TraceInput::open("/dev/zero", [&](std::string_view) { return ++reads < 10; });
  ASSERT_TRUE(input) << input.error();
  (void)input->line();
  EXPECT_TRUE(input->is_cut());
  EXPECT_FALSE(input->line());
  EXPECT_EQ(reads, 10);
  EXPECT_FALSE(input->failure()) << "it was ended, and did not fail";
}

class NamedPipe : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0); }
  void TearDown() override { std::filesystem::remove(path); }

  std::string path = testing::TempDir() + "trace_input_" + std::to_string(::getpid());
};

TEST_F(NamedPipe, NothingWritten_IsSaidOnceWithItsName_AndCanBeEnded) {
  std::vector<std::string> said;
  auto input = TraceInput::open(path, [&](std::string_view silent) {
    const bool was_said = !said.empty();
    if (!silent.empty()) said.emplace_back(silent);
    return !was_said;
  });
  ASSERT_TRUE(input) << "opening it does not wait: " << input.error();
  EXPECT_EQ(input->peek(1), "");
  EXPECT_EQ(said, std::vector{path});
  EXPECT_FALSE(input->failure());
}

}  // namespace
}  // namespace canopus::trace::trace_input_test
