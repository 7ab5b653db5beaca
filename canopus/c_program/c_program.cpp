#include "canopus/c_program/c_program.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "canopus/ascii/words.hpp"
#include "canopus/c_program/shared_object.hpp"
#include "canopus/program/canopus_program.h"

namespace canopus::c_program {

namespace {

using program::DataType;
using program::DeviceError;
using program::DevicePoint;
using program::Elementary;
using program::Family;
using program::Slot;

// The header's numbers of types are those of Elementary.
static_assert(CANOPUS_LWORD == static_cast<int>(Elementary::lword) &&
              CANOPUS_LREAL == static_cast<int>(Elementary::lreal) &&
              CANOPUS_TIME == static_cast<int>(Elementary::time) &&
              CANOPUS_DATE == static_cast<int>(Elementary::date) &&
              CANOPUS_TOD == static_cast<int>(Elementary::tod) &&
              CANOPUS_DT == static_cast<int>(Elementary::dt) &&
              CANOPUS_STRING == static_cast<int>(Elementary::string));

constexpr std::uint32_t most_variables = 100'000;
constexpr std::uint32_t longest_string = 1024;
constexpr std::size_t longest_name = 128;
constexpr std::size_t longest_reason = 200;

bool is_known(std::uint32_t type) {
  return type <= CANOPUS_TIME || type == CANOPUS_DATE || type == CANOPUS_TOD || type == CANOPUS_DT ||
         type == CANOPUS_STRING;
}

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= longest_name && !ascii::is_digit(text.front()) &&
         std::ranges::all_of(text,
                             [](char c) { return ascii::is_letter(c) || ascii::is_digit(c) || c == '_'; });
}

/// A variable of the program: in C, in the machine's memory and maybe in a device.
struct Variable {
  char* value = nullptr;
  std::size_t bytes = 0;  ///< of an element in C
  std::uint32_t count = 1;
  const DataType* type = nullptr;  ///< of an element
  std::uint32_t place = 0;
  std::uint32_t flags = 0;
  std::optional<DevicePoint> device{};
  std::string_view device_text{};
};

/// Little-endian: the lowest bytes of the slot.
void read_element(const Variable& variable, std::uint32_t number, Slot* to) {
  const char* const from = variable.value + number * variable.bytes;
  const DataType& type = *variable.type;
  if (type.is_string()) {
    const auto length = static_cast<std::uint32_t>(::strnlen(from, type.capacity));
    std::memcpy(to + 1, from, length);
    *to = program::string_header(length, type.capacity);
    return;
  }
  Slot value = 0;
  std::memcpy(&value, from, variable.bytes);
  const program::ElementaryInfo& kind = info(type.base);
  if (kind.family == Family::signed_integer && kind.bits < 64) {
    const unsigned shift = 64U - kind.bits;
    value = static_cast<Slot>(static_cast<std::int64_t>(value << shift) >> shift);
  }
  if (kind.family == Family::boolean) value = value != 0 ? 1 : 0;
  *to = value;
}

void write_element(const Variable& variable, std::uint32_t number, const Slot* from) {
  char* const to = variable.value + number * variable.bytes;
  if (variable.type->is_string()) {
    const std::uint32_t length = program::string_header(*from).length;
    std::memcpy(to, from + 1, length);
    to[length] = '\0';
    return;
  }
  std::memcpy(to, from, variable.bytes);
}

/// Points of a bit device, or words, of an element.
unsigned bits_of(const Variable& variable) { return info(variable.type->base).bits; }

/// Reads into `scratch`, whose size is the variable's in C, and from there into the variable: all of it, or nothing.
DeviceError read_device(const Variable& variable, std::span<std::uint16_t> scratch,
                        program::DeviceImage& devices) {
  DevicePoint point = *variable.device;
  const std::size_t bytes = variable.bytes * variable.count;
  if (!point.is_bit) {  // the lowest word first, as in C
    const DeviceError error = devices.read_words(point, scratch.first(bytes / 2));
    if (error == DeviceError::none) std::memcpy(variable.value, scratch.data(), bytes);
    return error;
  }
  auto* const read = reinterpret_cast<char*>(scratch.data());
  const unsigned step = std::min(bits_of(variable), 32U);
  const std::size_t step_bytes = (step + 7) / 8;
  for (std::size_t at = 0; at < bytes; at += step_bytes, point.number += step) {
    std::uint32_t bits = 0;
    if (const DeviceError error = devices.read_bits(point, step, bits); error != DeviceError::none)
      return error;
    std::memcpy(read + at, &bits, step_bytes);
  }
  std::memcpy(variable.value, read, bytes);
  return DeviceError::none;
}

DeviceError write_device(const Variable& variable, std::span<std::uint16_t> scratch,
                         program::DeviceImage& devices) {
  DevicePoint point = *variable.device;
  const std::size_t bytes = variable.bytes * variable.count;
  if (!point.is_bit) {
    std::memcpy(scratch.data(), variable.value, bytes);
    return devices.write_words(point, scratch.first(bytes / 2));
  }
  const unsigned step = std::min(bits_of(variable), 32U);
  const std::size_t step_bytes = (step + 7) / 8;
  for (std::size_t at = 0; at < bytes; at += step_bytes, point.number += step) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, variable.value + at, step_bytes);
    if (step == 1) bits = bits != 0 ? 1 : 0;
    if (const DeviceError error = devices.write_bits(point, step, bits); error != DeviceError::none)
      return error;
  }
  return DeviceError::none;
}

class Run final : public program::Plugin {
 public:
  Run(SharedObject object, const canopus_program_info& info, std::string file)
      : object_(std::move(object)), info_(info), file_(std::move(file)) {}

  void start() override {
    if (info_.start != nullptr) info_.start();
  }
  std::optional<program::Fault> scan(std::span<Slot> memory, std::int64_t now,
                                     program::DeviceImage* devices) noexcept override;

  void add(const Variable& variable) {
    variables_.push_back(variable);
    if (variable.device) scratch_.resize(std::max(scratch_.size(), variable.bytes * variable.count / 2 + 1));
  }

 private:
  using DeviceTransfer = DeviceError(const Variable&, std::span<std::uint16_t>, program::DeviceImage&);

  template <DeviceTransfer transfer>
  static int at_once(const canopus_image* image, std::uint32_t number) {
    const auto& [self, devices] = *static_cast<const Owner*>(image->owner);
    if (number >= self->variables_.size() || !self->variables_[number].device || devices == nullptr) return 1;
    return transfer(self->variables_[number], self->scratch_, *devices) == DeviceError::none ? 0 : 1;
  }
  struct Owner {
    Run* self;
    program::DeviceImage* devices;
  };

  SharedObject object_;
  const canopus_program_info& info_;
  std::string file_;
  std::string reason_;
  std::vector<Variable> variables_;     // of the table, in its order
  std::vector<std::uint16_t> scratch_;  // as large as the largest variable at a device
};

program::Fault refused(DeviceError error, const Variable& variable) {
  program::Fault fault;
  fault.code = error == DeviceError::no_module ? program::FaultCode::no_module
                                               : program::FaultCode::device_out_of_range;
  fault.device = variable.device_text;
  return fault;
}

std::optional<program::Fault> Run::scan(std::span<Slot> memory, std::int64_t now,
                                        program::DeviceImage* devices) noexcept {
  const auto all_at = [&](std::uint32_t flag, DeviceTransfer transfer) -> std::optional<program::Fault> {
    for (const Variable& variable : variables_) {
      if ((variable.flags & flag) == 0 || !variable.device) continue;
      const DeviceError error =
          devices == nullptr ? DeviceError::no_module : transfer(variable, scratch_, *devices);
      if (error != DeviceError::none) return refused(error, variable);
    }
    return std::nullopt;
  };
  for (const Variable& variable : variables_)
    for (std::uint32_t i = 0; i < variable.count; ++i)
      write_element(variable, i, memory.data() + variable.place + i * variable.type->slots);
  if (auto fault = all_at(CANOPUS_INPUT, read_device)) return fault;
  const Owner owner{this, devices};
  const canopus_image image{&owner, at_once<read_device>, at_once<write_device>};
  const char* const reason = info_.scan(&image, now);
  for (const Variable& variable : variables_)
    for (std::uint32_t i = 0; i < variable.count; ++i)
      read_element(variable, i, memory.data() + variable.place + i * variable.type->slots);
  if (reason != nullptr) {
    reason_ = file_ + ": " + std::string(reason, ::strnlen(reason, longest_reason));
    program::Fault fault{.code = program::FaultCode::reported};
    fault.reason = reason_;
    return fault;
  }
  return all_at(CANOPUS_OUTPUT, write_device);
}

/// Makes a program of the table in the shared object.
class Table {
 public:
  Table(program::Program& to, Run& run, const program::DeviceNames& devices)
      : program_(to), run_(run), devices_(devices) {}

  /// What is wrong, without the variable's name; empty: nothing.
  std::string add(const canopus_variable& given) {
    if (!is_known(given.type)) return "expected one of the types of canopus_program.h";
    if (given.value == nullptr) return "expected a place of its value";
    const bool is_string = given.type == CANOPUS_STRING;
    if (is_string ? given.length < 1 || given.length > longest_string : given.length != 0)
      return "expected a length from 1 to 1024 of a STRING, and 0 of any other type";
    constexpr std::uint32_t flags = CANOPUS_RETAIN | CANOPUS_CONSTANT | CANOPUS_INPUT | CANOPUS_OUTPUT;
    if ((given.flags & ~flags) != 0) return "expected flags of canopus_program.h";
    Variable variable{.value = static_cast<char*>(given.value)};
    variable.flags = given.flags;
    variable.count = std::max(given.count, 1U);
    variable.type = &element_type(given);
    variable.bytes = is_string ? given.length + 1 : (bits_of(variable) + 7) / 8;
    if (std::uint64_t{variable.count} * variable.type->slots + program_.initial.size() > program::most_slots)
      return "the program's variables are too large";
    if (std::string error = locate(given, variable); !error.empty()) return error;
    variable.place = static_cast<std::uint32_t>(program_.initial.size());
    program_.initial.resize(variable.place + std::size_t{variable.count} * variable.type->slots);
    for (std::uint32_t i = 0; i < variable.count; ++i) {
      Slot* const slot = program_.initial.data() + variable.place + i * variable.type->slots;
      if (is_string) *slot = program::string_header(0, given.length);
      read_element(variable, i, slot);
    }
    program_.symbols.push_back({given.name, &whole_type(given, *variable.type), variable.place, false,
                                (given.flags & CANOPUS_CONSTANT) != 0, (given.flags & CANOPUS_RETAIN) != 0});
    run_.add(variable);
    return {};
  }

 private:
  const DataType& element_type(const canopus_variable& given) {
    const auto base = static_cast<Elementary>(given.type);
    DataType type{.base = base, .name = std::string(program::info(base).name)};
    if (type.is_string()) {
      type.name += '[' + std::to_string(given.length) + ']';
      type.capacity = given.length;
      type.slots = program::string_slots(given.length, 8);
    }
    const auto known = std::ranges::find(program_.types, type.name, &DataType::name);
    return known != program_.types.end() ? *known : program_.types.emplace_back(std::move(type));
  }
  const DataType& whole_type(const canopus_variable& given, const DataType& element) {
    if (given.count == 0) return element;
    DataType array{.form = DataType::Form::array,
                   .slots = given.count * element.slots,
                   .low = 0,
                   .high = std::int64_t{given.count} - 1,
                   .element = &element};
    array.name = "ARRAY[0.." + std::to_string(array.high) + "] OF " + element.name;
    return program_.types.emplace_back(std::move(array));
  }
  std::string locate(const canopus_variable& given, Variable& variable) const {
    if (given.device == nullptr) {
      return (given.flags & (CANOPUS_INPUT | CANOPUS_OUTPUT)) == 0
                 ? ""
                 : "expected a device of an input or output";
    }
    auto point = devices_.point(ascii::upper(given.device));
    if (!point) return std::string(given.device) + ": " + point.error();
    const unsigned bits = bits_of(variable);
    if (variable.type->is_string() || bits == 8 || (bits == 1 && !point->is_bit))
      return std::string(given.device) +
             ": expected a BOOL at a bit device, or a type of 16, 32 or 64 bits at any device";
    variable.device = *point;
    variable.device_text = given.device;
    return {};
  }

  program::Program& program_;
  Run& run_;
  const program::DeviceNames& devices_;
};

}  // namespace

bool is_shared_object(std::string_view path) { return path.ends_with(".so"); }

std::expected<std::shared_ptr<const program::Program>, std::string> load(
    const std::string& path, const program::DeviceNames& devices) {
  auto object = SharedObject::open(path);
  if (!object) return std::unexpected(object.error());
  const auto described = reinterpret_cast<decltype(&canopus_program)>(object->symbol("canopus_program"));
  if (described == nullptr) return std::unexpected("expected a function canopus_program() in it");
  const canopus_program_info* const info = described();
  if (info == nullptr) return std::unexpected("expected that canopus_program() returns a description");
  if (info->abi != CANOPUS_PROGRAM_ABI) {
    return std::unexpected("expected version " + std::to_string(CANOPUS_PROGRAM_ABI) +
                           " of canopus_program.h, found " + std::to_string(info->abi));
  }
  if (info->scan == nullptr) return std::unexpected("expected a function for a scan");
  if (info->variable_count > most_variables || (info->variable_count != 0 && info->variables == nullptr))
    return std::unexpected("expected a table of at most " + std::to_string(most_variables) + " variables");
  auto made = std::make_shared<program::Program>();
  auto run = std::make_shared<Run>(std::move(*object), *info, path);
  run->start();
  Table table(*made, *run, devices);
  std::set<std::string> names;
  for (std::uint32_t i = 0; i < info->variable_count; ++i) {
    const canopus_variable& variable = info->variables[i];
    if (variable.name == nullptr || !is_name(variable.name))
      return std::unexpected("variable " + std::to_string(i) +
                             ": expected a name of letters, digits and _ that begins with no digit");
    std::string error = names.insert(ascii::upper(variable.name)).second
                            ? table.add(variable)
                            : "expected another name: it is there twice";
    if (!error.empty()) return std::unexpected("variable " + std::string(variable.name) + ": " + error);
  }
  made->files = {path};
  made->code = {{.code = program::Opcode::run_plugin}, {.code = program::Opcode::end}};
  made->positions.resize(made->code.size());
  made->functions = {{.name = std::filesystem::path(path).stem().string(),
                      .instructions = static_cast<std::uint32_t>(made->code.size())}};
  made->programs = {0};
  made->plugin = std::move(run);
  return made;
}

}  // namespace canopus::c_program
