#include "canopus/plc/modbus/map.hpp"

#include <algorithm>

#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc::modbus {

namespace {

constexpr std::uint32_t address_count = 0x10000;
constexpr unsigned bits_per_word = 16;

bool is_bit(const RackAddress& at) { return !at.is_buffer && device_info(at.device).is_bit; }

RackAddress further(RackAddress at, std::uint32_t points) {
  at.number += points;
  return at;
}

Rack::Access check_points(const Rack& rack, const RackAddress& at, std::uint32_t count) {
  return at.is_buffer ? rack.check_buffer(at.head_address, at.number, count)
                      : rack.check(at.device, at.number, count);
}

Rack::Access read(Rack& rack, const RackAddress& at, std::span<std::uint16_t> words, can::Time now) {
  return at.is_buffer ? rack.read_buffer(at.head_address, at.number, words, now)
                      : rack.read_words(at.device, at.number, words, now);
}

Rack::Access write(Rack& rack, const RackAddress& at, std::span<const std::uint16_t> words, can::Time now) {
  return at.is_buffer ? rack.write_buffer(at.head_address, at.number, words, now)
                      : rack.write_words(at.device, at.number, words, now);
}

Exception exception_of(const Rack::Access& access) {
  if (access) return Exception::none;
  // A module without supply is there, but cannot answer.
  return access.error() == AccessError::no_module ? Exception::server_device_failure
                                                  : Exception::illegal_data_address;
}

/// The position of address `offset` of a range of bits in its words, and the number of following bits in this
/// word.
struct BitsOfWord {
  RackAddress at;
  unsigned first = 0;
  std::size_t count = 0;
};
BitsOfWord bits_of_word(const Range& range, std::uint32_t offset, std::size_t count) {
  const unsigned first = offset % bits_per_word;
  return {further(range.at, offset / bits_per_word), first,
          std::min<std::size_t>(count, bits_per_word - first)};
}

}  // namespace

std::string_view table_name(Table table) noexcept {
  switch (table) {
    case Table::coils: return "coils";
    case Table::discrete_inputs: return "discrete inputs";
    case Table::holding_registers: return "holding registers";
    case Table::input_registers: break;
  }
  return "input registers";
}

std::expected<void, std::string> Map::add(Table table, const Range& range) {
  if (range.count == 0 || range.first + range.count > address_count)
    return std::unexpected("expected 1 to " + std::to_string(address_count - range.first) +
                           " addresses: the last one is 65535");
  auto& ranges = ranges_[static_cast<std::size_t>(table)];
  const auto behind = std::ranges::upper_bound(ranges, range.first, {}, &Range::first);
  const auto overlaps = [&](const Range& other) {
    return range.first < other.first + other.count && other.first < range.first + range.count;
  };
  for (const auto other : {behind, behind == ranges.begin() ? ranges.end() : behind - 1}) {
    if (other == ranges.end() || !overlaps(*other)) continue;
    return std::unexpected(std::string(table_name(table)) + " " + std::to_string(other->first) + " to " +
                           std::to_string(other->first + other->count - 1) + " are " + to_text(other->at) +
                           " already");
  }
  ranges.insert(behind, range);
  return {};
}

const Range* Map::find(Table table, std::uint32_t address) const noexcept {
  const auto& ranges = ranges_[static_cast<std::size_t>(table)];
  const auto behind = std::ranges::upper_bound(
      ranges, address, {}, [](const Range& range) { return static_cast<std::uint32_t>(range.first); });
  if (behind == ranges.begin()) return nullptr;
  const Range& range = *(behind - 1);
  return address < range.first + range.count ? &range : nullptr;
}

Map::DoubleWords Map::double_words(Table table, std::uint32_t first, std::size_t words) const noexcept {
  const Range* range = find(table, first);
  if (range == nullptr || !range->double_words) return {};
  const std::uint32_t offset = first - range->first;
  return {range, further(range->at, 2 * offset), words % 2 == 0 && words / 2 <= range->count - offset};
}

template <typename Use>
Exception Map::each_part(Table table, std::uint32_t first, std::size_t count, Use use) const {
  for (std::size_t done = 0; done < count;) {
    const auto address = static_cast<std::uint32_t>(first + done);
    const Range* range = find(table, address);
    if (range == nullptr || range->double_words) return Exception::illegal_data_address;
    const std::uint32_t offset = address - range->first;
    const std::size_t part = std::min<std::size_t>(count - done, range->count - offset);
    if (const Exception exception = use(*range, offset, done, part); exception != Exception::none)
      return exception;
    done += part;
  }
  return Exception::none;
}

Exception Map::check(const Rack& rack, Table table, std::uint32_t first, std::size_t count,
                     bool writes) const {
  if (const DoubleWords found = double_words(table, first, count); found.range != nullptr) {
    if (!found.fits || (writes && found.range->read_only)) return Exception::illegal_data_address;
    return exception_of(check_points(rack, found.at, static_cast<std::uint32_t>(count)));
  }
  return each_part(table, first, count,
                   [&](const Range& range, std::uint32_t offset, std::size_t /*done*/, std::size_t part) {
                     if (writes && range.read_only) return Exception::illegal_data_address;
                     const auto points = static_cast<std::uint32_t>(part);
                     if (is_bit_table(table) == is_bit(range.at))
                       return exception_of(check_points(rack, further(range.at, offset), points));
                     if (is_bit(range.at))
                       return exception_of(check_points(rack, further(range.at, bits_per_word * offset),
                                                        bits_per_word * points));
                     const std::uint32_t word = offset / bits_per_word;
                     const std::uint32_t words = (offset + points - 1) / bits_per_word - word + 1;
                     return exception_of(check_points(rack, further(range.at, word), words));
                   });
}

Exception Map::check_read(const Rack& rack, Table table, std::uint16_t first, std::size_t count) const {
  return check(rack, table, first, count, false);
}

Exception Map::check_write(const Rack& rack, Table table, std::uint16_t first, std::size_t count) const {
  return check(rack, table, first, count, true);
}

Exception Map::read_bits(Rack& rack, Table table, std::uint16_t first, std::span<std::uint8_t> bits,
                         can::Time now) const {
  if (const Exception refused = check(rack, table, first, bits.size(), false); refused != Exception::none)
    return refused;
  return each_part(table, first, bits.size(),
                   [&](const Range& range, std::uint32_t offset, std::size_t done, std::size_t part) {
                     if (is_bit(range.at))
                       return exception_of(rack.read_bits(range.at.device, range.at.number + offset,
                                                          bits.subspan(done, part), now));
                     for (std::size_t i = 0; i < part;) {
                       const BitsOfWord piece =
                           bits_of_word(range, static_cast<std::uint32_t>(offset + i), part - i);
                       std::uint16_t word = 0;
                       if (const auto access = read(rack, piece.at, {&word, 1}, now); !access)
                         return exception_of(access);
                       for (std::size_t bit = 0; bit < piece.count; ++bit)
                         bits[done + i + bit] = static_cast<std::uint8_t>(word >> (piece.first + bit) & 1U);
                       i += piece.count;
                     }
                     return Exception::none;
                   });
}

Exception Map::write_bits(Rack& rack, std::uint16_t first, std::span<const std::uint8_t> bits,
                          can::Time now) const {
  constexpr Table table = Table::coils;
  if (const Exception refused = check(rack, table, first, bits.size(), true); refused != Exception::none)
    return refused;
  return each_part(
      table, first, bits.size(),
      [&](const Range& range, std::uint32_t offset, std::size_t done, std::size_t part) {
        if (is_bit(range.at))
          return exception_of(
              rack.write_bits(range.at.device, range.at.number + offset, bits.subspan(done, part), now));
        for (std::size_t i = 0; i < part;) {
          const BitsOfWord piece = bits_of_word(range, static_cast<std::uint32_t>(offset + i), part - i);
          std::uint16_t word = 0;
          if (const auto access = read(rack, piece.at, {&word, 1}, now); !access) return exception_of(access);
          for (std::size_t bit = 0; bit < piece.count; ++bit) {
            const auto mask = static_cast<std::uint16_t>(1U << (piece.first + bit));
            word = static_cast<std::uint16_t>(bits[done + i + bit] != 0 ? word | mask : word & ~mask);
          }
          if (const auto access = write(rack, piece.at, {&word, 1}, now); !access)
            return exception_of(access);
          i += piece.count;
        }
        return Exception::none;
      });
}

Exception Map::read_words(Rack& rack, Table table, std::uint16_t first, std::span<std::uint16_t> words,
                          can::Time now) const {
  if (const Exception refused = check(rack, table, first, words.size(), false); refused != Exception::none)
    return refused;
  if (const DoubleWords found = double_words(table, first, words.size()); found.range != nullptr)
    return exception_of(read(rack, found.at, words, now));
  return each_part(
      table, first, words.size(),
      [&](const Range& range, std::uint32_t offset, std::size_t done, std::size_t part) {
        const std::uint32_t points = is_bit(range.at) ? bits_per_word * offset : offset;
        return exception_of(read(rack, further(range.at, points), words.subspan(done, part), now));
      });
}

Exception Map::write_words(Rack& rack, std::uint16_t first, std::span<const std::uint16_t> words,
                           can::Time now) const {
  constexpr Table table = Table::holding_registers;
  if (const Exception refused = check(rack, table, first, words.size(), true); refused != Exception::none)
    return refused;
  if (const DoubleWords found = double_words(table, first, words.size()); found.range != nullptr)
    return exception_of(write(rack, found.at, words, now));
  return each_part(
      table, first, words.size(),
      [&](const Range& range, std::uint32_t offset, std::size_t done, std::size_t part) {
        const std::uint32_t points = is_bit(range.at) ? bits_per_word * offset : offset;
        return exception_of(write(rack, further(range.at, points), words.subspan(done, part), now));
      });
}

Map default_map(const CpuModel& model) {
  Map map;
  const auto all = [&](Table table, Device device) {
    const std::uint32_t count = std::min(model.points_of(device), address_count);
    if (count != 0) (void)map.add(table, {0, count, {false, device, 0, 0}, false});
  };
  all(Table::coils, Device::y);
  all(Table::discrete_inputs, Device::x);
  all(Table::holding_registers, Device::d);
  all(Table::input_registers, Device::sd);
  return map;
}

}  // namespace canopus::plc::modbus
