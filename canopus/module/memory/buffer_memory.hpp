#pragma once
// The words a PLC reads with FROM and writes with TO (U\G), and the rules of each: a table of constexpr rows
// that reads like the manual's own (address range, name, access, default, range of values, stored or not,
// modes). Every access is checked against the table before an area sees it, so that whatever a module reports
// about bad writes comes from one place.
//
// One number need not be one word: on FX modules FROM and TO at the same address reach different storage.
// Then the table has two rows for it, one that can only be read and one that can only be written.

#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/module/interface/module_types.hpp"

namespace canopus::module {

/// Function modes of a module, one bit each; which bit is which is the module's own business.
using Modes = std::uint8_t;
inline constexpr Modes every_mode = 0xFF;

/// What the PLC may do with a word.
enum class WordAccess : std::uint8_t {
  none,   ///< system area: reads 0, writes have no effect
  read,   ///< writes have no effect
  write,  ///< the TO side of a number whose FROM side is another word
  read_write,
};

/// Values a word accepts.
struct ValueRange {
  enum class Kind : std::uint8_t { any, between, between_signed, one_of } kind = Kind::any;
  std::int32_t low = 0;
  std::int32_t high = 0;
  std::span<const std::uint16_t> values{};

  [[nodiscard]] constexpr bool contains(std::uint16_t value) const noexcept {
    switch (kind) {
      case Kind::any: return true;
      case Kind::between: return value >= low && value <= high;
      case Kind::between_signed: {
        const auto number = static_cast<std::int16_t>(value);
        return number >= low && number <= high;
      }
      case Kind::one_of:
        for (const std::uint16_t one : values) {
          if (one == value) return true;
        }
        return false;
    }
    return false;
  }
};
inline constexpr ValueRange any_value{};
constexpr ValueRange between(std::int32_t low, std::int32_t high) noexcept {
  return {.kind = low < 0 ? ValueRange::Kind::between_signed : ValueRange::Kind::between,
          .low = low,
          .high = high};
}
constexpr ValueRange one_of(std::span<const std::uint16_t> values) noexcept {
  return {.kind = ValueRange::Kind::one_of, .values = values};
}

/// Stored: survives power-off once the PLC has it saved.
enum class Stored : bool { no, yes };

/// One row of a module's memory map. Addresses that no row covers are system area.
struct BufferRow {
  BufferAddress first = 0;
  BufferAddress last = 0;
  std::string_view name{};
  WordAccess access = WordAccess::none;
  std::uint16_t initial = 0;
  ValueRange range{};
  Stored stored = Stored::no;
  Modes modes = every_mode;
  std::string_view section{};
  /// Words of a repeated block: only first, first + stride, first + 2 stride ... up to last.
  std::uint16_t stride = 1;
  /// Refused while the module is online (BufferMemory::set_online).
  bool offline_only = false;
  /// Bits that a write reaches; reserved ones stay as they are.
  std::uint16_t writable = 0xFFFF;

  [[nodiscard]] constexpr bool covers(BufferAddress address) const noexcept {
    return address >= first && address <= last && (address - first) % stride == 0;
  }
};

/// What became of a write.
enum class WriteResult : std::uint8_t {
  done,
  ignored,  ///< not for the PLC to write: system area, read only
  invalid,  ///< a value the word does not accept
  refused,  ///< not now: configuration while online
};

/// Words with a behaviour of their own. They are called after the table's check.
class BufferArea {
 public:
  [[nodiscard]] virtual std::uint16_t read_word(BufferAddress address, can::Time now) const = 0;
  /// FROM reads this word next: what the word does then.
  virtual void program_reads(BufferAddress /*address*/, can::Time /*now*/) {}
  virtual WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) = 0;

 protected:
  ~BufferArea() = default;
};

/// Words that survive power-off, by address.
using StoredWords = std::map<BufferAddress, std::uint16_t>;

class BufferMemory {
 public:
  /// The table must outlive the memory. Up to 254 rows.
  explicit BufferMemory(std::span<const BufferRow> table);

  /// Uses the rows of this mode from now on; every word goes to its initial value.
  void select_mode(Modes mode);
  /// The selected mode; 0 before the first selection.
  [[nodiscard]] Modes mode() const noexcept { return mode_; }
  /// While online, writes to offline_only rows are refused.
  void set_online(bool online) noexcept { online_ = online; }
  [[nodiscard]] bool online() const noexcept { return online_; }
  /// Gives first..last, as far as they are in the table, to an area.
  void attach(BufferAddress first, BufferAddress last, BufferArea& area);
  /// The owner of the word; nullptr: none, it is a plain one.
  [[nodiscard]] BufferArea* area(BufferAddress address) const noexcept {
    const std::uint8_t number = address < area_of_.size() ? area_of_[address] : std::uint8_t{0};
    return number == 0 ? nullptr : areas_[number - 1U];
  }

  /// What FROM reads, without its effects; 0 where the table has no word.
  [[nodiscard]] std::uint16_t peek(BufferAddress address, can::Time now) const;
  /// FROM.
  [[nodiscard]] std::uint16_t program_read(BufferAddress address, can::Time now);
  /// TO.
  WriteResult write(BufferAddress address, std::uint16_t value, can::Time now);
  /// The result of write() for this row of any mode, without the areas (settings given before power-on).
  [[nodiscard]] WriteResult check(BufferAddress address, std::uint16_t value, Modes mode) const noexcept;
  /// The row an access would be checked against, or nullptr.
  [[nodiscard]] const BufferRow* row(BufferAddress address, WordAccess direction) const noexcept;

  // The module's own access: no checks, no areas.
  /// What FROM reads.
  [[nodiscard]] std::uint16_t word(BufferAddress address) const noexcept { return from_[address]; }
  /// What TO wrote last (the same as word() where both directions are one word).
  [[nodiscard]] std::uint16_t written(BufferAddress address) const noexcept { return to_[address]; }
  /// What TO wrote to first .. first + count - 1.
  [[nodiscard]] std::span<const std::uint16_t> written(BufferAddress first,
                                                       std::size_t count) const noexcept {
    return std::span(to_).subspan(first, count);
  }
  /// What write() does with a word that has no area: only the bits that a write reaches.
  void store(BufferAddress address, std::uint16_t value) noexcept;
  /// What FROM shall read.
  void set_word(BufferAddress address, std::uint16_t value) noexcept;
  /// The same for as many words from `first` on as there are bytes for, low byte first.
  void set_words(BufferAddress first, std::span<const std::uint8_t> bytes) noexcept;

  /// Takes the present values of all stored words of the selected mode into `words`; other entries stay.
  void collect_stored(StoredWords& words) const;
  /// Puts stored words of the selected mode in. False, and nothing is put in, when a value is not one its
  /// word accepts.
  bool apply_stored(const StoredWords& words);
  /// Stored words of the selected mode back to their initial values.
  void restore_initial();

 private:
  template <typename Use>
  void for_each_stored(Use use) const;
  /// Both sides, where FROM and TO are two words.
  void put_stored(BufferAddress address, std::uint16_t value) noexcept {
    from_[address] = to_[address] = value;
  }

  std::span<const BufferRow> table_;
  Modes mode_ = 0;
  bool online_ = false;
  std::vector<std::uint16_t> from_;
  std::vector<std::uint16_t> to_;
  std::vector<std::uint8_t> from_row_;  // number of the row + 1, 0 = none
  std::vector<std::uint8_t> to_row_;
  static constexpr std::uint16_t every_bit = 0xFFFF;
  std::vector<std::uint16_t> one_word_;  // every_bit where FROM and TO mean the same word, else 0
  std::vector<std::uint8_t> area_of_;    // number of the area + 1, 0 = none
  std::vector<BufferArea*> areas_;
};

}  // namespace canopus::module
