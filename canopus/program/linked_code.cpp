#include "canopus/program/linked_code.hpp"

#include <algorithm>
#include <bit>
#include <optional>

#include "canopus/program/standard_timer.hpp"

namespace canopus::program {

namespace {

using Form = DeviceAccess::Form;

Instruction with_pointer(Opcode code, std::uint16_t extra, std::uint32_t a, const void* pointer) noexcept {
  const std::uint64_t bits = reinterpret_cast<std::uintptr_t>(pointer);
  return {code, extra, a, static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32U)};
}

// Devices

DeviceMemory memory_of(const DeviceAccess& access, DeviceImage& devices) {
  if (access.is_indexed || access.point.is_buffer) return {};
  switch (access.form) {
    case Form::bit: return {.bit = devices.bit_in_memory(access.point)};
    case Form::bit_of_word: return {.words = devices.words_in_memory(access.point, 1)};
    case Form::words: return {.words = devices.words_in_memory(access.point, access.count)};
    case Form::points: break;
  }
  return {};
}

/// How words are read as a value of a type.
std::optional<Opcode> load_of(const DeviceAccess& access) {
  const ElementaryInfo& kind = info(access.type);
  const bool has_sign = kind.family == Family::signed_integer && kind.bits < 64;
  if (has_sign && kind.bits != 16U * access.count) return std::nullopt;
  switch (access.count) {
    case 1: return has_sign ? Opcode::load_i16 : Opcode::load_u16;
    case 2: return has_sign ? Opcode::load_i32 : Opcode::load_u32;
    case 4: return Opcode::load_u64;
    default: return std::nullopt;
  }
}

/// The same access to the memory; none: only the image has the device.
std::optional<Instruction> linked_read(const Instruction& original, const DeviceAccess& access,
                                       const DeviceMemory& at) {
  if (original.extra != 0) return std::nullopt;
  if (at.bit != nullptr) return with_pointer(Opcode::load_bit, 0, original.a, at.bit);
  if (at.words == nullptr) return std::nullopt;
  if (access.form == Form::bit_of_word)
    return with_pointer(Opcode::load_bit_of_word, access.count, original.a, at.words);
  if (const auto load = load_of(access)) return with_pointer(*load, 0, original.a, at.words);
  return std::nullopt;
}

std::optional<Instruction> linked_write(const Instruction& original, const DeviceAccess& access,
                                        const DeviceMemory& at) {
  if (original.extra != 0) return std::nullopt;
  if (at.bit != nullptr) return with_pointer(Opcode::store_bit, 0, original.b, at.bit);
  if (at.words == nullptr) return std::nullopt;
  if (access.form == Form::bit_of_word)
    return with_pointer(Opcode::store_bit_of_word, access.count, original.b, at.words);
  switch (access.count) {
    case 1: return with_pointer(Opcode::store_16, 0, original.b, at.words);
    case 2: return with_pointer(Opcode::store_32, 0, original.b, at.words);
    case 4: return with_pointer(Opcode::store_64, 0, original.b, at.words);
    default: return std::nullopt;
  }
}

Instruction linked_call(const Instruction& original, const Program& program) {
  const bool is_block = original.code == Opcode::call_block;
  const Function& function = program.functions[is_block ? original.b : original.a];
  return {is_block ? Opcode::enter_block : Opcode::enter, 0, is_block ? original.a : function.frame,
          function.entry, function.instructions};
}

// Bits

constexpr std::uint32_t no_frame = ~std::uint32_t{0};

/// The frame of each instruction; no_frame: it has several, one for each instance of a function block.
std::vector<std::uint32_t> frames_of(const Program& program) {
  std::vector<bool> is_block(program.functions.size());
  for (const Instruction& each : program.code)
    if (each.code == Opcode::call_block) is_block[each.b] = true;
  std::vector<std::uint32_t> frames(program.code.size(), no_frame);
  for (std::size_t number = 0; number < program.functions.size(); ++number) {
    const Function& function = program.functions[number];
    const std::size_t end = std::min(frames.size(), std::size_t{function.entry} + function.instructions);
    for (std::size_t at = function.entry; at < end; ++at)
      frames[at] = is_block[number] ? no_frame : function.frame;
  }
  return frames;
}

/// Functions of the bit alone and of the result before with it, as BitOperand has them.
constexpr std::uint32_t bit_itself = 0b1010;
constexpr std::uint32_t of_and = 0b1000;
constexpr std::uint32_t of_or = 0b1110;
constexpr std::uint32_t of_xor = 0b0110;

constexpr std::uint32_t inverted_result(std::uint32_t function) { return function ^ 0b1111U; }
constexpr std::uint32_t of_inverted_bit(std::uint32_t function) {
  return (function & 0b0101U) << 1U | (function & 0b1010U) >> 1U;
}

/// Instructions on bits, one after the other, whose results are used by the next one alone: LD AND ORI OUT of a list, and what expressions
/// of BOOL become. It takes them until one does not fit.
class BitRun {
 public:
  /// `frame`: nullptr, where slots have no fixed place.
  explicit BitRun(Slot* frame) : frame_(frame) {}

  /// False: it does not fit, and nothing is changed.
  bool take(const Instruction& next) {
    switch (next.code) {
      case Opcode::load_bit: return load(next.a, pointer_in<std::uint8_t>(next));
      case Opcode::bit_xor:
        if ((next.extra & is_inversion) != 0) return invert(next);
        return (next.extra & of_bool) != 0 && combine(next, of_xor);
      case Opcode::bit_and: return (next.extra & of_bool) != 0 && combine(next, of_and);
      case Opcode::bit_or: return (next.extra & of_bool) != 0 && combine(next, of_or);
      case Opcode::store_bit:
        if (!result_ || pending_ || next.a != *result_) return false;
        to_ = pointer_in<std::uint8_t>(next);
        return true;
      default: return false;
    }
  }
  /// Nothing is loaded that has not been combined.
  [[nodiscard]] bool is_whole() const noexcept { return result_ && !pending_; }
  /// It ends with an output.
  [[nodiscard]] bool has_ended() const noexcept { return to_ != nullptr; }
  [[nodiscard]] std::uint32_t result() const noexcept { return *result_; }
  [[nodiscard]] const std::vector<BitOperand>& operands() const noexcept { return operands_; }
  [[nodiscard]] std::uint8_t* to() const noexcept { return to_; }

 private:
  struct Pending {
    std::uint32_t slot;
    BitOperand operand;
  };

  [[nodiscard]] std::uint8_t* byte_of(std::uint32_t slot) const noexcept {
    return frame_ == nullptr ? nullptr : reinterpret_cast<std::uint8_t*>(frame_ + slot);
  }
  bool add(BitOperand operand) {
    if (operands_.size() == most_bit_operands) return false;
    operands_.push_back(operand);
    return true;
  }
  bool load(std::uint32_t slot, std::uint8_t* bit, std::uint32_t function = bit_itself) {
    if (!result_) {
      result_ = slot;
      return add({bit, function});
    }
    if (pending_ || slot == *result_) return false;
    pending_ = Pending{slot, {bit, function}};
    return true;
  }
  bool invert(const Instruction& next) {
    const bool is_last = next.a == next.b || (next.extra & b_is_last) != 0;
    if (result_ && !pending_ && next.b == *result_) {
      if (!is_last) return false;
      operands_.back().function = inverted_result(operands_.back().function);
      result_ = next.a;
      return true;
    }
    if (pending_ && next.b == pending_->slot) {
      if (!is_last || next.a == *result_) return false;
      pending_->slot = next.a;
      pending_->operand.function = of_inverted_bit(pending_->operand.function);
      return true;
    }
    std::uint8_t* const bit = byte_of(next.b);
    const bool is_of_run = result_ && next.b == *result_;
    return bit != nullptr && !is_of_run && load(next.a, bit, of_inverted_bit(bit_itself));
  }
  bool combine(const Instruction& next, std::uint32_t function) {
    if (!result_) {
      std::uint8_t* const b = byte_of(next.b);
      std::uint8_t* const c = byte_of(next.c);
      if (b == nullptr || c == nullptr) return false;
      result_ = next.a;
      return add({b, bit_itself}) && add({c, function});
    }
    const bool is_b = next.b == *result_;
    const std::uint32_t other = is_b ? next.c : next.b;
    const auto is_last = [&](bool of_b) {
      return (of_b ? next.b : next.c) == next.a || (next.extra & (of_b ? b_is_last : c_is_last)) != 0;
    };
    if ((!is_b && next.c != *result_) || other == *result_ || !is_last(is_b)) return false;
    BitOperand operand{byte_of(other), bit_itself};
    if (pending_) {
      if (other != pending_->slot || !is_last(!is_b)) return false;
      operand = pending_->operand;
    }
    if (operand.bit == nullptr) return false;
    const bool is_inverted = operand.function != bit_itself;
    if (!add({operand.bit, is_inverted ? of_inverted_bit(function) : function})) return false;
    pending_.reset();
    result_ = next.a;
    return true;
  }

  Slot* frame_;
  std::optional<std::uint32_t> result_{};
  std::optional<Pending> pending_{};
  std::vector<BitOperand> operands_{};
  std::uint8_t* to_ = nullptr;
};

// Rows

/// Instructions that are executed as one when they follow each other. The longest ones first.
struct Row {
  Opcode as;
  std::vector<Opcode> of;
};

const std::vector<Row>& rows() {
  using enum Opcode;
  static const std::vector<Row> all = {
      {load_load_add_store, {load_i16, load_i16, add_i16, store_16}},
      {load_load_sub_store, {load_i16, load_i16, sub_i16, store_16}},
      {load_add_store, {load_i16, add_i16, store_16}},
      {load_sub_store, {load_i16, sub_i16, store_16}},
      {load_eq_move, {load_i16, eq, move}},
      {load_ne_move, {load_i16, ne, move}},
      {load_lt_move, {load_i16, lt, move}},
      {load_le_move, {load_i16, le, move}},
      {load_store, {load_i16, store_16}},
      {load_bit_jump_unless, {load_bit, jump_unless}},
      {load_bit_jump_if, {load_bit, jump_if}},
      {eq_jump_unless, {eq, jump_unless}},
      {lt_jump_unless, {lt, jump_unless}},
      {move_move, {move, move}},
      {move_move_on_delay, {move, move, on_delay}},
      {element_address_store_at, {element_address, store_at}},
      {store_at_enter_block, {store_at, enter_block}},
      {eq_bit_or, {eq, bit_or}},
      {element_address_load_at, {element_address, load_at}},
  };
  return all;
}

constexpr bool is_jump(Opcode code) noexcept {
  using enum Opcode;
  return code == jump || (code >= jump_if && code <= jump_leu);
}

/// A jump to another one, or to one on the same condition, goes where that one goes; one to the end of a function is that end.
void shorten_jumps(std::span<Instruction> code, std::span<const std::uint32_t> frames) {
  for (std::size_t at = code.size(); at-- > 0;) {
    Instruction& jump = code[at];
    if (!is_jump(jump.code) || static_cast<std::int32_t>(jump.c) <= 0) continue;
    const std::size_t to = at + jump.c;
    if (to >= code.size() || frames[to] != frames[at]) continue;
    const bool is_of_same =
        jump.code == Opcode::jump_unless && code[to].code == Opcode::jump_unless && code[to].a == jump.a;
    if ((code[to].code == Opcode::jump && static_cast<std::int32_t>(code[to].c) > 0) || is_of_same)
      jump.c += code[to].c;
    if (jump.code == Opcode::jump && code[at + jump.c].code == Opcode::return_) jump = code[at + jump.c];
  }
}

}  // namespace

void LinkedCode::link(const Program& program, std::span<Slot> memory, DeviceImage* devices) {
  memory_ = memory.data();
  layout_ = layout_of(devices);
  code_ = program.code;
  operands_.clear();
  device_memory_.assign(program.devices.size(), {});
  for (std::size_t i = 0; devices != nullptr && i < program.devices.size(); ++i)
    device_memory_[i] = memory_of(program.devices[i], *devices);
  for (Instruction& each : code_) {
    std::optional<Instruction> linked;
    if (each.code == Opcode::read_device)
      linked = linked_read(each, program.devices[each.b], device_memory_[each.b]);
    if (each.code == Opcode::write_device)
      linked = linked_write(each, program.devices[each.a], device_memory_[each.a]);
    if (linked) each = *linked;
    if (each.code == Opcode::call || each.code == Opcode::call_block) each = linked_call(each, program);
    if (each.code == Opcode::native && program.natives[each.a] == on_delay) each.code = Opcode::on_delay;
  }
  const std::vector<std::uint32_t> frames = frames_of(program);
  shorten_jumps(code_, frames);
  for (std::size_t first = 0; first < code_.size();) {
    std::size_t behind = link_bits(first, frames, memory);
    if (behind == first) behind = link_row(first);
    first = behind;
  }
  for (Instruction& each : code_) {
    if (each.code >= Opcode::bits_1 && each.code <= Opcode::bits_8)
      each = with_pointer(each.code, each.extra, each.a, operands_.data() + each.b);
  }
}

std::size_t LinkedCode::link_row(std::size_t first) {
  const std::span<const Instruction> rest = std::span(code_).subspan(first);
  for (const Row& row : rows()) {
    const std::size_t count = row.of.size();
    if (rest.size() < count || !std::ranges::equal(rest.first(count), row.of, {}, &Instruction::code))
      continue;
    code_[first].code = row.as;
    return first + count;
  }
  return first + 1;
}

std::size_t LinkedCode::link_bits(std::size_t first, std::span<const std::uint32_t> frames,
                                  std::span<Slot> memory) {
  if constexpr (std::endian::native != std::endian::little)
    return first;  // a BOOL is the first byte of its slot
  Slot* const frame = frames[first] == no_frame ? nullptr : memory.data() + frames[first];
  BitRun run(frame);
  std::optional<BitRun> longest;
  std::size_t behind = first + 1;
  for (std::size_t at = first; at < code_.size() && frames[at] == frames[first]; ++at) {
    if (!run.take(code_[at])) break;
    if (!run.is_whole() || (frame == nullptr && !run.has_ended())) continue;
    longest = run;
    behind = at + 1;
    if (run.has_ended()) break;
  }
  if (behind - first < 2) return first;
  const auto place = static_cast<std::uint32_t>(operands_.size());
  operands_.insert(operands_.end(), longest->operands().begin(), longest->operands().end());
  std::uint8_t* const result = reinterpret_cast<std::uint8_t*>(frame + longest->result());
  operands_.push_back({longest->has_ended() ? longest->to() : result, 0});
  const std::size_t count = longest->operands().size();
  code_[first] = {static_cast<Opcode>(static_cast<std::size_t>(Opcode::bits_1) + count - 1),
                  static_cast<std::uint16_t>(behind - first), longest->result(), place};
  return behind;
}

}  // namespace canopus::program
