// Words of a CPU's device against a plain vector of them: reads, writes and clearing over the ends of pages.

#include "canopus/plc/cpu/device_words.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <rapidcheck/gtest.h>

namespace canopus::plc::device_words_test {
namespace {

constexpr std::size_t size = 5000;  // the last page is not full

struct Piece {
  std::size_t first;
  std::size_t count;
};

Piece any_piece() {
  const auto first = *rc::gen::inRange<std::size_t>(0, size);
  return {first, *rc::gen::inRange<std::size_t>(0, std::min<std::size_t>(size - first, 2500) + 1)};
}

RC_GTEST_PROP(DeviceWords, HoldWhatWasWritten, ()) {
  DeviceWords words;
  words.resize(size);
  std::vector<std::uint16_t> expected(size);
  const int steps = *rc::gen::inRange(1, 20);
  for (int step = 0; step < steps; ++step) {
    const Piece piece = any_piece();
    const auto what = *rc::gen::inRange(0, 4);
    if (what == 0) {
      words.clear(piece.first);
      std::fill_n(expected.begin(), piece.first, std::uint16_t{0});
    } else if (what == 1 && piece.count > 0) {
      const auto word = *rc::gen::arbitrary<std::uint16_t>();
      words.set(piece.first, word);
      expected[piece.first] = word;
    } else {
      // Zeros, too: they take no memory, but count where something else was.
      std::vector<std::uint16_t> written(piece.count);
      if (what == 2) {
        for (std::size_t i = 0; i < written.size(); ++i) written[i] = static_cast<std::uint16_t>(step + i);
      }
      words.write(piece.first, written);
      std::ranges::copy(written, expected.begin() + static_cast<std::ptrdiff_t>(piece.first));
    }
    const Piece seen = any_piece();
    std::vector<std::uint16_t> read(seen.count, 0xAAAA);
    words.read(seen.first, read);
    for (std::size_t i = 0; i < read.size(); ++i) RC_ASSERT(read[i] == expected[seen.first + i]);
  }
  for (std::size_t i = 0; i < size; ++i) RC_ASSERT(words[i] == expected[i]);
}

TEST(DeviceWords, TakeMemory_WhereSomethingIsWritten) {
  DeviceWords words;
  words.resize(500'000);
  const auto heap = [] {
    const auto info = mallinfo2();
    return info.uordblks + info.hblkhd;
  };
  const std::size_t before = heap();
  std::vector<std::uint16_t> some(100);
  words.write(4'000, some);
  words.read(200'000, some);
  words.clear();
  EXPECT_LE(heap(), before + 256);  // `some`
  words.set(499'999, 1);
  EXPECT_EQ(words[499'999], 1);
  EXPECT_LE(heap(), before + 1024);
}

TEST(DeviceWords, AreZeroAtFirst) {
  DeviceWords words;
  words.resize(size);
  ASSERT_EQ(words.size(), size);
  std::vector<std::uint16_t> read(size, 0xAAAA);
  words.read(0, read);
  EXPECT_EQ(read, std::vector<std::uint16_t>(size));
}

}  // namespace
}  // namespace canopus::plc::device_words_test
