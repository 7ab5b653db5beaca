// What becomes of a process and its folder when its parent is killed. Processes of their own, as nothing else shows it.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canopus/web/commands/child_process.hpp"

namespace canopus::web::parent_process_test {
namespace {

namespace fs = std::filesystem;

class ParentProcessTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ChildProcess::make_folder();
    ASSERT_FALSE(folder_.empty());
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// A process, whose child has the folder and does `work` in it; `then` is what the parent does with the child.
  template <typename Work, typename Then>
  pid_t start(const Work& work, const Then& then) {
    const pid_t parent = ::fork();
    if (parent != 0) return parent;
    ::setenv(parent_variable, std::to_string(::getpid()).c_str(), 1);
    ::setenv(parent_folder_variable, folder_.c_str(), 1);
    const pid_t child = ::fork();
    if (child != 0) {
      then(child);
      ::_exit(0);
    }
    end_with_parent();
    work();
    ::_exit(5);
  }
  /// What somebody else does comes to pass.
  template <typename Condition>
  static bool becomes(const Condition& condition) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!condition() && std::chrono::steady_clock::now() < until) std::this_thread::yield();
    return condition();
  }

  fs::path folder_;
};

TEST_F(ParentProcessTest, WhenTheParentIsKilled_TheProcessEnds_AndItsFolderGoes) {
  const pid_t parent = start(
      [this] {
        std::ofstream(folder_ / "file") << "data";
        fs::create_directory(folder_ / "begun");
        while (true) ::pause();
      },
      [](pid_t) { ::pause(); });
  ASSERT_GT(parent, 0);
  ASSERT_TRUE(becomes([&] { return fs::exists(folder_ / "begun"); }));
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  EXPECT_TRUE(becomes([&] { return !fs::exists(folder_); }));
}

TEST_F(ParentProcessTest, WhileTheParentIsThere_TheFolderStays_AndItGetsTheExitCode) {
  const pid_t parent =
      start([this] { fs::create_directory(folder_ / std::to_string(::getenv(parent_variable) != nullptr)); },
            [](pid_t child) {
              int status = 0;
              ::waitpid(child, &status, 0);
              ::_exit(WIFEXITED(status) ? WEXITSTATUS(status) : 1);
            });
  int status = 0;
  ASSERT_EQ(::waitpid(parent, &status, 0), parent);
  EXPECT_EQ(WEXITSTATUS(status), 5);
  EXPECT_TRUE(fs::exists(folder_ / "0")) << "and its own children are not told the same";
}

TEST_F(ParentProcessTest, ASignalForTheProcess_ComesToWhatRuns) {
  const pid_t parent = start(
      [this] {
        std::signal(SIGINT, [](int) { ::_exit(7); });
        fs::create_directory(folder_ / "begun");
        while (true) ::pause();
      },
      [this](pid_t child) {
        while (!fs::exists(folder_ / "begun")) std::this_thread::yield();
        ::kill(child, SIGINT);
        int status = 0;
        ::waitpid(child, &status, 0);
        ::_exit(WIFEXITED(status) ? WEXITSTATUS(status) : 1);
      });
  int status = 0;
  ASSERT_EQ(::waitpid(parent, &status, 0), parent);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

/// Where this process makes temporary folders, meanwhile.
class OwnTemporaryFolder {
 public:
  explicit OwnTemporaryFolder(fs::path folder) : folder_(std::move(folder)) {
    fs::create_directory(folder_);
    ::setenv("TMPDIR", folder_.c_str(), 1);
  }
  ~OwnTemporaryFolder() {
    ::unsetenv("TMPDIR");
    if (!before_.empty()) ::setenv("TMPDIR", before_.c_str(), 1);
  }
  OwnTemporaryFolder(const OwnTemporaryFolder&) = delete;
  OwnTemporaryFolder& operator=(const OwnTemporaryFolder&) = delete;

 private:
  fs::path folder_;
  std::string before_ = ::getenv("TMPDIR") == nullptr ? "" : ::getenv("TMPDIR");
};

TEST_F(ParentProcessTest, AFolderOfAProcessThatWasKilledBeforeItStartedOne_GoesWithTheNextStart) {
  const fs::path place = folder_ / "temporary";
  const OwnTemporaryFolder temporary(place);
  const pid_t killed = ::fork();
  if (killed == 0) {
    const fs::path left = ChildProcess::make_folder();
    std::ofstream(left / "file") << "data";
    std::raise(SIGKILL);
  }
  ::waitpid(killed, nullptr, 0);
  ASSERT_EQ(std::distance(fs::directory_iterator(place), {}), 1);
  const fs::path left = fs::directory_iterator(place)->path();
  const fs::path own = ChildProcess::make_folder();
  const std::string name = left.filename().string();
  const fs::path link = place / (name.substr(0, name.size() - 6) + "linked");
  fs::create_directory_symlink(own, link);
  const fs::path longer = place / (name + "x");
  const fs::path others = place / "canopus-notes";
  fs::create_directory(longer);
  fs::create_directory(others);
  ChildProcess::remove_left_folders();
  EXPECT_FALSE(fs::exists(left));
  for (const fs::path& stays : {own, link, longer, others}) EXPECT_TRUE(fs::exists(stays)) << stays;
}

TEST_F(ParentProcessTest, AFolderThatIsNotOfThisProgram_IsLeftAlone) {
  const fs::path other = folder_ / "other";
  fs::create_directory(other);
  const fs::path own = std::exchange(folder_, other);
  const pid_t parent = start(
      [] {
        while (true) ::pause();
      },
      [](pid_t) {});
  ::waitpid(parent, nullptr, 0);
  folder_ = own;
  EXPECT_TRUE(fs::exists(other));
}

}  // namespace
}  // namespace canopus::web::parent_process_test
