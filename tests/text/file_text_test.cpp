#include "canopus/text/file_text.hpp"

#include <cstdio>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

namespace canopus::text::file_text_test {
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
  EXPECT_EQ(read_file("/dev/zero").error(), "cannot read /dev/zero: it is a device, not a file");
  EXPECT_NE(read_file(std::string("/etc\0x", 6)).error().find("cannot hold the character NUL"),
            std::string::npos);
}

// A FIFO that nobody writes to: opened as a file it would wait for ever.
TEST(ReadFile, AFifo_IsRefusedAndNotWaitedFor) {
  const std::string path = testing::TempDir() + "canopus_read_fifo";
  std::remove(path.c_str());
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(read_file(path).error(), "cannot read " + path + ": it is a FIFO, not a file");
  EXPECT_EQ(read_file_or_reason(path).error(), "it is a FIFO, not a file");
  std::remove(path.c_str());
}

TEST(ReadFile, DataThatAnotherProgramGives_EndWithIt) {
  EXPECT_EQ(read_file_or_pipe("/dev/zero").error(), "cannot read /dev/zero: it is larger than 64 MiB");
  EXPECT_EQ(read_file_or_pipe("/dev/null").value(), "");
}

}  // namespace
}  // namespace canopus::text::file_text_test
