// The files of the page as the program finds and reads them.

#include "canopus/web/http/page_files.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::web::page_files_test {
namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class PageFilesTest : public ::testing::Test {
 protected:
  PageFilesTest() { fs::create_directories(folder_ / "bin"); }
  ~PageFilesTest() override { fs::remove_all(folder_); }

  static void write(const fs::path& path, const std::string& content = "x") {
    fs::create_directories(path.parent_path());
    std::ofstream(path) << content;
  }
  static void write_page(const fs::path& folder, const std::string& content) {
    write(folder / "index.html", content);
    write(folder / "login.html");
  }

  fs::path folder_ = fs::path(::testing::TempDir()) / "page_files_test";
  fs::path program_ = folder_ / "bin/canopus";
};

TEST_F(PageFilesTest, TheFolderBesideTheProgramComesFirst_ThenThatOfItsInstallation) {
  write(program_);
  write_page(folder_ / "share/canopus/page", "installed");
  EXPECT_EQ(*PageFiles::of_program(program_)->find("/")->content, "installed");
  write_page(folder_ / "bin/page", "built");
  EXPECT_EQ(*PageFiles::of_program(program_)->find("/index.html")->content, "built");
}

TEST_F(PageFilesTest, WithoutAFolder_TheErrorNamesBoth) {
  write(program_);
  const auto files = PageFiles::of_program(program_);
  ASSERT_FALSE(files);
  EXPECT_THAT(files.error(), HasSubstr((folder_ / "bin/page").string() + " or "));
  EXPECT_THAT(files.error(), EndsWith("page_files_test/share/canopus/page"));
}

TEST_F(PageFilesTest, OnlyRegularFilesWithANameOfAPage) {
  write_page(folder_ / "page", "page");
  write(folder_ / "page/page.js");
  write(folder_ / "page/a b.js");
  write(folder_ / "page/.hidden.js");
  write(folder_ / "page/key.pem");
  write(folder_ / "page/inner/x.js");
  write(folder_ / "secret.txt");
  fs::create_symlink(folder_ / "secret.txt", folder_ / "page/secret.txt");
  const auto files = PageFiles::read(folder_ / "page");
  ASSERT_TRUE(files) << files.error();
  ASSERT_NE(files->find("/page.js"), nullptr);
  EXPECT_EQ(files->find("/page.js")->content_type, "text/javascript; charset=utf-8");
  for (const char* path : {"/a b.js", "/.hidden.js", "/key.pem", "/inner/x.js", "/secret.txt",
                           "/../secret.txt", "page.js", ""}) {
    EXPECT_EQ(files->find(path), nullptr) << path;
  }
}

TEST_F(PageFilesTest, AFolderWithoutItsFirstPage_IsNone) {
  write(folder_ / "page/page.js");
  const auto files = PageFiles::read(folder_ / "page");
  ASSERT_FALSE(files);
  EXPECT_THAT(files.error(), EndsWith("/page: expected the file index.html"));
}

TEST_F(PageFilesTest, TooManyFilesAreRefused) {
  write_page(folder_ / "page", "page");
  for (std::size_t i = 0; i < PageFiles::most_files; ++i)
    write(folder_ / "page" / (std::to_string(i) + ".js"));
  const auto files = PageFiles::read(folder_ / "page");
  ASSERT_FALSE(files);
  EXPECT_THAT(files.error(), HasSubstr("expected up to 200 files of a page with up to 64 MiB together"));
}

TEST_F(PageFilesTest, ATagIsThatOfTheContent) {
  PageFiles files;
  files.add("a.js", "one");
  files.add("b.js", "one");
  files.add("c.js", "two");
  EXPECT_EQ(files.find("/a.js")->tag, files.find("/b.js")->tag);
  EXPECT_NE(files.find("/a.js")->tag, files.find("/c.js")->tag);
  EXPECT_FALSE(files.add("../x.js", "x"));
}

}  // namespace
}  // namespace canopus::web::page_files_test
