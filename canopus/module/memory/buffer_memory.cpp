#include "canopus/module/memory/buffer_memory.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace canopus::module {

namespace {

// At every start of a module, for all its words.
template <typename Number>
void fill(std::vector<Number>& numbers, int byte) noexcept {
  if (!numbers.empty()) std::memset(numbers.data(), byte, numbers.size() * sizeof(Number));
}

}  // namespace

BufferMemory::BufferMemory(std::span<const BufferRow> table) : table_(table) {
  BufferAddress size = 0;
  for (const BufferRow& row : table_) {
    if (row.access != WordAccess::none) size = std::max(size, row.last + 1);
  }
  from_.resize(size);
  to_.resize(size);
  from_row_.resize(size);
  to_row_.resize(size);
  one_word_.resize(size, every_bit);
  area_of_.resize(size);
}

void BufferMemory::select_mode(Modes mode) {
  mode_ = mode;
  online_ = false;
  fill(from_, 0);
  fill(to_, 0);
  fill(from_row_, 0);
  fill(to_row_, 0);
  fill(one_word_, 0xFF);
  std::uint8_t number = 0;
  for (const BufferRow& row : table_) {
    ++number;
    if ((row.modes & mode) == 0 || row.access == WordAccess::none) continue;
    for (BufferAddress address = row.first; address <= row.last; address += row.stride) {
      if (row.access != WordAccess::write) {
        from_row_[address] = number;
        from_[address] = row.initial;
      }
      if (row.access == WordAccess::read) {
        // A word of its own may be on the TO side; when there is none, written() shows the same as word().
        if (to_row_[address] == 0) to_[address] = row.initial;
      } else {
        to_row_[address] = number;
        to_[address] = row.initial;
      }
      const bool is_one = to_row_[address] == 0 || to_row_[address] == from_row_[address];
      one_word_[address] = is_one ? every_bit : std::uint16_t{0};
    }
  }
}

void BufferMemory::attach(BufferAddress first, BufferAddress last, BufferArea& area) {
  auto known = std::ranges::find(areas_, &area);
  if (known == areas_.end()) known = areas_.insert(areas_.end(), &area);
  const auto number = static_cast<std::uint8_t>(known - areas_.begin() + 1);
  const std::size_t end = std::min<std::size_t>(last + 1U, area_of_.size());
  for (std::size_t address = first; address < end; ++address) area_of_[address] = number;
}

std::uint16_t BufferMemory::peek(BufferAddress address, can::Time now) const {
  if (address >= from_.size() || from_row_[address] == 0) return 0;
  const BufferArea* owner = area(address);
  return owner != nullptr ? owner->read_word(address, now) : from_[address];
}

std::uint16_t BufferMemory::program_read(BufferAddress address, can::Time now) {
  if (address >= from_.size() || from_row_[address] == 0) return 0;
  BufferArea* owner = area(address);
  if (owner == nullptr) return from_[address];
  owner->program_reads(address, now);
  return owner->read_word(address, now);
}

WriteResult BufferMemory::write(BufferAddress address, std::uint16_t value, can::Time now) {
  if (address >= to_.size() || to_row_[address] == 0) return WriteResult::ignored;
  const BufferRow& row = table_[to_row_[address] - 1U];
  if (row.offline_only && online_) return WriteResult::refused;
  if (!row.range.contains(value)) return WriteResult::invalid;
  if (const std::uint8_t area = area_of_[address]; area != 0) {
    return areas_[area - 1U]->write_word(address, value, now);
  }
  store(address, value);
  return WriteResult::done;
}

void BufferMemory::store(BufferAddress address, std::uint16_t value) noexcept {
  const BufferRow& row = table_[to_row_[address] - 1U];
  value = static_cast<std::uint16_t>((value & row.writable) | (to_[address] & ~row.writable));
  to_[address] = value;
  if (from_row_[address] == to_row_[address]) from_[address] = value;
}

WriteResult BufferMemory::check(BufferAddress address, std::uint16_t value, Modes mode) const noexcept {
  for (const BufferRow& row : table_) {
    if ((row.modes & mode) == 0 || !row.covers(address)) continue;
    if (row.access != WordAccess::write && row.access != WordAccess::read_write) continue;
    return row.range.contains(value) ? WriteResult::done : WriteResult::invalid;
  }
  return WriteResult::ignored;
}

const BufferRow* BufferMemory::row(BufferAddress address, WordAccess direction) const noexcept {
  if (address >= from_.size()) return nullptr;
  const std::uint8_t number = direction == WordAccess::write ? to_row_[address] : from_row_[address];
  return number == 0 ? nullptr : &table_[number - 1U];
}

void BufferMemory::set_word(BufferAddress address, std::uint16_t value) noexcept {
  from_[address] = value;
  if (one_word_[address] != 0) to_[address] = value;
}

void BufferMemory::set_words(BufferAddress first, std::span<const std::uint8_t> bytes) noexcept {
  static_assert(std::endian::native == std::endian::little);
  const std::size_t words = bytes.size() / 2;
  std::memcpy(&from_[first], bytes.data(), 2 * words);
  // Without branches: words of a PDO at once.
  for (std::size_t address = first; address < first + words; ++address) {
    const unsigned one_word = one_word_[address];
    to_[address] = static_cast<std::uint16_t>((from_[address] & one_word) | (to_[address] & ~one_word));
  }
}

template <typename Use>
void BufferMemory::for_each_stored(Use use) const {
  for (const BufferRow& row : table_) {
    if (row.stored == Stored::no || (row.modes & mode_) == 0) continue;
    for (BufferAddress address = row.first; address <= row.last; address += row.stride) use(row, address);
  }
}

void BufferMemory::collect_stored(StoredWords& words) const {
  for_each_stored([&](const BufferRow&, BufferAddress address) { words[address] = to_[address]; });
}

bool BufferMemory::apply_stored(const StoredWords& words) {
  bool good = true;
  for_each_stored([&](const BufferRow& row, BufferAddress address) {
    const auto found = words.find(address);
    good = good && (found == words.end() || row.range.contains(found->second));
  });
  if (!good) return false;
  for_each_stored([&](const BufferRow&, BufferAddress address) {
    if (const auto found = words.find(address); found != words.end()) put_stored(address, found->second);
  });
  return true;
}

void BufferMemory::restore_initial() {
  for_each_stored([&](const BufferRow& row, BufferAddress address) { put_stored(address, row.initial); });
}

}  // namespace canopus::module
