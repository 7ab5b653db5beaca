// The device files of examples/devices say exactly what they mean.

#include <gtest/gtest.h>

#include "eds/reading.hpp"
#include "paths.hpp"

namespace canopus::eds::example_devices_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;

class ExampleDevice : public testing::TestWithParam<const char*> {};

TEST_P(ExampleDevice, File_HasNotOneProblem) {
  const auto text = read_text(std::string(CANOPUS_SOURCE_DIR "/examples/devices/") + GetParam());
  ASSERT_TRUE(text);
  const ReadResult result = read_device_file(*text);
  ASSERT_NE(result.file, nullptr);
  EXPECT_EQ(all_problems(result), "");
  EXPECT_EQ(result.file->device.vendor_number, 0U);
  EXPECT_EQ(result.file->device.bit_rates.size(), 8U);
}

INSTANTIATE_TEST_SUITE_P(All, ExampleDevice, testing::Values("io-block.eds", "encoder.eds", "drive.eds"));

}  // namespace
}  // namespace canopus::eds::example_devices_test
