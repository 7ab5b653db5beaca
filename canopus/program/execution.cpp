#include "canopus/program/execution.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "canopus/program/linked_code.hpp"
#include "canopus/program/standard_timer.hpp"

// The dispatch goes from the end of one instruction straight to the next one's code: labels as values, which g++ and clang++ have.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"

namespace canopus::program {

namespace {

template <typename Integer>
constexpr Slot wrapped(Slot value) noexcept {
  if constexpr (std::is_signed_v<Integer>)
    return static_cast<Slot>(static_cast<std::int64_t>(static_cast<Integer>(value)));
  return static_cast<Slot>(static_cast<Integer>(value));
}

constexpr std::int64_t as_int(Slot value) noexcept { return static_cast<std::int64_t>(value); }

/// In which a division is done: 32 bits take half the time of 64.
template <typename Integer>
using Divided =
    std::conditional_t<sizeof(Integer) == 8, Integer,
                       std::conditional_t<std::is_signed_v<Integer>, std::int32_t, std::uint32_t>>;

template <typename Integer>
Slot quotient(Slot a, Slot b) noexcept {
  // The least number has no opposite: it wraps to itself.
  if (std::is_signed_v<Integer> && as_int(b) == -1) return wrapped<Integer>(Slot{0} - a);
  return wrapped<Integer>(
      static_cast<Slot>(static_cast<Divided<Integer>>(a) / static_cast<Divided<Integer>>(b)));
}

template <typename Integer>
Slot remainder_of(Slot a, Slot b) noexcept {
  if (std::is_signed_v<Integer> && as_int(b) == -1) return 0;
  return wrapped<Integer>(
      static_cast<Slot>(static_cast<Divided<Integer>>(a) % static_cast<Divided<Integer>>(b)));
}

struct Real {
  using Number = float;
  static float get(Slot value) noexcept { return std::bit_cast<float>(static_cast<std::uint32_t>(value)); }
  static Slot put(float value) noexcept { return std::bit_cast<std::uint32_t>(value); }
};
struct Lreal {
  using Number = double;
  static double get(Slot value) noexcept { return std::bit_cast<double>(value); }
  static Slot put(double value) noexcept { return std::bit_cast<Slot>(value); }
};

/// A whole number as a value of an integer type; false: beyond its range.
bool to_integer(double whole, Elementary type, Slot& to, Fault& fault) noexcept {
  const ElementaryInfo& kind = info(type);
  const bool is_signed =
      kind.family == Family::signed_integer || kind.family == Family::duration || kind.family == Family::date;
  const unsigned bits = kind.bits;
  const double end = std::ldexp(1.0, static_cast<int>(is_signed ? bits - 1 : bits));
  const double low = is_signed ? -end : 0;
  if (whole >= low && whole < end) {
    to = is_signed ? static_cast<Slot>(static_cast<std::int64_t>(whole)) : static_cast<Slot>(whole);
    return true;
  }
  fault.code = FaultCode::value_out_of_range;
  fault.value = whole > 9e18        ? std::numeric_limits<std::int64_t>::max()
                : whole < -9e18     ? std::numeric_limits<std::int64_t>::min()
                : std::isnan(whole) ? 0
                                    : static_cast<std::int64_t>(whole);
  fault.low =
      bits == 64 && is_signed ? std::numeric_limits<std::int64_t>::min() : static_cast<std::int64_t>(low);
  fault.high = bits == 64 ? std::numeric_limits<std::int64_t>::max() : static_cast<std::int64_t>(end - 1);
  return false;
}

bool refused(DeviceError error, const DeviceAccess& access, Fault& fault) noexcept {
  if (error == DeviceError::none) return false;
  fault.code = error == DeviceError::no_module ? FaultCode::no_module : FaultCode::device_out_of_range;
  fault.device = access.text;
  return true;
}

/// The point, moved by an array's index and by its index register.
bool point_of(Execution& x, const DeviceAccess& access, Slot moved, DevicePoint& point,
              Fault& fault) noexcept {
  point = access.point;
  point.number += static_cast<std::uint32_t>(moved);
  if (x.devices == nullptr) return !refused(DeviceError::no_module, access, fault);
  if (!access.is_indexed) return true;
  std::uint16_t index = 0;
  if (refused(x.devices->read_words(access.index, {&index, 1}), access, fault)) return false;
  const std::int64_t number = std::int64_t{point.number} + static_cast<std::int16_t>(index);
  if (number < 0) return !refused(DeviceError::out_of_range, access, fault);
  point.number = static_cast<std::uint32_t>(number);
  return true;
}

Slot extended(Slot value, Elementary type) noexcept {
  const ElementaryInfo& kind = info(type);
  if (kind.family != Family::signed_integer || kind.bits == 64) return value;
  const unsigned shift = 64U - kind.bits;
  return static_cast<Slot>(as_int(value << shift) >> shift);
}

bool read_device(Execution& x, const DeviceAccess& access, Slot moved, Slot& to, Fault& fault) noexcept {
  DevicePoint point;
  if (!point_of(x, access, moved, point, fault)) return false;
  if (access.form == DeviceAccess::Form::bit || access.form == DeviceAccess::Form::points) {
    std::uint32_t bits = 0;
    if (refused(x.devices->read_bits(point, access.count, bits), access, fault)) return false;
    to = extended(bits, access.type);
    return true;
  }
  std::array<std::uint16_t, 4> words{};
  const bool is_bit = access.form == DeviceAccess::Form::bit_of_word;
  const std::span<std::uint16_t> read = std::span(words).first(is_bit ? 1 : access.count);
  if (refused(x.devices->read_words(point, read), access, fault)) return false;
  if (is_bit) {
    to = words[0] >> access.count & 1U;
    return true;
  }
  Slot value = 0;
  for (std::size_t i = 0; i < read.size(); ++i) value |= Slot{words[i]} << (16 * i);
  to = extended(value, access.type);
  return true;
}

bool write_device(Execution& x, const DeviceAccess& access, Slot moved, Slot from, Fault& fault) noexcept {
  DevicePoint point;
  if (!point_of(x, access, moved, point, fault)) return false;
  if (access.form == DeviceAccess::Form::bit || access.form == DeviceAccess::Form::points) {
    return !refused(x.devices->write_bits(point, access.count, static_cast<std::uint32_t>(from)), access,
                    fault);
  }
  std::array<std::uint16_t, 4> words{};
  if (access.form == DeviceAccess::Form::bit_of_word) {
    const std::span<std::uint16_t> word(words.data(), 1);
    if (refused(x.devices->read_words(point, word), access, fault)) return false;
    const auto bit = static_cast<std::uint16_t>(1U << access.count);
    word[0] = static_cast<std::uint16_t>(from != 0 ? word[0] | bit : word[0] & ~bit);
    return !refused(x.devices->write_words(point, word), access, fault);
  }
  for (std::size_t i = 0; i < access.count; ++i) words[i] = static_cast<std::uint16_t>(from >> (16 * i));
  return !refused(x.devices->write_words(point, std::span<const std::uint16_t>(words).first(access.count)),
                  access, fault);
}

// Words of devices stand in a row, the low one first, as a number of the machine itself has them.
template <typename Number>
Slot number_in(const std::uint16_t* words) noexcept {
  std::make_unsigned_t<Number> number = 0;
  for (std::size_t i = 0; i < sizeof(Number) / 2; ++i)
    number = static_cast<std::make_unsigned_t<Number>>(number | std::make_unsigned_t<Number>{words[i]}
                                                                    << (16 * i));
  return wrapped<Number>(number);
}
template <std::size_t count>
void put_words(std::uint16_t* words, Slot value) noexcept {
  for (std::size_t i = 0; i < count; ++i) words[i] = static_cast<std::uint16_t>(value >> (16 * i));
}

template <int count>
Slot combined(const BitOperand* operands) noexcept {
  Slot result =
      Slot{*operands[0].bit} ^ (operands[0].function & 1U);  // there is none before: the bit, or its opposite
#pragma GCC unroll 8
  for (int i = 1; i < count; ++i) result = Slot{operands[i].function >> (2 * result + *operands[i].bit)} & 1U;
  return result;
}

struct Caller {
  const Instruction* next;
  Slot* frame;
};

}  // namespace

std::optional<Fault> execute(Execution& x, std::uint32_t entry, std::uint32_t frame) noexcept {
  static constexpr std::array labels_order = {
#define CANOPUS_EACH_OPCODE(name) Opcode::name,
      CANOPUS_OPCODES
#undef CANOPUS_EACH_OPCODE
  };
  static_assert(labels_order.back() == Opcode::element_address_load_at);
  static const void* const labels[] = {
#define CANOPUS_EACH_OPCODE(name) &&name,
      CANOPUS_OPCODES
#undef CANOPUS_EACH_OPCODE
  };

  const Instruction* const code = x.code.data();
  Slot* const memory = x.memory.data();
  const Slot* const initial = x.initial.data();
  const ElementAccess* const elements = x.program.elements.data();
  const Native* const natives = x.program.natives.data();
  std::array<Caller, most_nested_calls> callers;
  std::size_t depth = 0;
  const Instruction* at = code + entry;
  Slot* r = memory + frame;
  std::int64_t budget = x.budget;
  NativeCall native_call{memory, r, x.now};  // one for all: a new one takes longer than most functions
  native_call.devices = x.devices;
  native_call.program = &x.program;
  native_call.device_memory = x.device_memory;
  Fault& fault = native_call.fault;
  Opcode first = at->code;
  if (x.suspension != nullptr && x.suspension->is_set) {
    const Suspension& halted = *x.suspension;
    at = code + halted.next;
    r = memory + halted.frame;
    first = at->code == Opcode::halt ? x.program.code[halted.next].code : at->code;  // in place of the break
    for (; depth < halted.depth; ++depth)
      callers[depth] = {code + halted.callers[depth].next, memory + halted.callers[depth].frame};
    x.suspension->is_set = false;
  }

#define NEXT()                                        \
  do {                                                \
    ++at;                                             \
    goto* labels[static_cast<std::size_t>(at->code)]; \
  } while (false)
#define GO(distance)                                  \
  do {                                                \
    at += static_cast<std::int32_t>(distance);        \
    goto* labels[static_cast<std::size_t>(at->code)]; \
  } while (false)
#define A r[at->a]
#define B r[at->b]
#define C r[at->c]

  goto* labels[static_cast<std::size_t>(first)];

end:
  x.budget = budget;
  return std::nullopt;
halt : {
  x.budget = budget;
  Suspension& halted = *x.suspension;
  halted.is_set = true;
  halted.next = static_cast<std::uint32_t>(at - code);
  halted.frame = static_cast<std::uint32_t>(r - memory);
  halted.depth = static_cast<std::uint32_t>(depth);
  for (std::size_t i = 0; i < depth; ++i) {
    halted.callers[i] = {static_cast<std::uint32_t>(callers[i].next - code),
                         static_cast<std::uint32_t>(callers[i].frame - memory)};
  }
  return std::nullopt;
}
move:
  A = B;
  NEXT();
reset:
  std::copy_n(initial + (r - memory) + at->a, at->b, r + at->a);
  NEXT();
reset_global:
  std::copy_n(initial + at->a, at->b, memory + at->a);
  NEXT();
load_global:
  A = memory[at->b];
  NEXT();
store_global:
  memory[at->a] = B;
  NEXT();
address:
  A = static_cast<Slot>(r - memory) + at->b;
  NEXT();
load_at:
  A = memory[B + at->c];
  NEXT();
store_at:
  memory[A + at->c] = B;
  NEXT();
copy_at:
  std::memmove(memory + A, memory + B, at->c * sizeof(Slot));
  NEXT();
load_element : {
  const ElementAccess& array = elements[at->c];
  const std::int64_t index = as_int(B);
  if (index < array.low || index > array.high) goto bad_index;
  A = r[array.offset + static_cast<std::size_t>(index - array.low)];
  NEXT();
}
store_element : {
  const ElementAccess& array = elements[at->c];
  const std::int64_t index = as_int(B);
  if (index < array.low || index > array.high) goto bad_index;
  r[array.offset + static_cast<std::size_t>(index - array.low)] = A;
  NEXT();
}
element_address : {
  const ElementAccess& array = elements[at->c];
  const std::int64_t index = as_int(B);
  if (index < array.low || index > array.high) goto bad_index;
  A = static_cast<Slot>(r - memory) + array.offset + static_cast<Slot>(index - array.low) * array.size;
  NEXT();
}
global_element_address : {
  const ElementAccess& array = elements[at->c];
  const std::int64_t index = as_int(B);
  if (index < array.low || index > array.high) goto bad_index;
  A = array.offset + static_cast<Slot>(index - array.low) * array.size;
  NEXT();
}
index_at : {
  const ElementAccess& array = elements[at->c];
  const std::int64_t index = as_int(B);
  if (index < array.low || index > array.high) goto bad_index;
  A += static_cast<Slot>(index - array.low) * array.size;
  NEXT();
}

#define CANOPUS_INTEGER_CODE(type, Integer)       \
  add_##type : A = wrapped<Integer>(B + C);       \
  NEXT();                                         \
  sub_##type : A = wrapped<Integer>(B - C);       \
  NEXT();                                         \
  mul_##type : A = wrapped<Integer>(B * C);       \
  NEXT();                                         \
  div_##type : if (C == 0) goto division_by_zero; \
  A = quotient<Integer>(B, C);                    \
  NEXT();                                         \
  mod_##type : if (C == 0) goto division_by_zero; \
  A = remainder_of<Integer>(B, C);                \
  NEXT();                                         \
  neg_##type : A = wrapped<Integer>(Slot{0} - B); \
  NEXT();                                         \
  wrap_##type : A = wrapped<Integer>(B);          \
  NEXT();
  CANOPUS_INTEGER_TYPES(CANOPUS_INTEGER_CODE)

#define CANOPUS_REAL_CODE(type, Kind)                                                                      \
  add_##type : A = Kind::put(Kind::get(B) + Kind::get(C));                                                 \
  NEXT();                                                                                                  \
  sub_##type : A = Kind::put(Kind::get(B) - Kind::get(C));                                                 \
  NEXT();                                                                                                  \
  mul_##type : A = Kind::put(Kind::get(B) * Kind::get(C));                                                 \
  NEXT();                                                                                                  \
  div_##type : if (Kind::get(C) == 0) goto division_by_zero;                                               \
  A = Kind::put(Kind::get(B) / Kind::get(C));                                                              \
  NEXT();                                                                                                  \
  neg_##type : A = Kind::put(-Kind::get(B));                                                               \
  NEXT();                                                                                                  \
  eq_##type : A = Kind::get(B) == Kind::get(C);                                                            \
  NEXT();                                                                                                  \
  ne_##type : A = Kind::get(B) != Kind::get(C);                                                            \
  NEXT();                                                                                                  \
  lt_##type : A = Kind::get(B) < Kind::get(C);                                                             \
  NEXT();                                                                                                  \
  le_##type : A = Kind::get(B) <= Kind::get(C);                                                            \
  NEXT();                                                                                                  \
  round_##type : if (!to_integer(std::nearbyint(double{Kind::get(B)}), static_cast<Elementary>(at->extra), \
                                 A, fault)) goto failed;                                                   \
  NEXT();                                                                                                  \
  trunc_##type : if (!to_integer(std::trunc(double{Kind::get(B)}), static_cast<Elementary>(at->extra), A,  \
                                 fault)) goto failed;                                                      \
  NEXT();                                                                                                  \
  from_int_##type : A = Kind::put(static_cast<Kind::Number>(as_int(B)));                                   \
  NEXT();                                                                                                  \
  from_uint_##type : A = Kind::put(static_cast<Kind::Number>(B));                                          \
  NEXT();
  CANOPUS_REAL_CODE(real, Real)
  CANOPUS_REAL_CODE(lreal, Lreal)

real_to_lreal:
  A = Lreal::put(double{Real::get(B)});
  NEXT();
lreal_to_real:
  A = Real::put(static_cast<float>(Lreal::get(B)));
  NEXT();
bit_and:
  A = B & C;
  NEXT();
bit_or:
  A = B | C;
  NEXT();
bit_xor:
  A = B ^ C;
  NEXT();
shl:
  A = C < 64 ? B << C : 0;
  NEXT();
shr:
  A = C < 64 ? B >> C : 0;
  NEXT();
eq:
  A = B == C;
  NEXT();
ne:
  A = B != C;
  NEXT();
lt:
  A = as_int(B) < as_int(C);
  NEXT();
le:
  A = as_int(B) <= as_int(C);
  NEXT();
ltu:
  A = B < C;
  NEXT();
leu:
  A = B <= C;
  NEXT();
jump:
  GO(at->c);
loop:
  budget += static_cast<std::int32_t>(at->c);
  if (budget < 0) goto too_long;
  GO(at->c);
jump_if:
  if (A != 0) GO(at->c);
  NEXT();
jump_unless:
  if (A == 0) GO(at->c);
  NEXT();
jump_eq:
  if (A == B) GO(at->c);
  NEXT();
jump_ne:
  if (A != B) GO(at->c);
  NEXT();
jump_lt:
  if (as_int(A) < as_int(B)) GO(at->c);
  NEXT();
jump_le:
  if (as_int(A) <= as_int(B)) GO(at->c);
  NEXT();
jump_ltu:
  if (A < B) GO(at->c);
  NEXT();
jump_leu:
  if (A <= B) GO(at->c);
  NEXT();
for_first:
  if (as_int(r[at->b + 1]) < 0 ? as_int(A) < as_int(B) : as_int(A) > as_int(B)) GO(at->c);
  NEXT();
for_next : {
  const std::int64_t step = as_int(r[at->b + 1]);
  std::int64_t next = 0;
  const bool overflows = __builtin_add_overflow(as_int(A), step, &next);
  A = static_cast<Slot>(next);
  if (overflows || (step < 0 ? next < as_int(B) : next > as_int(B))) NEXT();
  budget += static_cast<std::int32_t>(at->c);
  if (budget < 0) goto too_long;
  GO(at->c);
}
check_range : {
  const ElementAccess& range = elements[at->b];
  const std::int64_t value = as_int(A);
  if (value >= range.low && value <= range.high) NEXT();
  fault.code = FaultCode::value_out_of_range;
  fault.value = value;
  fault.low = range.low;
  fault.high = range.high;
  goto failed;
}
call : {
  const Function& function = x.program.functions[at->a];
  if (depth == callers.size()) goto too_deep;
  callers[depth++] = {at + 1, r};
  budget -= function.instructions;
  if (budget < 0) goto too_long;
  r = memory + function.frame;
  at = code + function.entry;
  goto* labels[static_cast<std::size_t>(at->code)];
}
call_block : {
  const Function& function = x.program.functions[at->b];
  if (depth == callers.size()) goto too_deep;
  callers[depth++] = {at + 1, r};
  budget -= function.instructions;
  if (budget < 0) goto too_long;
  r = memory + A;
  at = code + function.entry;
  goto* labels[static_cast<std::size_t>(at->code)];
}
return_:
  if (depth == 0) goto end;
  --depth;
  at = callers[depth].next;
  r = callers[depth].frame;
  goto* labels[static_cast<std::size_t>(at->code)];
run_plugin:
  if (auto stopped = x.program.plugin->scan(x.memory, x.now, x.devices)) {
    x.budget = budget;
    return stopped;
  }
  NEXT();
native:
  native_call.slots = r + at->b;
  goto call_native;
native_at:
  native_call.slots = memory + B;
call_native:
  native_call.cost = NativeCall::usual_cost;
  if (!natives[at->a](native_call)) goto failed;
  budget -= native_call.cost;
  if (budget < 0) goto too_long;
  NEXT();
read_device:
  if (!program::read_device(x, x.program.devices[at->b], at->extra != 0 ? C : 0, A, fault)) goto failed;
  NEXT();
write_device:
  if (!program::write_device(x, x.program.devices[at->a], at->extra != 0 ? C : 0, B, fault)) goto failed;
  NEXT();

load_bit:
  A = *pointer_in<const std::uint8_t>(*at);
  NEXT();
store_bit:
  *pointer_in<std::uint8_t>(*at) = A & 1U;
  NEXT();
load_bit_of_word:
  A = *pointer_in<const std::uint16_t>(*at) >> at->extra & 1U;
  NEXT();
store_bit_of_word : {
  std::uint16_t& word = *pointer_in<std::uint16_t>(*at);
  const auto bit = static_cast<std::uint16_t>(1U << at->extra);
  word = static_cast<std::uint16_t>(A != 0 ? word | bit : word & ~bit);
  NEXT();
}
#define CANOPUS_LOAD_CODE(type, Number)                                      \
  load_##type : A = number_in<Number>(pointer_in<const std::uint16_t>(*at)); \
  NEXT();
  CANOPUS_LOAD_CODE(u16, std::uint16_t)
  CANOPUS_LOAD_CODE(i16, std::int16_t)
  CANOPUS_LOAD_CODE(u32, std::uint32_t)
  CANOPUS_LOAD_CODE(i32, std::int32_t)
  CANOPUS_LOAD_CODE(u64, std::uint64_t)
store_16:
  put_words<1>(pointer_in<std::uint16_t>(*at), A);
  NEXT();
store_32:
  put_words<2>(pointer_in<std::uint16_t>(*at), A);
  NEXT();
store_64:
  put_words<4>(pointer_in<std::uint16_t>(*at), A);
  NEXT();
// The usual distances are compared, not added: the processor goes on by what it predicts, before it has read the distance.
#define CANOPUS_BITS_CODE(count)                                          \
  bits_##count : {                                                        \
    const BitOperand* const operands = pointer_in<const BitOperand>(*at); \
    const Slot result = combined<count>(operands);                        \
    A = result;                                                           \
    *operands[count].bit = static_cast<std::uint8_t>(result);             \
    if (at->extra == 2 * count) GO(2 * count);                            \
    if (at->extra == 2 * count + 1) GO(2 * count + 1);                    \
    if (at->extra == count) GO(count);                                    \
    if (at->extra == count + 1) GO(count + 1);                            \
    GO(at->extra);                                                        \
  }
  CANOPUS_BITS_CODE(1)
  CANOPUS_BITS_CODE(2)
  CANOPUS_BITS_CODE(3)
  CANOPUS_BITS_CODE(4)
  CANOPUS_BITS_CODE(5)
  CANOPUS_BITS_CODE(6)
  CANOPUS_BITS_CODE(7)
  CANOPUS_BITS_CODE(8)

// Several instructions in a row, each with its own operands.
#define LOAD_I16() A = number_in<std::int16_t>(pointer_in<const std::uint16_t>(*at)), ++at
#define STORE_16() put_words<1>(pointer_in<std::uint16_t>(*at), A)
load_store:
  LOAD_I16();
  STORE_16();
  NEXT();
load_add_store:
  LOAD_I16();
  A = wrapped<std::int16_t>(B + C), ++at;
  STORE_16();
  NEXT();
load_sub_store:
  LOAD_I16();
  A = wrapped<std::int16_t>(B - C), ++at;
  STORE_16();
  NEXT();
load_load_add_store:
  LOAD_I16();
  LOAD_I16();
  A = wrapped<std::int16_t>(B + C), ++at;
  STORE_16();
  NEXT();
load_load_sub_store:
  LOAD_I16();
  LOAD_I16();
  A = wrapped<std::int16_t>(B - C), ++at;
  STORE_16();
  NEXT();
load_eq_move:
  LOAD_I16();
  A = B == C, ++at;
  A = B;
  NEXT();
load_ne_move:
  LOAD_I16();
  A = B != C, ++at;
  A = B;
  NEXT();
load_lt_move:
  LOAD_I16();
  A = as_int(B) < as_int(C), ++at;
  A = B;
  NEXT();
load_le_move:
  LOAD_I16();
  A = as_int(B) <= as_int(C), ++at;
  A = B;
  NEXT();
load_bit_jump_unless:
  A = *pointer_in<const std::uint8_t>(*at), ++at;
  if (A == 0) GO(at->c);
  NEXT();
load_bit_jump_if:
  A = *pointer_in<const std::uint8_t>(*at), ++at;
  if (A != 0) GO(at->c);
  NEXT();
move_move:
  A = B, ++at;
  A = B;
  NEXT();
eq_jump_unless:
  A = B == C, ++at;
  if (A == 0) GO(at->c);
  NEXT();
lt_jump_unless:
  A = as_int(B) < as_int(C), ++at;
  if (A == 0) GO(at->c);
  NEXT();
element_address_store_at : {
  const ElementAccess& array = elements[at->c];
  const std::int64_t index = as_int(B);
  if (index < array.low || index > array.high) goto bad_index;
  A = static_cast<Slot>(r - memory) + array.offset + static_cast<Slot>(index - array.low) * array.size;
  ++at;
  memory[A + at->c] = B;
  NEXT();
}
enter:
  if (depth == callers.size()) goto too_deep;
  callers[depth++] = {at + 1, r};
  budget -= at->c;
  if (budget < 0) goto too_long;
  r = memory + at->a;
  at = code + at->b;
  goto* labels[static_cast<std::size_t>(at->code)];
store_at_enter_block:
  memory[A + at->c] = B, ++at;
enter_block:
  if (depth == callers.size()) goto too_deep;
  callers[depth++] = {at + 1, r};
  budget -= at->c;
  if (budget < 0) goto too_long;
  r = memory + A;
  at = code + at->b;
  goto* labels[static_cast<std::size_t>(at->code)];
eq_bit_or:
  A = B == C, ++at;
  A = B | C;
  NEXT();
move_move_on_delay:
  A = B, ++at;
  A = B, ++at;
on_delay:
  reinterpret_cast<Timer*>(r + at->b)->run_on_delay(x.now);
  budget -= NativeCall::usual_cost;
  if (budget < 0) goto too_long;
  NEXT();
element_address_load_at : {
  const ElementAccess& array = elements[at->c];
  const std::int64_t index = as_int(B);
  if (index < array.low || index > array.high) goto bad_index;
  A = static_cast<Slot>(r - memory) + array.offset + static_cast<Slot>(index - array.low) * array.size;
  ++at;
  A = memory[B + at->c];
  NEXT();
}

bad_index:
  fault.code = FaultCode::index_out_of_range;
  fault.value = as_int(B);
  fault.low = elements[at->c].low;
  fault.high = elements[at->c].high;
  goto failed;
division_by_zero:
  fault.code = FaultCode::division_by_zero;
  goto failed;
too_long:
  fault.code = FaultCode::watchdog;
  goto failed;
too_deep:
  fault.code = FaultCode::call_depth;
failed:
  x.budget = budget;
  fault.position = x.positions[static_cast<std::size_t>(at - code)];
  return fault;
#undef LOAD_I16
#undef STORE_16
#undef NEXT
#undef GO
#undef A
#undef B
#undef C
}

}  // namespace canopus::program

#pragma GCC diagnostic pop
