#pragma once
// Which addresses of the Modbus data model are which devices or buffer memory of a rack.
//
// Each of the four tables has addresses 0 to FFFFH of its own. A range of them maps to consecutive points:
//
//   table              on a bit device                on a word device or buffer memory
//   coils, inputs      one point each                 16 for each word, bit 0 first
//   registers          16 points each, first in bit 0 one word each
//
// An address that no range has is not there: exception 02. [Modbus Application Protocol V1.1b3 4.3]

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/plc/rack/rack_address.hpp"

namespace canopus::plc {
class Rack;
}

namespace canopus::plc::modbus {

enum class Table : std::uint8_t { coils, discrete_inputs, holding_registers, input_registers };
inline constexpr std::size_t table_count = 4;

/// "coils", "holding registers".
[[nodiscard]] std::string_view table_name(Table table) noexcept;
/// Coils and discrete inputs.
[[nodiscard]] constexpr bool is_bit_table(Table table) noexcept {
  return table == Table::coils || table == Table::discrete_inputs;
}

/// Why a request is refused; the numbers are the protocol's exception codes.
enum class Exception : std::uint8_t {
  none = 0,
  illegal_function = 1,
  illegal_data_address = 2,
  illegal_data_value = 3,
  server_device_failure = 4,
  target_failed_to_respond = 0x0B,  ///< a unit identifier without a device
};

struct Range {
  std::uint16_t first = 0;  ///< address in its table, from 0
  std::uint32_t count = 0;  ///< 1 to 65536
  RackAddress at{};         ///< what the first address is
  bool read_only = false;   ///< for coils and holding registers; the other tables are
  /// Registers: each address is a 32-bit value, two registers of a request, the low word first.
  bool double_words = false;
};

class Map {
 public:
  /// Ranges of one table must not overlap, and must end at FFFFH; the error names the range in conflict.
  std::expected<void, std::string> add(Table table, const Range& range);
  [[nodiscard]] const std::vector<Range>& ranges(Table table) const noexcept {
    return ranges_[static_cast<std::size_t>(table)];
  }

  /// Bits of coils or discrete inputs, 0 or 1 each.
  Exception read_bits(Rack& rack, Table table, std::uint16_t first, std::span<std::uint8_t> bits,
                      can::Time now) const;
  Exception write_bits(Rack& rack, std::uint16_t first, std::span<const std::uint8_t> bits,
                       can::Time now) const;
  /// Registers. A write that is refused has changed nothing.
  Exception read_words(Rack& rack, Table table, std::uint16_t first, std::span<std::uint16_t> words,
                       can::Time now) const;
  Exception write_words(Rack& rack, std::uint16_t first, std::span<const std::uint16_t> words,
                        can::Time now) const;
  /// Whether a read or write of these addresses would be refused, without doing it.
  [[nodiscard]] Exception check_read(const Rack& rack, Table table, std::uint16_t first,
                                     std::size_t count) const;
  [[nodiscard]] Exception check_write(const Rack& rack, Table table, std::uint16_t first,
                                      std::size_t count) const;

 private:
  /// The range that has this address, or nullptr.
  [[nodiscard]] const Range* find(Table table, std::uint32_t address) const noexcept;
  /// The range and first word of a request that begins in a range of 32-bit values, which it must not leave.
  struct DoubleWords {
    const Range* range = nullptr;  // nullptr: it does not begin in one
    RackAddress at{};
    bool fits = false;
  };
  [[nodiscard]] DoubleWords double_words(Table table, std::uint32_t first, std::size_t words) const noexcept;
  /// Calls use(range, offset in it, done so far, count) for each part of the addresses until one refuses.
  template <typename Use>
  Exception each_part(Table table, std::uint32_t first, std::size_t count, Use use) const;
  [[nodiscard]] Exception check(const Rack& rack, Table table, std::uint32_t first, std::size_t count,
                                bool writes) const;

  std::array<std::vector<Range>, table_count> ranges_;  // in the order of their addresses
};

/// The map of a rack whose plant file has none: coils are Y0, discrete inputs X0, holding registers D0 and input
/// registers SD0 onwards, as far as the CPU has them.
[[nodiscard]] Map default_map(const CpuModel& model);

}  // namespace canopus::plc::modbus
