// The supply goes off at every system call and every byte of a write or an erasure.

#include <gtest/gtest.h>

#include "canopus/store/file_memory.hpp"

#include "store/cut_files.hpp"

namespace canopus::store::power_cut_test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using State = module::NonVolatileMemory::Content::State;
using Content = std::optional<Bytes>;  // nothing: missing

const std::filesystem::path folder = "plant/state/module";

Bytes some_bytes(std::size_t length, unsigned seed) {
  std::mt19937 random(seed);
  Bytes bytes(length);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

struct Change {
  std::string_view name;
  Content content;
};

void make(FileMemory& memory, const Change& change) {
  const bool done = change.content ? memory.write(change.name, *change.content) : memory.erase(change.name);
  EXPECT_TRUE(done) << memory.error();
}

// Cuts `change` after each of its steps, `rounds` times with other dice, and once not at all.
void cut_everywhere(const std::vector<Change>& before, const Change& change, unsigned rounds) {
  Content old;
  bool done = false;
  for (std::uint64_t cut = 0; !done; ++cut) {
    for (unsigned round = 0; round < rounds; ++round) {
      CutFiles files;
      ASSERT_EQ(files.make_folder("plant"), 0);
      std::mt19937 random(static_cast<unsigned>(cut) * rounds + round);
      {
        FileMemory memory(folder, "the owner", files);
        for (const Change& earlier : before) {
          make(memory, earlier);
          if (earlier.name == change.name) old = earlier.content;
        }
      }
      done = false;
      files.cut_after(cut);
      try {
        FileMemory memory(folder, "the owner", files);
        make(memory, change);
        done = true;
      } catch (const PowerCut&) {
      }
      files.power_back(random);
      FileMemory memory(folder, "the owner", files);
      const auto found = memory.read(change.name);
      ASSERT_NE(found.state, State::damaged) << "cut after " << cut << " steps";
      const Content left = found.state == State::good ? Content(found.bytes) : std::nullopt;
      ASSERT_TRUE(left == change.content || (!done && left == old)) << "cut after " << cut << " steps";
      for (const Change& earlier : before) {
        if (earlier.name == change.name) continue;
        ASSERT_EQ(memory.read(earlier.name).bytes, *earlier.content) << "cut after " << cut << " steps";
      }
      // The next write works, whatever was left lying about.
      make(memory, {change.name, Bytes{1, 2, 3}});
      ASSERT_EQ(memory.read(change.name).bytes, (Bytes{1, 2, 3}));
    }
  }
}

TEST(PowerCut, OfTheFirstWrite_LeavesNothingOrTheContent) {
  cut_everywhere({}, {"words", some_bytes(100, 1)}, 20);
}

TEST(PowerCut, OfARewrite_LeavesTheOldOrTheNewContent) {
  cut_everywhere({{"words", some_bytes(90, 1)}, {"objects", some_bytes(700, 2)}},
                 {"words", some_bytes(100, 3)}, 20);
  cut_everywhere({{"words", some_bytes(100, 1)}}, {"words", some_bytes(7, 3)}, 50);
}

TEST(PowerCut, OfALongRewrite_LeavesTheOldOrTheNewContent) {
  cut_everywhere({{"objects", some_bytes(1800, 1)}}, {"objects", some_bytes(1500, 2)}, 1);
}

TEST(PowerCut, OfAnErasure_LeavesTheContentOrNothing) {
  cut_everywhere({{"words", some_bytes(100, 1)}, {"saving", Bytes{}}}, {"saving", std::nullopt}, 100);
}

// The file system of these tests does lose what it may lose: a store that forgets a flush is found out.
TEST(PowerCut, TheFileSystemOfTheTest_ForgetsWhatWasNotFlushed) {
  unsigned lost_name = 0, lost_bytes = 0, kept = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    CutFiles files;
    std::mt19937 random(seed);
    ASSERT_EQ(files.make_folder("plant"), 0);
    const auto file = files.create("plant/words");
    ASSERT_TRUE(file.has_value());
    ASSERT_EQ(files.write(*file, Bytes(600, 0x55)).value_or(0), 600U);
    files.close(*file);
    files.power_back(random);
    const Bytes* left = files.content("plant/words");
    if (left == nullptr) {
      ++lost_name;
    } else if (*left != Bytes(600, 0x55)) {
      ++lost_bytes;
    } else {
      ++kept;
    }
  }
  EXPECT_GT(lost_name, 20U);
  EXPECT_GT(lost_bytes, 20U);
  EXPECT_GT(kept, 10U);
}

}  // namespace
}  // namespace canopus::store::power_cut_test
