#include "canopus/program/standard_functions.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

#include "canopus/ascii/words.hpp"
#include "canopus/program/time_text.hpp"

namespace canopus::program {

namespace {

bool out_of_range(NativeCall& call, double value, std::int64_t low, std::int64_t high) {
  constexpr double most = 9e18;
  call.fault.code = FaultCode::value_out_of_range;
  call.fault.value = std::isnan(value) ? 0 : static_cast<std::int64_t>(std::clamp(value, -most, most));
  call.fault.low = low;
  call.fault.high = high;
  return false;
}

constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();

template <typename Number>
Number number_of(Slot slot) {
  if constexpr (sizeof(Number) == 4)
    return std::bit_cast<float>(static_cast<std::uint32_t>(slot));
  else
    return std::bit_cast<double>(slot);
}
template <typename Number>
Slot slot_of(Number number) {
  if constexpr (sizeof(Number) == 4)
    return std::bit_cast<std::uint32_t>(number);
  else
    return std::bit_cast<Slot>(number);
}

// Functions of one number [IEC 61131-3 6.6.2.5.3]. Where there is no result, the CPU's error is "out of range".
template <typename Number, Number (*function)(Number)>
bool numeric(NativeCall& call) {
  call.slots[0] = slot_of(function(number_of<Number>(call.slots[1])));
  return true;
}
template <typename Number, Number (*function)(Number)>
bool numeric_from_0(NativeCall& call) {
  const auto value = number_of<Number>(call.slots[1]);
  if (!(value >= 0)) return out_of_range(call, double{value}, 0, no_limit);
  return numeric<Number, function>(call);
}
template <typename Number, Number (*function)(Number)>
bool numeric_above_0(NativeCall& call) {
  const auto value = number_of<Number>(call.slots[1]);
  if (!(value > 0)) return out_of_range(call, double{value}, 0, no_limit);
  return numeric<Number, function>(call);
}
template <typename Number, Number (*function)(Number)>
bool numeric_to_1(NativeCall& call) {
  const auto value = number_of<Number>(call.slots[1]);
  if (!(value >= -1 && value <= 1)) return out_of_range(call, double{value}, -1, 1);
  return numeric<Number, function>(call);
}
template <typename Number>
bool atan2_of(NativeCall& call) {
  call.slots[0] = slot_of(std::atan2(number_of<Number>(call.slots[1]), number_of<Number>(call.slots[2])));
  return true;
}
template <typename Number>
bool power(NativeCall& call) {
  const auto base = number_of<Number>(call.slots[1]);
  const Number result = std::pow(base, number_of<Number>(call.slots[2]));
  if (std::isnan(result) || (base == 0 && std::isinf(result)))
    return out_of_range(call, double{base}, 0, no_limit);
  call.slots[0] = slot_of(result);
  return true;
}
template <typename Number>
bool absolute(NativeCall& call) {
  call.slots[0] = slot_of(std::abs(number_of<Number>(call.slots[1])));
  return true;
}
template <typename Number>
bool is_valid(NativeCall& call) {
  call.slots[0] = std::isfinite(number_of<Number>(call.slots[1])) ? 1 : 0;
  return true;
}

/// value, places, bits of the type
template <bool is_left>
bool rotate(NativeCall& call) {
  const Slot bits = call.slots[3];
  const Slot value = call.slots[1];
  Slot places = call.slots[2] % bits;
  if (!is_left) places = (bits - places) % bits;
  const Slot mask = bits == 64 ? ~Slot{0} : (Slot{1} << bits) - 1;
  call.slots[0] = places == 0 ? value : (value << places | value >> (bits - places)) & mask;
  return true;
}

bool bcd_is_valid(NativeCall& call) {
  call.slots[0] = 1;
  for (Slot rest = call.slots[1]; rest != 0; rest >>= 4U)
    if ((rest & 0xFU) > 9) call.slots[0] = 0;
  return true;
}
bool from_bcd(NativeCall& call) {
  Slot result = 0;
  Slot factor = 1;
  for (Slot rest = call.slots[1]; rest != 0; rest >>= 4U, factor *= 10) {
    if ((rest & 0xFU) > 9) return out_of_range(call, static_cast<double>(rest & 0xFU), 0, 9);
    result += (rest & 0xFU) * factor;
  }
  call.slots[0] = result;
  return true;
}
/// value, bits of the result
bool to_bcd(NativeCall& call) {
  Slot result = 0;
  unsigned place = 0;
  for (Slot rest = call.slots[1]; rest != 0; rest /= 10, place += 4) {
    if (place >= call.slots[2]) {
      Slot end = 1;
      for (Slot digit = 0; digit < call.slots[2]; digit += 4) end *= 10;
      return out_of_range(call, static_cast<double>(call.slots[1]), 0, static_cast<std::int64_t>(end - 1));
    }
    result |= rest % 10 << place;
  }
  call.slots[0] = result;
  return true;
}

/// The characters of a string in the memory. The machine's bytes have the order of the slots' bits: the lowest first.
template <typename Character>
struct Text {
  static_assert(std::endian::native == std::endian::little);
  Slot* header;

  Text(const NativeCall& call, std::size_t argument) : header(call.memory + call.slots[argument]) {}
  [[nodiscard]] std::uint32_t length() const { return string_header(*header).length; }
  [[nodiscard]] std::uint32_t capacity() const { return string_header(*header).capacity; }
  void set_length(std::uint32_t length) const { *header = string_header(length, capacity()); }
  [[nodiscard]] Character at(std::uint32_t number) const {
    Character c;
    std::memcpy(&c, bytes() + number * sizeof(Character), sizeof c);
    return c;
  }
  [[nodiscard]] unsigned char* bytes() const { return reinterpret_cast<unsigned char*>(header + 1); }
  /// Appends characters of another string, as many as there is room for.
  void append(const Text& from, std::uint32_t first, std::uint32_t count) const {
    const std::uint32_t begin = length();
    count = std::min(count, capacity() - begin);
    std::memmove(bytes() + begin * sizeof(Character), from.bytes() + first * sizeof(Character),
                 count * sizeof(Character));
    set_length(begin + count);
  }
  void append(Character c) const {
    const std::uint32_t begin = length();
    if (begin == capacity()) return;
    std::memcpy(bytes() + begin * sizeof(Character), &c, sizeof c);
    set_length(begin + 1);
  }
};

/// A number of characters, or a place: negative ones are refused [IEC 61131-3 6.6.2.5.12].
bool characters(NativeCall& call, std::size_t argument, std::uint32_t least, std::uint32_t& to) {
  const auto value = static_cast<std::int64_t>(call.slots[argument]);
  if (value < static_cast<std::int64_t>(least))
    return out_of_range(call, static_cast<double>(value), least, no_limit);
  to = static_cast<std::uint32_t>(std::min<std::int64_t>(value, 0x7FFFFFFF));
  return true;
}

template <typename Character>
bool assign(NativeCall& call) {
  const Text<Character> to(call, 0);
  const Text<Character> from(call, 1);
  if (to.header == from.header) return true;
  to.set_length(0);
  to.append(from, 0, from.length());
  return true;
}
template <typename Character>
bool length(NativeCall& call) {
  call.slots[0] = Text<Character>(call, 1).length();
  return true;
}
/// -1, 0 or 1, by the codes of the characters from the left.
template <typename Character>
bool compare(NativeCall& call) {
  const Text<Character> a(call, 1);
  const Text<Character> b(call, 2);
  const std::uint32_t both = std::min(a.length(), b.length());
  for (std::uint32_t i = 0; i < both; ++i) {
    if (a.at(i) == b.at(i)) continue;
    call.slots[0] = a.at(i) < b.at(i) ? ~Slot{0} : 1;
    return true;
  }
  call.slots[0] = a.length() == b.length() ? 0 : a.length() < b.length() ? ~Slot{0} : 1;
  return true;
}
template <typename Character>
bool left(NativeCall& call) {
  const Text<Character> to(call, 0);
  const Text<Character> from(call, 1);
  std::uint32_t count = 0;
  if (!characters(call, 2, 0, count)) return false;
  to.set_length(0);
  to.append(from, 0, std::min(count, from.length()));
  return true;
}
template <typename Character>
bool right(NativeCall& call) {
  const Text<Character> to(call, 0);
  const Text<Character> from(call, 1);
  std::uint32_t count = 0;
  if (!characters(call, 2, 0, count)) return false;
  count = std::min(count, from.length());
  to.set_length(0);
  to.append(from, from.length() - count, count);
  return true;
}
template <typename Character>
bool mid(NativeCall& call) {  // IN L P
  const Text<Character> to(call, 0);
  const Text<Character> from(call, 1);
  std::uint32_t count = 0;
  std::uint32_t place = 0;
  if (!characters(call, 2, 0, count) || !characters(call, 3, 1, place)) return false;
  to.set_length(0);
  if (place <= from.length()) to.append(from, place - 1, std::min(count, from.length() - place + 1));
  return true;
}
template <typename Character>
bool concat(NativeCall& call) {
  const Text<Character> to(call, 0);
  to.set_length(0);
  for (std::size_t i = 1; i <= 2; ++i) {
    const Text<Character> from(call, i);
    to.append(from, 0, from.length());
  }
  return true;
}
/// Of IN1 `kept` characters, IN2, and IN1 from `rest` on.
template <typename Character>
void compose(NativeCall& call, std::uint32_t kept, std::size_t inserted, std::uint32_t rest) {
  const Text<Character> to(call, 0);
  const Text<Character> from(call, 1);
  kept = std::min(kept, from.length());
  to.set_length(0);
  to.append(from, 0, kept);
  if (inserted != 0) {
    const Text<Character> middle(call, inserted);
    to.append(middle, 0, middle.length());
  }
  if (rest < from.length()) to.append(from, rest, from.length() - rest);
}
template <typename Character>
bool insert(NativeCall& call) {  // IN1 IN2 P
  std::uint32_t place = 0;
  if (!characters(call, 3, 0, place)) return false;
  compose<Character>(call, place, 2, place);
  return true;
}
template <typename Character>
bool delete_(NativeCall& call) {  // IN L P
  std::uint32_t count = 0;
  std::uint32_t place = 0;
  if (!characters(call, 2, 0, count) || !characters(call, 3, 1, place)) return false;
  compose<Character>(call, place - 1, 0, place - 1 + std::min(count, 0x7FFFFFFFU));
  return true;
}
template <typename Character>
bool replace(NativeCall& call) {  // IN1 IN2 L P
  std::uint32_t count = 0;
  std::uint32_t place = 0;
  if (!characters(call, 3, 0, count) || !characters(call, 4, 1, place)) return false;
  compose<Character>(call, place - 1, 2, place - 1 + count);
  return true;
}
template <typename Character>
bool find(NativeCall& call) {
  const Text<Character> in(call, 1);
  const Text<Character> wanted(call, 2);
  call.slots[0] = 0;
  if (wanted.length() == 0) return true;
  for (std::uint32_t i = 0; i + wanted.length() <= in.length(); ++i) {
    std::uint32_t same = 0;
    while (same < wanted.length() && in.at(i + same) == wanted.at(same)) ++same;
    call.cost += 1 + same;
    if (same < wanted.length()) continue;
    call.slots[0] = i + 1;
    return true;
  }
  return true;
}

/// value, its type
template <typename Character>
bool to_string(NativeCall& call) {
  const Text<Character> to(call, 0);
  const Slot value = call.slots[1];
  const auto type = static_cast<Elementary>(call.slots[2]);
  std::array<char, 40> digits{};
  char* const begin = digits.data();
  char* const last = begin + digits.size();
  std::to_chars_result end{begin, {}};
  to.set_length(0);
  switch (info(type).family) {
    case Family::boolean: {
      const std::string_view text = value != 0 ? "TRUE" : "FALSE";
      for (const char c : text) to.append(static_cast<Character>(c));
      return true;
    }
    case Family::signed_integer: end = std::to_chars(begin, last, static_cast<std::int64_t>(value)); break;
    case Family::unsigned_integer:
    case Family::bits: end = std::to_chars(begin, last, value); break;
    case Family::real:
      end = type == Elementary::real ? std::to_chars(begin, last, number_of<float>(value))
                                     : std::to_chars(begin, last, number_of<double>(value));
      break;
    case Family::character: to.append(static_cast<Character>(value)); return true;
    case Family::duration:
    case Family::date:
    case Family::string: {
      DataType shown{.base = type};
      for (const char c : value_text(shown, &value)) to.append(static_cast<Character>(c));
      return true;
    }
  }
  for (const char* c = begin; c != end.ptr; ++c) to.append(static_cast<Character>(*c));
  return true;
}

/// text, type of the result
template <typename Character>
bool from_string(NativeCall& call) {
  const Text<Character> from(call, 1);
  DataType type{.base = static_cast<Elementary>(call.slots[2])};
  if (info(type.base).family == Family::character) {  // of an empty string: not defined by the standard
    call.slots[0] = from.length() == 0 ? 0 : from.at(0);
    return true;
  }
  std::array<char, 64> memory{};
  if (from.length() <= memory.size()) {
    for (std::uint32_t i = 0; i < from.length(); ++i) {
      const auto c = from.at(i);
      memory[i] = c < 0x80 ? static_cast<char>(c) : '?';
    }
    const std::string_view text = ascii::trim(std::string_view(memory.data(), from.length()));
    if (!parse_value(type, text, call.slots)) return true;
  }
  call.fault.code = FaultCode::no_value;
  return false;
}

/// Characters of another width; those that a STRING cannot hold are an error.
template <typename From, typename To>
bool change_width(NativeCall& call) {
  const Text<To> to(call, 0);
  const Text<From> from(call, 1);
  to.set_length(0);
  for (std::uint32_t i = 0; i < from.length(); ++i) {
    if (from.at(i) > std::numeric_limits<To>::max())
      return out_of_range(call, from.at(i), 0, std::numeric_limits<To>::max());
    to.append(static_cast<To>(from.at(i)));
  }
  return true;
}

constexpr std::int64_t second = 1'000'000'000;

bool date_of(NativeCall& call, std::size_t first, std::int64_t& ns) {
  const auto part = [&](std::size_t i) { return static_cast<std::int64_t>(call.slots[first + i]); };
  if (part(0) < 1700 || part(0) > 2261) return out_of_range(call, static_cast<double>(part(0)), 1700, 2261);
  if (part(1) < 1 || part(1) > 12) return out_of_range(call, static_cast<double>(part(1)), 1, 12);
  const auto month =
      std::chrono::year(static_cast<int>(part(0))) / std::chrono::month(static_cast<unsigned>(part(1)));
  const auto last = static_cast<unsigned>((month / std::chrono::last).day());
  if (part(2) < 1 || part(2) > last) return out_of_range(call, static_cast<double>(part(2)), 1, last);
  const std::chrono::sys_days days = month / std::chrono::day(static_cast<unsigned>(part(2)));
  ns = days.time_since_epoch().count() * 86'400 * second;
  return true;
}
bool time_of(NativeCall& call, std::size_t first, std::int64_t& ns) {
  constexpr std::array<std::int64_t, 4> ends = {24, 60, 60, 1000};
  ns = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto part = static_cast<std::int64_t>(call.slots[first + i]);
    if (part < 0 || part >= ends[i]) return out_of_range(call, static_cast<double>(part), 0, ends[i] - 1);
    ns = ns * ends[i] + part;
  }
  ns *= 1'000'000;
  return true;
}
bool concat_date(NativeCall& call) {
  std::int64_t ns = 0;
  if (!date_of(call, 1, ns)) return false;
  call.slots[0] = static_cast<Slot>(ns);
  return true;
}
bool concat_tod(NativeCall& call) {
  std::int64_t ns = 0;
  if (!time_of(call, 1, ns)) return false;
  call.slots[0] = static_cast<Slot>(ns);
  return true;
}
bool concat_dt(NativeCall& call) {
  std::int64_t date = 0;
  std::int64_t time = 0;
  if (!date_of(call, 1, date) || !time_of(call, 4, time)) return false;
  call.slots[0] = static_cast<Slot>(date + time);
  return true;
}
/// 0 is Sunday [IEC 61131-3 6.6.2.5.13].
bool day_of_week(NativeCall& call) {
  const auto days = std::chrono::floor<std::chrono::days>(
      std::chrono::nanoseconds(static_cast<std::int64_t>(call.slots[1])));
  call.slots[0] = std::chrono::weekday(std::chrono::sys_days{days}).c_encoding();
  return true;
}
/// Of a date and time: midnight before it.
bool date_part(NativeCall& call) {
  constexpr std::int64_t day = 86'400 * second;
  const auto ns = static_cast<std::int64_t>(call.slots[1]);
  call.slots[0] = static_cast<Slot>(ns - (ns % day + day) % day);
  return true;
}
bool time_part(NativeCall& call) {
  constexpr std::int64_t day = 86'400 * second;
  const auto ns = static_cast<std::int64_t>(call.slots[1]);
  call.slots[0] = static_cast<Slot>((ns % day + day) % day);
  return true;
}
/// Year, month and day go to slots 0 to 2.
void split_days(std::int64_t ns, Slot* to) {
  const auto days = std::chrono::floor<std::chrono::days>(std::chrono::nanoseconds(ns));
  const std::chrono::year_month_day date{std::chrono::sys_days{days}};
  to[0] = static_cast<Slot>(static_cast<int>(date.year()));
  to[1] = static_cast<unsigned>(date.month());
  to[2] = static_cast<unsigned>(date.day());
}
/// Hour, minute, second and millisecond go to slots 0 to 3.
void split_time(std::int64_t ns, Slot* to) {
  const auto ms = static_cast<Slot>(ns / 1'000'000);
  to[0] = ms / 3'600'000;
  to[1] = ms / 60'000 % 60;
  to[2] = ms / 1000 % 60;
  to[3] = ms % 1000;
}
// The value is in the last slot; what it is made of comes before it.
bool split_date(NativeCall& call) {
  split_days(static_cast<std::int64_t>(call.slots[3]), call.slots);
  return true;
}
bool split_tod(NativeCall& call) {
  split_time(static_cast<std::int64_t>(call.slots[4]), call.slots);
  return true;
}
bool split_dt(NativeCall& call) {
  constexpr std::int64_t day = 86'400 * second;
  const auto ns = static_cast<std::int64_t>(call.slots[7]);
  split_days(ns, call.slots);
  split_time((ns % day + day) % day, call.slots + 3);
  return true;
}
/// duration, number (LREAL)
bool multiply_time(NativeCall& call) {
  const double result = std::nearbyint(static_cast<double>(static_cast<std::int64_t>(call.slots[1])) *
                                       number_of<double>(call.slots[2]));
  if (!(std::abs(result) < 9.2e18)) return out_of_range(call, result, -no_limit, no_limit);
  call.slots[0] = static_cast<Slot>(static_cast<std::int64_t>(result));
  return true;
}
bool divide_time(NativeCall& call) {
  const double divisor = number_of<double>(call.slots[2]);
  if (divisor == 0) {
    call.fault.code = FaultCode::division_by_zero;
    return false;
  }
  const double result =
      std::nearbyint(static_cast<double>(static_cast<std::int64_t>(call.slots[1])) / divisor);
  if (!(std::abs(result) < 9.2e18)) return out_of_range(call, result, -no_limit, no_limit);
  call.slots[0] = static_cast<Slot>(static_cast<std::int64_t>(result));
  return true;
}
/// value, bytes
bool swap_bytes(NativeCall& call) {
  call.slots[0] = std::byteswap(call.slots[1]) >> (64 - 8 * call.slots[2]);
  return true;
}

struct Named {
  std::string_view name;
  Native native;
};

constexpr std::array natives = {
#define CANOPUS_NUMERIC(name, kind, function) \
  Named{name "_REAL", kind<float, std::function>}, Named{name "_LREAL", kind<double, std::function>},
    CANOPUS_NUMERIC("SQRT", numeric_from_0, sqrt) CANOPUS_NUMERIC("LN", numeric_above_0, log)
        CANOPUS_NUMERIC("LOG", numeric_above_0, log10) CANOPUS_NUMERIC("EXP", numeric, exp)
            CANOPUS_NUMERIC("SIN", numeric, sin) CANOPUS_NUMERIC("COS", numeric, cos)
                CANOPUS_NUMERIC("TAN", numeric, tan) CANOPUS_NUMERIC("ASIN", numeric_to_1, asin)
                    CANOPUS_NUMERIC("ACOS", numeric_to_1, acos) CANOPUS_NUMERIC("ATAN", numeric, atan)
#undef CANOPUS_NUMERIC
                        Named{"ATAN2_REAL", atan2_of<float>},
    Named{"ATAN2_LREAL", atan2_of<double>},
    Named{"EXPT_REAL", power<float>},
    Named{"EXPT_LREAL", power<double>},
    Named{"ABS_REAL", absolute<float>},
    Named{"ABS_LREAL", absolute<double>},
    Named{"IS_VALID_REAL", is_valid<float>},
    Named{"IS_VALID_LREAL", is_valid<double>},
    Named{"ROL", rotate<true>},
    Named{"ROR", rotate<false>},
    Named{"IS_VALID_BCD", bcd_is_valid},
    Named{"BCD_TO", from_bcd},
    Named{"TO_BCD", to_bcd},
#define CANOPUS_TEXT(name, function) \
  Named{name "_STRING", function<std::uint8_t>}, Named{name "_WSTRING", function<std::uint16_t>},
    CANOPUS_TEXT("ASSIGN", assign) CANOPUS_TEXT("LEN", length) CANOPUS_TEXT("COMPARE", compare) CANOPUS_TEXT(
        "LEFT", left) CANOPUS_TEXT("RIGHT", right) CANOPUS_TEXT("MID", mid) CANOPUS_TEXT("CONCAT", concat)
        CANOPUS_TEXT("INSERT", insert) CANOPUS_TEXT("DELETE", delete_) CANOPUS_TEXT("REPLACE", replace)
            CANOPUS_TEXT("FIND", find) CANOPUS_TEXT("TO", to_string) CANOPUS_TEXT("FROM", from_string)
#undef CANOPUS_TEXT
                Named{"CONCAT_DATE", concat_date},
    Named{"CONCAT_TOD", concat_tod},
    Named{"CONCAT_DT", concat_dt},
    Named{"STRING_TO_WSTRING", change_width<std::uint8_t, std::uint16_t>},
    Named{"WSTRING_TO_STRING", change_width<std::uint16_t, std::uint8_t>},
    Named{"SPLIT_DATE", split_date},
    Named{"SPLIT_TOD", split_tod},
    Named{"SPLIT_DT", split_dt},
    Named{"DAY_OF_WEEK", day_of_week},
    Named{"DATE_PART", date_part},
    Named{"TIME_PART", time_part},
    Named{"MUL_TIME", multiply_time},
    Named{"DIV_TIME", divide_time},
    Named{"SWAP_BYTES", swap_bytes},
};

}  // namespace

Native native_named(std::string_view name) noexcept {
  const auto* const found = std::ranges::find(natives, name, &Named::name);
  return found == natives.end() ? nullptr : found->native;
}

}  // namespace canopus::program
