// What each instruction is compiled to.

#include <algorithm>
#include <utility>

#include "canopus/instruction_list/device_functions.hpp"
#include "canopus/instruction_list/list_compiler.hpp"
#include "canopus/program/standard_functions.hpp"

namespace canopus::instruction_list {

using program::DeviceAccess;
using Kind = Operand::Kind;
namespace functions = device_functions;

namespace {

/// LD, AND or OR: 0, 1, 2.
unsigned place_of(std::string_view name) {
  return name.starts_with("LD") ? 0 : name.starts_with("AND") ? 1 : 2;
}

/// 10 ms timers and others of an FX3, by their number; 0: there is no such timer.
struct TimerKind {
  std::int64_t unit = 0;  ///< ns
  bool is_retentive = false;
};
TimerKind fx3_timer(std::uint32_t number) {
  constexpr std::int64_t millisecond = 1'000'000;
  if (number < 200) return {100 * millisecond, false};
  if (number < 246) return {10 * millisecond, false};
  if (number < 250) return {millisecond, true};
  if (number < 256) return {100 * millisecond, true};
  if (number < 512) return {millisecond, false};
  return {};
}

constexpr std::uint32_t first_high_speed_counter = 235;  // of an FX3

}  // namespace

// Contacts

void ListCompiler::contact(unsigned variant) {
  const unsigned place = variant / 2;
  const bool is_inverted = variant % 2 == 1;
  if (place == 0) {
    push_result();
    const std::uint32_t top = result_slot(depth_ - 1);
    if (load_bit(operands_[0], top) && is_inverted) invert(top);
    return;
  }
  const auto value = load_bit(operands_[0]);
  if (!value) return;
  if (is_inverted) invert(*value);
  combine(place, *value);
}

void ListCompiler::pulse_contact(unsigned variant) {
  const auto value = load_bit(operands_[0]);
  if (!value) {
    if (variant % 6 / 2 == 0) push_result();
    return;
  }
  const std::uint32_t found = edge(*value, variant % 2 == 0);
  if (variant >= 6) invert(found);
  combine(variant % 6 / 2, found);
}

void ListCompiler::block(bool is_or) {
  if (depth_ < 2)
    return error(text_->instructions[row_].name + ": expected two blocks of contacts before it");
  const std::uint32_t below = result_slot(depth_ - 2);
  emit(is_or ? Opcode::bit_or : Opcode::bit_and, below, below, result_slot(depth_ - 1),
       program::of_bool | program::c_is_last);
  --depth_;
}

void ListCompiler::stack(unsigned variant) {
  const auto top = result();
  if (!top) return;
  std::vector<std::uint32_t>& slots = routine().stored;
  constexpr std::size_t most = 16;
  if (variant == 0) {
    if (stored_ == most) return error("expected at most 16 MPS without MPP");
    while (slots.size() <= stored_) slots.push_back(reserve(1));
    emit(Opcode::move, slots[stored_++], *top);
    return;
  }
  if (stored_ == 0) return error(text_->instructions[row_].name + " without MPS; expected one above");
  emit(Opcode::move, *top, slots[stored_ - 1]);
  if (variant == 2) --stored_;
}

void ListCompiler::compare(std::string_view name, unsigned variant, Elementary type) {
  auto a = load(operands_[0], type);
  auto b = load(operands_[1], type);
  if (!a || !b) {
    if (place_of(name) == 0) push_result();
    return;
  }
  // = <> > <= < >=: greater is less with the operands exchanged.
  if (variant == 2 || variant == 5) std::swap(a, b);
  Opcode code = variant == 0                   ? Opcode::eq
                : variant == 1                 ? Opcode::ne
                : variant == 2 || variant == 4 ? Opcode::lt
                                               : Opcode::le;
  if (type == Elementary::real)
    code = code == Opcode::eq   ? Opcode::eq_real
           : code == Opcode::ne ? Opcode::ne_real
           : code == Opcode::lt ? Opcode::lt_real
                                : Opcode::le_real;
  if (type == Elementary::lreal)
    code = code == Opcode::eq   ? Opcode::eq_lreal
           : code == Opcode::ne ? Opcode::ne_lreal
           : code == Opcode::lt ? Opcode::lt_lreal
                                : Opcode::le_lreal;
  const std::uint32_t found = temporary();
  emit(code, found, *a, *b);
  combine(place_of(name), found);
}

bool ListCompiler::text_argument(const Operand& operand, std::uint32_t record, std::uint32_t slot) {
  if (operand.kind == Kind::text) {
    const std::size_t slots = (operand.text.size() + 7) / 8 + 1;
    const std::uint32_t place = place_in_memory(slots);
    std::copy(operand.text.begin(), operand.text.end(),
              reinterpret_cast<char*>(shared_.program.initial.data() + place));
    if (shared_.is_too_large) return false;
    image_[record + slot] = functions::none;
    image_[record + slot + 2] = place;
    image_[record + slot + 3] = operand.text.size();
    return true;
  }
  const auto from = located(operand, Elementary::word);
  if (from) locate(record, slot, *from);
  return from.has_value();
}

void ListCompiler::compare_text(std::string_view name, unsigned variant) {
  const std::uint32_t texts = record({0, 0, 0, 0, 0, 0, 0, 0});
  if (!text_argument(operands_[0], texts, 1) || !text_argument(operands_[1], texts, 5)) {
    if (place_of(name) == 0) push_result();
    return;
  }
  native(functions::compare_text, texts);
  const std::uint32_t zero = constant(0);
  const std::uint32_t found = temporary();
  const bool is_swapped = variant == 2 || variant == 5;
  const Opcode code = variant == 0                   ? Opcode::eq
                      : variant == 1                 ? Opcode::ne
                      : variant == 2 || variant == 4 ? Opcode::lt
                                                     : Opcode::le;
  emit(code, found, is_swapped ? zero : texts, is_swapped ? texts : zero);
  combine(place_of(name), found);
}

// Outputs

/// `unit` of a timer in ns; 0: that of OUT.
void ListCompiler::out(std::int64_t unit) {
  const auto when = condition();
  if (!when) return;
  const Operand& target = operands_[0];
  const bool is_timer = target.kind == Kind::timer || target.kind == Kind::retentive_timer;
  const bool has_setting = operands_.size() == 2;
  if (unit != 0 && !is_timer) return operand_error(target, "expected a timer");
  if ((is_timer || target.kind == Kind::counter) != has_setting)
    return operand_error(target, has_setting ? "expected a timer or counter, as there is a setting"
                                             : "expected a setting behind the timer or counter, such as K10");
  if (is_timer) return out_timer(target, *when, unit);
  if (has_setting) return out_counter(target, *when);
  if (transfer(*when)) return;
  (void)store_bit(target, *when);
}

void ListCompiler::out_timer(const Operand& timer, std::uint32_t when, std::int64_t unit) {
  const bool is_fx3 = shared_.family == Family::fx3;
  TimerKind kind{unit == 0 ? 100'000'000 : unit, timer.kind == Kind::retentive_timer};
  if (is_fx3) kind = fx3_timer(timer.number);
  if (kind.unit == 0) return operand_error(timer, "expected T0 to T511");
  const std::string letters = timer.kind == Kind::retentive_timer ? "ST" : "T";
  const std::string number = std::to_string(timer.number);
  auto contact = named(letters + "S" + number, timer);
  if (!contact) return;
  auto coil = named(letters + "C" + number, timer);
  auto value = named(letters + "N" + number, timer);
  const auto setting = load(operands_[1], is_fx3 ? Elementary::int_ : Elementary::uint);
  if (!coil || !value || !setting) return;
  if (!timer.index.empty()) return operand_error(timer, "expected a timer without an index register");
  contact->form = coil->form = DeviceAccess::Form::bit;
  const std::uint32_t slots =
      record({0, 0, add_device(std::move(*contact)), add_device(std::move(*coil)),
              add_device(std::move(*value)), static_cast<Slot>(kind.unit), kind.is_retentive ? 1U : 0U, 0});
  members_.push_back({.name = "OUT T" + number + " #" + std::to_string(++members_named_["OUT T" + number]),
                      .offset = slots + 8,
                      .kind = program::MemberKind::hidden});
  emit(Opcode::move, slots + 1, when);
  emit(Opcode::move, slots + 2, *setting);
  native(functions::timer, slots);
}

void ListCompiler::out_counter(const Operand& counter, std::uint32_t when) {
  const bool is_fx3 = shared_.family == Family::fx3;
  const bool is_long = is_fx3 && counter.number >= first_long_counter;
  if (is_fx3 && counter.number >= first_high_speed_counter)
    return operand_error(counter, "expected C0 to C234: there are no inputs of high-speed counters");
  if (!counter.index.empty()) return operand_error(counter, "expected a counter without an index register");
  const std::string number = std::to_string(counter.number);
  auto contact = named("CS" + number, counter);
  if (!contact) return;
  auto coil = named("CC" + number, counter);
  auto value = named("CN" + number, counter);
  const auto setting = load(operands_[1], is_long  ? Elementary::dint
                                          : is_fx3 ? Elementary::int_
                                                   : Elementary::uint);
  if (!coil || !value || !setting) return;
  contact->form = coil->form = DeviceAccess::Form::bit;
  const std::uint32_t slots = record({0, 0, add_device(std::move(*contact)), add_device(std::move(*coil)),
                                      add_device(std::move(*value)), 0, 0});
  emit(Opcode::move, slots + 1, when);
  emit(Opcode::move, slots + 2, *setting);
  if (!is_long) return native(functions::counter, slots);
  auto high = named("HCN" + std::to_string(counter.number - first_long_counter), counter);
  auto direction = named("M8" + number, counter);  // M8200 to M8234
  if (!high || !direction || shared_.is_too_large) return;
  direction->form = DeviceAccess::Form::bit;
  image_[slots + 6] = add_device(std::move(*high));
  image_[slots + 7] = add_device(std::move(*direction));
  native(functions::counter_32, slots);
}

void ListCompiler::set_or_reset(bool is_set) {
  if (!is_set) return (void)reset(operands_[0]);
  if (operands_[0].kind == Kind::timer || operands_[0].kind == Kind::retentive_timer ||
      operands_[0].kind == Kind::counter)
    return operand_error(operands_[0], "expected a bit device");
  (void)store_bit(operands_[0], constant(1));
}

bool ListCompiler::reset(const Operand& operand) {
  const std::uint32_t zero = constant(0);
  const bool is_timer = operand.kind == Kind::timer || operand.kind == Kind::retentive_timer;
  if (is_timer || operand.kind == Kind::counter) {
    const bool is_long = shared_.family == Family::fx3 && operand.kind == Kind::counter &&
                         operand.number >= first_long_counter;
    return store_bit(operand, zero) && store(operand, is_long ? Elementary::dint : Elementary::int_, zero);
  }
  if (operand.kind == Kind::index_register) return store(operand, Elementary::int_, zero);
  if (operand.kind == Kind::variable) return store(operand, operand.type, zero);
  if (operand.bit >= 0) return store_bit(operand, zero);
  const auto point = shared_.devices.point(operand.name);
  if (point && !point->is_bit && operand.digits == 0) return store(operand, Elementary::int_, zero);
  return store_bit(operand, zero);
}

void ListCompiler::shift_device() {
  auto above = bit_access(operands_[0]);
  if (!above) return;
  if (!operands_[0].index.empty())
    return operand_error(operands_[0], "expected a bit without an index register");
  DeviceAccess below = *above;
  const bool is_bit_of_word = below.form == DeviceAccess::Form::bit_of_word;
  if (is_bit_of_word ? below.count == 0 : below.point.number == 0)
    return operand_error(operands_[0], "expected a bit that another one is below");
  if (is_bit_of_word)
    --below.count;
  else
    --below.point.number;
  const std::uint32_t value = temporary();
  const std::uint32_t device = add_device(std::move(below));
  emit(Opcode::read_device, value, device);
  emit(Opcode::write_device, add_device(std::move(*above)), value);
  emit(Opcode::write_device, device, constant(0));
}

// Values

bool ListCompiler::store_behind(const Operand& operand, unsigned points, Elementary type,
                                std::uint32_t value) {
  if (operand.kind == Kind::index_register) {
    Operand next = operand;
    next.number += points;
    if (next.number < 16) return store(next, type, value);
    operand_error(operand, "expected a register that others are behind");
    return false;
  }
  auto to = type == Elementary::boolean ? bit_access(operand) : access(operand, type);
  if (!to) return false;
  if (to->form != DeviceAccess::Form::bit_of_word) {
    to->point.number += points;
  } else if (to->count + points > 15) {
    operand_error(operand, "expected a bit that " + std::to_string(points) + " more are above");
    return false;
  } else {
    to->count = static_cast<std::uint8_t>(to->count + points);
  }
  return store_access(std::move(*to), operand.index, value);
}

void ListCompiler::arithmetic(const NamedInstruction& named, Elementary type) {
  const bool has_two = operands_.size() == 2;
  const Operand& target = operands_.back();
  const auto a = load(has_two ? operands_[1] : operands_[0], type);
  const auto b = load(has_two ? operands_[0] : operands_[1], type);
  if (!a || !b) return;
  const bool is_second = named.variant == 1;  // - or /
  const bool multiplies = named.instruction->action == Action::real_multiply;
  Opcode code = Opcode::add_i16;
  switch (type) {
    case Elementary::real:
      code = multiplies ? (is_second ? Opcode::div_real : Opcode::mul_real)
                        : (is_second ? Opcode::sub_real : Opcode::add_real);
      break;
    case Elementary::lreal:
      code = multiplies ? (is_second ? Opcode::div_lreal : Opcode::mul_lreal)
                        : (is_second ? Opcode::sub_lreal : Opcode::add_lreal);
      break;
    case Elementary::dint: code = is_second ? Opcode::sub_i32 : Opcode::add_i32; break;
    case Elementary::uint: code = is_second ? Opcode::sub_u16 : Opcode::add_u16; break;
    case Elementary::udint: code = is_second ? Opcode::sub_u32 : Opcode::add_u32; break;
    default: code = is_second ? Opcode::sub_i16 : Opcode::add_i16; break;
  }
  const std::uint32_t result = temporary();
  emit(code, result, *a, *b);
  (void)store(target, type, result);
}

// A product has twice the width; the remainder of a quotient stands behind it, but for digits of a bit device.
void ListCompiler::multiply(bool divides, Elementary type) {
  const auto a = load(operands_[0], type);
  const auto b = load(operands_[1], type);
  if (!a || !b) return;
  const bool is_double = type == Elementary::dint || type == Elementary::udint;
  const bool is_signed = type == Elementary::int_ || type == Elementary::dint;
  const std::uint32_t result = temporary();
  const Operand& target = operands_[2];
  if (!divides) {
    emit(is_signed ? Opcode::mul_i64 : Opcode::mul_u64, result, *a, *b);
    const bool is_narrow = target.digits != 0 || target.kind == Kind::index_register;
    const Elementary wide = is_double ? (is_narrow ? Elementary::dint : Elementary::lint) : Elementary::dint;
    return (void)store(target, wide, result);
  }
  emit(is_signed ? Opcode::div_i64 : Opcode::div_u64, result, *a, *b);
  const std::uint32_t remainder = temporary();
  emit(is_signed ? Opcode::mod_i64 : Opcode::mod_u64, remainder, *a, *b);
  if (!store(target, type, result) || target.digits != 0) return;
  (void)store_behind(target, is_double ? 2 : 1, type, remainder);
}

void ListCompiler::logic(unsigned variant, Elementary type) {
  const bool has_two = operands_.size() == 2;
  const auto a = load(has_two ? operands_[1] : operands_[0], type);
  const auto b = load(has_two ? operands_[0] : operands_[1], type);
  if (!a || !b) return;
  const std::uint32_t result = temporary();
  emit(variant == 0 ? Opcode::bit_and : variant == 1 ? Opcode::bit_or : Opcode::bit_xor, result, *a, *b);
  if (variant == 3) emit(Opcode::bit_xor, result, result, constant(~Slot{0}));
  (void)store(operands_.back(), type, result);
}

void ListCompiler::values(const NamedInstruction& named, Elementary type) {
  const bool is_double = type == Elementary::dint;
  const Operand& first = operands_.front();
  const Operand& last = operands_.back();
  const std::uint32_t result = temporary();
  switch (named.instruction->action) {
    case Action::move:
      if (const auto value = load(first, type)) (void)store(last, type, *value);
      return;
    case Action::complement:
      if (const auto value = load(first, type)) {
        emit(Opcode::bit_xor, result, *value, constant(~Slot{0}));
        (void)store(last, type, result);
      }
      return;
    case Action::negate:
    case Action::increment:
    case Action::decrement:
      if (const auto value = load(first, type)) {
        if (named.instruction->action == Action::negate)
          emit(is_double ? Opcode::neg_i32 : Opcode::neg_i16, result, *value);
        else if (named.instruction->action == Action::increment)
          emit(is_double ? Opcode::add_i32 : Opcode::add_i16, result, *value, constant(1));
        else
          emit(is_double ? Opcode::sub_i32 : Opcode::sub_i16, result, *value, constant(1));
        (void)store(first, type, result);
      }
      return;
    case Action::exchange: {
      const auto a = load(first, type);
      const auto b = load(last, type);
      if (a && b && store(first, type, *b)) (void)store(last, type, *a);
      return;
    }
    case Action::swap_bytes:
      if (const auto value = load(first, Elementary::word)) {
        const std::uint32_t high = temporary();
        emit(Opcode::shl, high, *value, constant(8));
        emit(Opcode::shr, result, *value, constant(8));
        emit(Opcode::bit_or, result, result, high);
        (void)store(first, Elementary::word, result);
      }
      return;
    case Action::to_bcd:
    case Action::from_bcd: {
      const bool is_to = named.instruction->action == Action::to_bcd;
      const Elementary bits = is_double ? Elementary::dword : Elementary::word;
      const auto value = load(first, is_to ? type : bits);
      if (!value) return;
      const std::uint32_t slots = record({0, is_double ? 8U : 4U});
      emit(Opcode::move, slots + 1, *value);
      native(is_to ? functions::to_bcd : functions::from_bcd, slots);
      (void)store(last, is_to ? bits : type, slots);
      return;
    }
    case Action::to_real:
      if (const auto value = load(first, type)) {
        emit(Opcode::from_int_real, result, *value);
        (void)store(last, Elementary::real, result);
      }
      return;
    case Action::from_real:
    case Action::truncate_real: {
      const bool is_long = (named.forms & with_double) != 0 || letters_.ends_with('L');
      const Elementary to = is_long ? Elementary::dint : Elementary::int_;
      if (const auto value = load(first, Elementary::real)) {
        emit(named.instruction->action == Action::from_real ? Opcode::round_real : Opcode::trunc_real, result,
             *value, 0, static_cast<std::uint16_t>(to));
        (void)store(last, to, result);
      }
      return;
    }
    default: error(text_->instructions[row_].name + ": not compiled"); return;
  }
}

void ListCompiler::calculation(Action action, Elementary type) {
  const bool is_double = type == Elementary::dint || type == Elementary::udint;
  const bool has_no_sign = type == Elementary::uint || type == Elementary::udint;
  if (action == Action::mean) {
    const auto from = located(operands_[0], Elementary::word);
    const auto count = load(operands_[2], Elementary::int_);
    if (!from || !count) return;
    const Slot most = shared_.family == Family::fx3 ? 64 : 32'767;
    const std::uint32_t slots = record({0, 0, 0, is_double ? 2U : 1U, most, has_no_sign ? 1U : 0U});
    locate(slots, 1, *from);
    emit(Opcode::move, slots + 3, *count);
    native(functions::mean, slots);
    return (void)store(operands_[1], type, slots);
  }
  if (action == Action::count_bits) {
    const auto value = load(operands_[0], is_double ? Elementary::dword : Elementary::word);
    if (!value) return;
    const std::uint32_t slots = record({0});
    emit(Opcode::move, slots + 1, *value);
    native(functions::count_bits, slots);
    if (!store(operands_[1], letters_.ends_with('W') ? Elementary::int_ : type, slots)) return;
    if (shared_.family != Family::fx3) return;
    auto zero = named("M8020", operands_[0]);
    if (!zero) return;
    zero->form = DeviceAccess::Form::bit;
    zero->type = Elementary::boolean;
    const std::uint32_t is_zero = temporary();
    emit(Opcode::eq, is_zero, slots, constant(0));
    emit(Opcode::write_device, add_device(std::move(*zero)), is_zero);
    return;
  }
  std::vector<std::uint32_t> values;
  for (std::size_t i = 0; i + 1 < operands_.size(); ++i) {
    const auto value = load(operands_[i], type);
    if (!value) return;
    values.push_back(*value);
  }
  const std::uint32_t slots = record({0, 0, 0});
  for (std::size_t i = 0; i < values.size(); ++i)
    emit(Opcode::move, slots + 1 + static_cast<std::uint32_t>(i), values[i]);
  native(action == Action::limit    ? functions::limit
         : type == Elementary::real ? program::native_named("SQRT_REAL")
                                    : functions::square_root,
         slots);
  (void)store(operands_.back(), type, slots);
}

void ListCompiler::compare_to_bits(bool is_zone, Elementary type) {
  const auto low = load(operands_[0], type);
  const auto high = load(operands_[is_zone ? 1 : 0], type);
  const auto value = load(operands_[is_zone ? 2 : 1], type);
  if (!low || !high || !value) return;
  // CMP: greater, equal, less than the second one. ZCP: the value below, within, above.
  store_comparison(*low, *high, *value);
}

void ListCompiler::store_comparison(std::uint32_t low, std::uint32_t high, std::uint32_t value) {
  const std::uint32_t first = temporary();
  const std::uint32_t third = temporary();
  const std::uint32_t second = temporary();
  emit(Opcode::lt, first, value, low);
  emit(Opcode::lt, third, high, value);
  emit(Opcode::bit_or, second, first, third);
  emit(Opcode::bit_xor, second, second, constant(1));
  unsigned points = 0;
  for (const std::uint32_t slot : {first, second, third}) {
    if (!store_behind(operands_.back(), points++, Elementary::boolean, slot)) return;
  }
}

// Shift

// What leaves the word last is the carry: SM700, M8022 of an FX3.
void ListCompiler::rotate(unsigned rotation, unsigned bits, Elementary type) {
  const auto value = load(operands_[0], type);
  const auto count = load(operands_[1], Elementary::int_);
  if (!value || !count) return;
  const std::uint32_t slots = record({0, 0, bits, rotation, 0});
  emit(Opcode::move, slots + 1, *value);
  emit(Opcode::move, slots + 2, *count);
  const auto carry = shared_.devices.point(shared_.family == Family::fx3 ? "M8022" : "SM700");
  std::uint32_t device = 0;
  if (carry) {
    DeviceAccess access{.point = *carry, .form = DeviceAccess::Form::bit, .type = Elementary::boolean};
    access.text = "carry";
    device = add_device(std::move(access));
    emit(Opcode::read_device, slots + 5, device);
  }
  native(functions::rotate, slots);
  if (!store(operands_[0], type, slots) || !carry) return;
  emit(Opcode::write_device, device, slots + 5);
}

void ListCompiler::shift_in(bool has_source, bool is_left, bool of_words) {
  const Elementary type = of_words ? Elementary::word : Elementary::boolean;
  const std::uint32_t slots = record({functions::none, 0, 0, 0, 0, 1, is_left ? 1U : 0U});
  const Operand& row = operands_[has_source ? 1 : 0];
  const auto to = located(row, type);
  const auto count = load(operands_[has_source ? 2 : 1], Elementary::int_);
  if (!to || !count) return;
  if (has_source) {
    const auto from = located(operands_[0], type);
    const auto by = load(operands_[3], Elementary::int_);
    if (!from || !by) return;
    locate(slots, 1, *from);
    emit(Opcode::move, slots + 6, *by);
  }
  locate(slots, 3, *to);
  emit(Opcode::move, slots + 5, *count);
  native(functions::shift_in, slots);
}

// Blocks

void ListCompiler::block_instruction(const NamedInstruction& named, Elementary type) {
  const Action action = named.instruction->action;
  if (action == Action::block_move) {
    const auto from = located(operands_[0], Elementary::word);
    const auto to = located(operands_[1], Elementary::word);
    const auto count = load(operands_[2], Elementary::int_);
    if (!from || !to || !count) return;
    const std::uint32_t slots = record({0, 0, 0, 0, 0});
    locate(slots, 1, *from);
    locate(slots, 3, *to);
    emit(Opcode::move, slots + 5, *count);
    return native(functions::block_move, slots);
  }
  const auto fill = [&](const Operand& target, Elementary element, std::uint32_t value, std::uint32_t count,
                        unsigned words) {
    const auto to = located(target, element);
    if (!to) return;
    const std::uint32_t slots = record({0, 0, 0, 0, words});
    emit(Opcode::move, slots + 1, value);
    locate(slots, 2, *to);
    emit(Opcode::move, slots + 4, count);
    native(functions::fill, slots);
  };
  if (action == Action::fill_move) {
    const auto value = load(operands_[0], type);
    const auto count = load(operands_[2], Elementary::int_);
    if (value && count)
      fill(operands_[1], Elementary::word, *value, *count, type == Elementary::dint ? 2 : 1);
    return;
  }
  if (action == Action::reset_block) {
    if (const auto count = load(operands_[1], Elementary::int_))
      fill(operands_[0], Elementary::boolean, constant(0), *count, 1);
    return;
  }
  // ZRST: from one device to another one.
  const Operand& first = operands_[0];
  const Operand& last = operands_[1];
  const auto point_of = [&](const Operand& operand) -> std::optional<program::DevicePoint> {
    const bool is_named = operand.kind == Kind::device;
    const std::string letters = operand.kind == Kind::timer             ? "TN"
                                : operand.kind == Kind::retentive_timer ? "STN"
                                                                        : "CN";
    if (!is_named && operand.kind != Kind::timer && operand.kind != Kind::retentive_timer &&
        operand.kind != Kind::counter) {
      operand_error(operand, "expected a device");
      return std::nullopt;
    }
    const auto found =
        shared_.devices.point(is_named ? operand.name : letters + std::to_string(operand.number));
    if (!found) operand_error(operand, found.error());
    return found ? std::optional(*found) : std::nullopt;
  };
  const auto a = point_of(first);
  const auto b = point_of(last);
  if (!a || !b) return;
  if (a->device != b->device || a->is_buffer || b->is_buffer || b->number < a->number ||
      !first.index.empty() || !last.index.empty())
    return operand_error(last, "expected a device of the same kind with a number from the first one's on");
  const std::uint32_t count = constant(b->number - a->number + 1);
  const std::uint32_t zero = constant(0);
  if (first.kind == Kind::device)
    return fill(first, a->is_bit ? Elementary::boolean : Elementary::word, zero, count, 1);
  fill(first, Elementary::boolean, zero, count, 1);
  fill(first, Elementary::word, zero, count, 1);
  if (shared_.family == Family::fx3 && first.kind == Kind::counter && last.number >= first_long_counter) {
    Operand high = first;
    high.kind = Kind::device;
    const std::uint32_t from = std::max(first.number, first_long_counter);
    high.name = "HCN" + std::to_string(from - first_long_counter);
    fill(high, Elementary::word, zero, constant(last.number - from + 1), 1);
  }
}

// Modules

void ListCompiler::module_access(bool writes, bool is_double) {
  const auto module = load(operands_[0], Elementary::uint);
  const auto address = load(operands_[1], Elementary::uint);
  const auto count = load(operands_[3], Elementary::int_);
  if (!module || !address || !count) return;
  const std::uint32_t slots = record({0, 0, functions::none, 0, 0, is_double ? 2U : 1U, 0});
  emit(Opcode::move, slots + 1, *module);
  emit(Opcode::move, slots + 2, *address);
  emit(Opcode::move, slots + 5, *count);
  const Operand& data = operands_[2];
  if (writes && (data.is_constant() || data.kind == Kind::index_register)) {
    const auto value = load(data, is_double ? Elementary::dint : Elementary::int_);
    if (!value) return;
    emit(Opcode::move, slots + 7, *value);
  } else {
    const auto found = located(data, Elementary::word);
    if (!found) return;
    locate(slots, 3, *found);
  }
  native(writes ? functions::to : functions::from, slots);
}

void ListCompiler::move_text() {
  const std::uint32_t slots = record({0, 0, 0, 0, 0, 0});
  const auto to = located(operands_[1], Elementary::word);
  if (!to || !text_argument(operands_[0], slots, 1)) return;
  locate(slots, 5, *to);
  native(functions::move_text, slots);
}

}  // namespace canopus::instruction_list
