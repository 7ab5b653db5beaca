// Values of operands: constants, devices, timers and counters, index registers.

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "canopus/instruction_list/device_functions.hpp"
#include "canopus/instruction_list/list_compiler.hpp"

namespace canopus::instruction_list {

using program::DataType;
using program::DeviceAccess;
using AccessForm = DeviceAccess::Form;
using Kind = Operand::Kind;

namespace {

std::uint8_t words_of(program::Elementary type) {
  return static_cast<std::uint8_t>((program::info(type).bits + 15) / 16);
}

bool is_long_counter(const Operand& operand, Family family) {
  return family == Family::fx3 && operand.kind == Kind::counter && operand.number >= first_long_counter;
}

}  // namespace

std::optional<DeviceAccess> ListCompiler::named(std::string name, const Operand& operand) {
  const auto point = shared_.devices.point(name);
  if (!point) {
    operand_error(operand, point.error());
    return std::nullopt;
  }
  DeviceAccess made;
  made.point = *point;
  made.text = operand.written;
  return made;
}

// A timer or counter is its value where a word is wanted, and its contact where a bit is.
std::optional<DeviceAccess> ListCompiler::access(const Operand& operand, Elementary type) {
  std::string name = operand.name;
  const std::string number = std::to_string(operand.number);
  if (operand.kind == Kind::timer) name = "TN" + number;
  if (operand.kind == Kind::retentive_timer) name = "STN" + number;
  if (operand.kind == Kind::counter) name = "CN" + number;
  if (operand.kind == Kind::text) {
    operand_error(operand, "expected a device or a number, not a text");
    return std::nullopt;
  }
  if (operand.kind == Kind::variable) {
    operand_error(operand, "it is a variable; expected a device, or a label that has one");
    return std::nullopt;
  }
  if (operand.bit >= 0) {
    operand_error(operand, "expected a word, not a bit of one");
    return std::nullopt;
  }
  auto made = named(std::move(name), operand);
  if (!made) return made;
  made->type = type;
  made->count = words_of(type);
  if (made->point.is_bit != (operand.digits != 0)) {
    operand_error(operand, operand.digits != 0
                               ? "expected a bit device behind the digits"
                               : "expected a word device, or digits before the bit device such as K4M0");
    return std::nullopt;
  }
  if (operand.digits == 0) return made;
  if (operand.digits > 4U * made->count || made->count > 2) {
    operand_error(operand,
                  "expected at most K" + std::to_string(4 * std::min<unsigned>(made->count, 2)) + " here");
    return std::nullopt;
  }
  made->form = AccessForm::points;
  made->count = static_cast<std::uint8_t>(4 * operand.digits);
  return made;
}

std::optional<DeviceAccess> ListCompiler::bit_access(const Operand& operand) {
  std::string name = operand.name;
  const std::string number = std::to_string(operand.number);
  if (operand.kind == Kind::timer) name = "TS" + number;
  if (operand.kind == Kind::retentive_timer) name = "STS" + number;
  if (operand.kind == Kind::counter) name = "CS" + number;
  if (operand.kind == Kind::variable) {
    operand_error(operand, "it is a variable; expected a device, or a label that has one");
    return std::nullopt;
  }
  if (operand.is_constant() || operand.kind == Kind::text || operand.kind == Kind::index_register ||
      operand.digits != 0) {
    operand_error(operand, "expected a bit device, or a bit of a word such as D0.5");
    return std::nullopt;
  }
  auto made = named(std::move(name), operand);
  if (!made) return made;
  made->type = Elementary::boolean;
  if (made->point.is_bit && operand.bit < 0) {
    made->form = AccessForm::bit;
    made->count = 1;
  } else if (!made->point.is_bit && operand.bit >= 0) {
    made->form = AccessForm::bit_of_word;
    made->count = static_cast<std::uint8_t>(operand.bit);
  } else {
    operand_error(operand, "expected a bit device, or a bit of a word such as D0.5");
    return std::nullopt;
  }
  return made;
}

std::uint32_t ListCompiler::index_register_place(std::uint32_t number) {
  if (!shared_.index_registers) {
    shared_.index_registers = place_in_memory(8);
    program::Program& program = shared_.program;
    program.types.push_back({.form = DataType::Form::elementary, .base = Elementary::int_, .name = "INT"});
    for (std::uint32_t i = 0; i < 8; ++i)
      program.symbols.push_back({.name = "V" + std::to_string(i),
                                 .type = &program.types.back(),
                                 .place = *shared_.index_registers + i});
  }
  return *shared_.index_registers + number - 8;
}

/// Z0 to Z7, as a word.
std::optional<program::DeviceAccess> ListCompiler::index_register(const Operand& operand) {
  auto access = named("Z" + std::to_string(operand.number), operand);
  if (!access) return std::nullopt;
  access->type = Elementary::int_;
  access->count = 1;
  return access;
}

// Z0 to Z7 are those of the CPU, which a program in Structured Text has, too; V0 to V7 are in lists alone.
bool ListCompiler::load_index_register(const Operand& operand, std::uint32_t into) {
  if (operand.number > 7) {
    emit(Opcode::load_global, into, index_register_place(operand.number));
    return true;
  }
  auto access = index_register(operand);
  if (!access) return false;
  emit(Opcode::read_device, into, add_device(std::move(*access)));
  return true;
}

bool ListCompiler::store_index_register(const Operand& operand, std::uint32_t value) {
  if (operand.number > 7) {
    emit(Opcode::store_global, index_register_place(operand.number), value);
    return true;
  }
  auto access = index_register(operand);
  if (!access) return false;
  emit(Opcode::write_device, add_device(std::move(*access)), value);
  return true;
}

std::optional<std::uint32_t> ListCompiler::index_value(const std::string& register_name) {
  const auto operand = parse_operand(register_name, shared_.family);
  if (!operand) {
    error(operand.error());
    return std::nullopt;
  }
  return load(*operand, Elementary::int_);
}

std::optional<ListCompiler::Slot> ListCompiler::constant_value(const Operand& operand, Elementary type) {
  const bool is_real = type == Elementary::real || type == Elementary::lreal;
  if (operand.kind == Kind::real && !is_real) {
    operand_error(operand, "expected a whole number here, such as K10");
    return std::nullopt;
  }
  if (is_real) {
    const double value = operand.kind == Kind::real ? operand.real : static_cast<double>(operand.value);
    if (type == Elementary::lreal) return std::bit_cast<Slot>(value);
    if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
      operand_error(operand, "expected a number of the range of REAL");
      return std::nullopt;
    }
    return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  }
  const unsigned bits = program::info(type).bits;
  const bool is_signed = program::info(type).family == program::Family::signed_integer;
  const std::int64_t half = std::int64_t{1} << (bits - 1);
  const std::int64_t low = is_signed && !operand.is_hexadecimal ? -half : 0;
  const std::int64_t high = is_signed && !operand.is_hexadecimal ? half - 1 : 2 * half - 1;
  if (operand.value < low || operand.value > high) {
    const auto text = [&](std::int64_t value) {
      if (!operand.is_hexadecimal) return 'K' + std::to_string(value);
      return value == 0 ? std::string("H0") : 'H' + std::string(bits / 4, 'F');
    };
    operand_error(operand, "expected " + text(low) + " to " + text(high));
    return std::nullopt;
  }
  const std::int64_t value = is_signed && operand.value >= half ? operand.value - 2 * half : operand.value;
  return static_cast<Slot>(value);
}

std::optional<std::uint32_t> ListCompiler::load_access(DeviceAccess access, const std::string& index,
                                                       std::optional<std::uint32_t> into) {
  if (index.empty()) {
    const std::uint32_t to = into ? *into : temporary();
    emit(Opcode::read_device, to, add_device(std::move(access)));
    return to;
  }
  const auto offset = index_value(index);
  if (!offset) return std::nullopt;
  const std::uint32_t record_slot = record({add_device(std::move(access)), 0});
  emit(Opcode::move, record_slot + 2, *offset);
  native(device_functions::read_indexed, record_slot);
  if (into) emit(Opcode::move, *into, record_slot);
  return into ? *into : record_slot;
}

std::optional<std::uint32_t> ListCompiler::load_bit(const Operand& operand,
                                                    std::optional<std::uint32_t> into) {
  if (operand.kind == Kind::variable) {
    const auto value = load_variable(operand, Elementary::boolean);
    if (value && into) emit(Opcode::move, *into, *value);
    return value && into ? into : value;
  }
  auto from = bit_access(operand);
  if (!from) return std::nullopt;
  return load_access(std::move(*from), operand.index, into);
}

std::optional<std::uint32_t> ListCompiler::load(const Operand& operand, Elementary type) {
  if (operand.is_constant()) {
    const auto value = constant_value(operand, type);
    if (!value) return std::nullopt;
    const std::uint32_t slot = constant(*value);
    if (operand.index.empty()) return slot;
    const auto offset = index_value(operand.index);
    if (!offset) return std::nullopt;
    const std::uint32_t sum = temporary();
    emit(type == Elementary::int_ ? Opcode::add_i16 : Opcode::add_i32, sum, slot, *offset);
    return sum;
  }
  if (operand.kind == Kind::variable) return load_variable(operand, type);
  const std::uint8_t words = words_of(type);
  if (operand.kind == Kind::index_register) {
    const std::uint32_t low = temporary();
    if (!load_index_register(operand, low)) return std::nullopt;
    if (words == 1) return low;
    if (words > 2 || operand.number > 7) {
      operand_error(operand, "expected Z0 to Z7 for 32 bits, which are V and Z of that number");
      return std::nullopt;
    }
    const std::uint32_t high = temporary();
    emit(Opcode::load_global, high, index_register_place(operand.number + 8));
    emit(Opcode::shl, high, high, constant(16));
    emit(Opcode::wrap_u16, low, low);
    emit(Opcode::bit_or, high, high, low);
    emit(Opcode::wrap_i32, high, high);
    return high;
  }
  if (is_long_counter(operand, shared_.family) && words == 2) {
    auto low = named("CN" + std::to_string(operand.number), operand);
    auto high = named("HCN" + std::to_string(operand.number - first_long_counter), operand);
    if (!low || !high) return std::nullopt;
    low->type = high->type = Elementary::word;
    high->type = Elementary::int_;
    const auto a = load_access(std::move(*low), operand.index);
    const auto b = load_access(std::move(*high), operand.index);
    if (!a || !b) return std::nullopt;
    const std::uint32_t whole = temporary();
    emit(Opcode::shl, whole, *b, constant(16));
    emit(Opcode::bit_or, whole, whole, *a);
    return whole;
  }
  auto from = access(operand, type);
  if (!from) return std::nullopt;
  return load_access(std::move(*from), operand.index);
}

bool ListCompiler::store_access(DeviceAccess access, const std::string& index, std::uint32_t value) {
  if (index.empty()) {
    emit(Opcode::write_device, add_device(std::move(access)), value);
    return true;
  }
  const auto offset = index_value(index);
  if (!offset) return false;
  const std::uint32_t record_slot = record({add_device(std::move(access)), 0, 0});
  emit(Opcode::move, record_slot + 2, *offset);
  emit(Opcode::move, record_slot + 3, value);
  native(device_functions::write_indexed, record_slot);
  return true;
}

bool ListCompiler::store_bit(const Operand& operand, std::uint32_t value) {
  if (operand.kind == Kind::variable) return store_variable(operand, Elementary::boolean, value);
  auto to = bit_access(operand);
  return to && store_access(std::move(*to), operand.index, value);
}

bool ListCompiler::store(const Operand& operand, Elementary type, std::uint32_t value) {
  if (operand.kind == Kind::variable) return store_variable(operand, type, value);
  const std::uint8_t words = words_of(type);
  if (operand.kind == Kind::index_register) {
    const std::uint32_t low = temporary();
    emit(Opcode::wrap_i16, low, value);
    if (!store_index_register(operand, low)) return false;
    if (words == 1) return true;
    if (words > 2 || operand.number > 7) {
      operand_error(operand, "expected Z0 to Z7 for 32 bits, which are V and Z of that number");
      return false;
    }
    emit(Opcode::shr, low, value, constant(16));
    emit(Opcode::wrap_i16, low, low);
    emit(Opcode::store_global, index_register_place(operand.number + 8), low);
    return true;
  }
  if (is_long_counter(operand, shared_.family) && words == 2) {
    auto low = named("CN" + std::to_string(operand.number), operand);
    auto high = named("HCN" + std::to_string(operand.number - first_long_counter), operand);
    if (!low || !high) return false;
    const std::uint32_t part = temporary();
    emit(Opcode::shr, part, value, constant(16));
    return store_access(std::move(*low), operand.index, value) &&
           store_access(std::move(*high), operand.index, part);
  }
  auto to = access(operand, type);
  return to && store_access(std::move(*to), operand.index, value);
}

std::optional<ListCompiler::Located> ListCompiler::located(const Operand& operand, Elementary type) {
  if (operand.kind == Kind::index_register || operand.is_constant()) {
    operand_error(operand, "expected a device that others follow");
    return std::nullopt;
  }
  auto found = type == Elementary::boolean ? bit_access(operand) : access(operand, type);
  if (!found) return std::nullopt;
  Located made{add_device(std::move(*found)), {}};
  if (!operand.index.empty()) {
    made.offset = index_value(operand.index);
    if (!made.offset) return std::nullopt;
  }
  return made;
}

void ListCompiler::locate(std::uint32_t record, std::uint32_t slot, const Located& located) {
  if (shared_.is_too_large) return;
  image_[record + slot] = located.device;
  if (located.offset) emit(Opcode::move, record + slot + 1, *located.offset);
}

}  // namespace canopus::instruction_list
