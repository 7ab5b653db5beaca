#include "canopus/app/file_text.hpp"

#include <cstdio>
#include <fstream>

#include <gtest/gtest.h>

namespace canopus::app {
namespace {

TEST(ReadFile, EveryByte_AndNoneOfAnEmptyFile) {
  const std::string path = testing::TempDir() + "canopus_read_file";
  for (const std::string& content : {std::string(), std::string("a\r\n\0b", 5), std::string(200'000, 'x')}) {
    std::ofstream(path, std::ios::binary) << content;
    const auto text = read_file(path);
    ASSERT_TRUE(text.has_value()) << text.error();
    EXPECT_EQ(*text, content);
  }
  std::remove(path.c_str());
}

TEST(ReadFile, WhatIsNoFile_IsToldWithTheReason) {
  EXPECT_EQ(read_file("/no/such/file").error(), "cannot read /no/such/file: No such file or directory");
  EXPECT_EQ(read_file("/").error(), "cannot read /: Is a directory");
  EXPECT_EQ(read_file("/dev/zero").error(), "cannot read /dev/zero: it is larger than 64 MiB");
}

}  // namespace
}  // namespace canopus::app
