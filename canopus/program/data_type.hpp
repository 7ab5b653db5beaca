#pragma once
// Data types of PLC programs [IEC 61131-3 6.4], shared by the compilers and by access to variables by name.
//
// A variable is a row of slots of 64 bits. An elementary value is one slot: integers and bit strings extended to 64 bits by
// their sign or by zeros, REAL the 32 bits of a float, durations, dates and times of day nanoseconds. A string is a slot
// with length and capacity (StringHeader), then its characters. Arrays and structures are their elements in a row.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::program {

using Slot = std::uint64_t;

enum class Elementary : std::uint8_t {
  boolean,
  sint,
  int_,
  dint,
  lint,
  usint,
  uint,
  udint,
  ulint,
  byte,
  word,
  dword,
  lword,
  real,
  lreal,
  time,
  ltime,  ///< ns
  date,
  ldate,
  tod,
  ltod,
  dt,
  ldt,  ///< ns since 1970-01-01, or since midnight
  char_,
  wchar,
  string,
  wstring
};
inline constexpr std::size_t elementary_count = 27;

enum class Family : std::uint8_t {
  boolean,
  signed_integer,
  unsigned_integer,
  bits,
  real,
  duration,
  date,
  character,
  string
};

struct ElementaryInfo {
  std::string_view name;  ///< "DINT"
  Family family;
  std::uint8_t bits;  ///< of a value; of a string: of a character
};
[[nodiscard]] const ElementaryInfo& info(Elementary type) noexcept;
/// "dint" -> Elementary::dint; also the long names of the standard (TIME_OF_DAY). Empty for what is none.
[[nodiscard]] std::optional<Elementary> elementary_named(std::string_view name) noexcept;

/// The first slot of a string.
struct StringHeader {
  std::uint32_t length = 0;    ///< in characters
  std::uint32_t capacity = 0;  ///< the most that it can have
};
[[nodiscard]] constexpr Slot string_header(std::uint32_t length, std::uint32_t capacity) noexcept {
  return Slot{capacity} << 32U | length;
}
[[nodiscard]] constexpr StringHeader string_header(Slot slot) noexcept {
  return {static_cast<std::uint32_t>(slot), static_cast<std::uint32_t>(slot >> 32U)};
}
/// Of a string of that capacity, its header included; `bits` of a character: 8 or 16.
[[nodiscard]] constexpr std::uint32_t string_slots(std::uint32_t capacity, unsigned bits) noexcept {
  return 1 + (capacity * bits + 63) / 64;
}

struct DataType;

enum class MemberKind : std::uint8_t { local, input, output, in_out, temporary, field, hidden };

struct Member {
  std::string name;
  const DataType* type = nullptr;
  std::uint32_t offset = 0;  ///< in slots
  MemberKind kind = MemberKind::field;
  bool is_constant = false;
  bool is_retained = false;
  std::string comment{};
};

struct DataType {
  enum class Form : std::uint8_t { elementary, enumeration, subrange, array, structure, block };
  Form form = Form::elementary;
  Elementary base = Elementary::int_;  ///< of elementary types, enumerations and subranges
  std::string name{};
  std::uint32_t slots = 1;
  std::int64_t low = 0;  ///< of a subrange, or the first index of an array
  std::int64_t high = 0;
  const DataType* element = nullptr;  ///< of an array; one with two dimensions is an array of arrays
  std::uint32_t capacity = 0;         ///< of a string, in characters
  std::vector<Member> members{};      ///< of a structure or a block
  std::vector<std::pair<std::string, std::int64_t>> values{};  ///< of an enumeration
  std::vector<Slot> initial{};                                 ///< of `slots`; empty: see write_initial()

  [[nodiscard]] bool is_scalar() const noexcept {
    return form < Form::array && base != Elementary::string && base != Elementary::wstring;
  }
  [[nodiscard]] bool is_string() const noexcept {
    return form == Form::elementary && (base == Elementary::string || base == Elementary::wstring);
  }
  [[nodiscard]] const Member* member(
      std::string_view wanted) const noexcept;  ///< whatever the case of its letters
};

/// Writes the value that a variable of the type has without an initial value of its own, at `to`, which has type.slots.
void write_initial(const DataType& type, Slot* to);
/// Slots that are a value of the type: extended to 64 bits as it is, within a subrange, of a string no longer than its capacity.
/// Scalars and strings alone.
[[nodiscard]] bool is_value(const DataType& type, std::span<const Slot> slots) noexcept;
/// The same form, base, bounds, lengths and members.
[[nodiscard]] bool same_type(const DataType& a, const DataType& b) noexcept;

/// A value for people: "TRUE", "-12", "16#00FF", "1.5", "T#1s500ms", "'text'", "[1, 2]", "(a := 1)". Long ones end in "...".
[[nodiscard]] std::string value_text(const DataType& type, const Slot* value);
/// A literal of the type, with or without the type's prefix, written to `to`; strings in quotes or without. The error names what was
/// expected; nothing is written then. Scalars and strings alone.
[[nodiscard]] std::optional<std::string> parse_value(const DataType& type, std::string_view text, Slot* to);

}  // namespace canopus::program
