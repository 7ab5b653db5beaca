#include "canopus/store/file_memory.hpp"

#include <fstream>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/stat.h>

namespace canopus::store::file_memory_test {
namespace {

using State = module::NonVolatileMemory::Content::State;
using Bytes = std::vector<std::uint8_t>;

// A folder of the test's own, gone at its end.
class FileMemoryTest : public testing::Test {
 protected:
  FileMemoryTest() {
    std::string name = (std::filesystem::temp_directory_path() / "canopus-store-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~FileMemoryTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path inside(std::string_view name) const {
    return folder_ / "module" / name;
  }
  [[nodiscard]] Bytes file(std::string_view name) const {
    std::ifstream stream(inside(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void put_file(std::string_view name, const Bytes& bytes) const {
    std::ofstream stream(inside(name), std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }

  std::filesystem::path folder_;
};

TEST_F(FileMemoryTest, NeverWritten_IsMissing) {
  FileMemory memory(folder_ / "module");
  EXPECT_EQ(memory.read("words").state, State::missing);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "module"));
}

TEST_F(FileMemoryTest, Written_IsReadByTheNextRun) {
  EXPECT_TRUE(FileMemory(folder_ / "module").write("words", Bytes{1, 2, 3}));
  FileMemory next(folder_ / "module");
  const auto content = next.read("words");
  EXPECT_EQ(content.state, State::good);
  EXPECT_EQ(content.bytes, (Bytes{1, 2, 3}));
}

TEST_F(FileMemoryTest, FileFormat_IsAsDocumented) {
  FileMemory memory(folder_ / "module");
  ASSERT_TRUE(memory.write("words", Bytes{'1', '2', '3', '4', '5', '6', '7', '8', '9'}));
  // The CRC-32 of "123456789" is CBF43926H.
  EXPECT_EQ(file("words"), (Bytes{'C', 'N',  'P',  'S',  1,    0,   0,   0,   9,   0,   0,   0,   0,   0,  0,
                                  0,   0x26, 0x39, 0xF4, 0xCB, '1', '2', '3', '4', '5', '6', '7', '8', '9'}));
}

TEST_F(FileMemoryTest, FileFormatWithAnOwner_IsAsDocumented) {
  FileMemory memory(folder_ / "module", "me");
  ASSERT_TRUE(memory.write("words", Bytes{'5', '6', '7', '8', '9'}));
  const Bytes bytes = file("words");
  ASSERT_EQ(bytes.size(), 29U);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 16),
            (Bytes{'C', 'N', 'P', 'S', 2, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(Bytes(bytes.begin() + 20, bytes.end()), (Bytes{2, 0, 'm', 'e', '5', '6', '7', '8', '9'}));
}

TEST_F(FileMemoryTest, OfAnotherOwner_IsDamageThatNamesBoth) {
  ASSERT_TRUE(FileMemory(folder_ / "module", "device \"a\"").write("words", Bytes{1}));
  FileMemory other(folder_ / "module", "device \"b\"");
  EXPECT_EQ(other.read("words").state, State::damaged);
  EXPECT_EQ(other.damage("words"),
            inside("words").string() + ": belongs to device \"a\", not to device \"b\"");
  EXPECT_EQ(FileMemory(folder_ / "module", "device \"a\"").read("words").bytes, Bytes{1});
  EXPECT_EQ(FileMemory(folder_ / "module").read("words").bytes, Bytes{1});  // whoever asks
}

TEST_F(FileMemoryTest, WithoutAnOwner_IsReadByAnyAndGetsOneWhenItIsWritten) {
  ASSERT_TRUE(FileMemory(folder_ / "module").write("words", Bytes{1}));
  FileMemory mine(folder_ / "module", "me");
  EXPECT_EQ(mine.read("words").bytes, Bytes{1});
  EXPECT_EQ(mine.damage("words"), "");
  ASSERT_TRUE(mine.write("words", Bytes{2}));
  EXPECT_EQ(FileMemory(folder_ / "module", "another").read("words").state, State::damaged);
}

TEST_F(FileMemoryTest, Damage_IsASentenceWithThePath) {
  FileMemory memory(folder_ / "module");
  EXPECT_EQ(memory.damage("words"), "");
  ASSERT_TRUE(memory.write("words", Bytes{1}));
  EXPECT_EQ(memory.damage("words"), "");
  put_file("words", Bytes{'h', 'i'});
  EXPECT_EQ(memory.damage("words"),
            inside("words").string() + ": is damaged, or not a file that Canopus has stored");
  std::filesystem::remove(inside("words"));
  std::filesystem::create_directory(inside("words"));
  EXPECT_EQ(memory.damage("words"), inside("words").string() + ": cannot read: Is a directory");
}

// A FIFO that nobody writes to: opened as a file it would wait for ever.
TEST_F(FileMemoryTest, AFifo_IsDamageAndNotWaitedFor) {
  std::filesystem::create_directory(folder_ / "module");
  ASSERT_EQ(::mkfifo(inside("words").c_str(), 0600), 0);
  FileMemory memory(folder_ / "module");
  EXPECT_EQ(memory.read("words").state, State::damaged);
  EXPECT_EQ(memory.damage("words"), inside("words").string() + ": cannot read: it is not a file");
}

TEST_F(FileMemoryTest, ALinkInPlaceOfTheNewFile_IsNotFollowed) {
  std::filesystem::create_directory(folder_ / "module");
  std::ofstream(folder_ / "other") << "keep me";
  std::filesystem::create_symlink(folder_ / "other", inside("words.new"));
  FileMemory memory(folder_ / "module");
  ASSERT_TRUE(memory.write("words", Bytes{1, 2, 3})) << memory.error();
  std::ifstream other(folder_ / "other");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(other), {}), "keep me");
  EXPECT_EQ(memory.read("words").bytes, (Bytes{1, 2, 3}));
}

// Nor is a FIFO waited for that somebody put in its place.
TEST_F(FileMemoryTest, AFifoInPlaceOfTheNewFile_IsTakenAway) {
  std::filesystem::create_directory(folder_ / "module");
  ASSERT_EQ(::mkfifo(inside("words.new").c_str(), 0600), 0);
  FileMemory memory(folder_ / "module");
  ASSERT_TRUE(memory.write("words", Bytes{1})) << memory.error();
  EXPECT_EQ(memory.read("words").bytes, Bytes{1});
}

TEST_F(FileMemoryTest, EmptyContent_IsNotMissing) {
  FileMemory memory(folder_ / "module");
  ASSERT_TRUE(memory.write("words", {}));
  EXPECT_EQ(memory.read("words").state, State::good);
  EXPECT_TRUE(memory.read("words").bytes.empty());
}

TEST_F(FileMemoryTest, Erased_IsMissing_AndErasingWhatIsNotThereIsFine) {
  FileMemory memory(folder_ / "module");
  EXPECT_TRUE(memory.erase("words"));
  ASSERT_TRUE(memory.write("words", Bytes{1}));
  EXPECT_TRUE(memory.erase("words"));
  EXPECT_EQ(memory.read("words").state, State::missing);
}

TEST_F(FileMemoryTest, EveryFlippedBit_IsDamage) {
  FileMemory memory(folder_ / "module");
  ASSERT_TRUE(memory.write("words", Bytes{1, 2, 3}));
  const Bytes good = file("words");
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ 1U << (bit % 8));
    put_file("words", bad);
    EXPECT_EQ(memory.read("words").state, State::damaged) << "bit " << bit;
  }
}

TEST_F(FileMemoryTest, EveryCutLength_AndWhatIsAppended_IsDamage) {
  FileMemory memory(folder_ / "module");
  ASSERT_TRUE(memory.write("words", Bytes{1, 2, 3}));
  const Bytes good = file("words");
  for (std::size_t length = 0; length < good.size(); ++length) {
    put_file("words", Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)));
    EXPECT_EQ(memory.read("words").state, State::damaged) << length << " bytes";
  }
  Bytes longer = good;
  longer.push_back(0);
  put_file("words", longer);
  EXPECT_EQ(memory.read("words").state, State::damaged);
}

TEST_F(FileMemoryTest, CutBeforeTheNewFileIsInPlace_LeavesTheOldContent) {
  FileMemory memory(folder_ / "module");
  ASSERT_TRUE(memory.write("words", Bytes{1, 2, 3}));
  put_file("words.new", Bytes{9, 9});  // what a cut in the middle of a write leaves behind
  EXPECT_EQ(FileMemory(folder_ / "module").read("words").bytes, (Bytes{1, 2, 3}));
  ASSERT_TRUE(memory.write("words", Bytes{4}));
  EXPECT_EQ(memory.read("words").bytes, (Bytes{4}));
  EXPECT_FALSE(std::filesystem::exists(inside("words.new")));
}

TEST_F(FileMemoryTest, FolderThatCannotBeMade_IsAnErrorWithItsName) {
  std::ofstream(folder_ / "module") << "a file, not a folder";
  FileMemory memory(folder_ / "module");
  EXPECT_FALSE(memory.write("words", Bytes{1}));
  EXPECT_NE(memory.error().find((folder_ / "module").string()), std::string::npos) << memory.error();
  EXPECT_EQ(memory.read("words").state, State::missing);
}

TEST_F(FileMemoryTest, NamesThatLeaveTheFolder_AreRefused) {
  FileMemory memory(folder_ / "module");
  for (const char* name : {"", "..", "../words", "a/b", ".hidden", "a b", "a\n"}) {
    EXPECT_FALSE(memory.write(name, Bytes{1})) << name;
    EXPECT_FALSE(memory.erase(name)) << name;
    EXPECT_EQ(memory.read(name).state, State::missing) << name;
    EXPECT_FALSE(memory.error().empty());
  }
}

RC_GTEST_FIXTURE_PROP(FileMemoryTest, AnyContent_ComesBack, (const Bytes& bytes)) {
  FileMemory memory(folder_ / "module");
  RC_ASSERT(memory.write("words", bytes));
  const auto content = memory.read("words");
  RC_ASSERT(content.state == State::good);
  RC_ASSERT(content.bytes == bytes);
}

}  // namespace
}  // namespace canopus::store::file_memory_test
