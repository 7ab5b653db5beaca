#include "canopus/instruction_list/device_functions.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "canopus/instruction_list/device_blocks.hpp"

namespace canopus::instruction_list::device_functions {

namespace {

using program::DeviceAccess;
using program::DeviceError;
using program::DevicePoint;
using program::FaultCode;

constexpr std::size_t most_words = 32'768;  // of a block
using Words = std::array<std::uint16_t, most_words>;

constexpr std::int64_t as_int(Slot slot) { return static_cast<std::int64_t>(slot); }

/// The number of words of a block, or a fault.
bool count_of(NativeCall& call, Slot slot, std::size_t words_of_one, std::size_t& count) {
  const auto most = static_cast<std::int64_t>(most_words / words_of_one) - 1;
  if (out_of_range(call, as_int(slot), 0, most)) return false;
  count = static_cast<std::size_t>(slot) * words_of_one;
  call.cost = 10 + static_cast<std::int64_t>(count);
  return true;
}

/// Where the device is in memory; the members are nullptr, where only the image reaches it.
program::DeviceMemory memory_of(const NativeCall& call, Slot device) {
  return call.device_memory == nullptr ? program::DeviceMemory{} : call.device_memory[device];
}

bool bit_at(NativeCall& call, Slot device, bool& on) {
  if (const std::uint8_t* const bit = memory_of(call, device).bit; bit != nullptr) {
    on = *bit != 0;
    return true;
  }
  const DeviceAccess& access = call.program->devices[device];
  DevicePoint point;
  std::uint32_t bits = 0;
  if (!point_of(call, access, 0, point) || refused(call, call.devices->read_bits(point, 1, bits), access))
    return false;
  on = bits != 0;
  return true;
}

bool set_bit(NativeCall& call, Slot device, bool on) {
  if (std::uint8_t* const bit = memory_of(call, device).bit; bit != nullptr) {
    *bit = on ? 1 : 0;
    return true;
  }
  const DeviceAccess& access = call.program->devices[device];
  DevicePoint point;
  return point_of(call, access, 0, point) &&
         !refused(call, call.devices->write_bits(point, 1, on ? 1 : 0), access);
}

bool word_at(NativeCall& call, Slot device, std::uint16_t& word) {
  if (const std::uint16_t* const words = memory_of(call, device).words; words != nullptr) {
    word = *words;
    return true;
  }
  return read(call, {call.program->devices[device], 0}, {&word, 1});
}

bool set_word(NativeCall& call, Slot device, std::uint16_t word) {
  if (std::uint16_t* const words = memory_of(call, device).words; words != nullptr) {
    *words = word;
    return true;
  }
  return write(call, {call.program->devices[device], 0}, {&word, 1});
}

/// The bytes of a text: a constant, or a device's up to 00H. Slots: device (or `none`), offset, place of the constant, its length.
bool text_of(NativeCall& call, std::size_t slot, std::string_view& text, std::array<char, 1024>& memory) {
  if (call.slots[slot] == none) {
    text = {reinterpret_cast<const char*>(call.memory + call.slots[slot + 2]), call.slots[slot + 3]};
    return true;
  }
  std::size_t length = 0;
  while (length < memory.size()) {
    DevicePlace from = place(call, slot);
    from.offset += static_cast<std::int64_t>(length / 2);
    std::uint16_t word = 0;
    if (!read(call, from, {&word, 1})) return false;
    if ((word & 0xFFU) == 0) break;
    memory[length++] = static_cast<char>(word & 0xFFU);
    if (word >> 8U == 0) break;
    memory[length++] = static_cast<char>(word >> 8U);
  }
  if (length == memory.size()) {
    call.fault.code = FaultCode::no_value;
    return false;
  }
  text = {memory.data(), length};
  return true;
}

}  // namespace

bool read_indexed(NativeCall& call) {
  const DevicePlace from = place(call, 1);
  DevicePoint point;
  if (!point_of(call, from.access, from.offset, point)) return false;
  Slot value = 0;
  if (has_points(from.access)) {
    std::uint32_t bits = 0;
    if (refused(call, call.devices->read_bits(point, from.access.count, bits), from.access)) return false;
    value = bits;
  } else {
    std::array<std::uint16_t, 4> words{};
    const bool is_bit = from.access.form == DeviceAccess::Form::bit_of_word;
    const auto some = std::span(words).first(is_bit ? 1 : from.access.count);
    if (refused(call, call.devices->read_words(point, some), from.access)) return false;
    for (std::size_t i = 0; i < some.size(); ++i) value |= Slot{words[i]} << (16 * i);
    if (is_bit) value = value >> from.access.count & 1U;
  }
  const program::ElementaryInfo& kind = program::info(from.access.type);
  if (kind.family == program::Family::signed_integer && kind.bits < 64) {
    const unsigned shift = 64U - kind.bits;
    value = static_cast<Slot>(as_int(value << shift) >> shift);
  }
  call.slots[0] = value;
  return true;
}

bool write_indexed(NativeCall& call) {
  const DevicePlace to = place(call, 1);
  const Slot value = call.slots[3];
  DevicePoint point;
  if (!point_of(call, to.access, to.offset, point)) return false;
  if (has_points(to.access))
    return !refused(call, call.devices->write_bits(point, to.access.count, static_cast<std::uint32_t>(value)),
                    to.access);
  std::array<std::uint16_t, 4> words{};
  if (to.access.form == DeviceAccess::Form::bit_of_word) {
    const std::span<std::uint16_t> word(words.data(), 1);
    if (refused(call, call.devices->read_words(point, word), to.access)) return false;
    const auto bit = static_cast<std::uint16_t>(1U << to.access.count);
    word[0] = static_cast<std::uint16_t>(value != 0 ? word[0] | bit : word[0] & ~bit);
    return !refused(call, call.devices->write_words(point, word), to.access);
  }
  for (std::size_t i = 0; i < to.access.count; ++i) words[i] = static_cast<std::uint16_t>(value >> (16 * i));
  return !refused(
      call, call.devices->write_words(point, std::span<const std::uint16_t>(words).first(to.access.count)),
      to.access);
}

bool block_move(NativeCall& call) {
  std::size_t count = 0;
  if (!count_of(call, call.slots[5], 1, count)) return false;
  if (count == 0) return true;
  Words words;
  const auto some = std::span(words).first(count);
  return read(call, place(call, 1), some) && write(call, place(call, 3), some);
}

bool fill(NativeCall& call) {
  const auto words_of_one = static_cast<std::size_t>(call.slots[5]);
  std::size_t count = 0;
  if (!count_of(call, call.slots[4], words_of_one, count)) return false;
  if (count == 0) return true;
  Words words;
  for (std::size_t i = 0; i < count; ++i)
    words[i] = static_cast<std::uint16_t>(call.slots[1] >> (i % words_of_one * 16));
  return write(call, place(call, 2), std::span(words).first(count));
}

bool shift_in(NativeCall& call) {
  std::size_t count = 0;
  if (!count_of(call, call.slots[5], 1, count) || count == 0) return call.fault.code == FaultCode::none;
  if (out_of_range(call, as_int(call.slots[6]), 0, static_cast<std::int64_t>(count))) return false;
  const auto by = static_cast<std::size_t>(call.slots[6]);
  Words words;
  Words incoming;
  const auto row = std::span(words).first(count);
  const auto in = std::span(incoming).first(by);
  if (!read(call, place(call, 3), row)) return false;
  std::ranges::fill(in, std::uint16_t{0});
  if (call.slots[1] != none && by > 0 && !read(call, place(call, 1), in)) return false;
  if (call.slots[7] != 0) {
    std::ranges::copy_backward(row.first(count - by), row.end());
    std::ranges::copy(in, row.begin());
  } else {
    std::ranges::copy(row.subspan(by), row.begin());
    std::ranges::copy(in, row.end() - static_cast<std::ptrdiff_t>(by));
  }
  return write(call, place(call, 3), row);
}

namespace {

/// The word of buffer memory that slots 1 and 2 name.
bool buffer_word(NativeCall& call, DevicePoint& point) {
  if (out_of_range(call, as_int(call.slots[1]), 0, 0x1FF) ||
      out_of_range(call, as_int(call.slots[2]), 0, 0x7FFFFFFF))
    return false;
  point = {.unit = static_cast<std::uint16_t>(call.slots[1]),
           .number = static_cast<std::uint32_t>(call.slots[2]),
           .is_buffer = true};
  return true;
}

bool buffer_refused(NativeCall& call, DeviceError error) {
  if (error == DeviceError::none) return false;
  call.fault.code = error == DeviceError::no_module ? FaultCode::no_module : FaultCode::device_out_of_range;
  call.fault.device = "buffer memory";
  return true;
}

}  // namespace

bool from(NativeCall& call) {
  std::size_t count = 0;
  DevicePoint point;
  if (!count_of(call, call.slots[5], static_cast<std::size_t>(call.slots[6]), count) ||
      !buffer_word(call, point))
    return false;
  if (count == 0) return true;
  if (call.devices == nullptr) return !buffer_refused(call, DeviceError::no_module);
  Words words;
  const auto some = std::span(words).first(count);
  return !buffer_refused(call, call.devices->read_words(point, some)) && write(call, place(call, 3), some);
}

bool to(NativeCall& call) {
  const auto words_of_one = static_cast<std::size_t>(call.slots[6]);
  std::size_t count = 0;
  DevicePoint point;
  if (!count_of(call, call.slots[5], words_of_one, count) || !buffer_word(call, point)) return false;
  if (count == 0) return true;
  if (call.devices == nullptr) return !buffer_refused(call, DeviceError::no_module);
  Words words;
  const auto some = std::span(words).first(count);
  if (call.slots[3] == none) {
    for (std::size_t i = 0; i < count; ++i)
      some[i] = static_cast<std::uint16_t>(call.slots[7] >> (i % words_of_one * 16));
  } else if (!read(call, place(call, 3), some)) {
    return false;
  }
  return !buffer_refused(call, call.devices->write_words(point, some));
}

// The carry bit is one more bit in the circle of RCR and RCL; of the others it takes the last bit that has moved.
bool rotate(NativeCall& call) {
  const auto bits = static_cast<unsigned>(call.slots[3]);
  const auto rotation = static_cast<Rotation>(call.slots[4]);
  if (out_of_range(call, as_int(call.slots[2]), 0, 32'767)) return false;
  const Slot mask = (Slot{1} << bits) - 1;
  Slot value = call.slots[1] & mask;
  Slot carry = call.slots[5] & 1U;
  const bool is_shift = rotation == Rotation::shift_right || rotation == Rotation::shift_left;
  const bool is_through_carry =
      rotation == Rotation::right_with_carry || rotation == Rotation::left_with_carry;
  const bool is_left =
      rotation == Rotation::left || rotation == Rotation::left_with_carry || rotation == Rotation::shift_left;
  const unsigned circle = is_through_carry ? bits + 1 : bits;
  for (Slot n = call.slots[2] % circle; n > 0; --n) {
    const Slot out = is_left ? value >> (bits - 1) & 1U : value & 1U;
    const Slot in = is_shift ? 0 : is_through_carry ? carry : out;
    value = is_left ? (value << 1U | in) & mask : value >> 1U | in << (bits - 1);
    carry = out;
  }
  const unsigned extend = 64U - bits;
  call.slots[0] = static_cast<Slot>(as_int(value << extend) >> extend);
  call.slots[5] = carry;
  return true;
}

bool to_bcd(NativeCall& call) {
  const auto digits = static_cast<unsigned>(call.slots[2]);
  if (out_of_range(call, as_int(call.slots[1]), 0, digits == 4 ? 9'999 : 99'999'999)) return false;
  Slot value = call.slots[1];
  Slot bcd = 0;
  for (unsigned i = 0; i < digits; ++i, value /= 10) bcd |= value % 10 << (4 * i);
  call.slots[0] = bcd;
  return true;
}

bool from_bcd(NativeCall& call) {
  const auto digits = static_cast<unsigned>(call.slots[2]);
  Slot value = 0;
  for (unsigned i = digits; i-- > 0;) {
    const Slot digit = call.slots[1] >> (4 * i) & 0xFU;
    if (out_of_range(call, as_int(digit), 0, 9)) return false;
    value = 10 * value + digit;
  }
  call.slots[0] = value;
  return true;
}

bool move_text(NativeCall& call) {
  std::array<char, 1024> memory;
  std::string_view text;
  if (!text_of(call, 1, text, memory)) return false;
  std::array<std::uint16_t, 513> words{};
  for (std::size_t i = 0; i < text.size(); ++i)
    words[i / 2] =
        static_cast<std::uint16_t>(words[i / 2] | static_cast<unsigned char>(text[i]) << (i % 2 * 8));
  call.cost = 10 + static_cast<std::int64_t>(text.size());
  return write(call, place(call, 5), std::span<const std::uint16_t>(words).first(text.size() / 2 + 1));
}

bool compare_text(NativeCall& call) {
  std::array<std::array<char, 1024>, 2> memory;
  std::string_view a;
  std::string_view b;
  if (!text_of(call, 1, a, memory[0]) || !text_of(call, 5, b, memory[1])) return false;
  const int order = a.compare(b);
  call.slots[0] = static_cast<Slot>(static_cast<std::int64_t>(order < 0 ? -1 : order > 0 ? 1 : 0));
  return true;
}

// The time counts in units of a clock that runs freely, so a timer is up to one unit short. The value changes here and nowhere else, and a
// timer that has timed out stays so, whatever the setting becomes [SH-080483 9.2.8].
bool timer(NativeCall& call) {
  Slot* const slots = call.slots;
  const bool is_on = slots[1] != 0;
  const bool is_retentive = slots[7] != 0;
  const std::int64_t ticks = call.now / as_int(slots[6]);
  bool was_on = false;
  bool has_timed_out = false;
  std::uint16_t value = 0;
  if (!bit_at(call, slots[4], was_on) || !bit_at(call, slots[3], has_timed_out) ||
      !word_at(call, slots[5], value))
    return false;
  const std::int64_t setting = std::max<std::int64_t>(as_int(slots[2]), 0);
  // One more than the time of the last execution; 0: none since RUN.
  const std::int64_t elapsed = slots[8] == 0 ? 0 : std::max<std::int64_t>(ticks + 1 - as_int(slots[8]), 0);
  if (is_on) {
    if (was_on && !has_timed_out)
      value = static_cast<std::uint16_t>(std::min<std::int64_t>(value + elapsed, setting));
    has_timed_out = has_timed_out || value >= setting;
  } else if (!is_retentive) {
    value = 0;
    has_timed_out = false;
  }
  slots[8] = static_cast<Slot>(ticks + 1);
  slots[0] = has_timed_out ? 1 : 0;
  return set_bit(call, slots[4], is_on) && set_bit(call, slots[3], has_timed_out) &&
         set_word(call, slots[5], value);
}

bool counter(NativeCall& call) {
  Slot* const slots = call.slots;
  const bool is_on = slots[1] != 0;
  bool was_on = false;
  bool is_done = false;
  std::uint16_t value = 0;
  if (!bit_at(call, slots[4], was_on) || !bit_at(call, slots[3], is_done) || !word_at(call, slots[5], value))
    return false;
  if (is_on && !was_on && !is_done) {
    if (value < 0x7FFF) ++value;
    is_done = value >= std::max<std::int64_t>(as_int(slots[2]), 0);
  }
  return set_bit(call, slots[4], is_on) && set_bit(call, slots[3], is_done) &&
         set_word(call, slots[5], value);
}

bool counter_32(NativeCall& call) {
  Slot* const slots = call.slots;
  const bool is_on = slots[1] != 0;
  bool was_on = false;
  bool is_done = false;
  bool is_down = false;
  std::uint16_t low = 0;
  std::uint16_t high = 0;
  if (!bit_at(call, slots[4], was_on) || !bit_at(call, slots[3], is_done) ||
      !bit_at(call, slots[7], is_down) || !word_at(call, slots[5], low) || !word_at(call, slots[6], high))
    return false;
  std::uint32_t value = std::uint32_t{high} << 16U | low;
  if (is_on && !was_on) {
    value += is_down ? ~std::uint32_t{0} : 1U;
    const auto setting = static_cast<std::uint32_t>(slots[2]);
    if (!is_down && value == setting) is_done = true;
    if (is_down && value == setting - 1) is_done = false;
  }
  return set_bit(call, slots[4], is_on) && set_bit(call, slots[3], is_done) &&
         set_word(call, slots[5], static_cast<std::uint16_t>(value)) &&
         set_word(call, slots[6], static_cast<std::uint16_t>(value >> 16U));
}

bool count_bits(NativeCall& call) {
  call.slots[0] = static_cast<Slot>(std::popcount(call.slots[1]));
  return true;
}

bool mean(NativeCall& call) {
  const auto words_of_one = static_cast<std::size_t>(call.slots[4]);
  std::size_t count = 0;
  if (out_of_range(call, as_int(call.slots[3]), 1, as_int(call.slots[5])) ||
      !count_of(call, call.slots[3], words_of_one, count))
    return false;
  Words words;
  if (!read(call, place(call, 1), std::span(words).first(count))) return false;
  const bool has_no_sign = call.slots[6] != 0;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < count; i += words_of_one) {
    const std::uint32_t bits = words_of_one == 1 ? words[i] : std::uint32_t{words[i + 1]} << 16U | words[i];
    sum += has_no_sign         ? std::int64_t{bits}
           : words_of_one == 1 ? std::int64_t{static_cast<std::int16_t>(bits)}
                               : std::int64_t{static_cast<std::int32_t>(bits)};
  }
  call.slots[0] = static_cast<Slot>(sum / as_int(call.slots[3]));
  return true;
}

bool limit(NativeCall& call) {
  const std::int64_t low = as_int(call.slots[1]);
  const std::int64_t high = as_int(call.slots[2]);
  if (out_of_range(call, low, std::numeric_limits<std::int32_t>::min(), high)) return false;
  call.slots[0] = static_cast<Slot>(std::clamp(as_int(call.slots[3]), low, high));
  return true;
}

bool square_root(NativeCall& call) {
  if (out_of_range(call, as_int(call.slots[1]), 0, std::numeric_limits<std::int32_t>::max())) return false;
  call.slots[0] = static_cast<Slot>(std::sqrt(static_cast<double>(call.slots[1])));  // exact below 2^53
  return true;
}

}  // namespace canopus::instruction_list::device_functions
