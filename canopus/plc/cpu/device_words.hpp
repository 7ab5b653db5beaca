#pragma once
// The words of one device of a CPU, all 0 at first. Memory is taken a page at a time, when something else than 0 is
// written there: of half a million file registers nearly all stay 0 in nearly every plant.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace canopus::plc {

class DeviceWords {
 public:
  /// Call it once.
  void resize(std::size_t words) {
    size_ = words;
    pages_.resize((words + page_words - 1) / page_words);
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

  /// Below size(), as all numbers here.
  [[nodiscard]] std::uint16_t operator[](std::size_t number) const noexcept {
    const Page* const page = pages_[number / page_words].get();
    return page == nullptr ? std::uint16_t{0} : (*page)[number % page_words];
  }
  void set(std::size_t number, std::uint16_t word) { write(number, {&word, 1}); }
  /// `count` words in a row, at a place that stays; takes their memory. nullptr: they are of two pages.
  [[nodiscard]] std::uint16_t* at(std::size_t first, std::size_t count) {
    if (first % page_words + count > page_words) return nullptr;
    std::unique_ptr<Page>& page = pages_[first / page_words];
    if (page == nullptr) page = std::make_unique<Page>();
    return page->data() + first % page_words;
  }
  void read(std::size_t first, std::span<std::uint16_t> words) const noexcept {
    each_piece(first, words, [this](std::size_t number, std::size_t begin, std::span<std::uint16_t> piece) {
      const Page* const page = pages_[number].get();
      if (page == nullptr) {
        std::ranges::fill(piece, std::uint16_t{0});
      } else {
        std::copy_n(page->data() + begin, piece.size(), piece.begin());
      }
    });
  }
  void write(std::size_t first, std::span<const std::uint16_t> words) {
    each_piece(first, words,
               [this](std::size_t number, std::size_t begin, std::span<const std::uint16_t> piece) {
                 std::unique_ptr<Page>& page = pages_[number];
                 if (page == nullptr) {
                   if (std::ranges::all_of(piece, [](std::uint16_t word) { return word == 0; })) return;
                   page = std::make_unique<Page>();
                 }
                 std::ranges::copy(piece, page->begin() + static_cast<std::ptrdiff_t>(begin));
               });
  }
  /// The first `count` are 0 again. What memory there is, stays: it will be used again.
  void clear(std::size_t count) noexcept {
    for (std::size_t number = 0; number * page_words < count; ++number) {
      if (pages_[number] == nullptr) continue;
      std::fill_n(pages_[number]->begin(), std::min(page_words, count - number * page_words),
                  std::uint16_t{0});
    }
  }
  void clear() noexcept { clear(size_); }

 private:
  static constexpr std::size_t page_words = 256;
  using Page = std::array<std::uint16_t, page_words>;

  /// Calls `each(number of a page, place in it, piece of words)` for each page of the range.
  template <typename Word, typename Each>
  static void each_piece(std::size_t first, std::span<Word> words, Each each) {
    while (!words.empty()) {
      const std::size_t begin = first % page_words;
      const auto piece = words.first(std::min(words.size(), page_words - begin));
      each(first / page_words, begin, piece);
      first += piece.size();
      words = words.subspan(piece.size());
    }
  }

  std::vector<std::unique_ptr<Page>> pages_;  // nullptr: all 0
  std::size_t size_ = 0;
};

}  // namespace canopus::plc
