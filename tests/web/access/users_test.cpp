// The file of the page's users, and their passwords. The hashes are those of another program's crypt(): Debian's mkpasswd and
// Python's crypt made them.

#include "canopus/web/access/users.hpp"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canopus/web/access/password.hpp"
#include "canopus/web/access/secret.hpp"

namespace canopus::web::users_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;

// python3 -c 'import crypt; print(crypt.crypt("x", "$y$j9T$abcdefgh$"), crypt.crypt("x", "$7$CU..../....abcdefgh$"))'
const std::string yescrypt = "$y$j9T$abcdefgh$9WNEpu8Mx2S4KNGvbVWKM6clOSoY6.YEl7AYF4DGV04";
const std::string scrypt = "$7$CU..../....abcdefgh$19TzpFZ5AwP26vdEMbfvWacoVUfd2MfVusFAVFilh.C";

std::string error_of(const std::string& text) {
  const auto users = parse_web_users(text, "users");
  return users ? "none" : users.error();
}

TEST(WebUsers, OneALine_WithCommentsAndEmptyLines) {
  const auto users = parse_web_users("# shift\n\nanna\toperate  " + yescrypt + "\r\n  bob look " + scrypt +
                                         " \nc.d_e-f@g configure " + yescrypt,
                                     "u");
  ASSERT_TRUE(users) << users.error();
  ASSERT_EQ(users->size(), 3U);
  EXPECT_EQ((*users)[0].name, "anna");
  EXPECT_EQ((*users)[0].role, WebRole::operate);
  EXPECT_EQ((*users)[0].hash, yescrypt);
  EXPECT_EQ((*users)[0].line, 3U);
  EXPECT_EQ((*users)[1].role, WebRole::look);
  EXPECT_EQ((*users)[1].hash, scrypt);
  EXPECT_EQ((*users)[2].name, "c.d_e-f@g");
  EXPECT_EQ((*users)[2].role, WebRole::configure);
  EXPECT_THAT(*parse_web_users("", "u"), IsEmpty());
}

TEST(WebUsers, ALineThatIsWrong_IsNamed_WithWhatWasExpected) {
  EXPECT_EQ(error_of("\nanna operate\n"), "users:2: expected NAME ROLE HASH, found 2 words");
  EXPECT_EQ(error_of("anna"), "users:1: expected NAME ROLE HASH, found 1 word");
  EXPECT_EQ(error_of("anna operate " + yescrypt + " more"),
            "users:1: expected NAME ROLE HASH, found 4 words");
  EXPECT_EQ(error_of("anna root " + yescrypt),
            "users:1: \"root\" is no role; expected look, operate or configure");
  for (const char* name :
       {"-anna", ".", "an:na", "a\xC3\xA4", "an\x1B[2Jna", "abcdefghijklmnopqrstuvwxyz0123456"}) {
    EXPECT_THAT(error_of(name + std::string(" look ") + yescrypt),
                HasSubstr("users:1: expected a name of 1 to 32"))
        << name;
  }
  EXPECT_EQ(error_of("anna look " + yescrypt + "\n#\nanna look " + scrypt),
            "users:3: anna is in line 1 already; expected a user once");
  EXPECT_THAT(error_of(std::string(300000, '#')), HasSubstr("expected at most 262144 bytes"));
}

TEST(WebUsers, AsManyAsThereMayBe_AndOneMore) {
  std::string text;
  for (std::size_t i = 0; i < most_users; ++i) text += fmt::format("u{} look {}\n", i, scrypt);
  EXPECT_EQ(error_of(text), "none");
  EXPECT_EQ(error_of(text + "one look " + scrypt), "users:1001: expected at most 1000 users");
}

TEST(WebUsers, APasswordInPlaceOfAHash_IsNotRepeated) {
  EXPECT_THAT(error_of("anna look my-password"), HasSubstr("users:1: expected a yescrypt or scrypt hash"));
  EXPECT_THAT(error_of("anna look my-password"), Not(HasSubstr("my-password")));
}

TEST(WebUsers, HashesOfLittleMemory_OrOfNoUsualCost_AreNotTaken) {
  EXPECT_TRUE(is_password_hash(yescrypt));
  EXPECT_TRUE(is_password_hash(scrypt));
  for (const std::string hash :
       {"", "x", "$1$abcdefgh$0123456789012345678901", "$6$abcdefgh$012345678901234567890123456789",
        "$2b$12$abcdefghijklmnopqrstuuKX5Yp1vLVDsJPiLYb0hSMHPB4XoyvqS", "$y$", "$y$j9T$",
        "$y$j9T$abcdefgh$"}) {
    EXPECT_FALSE(is_password_hash(hash)) << hash;
  }
  for (const char* cost : {"j75", "j8T", "jGT", "jzT", "i9T", "j9/", "j9TT"}) {
    std::string hash = yescrypt;
    EXPECT_FALSE(is_password_hash(hash.replace(3, 3, cost))) << hash;
  }
  EXPECT_FALSE(is_password_hash(yescrypt + "A"));
  EXPECT_FALSE(is_password_hash(yescrypt.substr(0, yescrypt.size() - 1)));
  std::string odd = yescrypt;
  EXPECT_FALSE(is_password_hash(odd.replace(10, 1, ":")));
  for (const char* cost : {"AU..../....", "HU..../....", "CU..../.../", "CT..../...."}) {
    std::string hash = scrypt;
    EXPECT_FALSE(is_password_hash(hash.replace(3, 11, cost))) << hash;
  }
}

TEST(WebPassword, FitsTheHashesOfOtherPrograms) {
  EXPECT_TRUE(fits_hash("x", yescrypt));
  EXPECT_TRUE(fits_hash("x", scrypt));
  EXPECT_FALSE(fits_hash("y", yescrypt));
  EXPECT_FALSE(fits_hash("", yescrypt));
  EXPECT_FALSE(fits_hash("xx", scrypt));
}

TEST(WebPassword, ANulDoesNotEndIt) {
  EXPECT_FALSE(fits_hash(std::string("x\0y", 3), yescrypt));
  EXPECT_FALSE(fits_hash(std::string("x\0", 2), yescrypt));
  EXPECT_FALSE(fits_hash(std::string(longest_password + 1, 'x'), yescrypt));
}

TEST(WebPassword, ANewHashHasASaltOfItsOwn) {
  const auto one = hash_of("correct horse");
  const auto other = hash_of("correct horse");
  ASSERT_TRUE(one) << one.error();
  EXPECT_NE(*one, *other);
  EXPECT_THAT(*one, MatchesRegex("\\$y\\$j9T\\$.{22}\\$.{43}"));
  EXPECT_TRUE(is_password_hash(*one));
  EXPECT_TRUE(fits_hash("correct horse", *one));
  EXPECT_FALSE(fits_hash("correct horsf", *one));
}

TEST(WebPassword, ANewOneHasALength_AndNoControlCharacters) {
  EXPECT_EQ(hash_of("1234567").error(), "expected a password of 8 to 256 bytes, found 7");
  EXPECT_FALSE(hash_of(std::string(257, 'x')));
  EXPECT_TRUE(hash_of(std::string(256, 'x')));
  EXPECT_EQ(hash_of("12345678\x03").error(), "a password has no control characters");
  EXPECT_FALSE(hash_of(std::string("12345678\0", 9)));
  EXPECT_TRUE(
      hash_of("gr\xC3\xBC\xC3\x9F"
              "e 123"));
}

TEST(WebSecret, IsNeverTheSame_AndComparedWhole) {
  EXPECT_THAT(new_secret(), MatchesRegex("[0-9a-f]{32}"));
  EXPECT_NE(new_secret(), new_secret());
  EXPECT_TRUE(is_same_secret("abc", "abc"));
  EXPECT_TRUE(is_same_secret("", ""));
  for (const char* other : {"abd", "bbc", "ab", "abcd", "", "ABC"})
    EXPECT_FALSE(is_same_secret("abc", other)) << other;
}

class WebUsersFile : public ::testing::Test {
 protected:
  WebUsersFile()
      : folder_(std::filesystem::temp_directory_path() /
                ("canopus-web-users-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    file_ = (folder_ / "users").string();
    std::ofstream(file_) << "anna look " << yescrypt << "\n";
    ::chmod(file_.c_str(), 0600);
  }
  ~WebUsersFile() override { std::filesystem::remove_all(folder_); }
  std::string error_with(mode_t mode) {
    ::chmod(file_.c_str(), mode);
    const auto users = read_web_users(file_);
    return users ? "none" : users.error();
  }
  std::filesystem::path folder_;
  std::string file_;
};

TEST_F(WebUsersFile, IsForItsOwner_AndMayBeForHisGroupToRead) {
  EXPECT_EQ(error_with(0600), "none");
  EXPECT_EQ(error_with(0640), "none");
  EXPECT_EQ(error_with(0400), "none");
  EXPECT_EQ(error_with(0644),
            file_ + ": its mode is 0644: others can read it; expected 0600 or 0640 (chmod 600)");
  EXPECT_EQ(error_with(0660),
            file_ + ": its mode is 0660: others can write it; expected 0600 or 0640 (chmod 600)");
  EXPECT_EQ(error_with(0602),
            file_ + ": its mode is 0602: others can write it; expected 0600 or 0640 (chmod 600)");
}

TEST_F(WebUsersFile, OfAnotherUserIsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  ASSERT_EQ(::chown(file_.c_str(), 12345, 0), 0);
  EXPECT_EQ(error_with(0600), file_ + ": expected a file owned by the user of this program, or by root");
}

TEST_F(WebUsersFile, WhatIsNoFile_IsNotWaitedFor) {
  EXPECT_EQ(read_web_users((folder_ / "no").string()).error(),
            (folder_ / "no").string() + ": No such file or directory");
  EXPECT_THAT(read_web_users(folder_.string()).error(), HasSubstr("expected a file"));
  const std::string pipe = (folder_ / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(read_web_users(pipe).error(), pipe + ": expected a file");
  std::filesystem::resize_file(file_, 3U << 20);
  EXPECT_THAT(read_web_users(file_).error(), HasSubstr("expected at most 262144 bytes"));
}

/// Whatever stands there: users with names, roles and hashes, each once, or an error with the file's name.
RC_GTEST_PROP(WebUsers, AnyText, ()) {
  const auto piece =
      rc::gen::element<std::string>("anna", "bob", " ", "\t", "look", "operate", yescrypt, scrypt, "\n", "\r",
                                    "#", "$y$j9T$", std::string(1, '\0'), "\xFF");
  std::string text;
  for (const std::string& part : *rc::gen::container<std::vector<std::string>>(piece)) text += part;
  const auto users = parse_web_users(text, "u");
  if (!users) {
    RC_ASSERT(users.error().starts_with("u:"));
    return;
  }
  for (const WebAccount& user : *users) {
    RC_ASSERT(is_user_name(user.name));
    RC_ASSERT(is_password_hash(user.hash));
    RC_ASSERT(std::ranges::count(*users, user.name, &WebAccount::name) == 1);
  }
}

}  // namespace
}  // namespace canopus::web::users_test
