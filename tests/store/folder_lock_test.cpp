#include "canopus/store/folder_lock.hpp"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace canopus::store::folder_lock_test {
namespace {

class FolderLockTest : public testing::Test {
 protected:
  FolderLockTest() {
    std::string name = (std::filesystem::temp_directory_path() / "canopus-lock-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~FolderLockTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

TEST_F(FolderLockTest, IsTakenOnceAndFreeAgainAfterwards) {
  {
    const auto first = FolderLock::acquire(folder_ / "a" / "b");
    ASSERT_TRUE(first.has_value()) << first.error();
    const auto second = FolderLock::acquire(folder_ / "a" / "b");
    ASSERT_FALSE(second.has_value());
    EXPECT_EQ(second.error(), "another process (" + std::to_string(::getpid()) + ") uses it");
  }
  EXPECT_TRUE(FolderLock::acquire(folder_ / "a" / "b").has_value());
}

TEST_F(FolderLockTest, KeepsWhenItIsMoved) {
  auto first = FolderLock::acquire(folder_);
  ASSERT_TRUE(first.has_value());
  const FolderLock kept = std::move(*first);
  EXPECT_FALSE(FolderLock::acquire(folder_).has_value());
}

TEST_F(FolderLockTest, OfTwoFoldersIsTwoLocks) {
  const auto first = FolderLock::acquire(folder_ / "a");
  EXPECT_TRUE(FolderLock::acquire(folder_ / "b").has_value());
  EXPECT_TRUE(first.has_value());
}

TEST_F(FolderLockTest, AFileInPlaceOfTheFolderIsRefused) {
  std::ofstream(folder_ / "a") << "a file";
  EXPECT_EQ(FolderLock::acquire(folder_ / "a").error(), "cannot use it: Not a directory");
  EXPECT_EQ(FolderLock::acquire(folder_ / "a" / "b").error(), "cannot make the folder: Not a directory");
}

TEST_F(FolderLockTest, ALinkInPlaceOfTheLockIsNotFollowed) {
  std::ofstream(folder_ / "other") << "keep me";
  std::filesystem::create_symlink(folder_ / "other", folder_ / ".lock");
  EXPECT_FALSE(FolderLock::acquire(folder_).has_value());
  std::ifstream other(folder_ / "other");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(other), {}), "keep me");
}

}  // namespace
}  // namespace canopus::store::folder_lock_test
