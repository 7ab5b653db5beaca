// Files that another file names, in other upper and lower case: projects come from Windows.

#include "canopus/store/inner_path.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

namespace canopus::store::inner_path_test {
namespace {

class FindInnerFile : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "Dcf");
    for (const char* name : {"a.dcf", "Dcf/Pump.dcf", "x.dcf", "X.dcf"})
      std::ofstream(folder_ / name) << name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "find_inner_file";
};

TEST_F(FindInnerFile, OnlyFileOfThatNameInAnotherCase_IsFound) {
  EXPECT_EQ(find_inner_file(folder_, "A.DCF"), "a.dcf");
  EXPECT_EQ(find_inner_file(folder_, "dcf/PUMP.dcf"), "Dcf/Pump.dcf");
  EXPECT_EQ(find_inner_file(folder_, "a.dcf"), "a.dcf");
}

TEST_F(FindInnerFile, SeveralOrNoneOrOutside_AreNot) {
  EXPECT_EQ(find_inner_file(folder_, "x.DCF"), std::nullopt);
  EXPECT_EQ(find_inner_file(folder_, "b.dcf"), std::nullopt);
  EXPECT_EQ(find_inner_file(folder_ / "Dcf", "../A.DCF"), std::nullopt);
  EXPECT_EQ(find_inner_file(folder_ / "none", "a.dcf"), std::nullopt);
  EXPECT_EQ(find_inner_file(folder_, "/etc/PASSWD"), std::nullopt);
}

}  // namespace
}  // namespace canopus::store::inner_path_test
