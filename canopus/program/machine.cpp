#include "canopus/program/machine.hpp"

#include <algorithm>
#include <utility>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/program/execution.hpp"

namespace canopus::program {

namespace {

/// Calls each(place, slots) for what is retained of a variable: all of it, or members that are RETAIN themselves.
template <typename Each>
void each_retained_of(const DataType& type, std::uint32_t place, bool is_retained, Each& each) {
  if (type.form == DataType::Form::block) {
    for (const Member& member : type.members) {
      if (member.kind == MemberKind::in_out || member.kind == MemberKind::temporary || member.is_constant)
        continue;
      each_retained_of(*member.type, place + member.offset, is_retained || member.is_retained, each);
    }
  } else if (type.form == DataType::Form::array && type.element->form == DataType::Form::block) {
    for (std::uint32_t at = 0; at < type.slots; at += type.element->slots)
      each_retained_of(*type.element, place + at, is_retained, each);
  } else if (is_retained) {
    each(place, type.slots);
  }
}

void copy_string(const Slot* from, const DataType& type, Slot* to) {
  const StringHeader old = string_header(*from);
  const std::uint32_t length = std::min(old.length, type.capacity);
  const unsigned bits = info(type.base).bits;
  std::copy_n(from + 1, string_slots(length, bits) - 1, to + 1);
  *to = string_header(length, type.capacity);
}

/// Values of an old variable in a new one, as far as they fit.
void transfer(const DataType& old_type, const Slot* from, const DataType& new_type, Slot* to) {
  if (old_type.is_string() && new_type.is_string() && old_type.base == new_type.base)
    return copy_string(from, new_type, to);
  if (old_type.form != new_type.form) return;
  switch (new_type.form) {
    case DataType::Form::elementary:
    case DataType::Form::enumeration:
    case DataType::Form::subrange:
      if (same_type(old_type, new_type)) std::copy_n(from, new_type.slots, to);
      return;
    case DataType::Form::array: {
      const std::int64_t low = std::max(old_type.low, new_type.low);
      const std::int64_t high = std::min(old_type.high, new_type.high);
      for (std::int64_t i = low; i <= high; ++i) {
        transfer(
            *old_type.element, from + static_cast<std::size_t>(i - old_type.low) * old_type.element->slots,
            *new_type.element, to + static_cast<std::size_t>(i - new_type.low) * new_type.element->slots);
      }
      return;
    }
    case DataType::Form::structure:
    case DataType::Form::block:
      for (const Member& member : new_type.members) {
        const Member* const old = old_type.member(member.name);
        const bool is_value =
            member.kind != MemberKind::in_out && member.kind != MemberKind::temporary && !member.is_constant;
        if (old == nullptr || old->kind == MemberKind::in_out || !is_value) continue;
        transfer(*old->type, from + old->offset, *member.type, to + member.offset);
      }
      return;
  }
}

const Symbol* symbol_named(const Program& program, std::string_view name, bool is_program) {
  const auto found = std::ranges::find_if(program.symbols, [&](const Symbol& symbol) {
    return symbol.is_program == is_program && ascii::equal_ignoring_case(symbol.name, name);
  });
  return found == program.symbols.end() ? nullptr : &*found;
}

std::string_view name_at(std::string_view& path) {
  std::size_t end = 0;
  while (end < path.size() && path[end] != '.' && path[end] != '[') ++end;
  const std::string_view name = path.substr(0, end);
  path.remove_prefix(end);
  return name;
}

}  // namespace

Machine::Machine(std::shared_ptr<const Program> program)
    : program_(std::move(program)), memory_(program_->initial) {
  pending_.reserve(program_->programs.size());
}

template <typename Each>
void Machine::each_retained(Each each) const {
  for (const Symbol& symbol : program_->symbols) {
    if (!symbol.is_constant) each_retained_of(*symbol.type, symbol.place, symbol.is_retained, each);
  }
}

void Machine::cold_start() {
  suspension_.is_set = false;
  std::ranges::copy(program_->initial, memory_.begin());
  if (program_->plugin != nullptr) program_->plugin->start();
  apply_forces();
}

void Machine::warm_start() {
  const std::vector<Slot> values = retained();
  cold_start();
  (void)restore_retained(values);
  apply_forces();
}

std::vector<Slot> Machine::retained() const {
  std::vector<Slot> values;
  each_retained([&](std::uint32_t place, std::uint32_t slots) {
    values.insert(values.end(), memory_.begin() + place, memory_.begin() + place + slots);
  });
  return values;
}

bool Machine::restore_retained(const std::vector<Slot>& values) {
  std::size_t size = 0;
  each_retained([&](std::uint32_t, std::uint32_t slots) { size += slots; });
  if (size != values.size()) return false;
  auto from = values.begin();
  each_retained([&](std::uint32_t place, std::uint32_t slots) {
    std::copy_n(from, slots, memory_.begin() + place);
    from += slots;
  });
  return true;
}

void Machine::apply_forces() noexcept {
  for (const Force& force : forces_) std::ranges::copy(force.value, memory_.begin() + force.place);
}

std::optional<Fault> Machine::scan(std::int64_t now, DeviceImage* devices) {
  return run(program_->programs, now, devices);
}

std::optional<Fault> Machine::run(std::span<const std::uint32_t> programs, std::int64_t now,
                                  DeviceImage* devices) {
  suspension_.is_set = false;
  pending_.assign(programs.begin(), programs.end());
  next_pending_ = 0;
  apply_forces();
  return run_pending(now, devices);
}

std::optional<Fault> Machine::resume(std::int64_t now, DeviceImage* devices) {
  if (!is_halted()) return std::nullopt;
  apply_forces();
  return run_pending(now, devices);
}

std::optional<Fault> Machine::run_pending(std::int64_t now, DeviceImage* devices) {
  Execution execution{
      program_->code, program_->positions, *program_, memory_, program_->initial, devices, now, watchdog_};
  if (!linked_.is_of(memory_, devices)) linked_.link(*program_, memory_, devices);
  execution.code =
      code_with_breaks_.empty() ? linked_.code() : std::span<const Instruction>(code_with_breaks_);
  execution.device_memory = linked_.device_memory();
  execution.suspension = &suspension_;
  std::optional<Fault> fault;
  executed_ = 0;
  while (next_pending_ < pending_.size()) {
    const Function& function = program_->functions[pending_[next_pending_]];
    if (!is_halted()) executed_ += function.instructions;
    fault = execute(execution, function.entry, function.frame);
    if (fault || is_halted()) break;
    ++next_pending_;
  }
  executed_ += watchdog_ - execution.budget;
  apply_forces();
  return fault;
}

SourcePosition Machine::halted_at() const noexcept {
  return is_halted() ? program_->positions[suspension_.next] : SourcePosition{};
}

std::expected<std::uint32_t, std::string> Machine::set_break(std::string_view file, std::uint32_t line) {
  const auto found = std::ranges::find(program_->files, file);
  if (found == program_->files.end())
    return std::unexpected("'" + std::string(file) + "': expected a file of the program");
  const auto number = static_cast<std::uint16_t>(found - program_->files.begin());
  std::uint32_t next = 0;
  for (const SourcePosition& position : program_->positions) {
    if (position.file == number && position.line >= line && position.line != 0)
      next = next == 0 ? position.line : std::min(next, position.line);
  }
  if (next == 0)
    return std::unexpected("line " + std::to_string(line) + ": no statement of '" + std::string(file) +
                           "' stands there or behind it");
  const Break one{number, next};
  if (std::ranges::find(breaks_, one) == breaks_.end()) breaks_.push_back(one);
  place_breaks();
  return next;
}

bool Machine::clear_break(std::string_view file, std::uint32_t line) {
  const bool is_removed = std::erase_if(breaks_, [&](const Break& one) {
                            return one.line == line && program_->files[one.file] == file;
                          }) != 0;
  place_breaks();
  return is_removed;
}

void Machine::clear_breaks() {
  breaks_.clear();
  place_breaks();
}

/// In every function the first instruction of a line: the others, and those of a loop's end, are not another execution of it.
void Machine::place_breaks() {
  code_with_breaks_.clear();
  if (breaks_.empty()) return;
  code_with_breaks_ = program_->code;
  for (const Break& one : breaks_) {
    for (const Function& function : program_->functions) {
      for (std::uint32_t at = function.entry; at < function.entry + function.instructions; ++at) {
        const SourcePosition& position = program_->positions[at];
        if (position.file != one.file || position.line != one.line) continue;
        code_with_breaks_[at].code = Opcode::halt;
        break;
      }
    }
  }
}

std::vector<std::string> Machine::forced_names() const {
  std::vector<std::string> names;
  for (const Force& force : forces_) names.push_back(force.path);
  return names;
}

void Machine::change(std::shared_ptr<const Program> program) {
  std::vector<Slot> memory = program->initial;
  for (const Symbol& symbol : program->symbols) {
    const Symbol* const old = symbol_named(*program_, symbol.name, symbol.is_program);
    if (old == nullptr || symbol.is_constant || old->is_constant) continue;
    transfer(*old->type, memory_.data() + old->place, *symbol.type, memory.data() + symbol.place);
  }
  std::vector<std::pair<std::string, std::uint32_t>> breaks;
  for (const Break& one : breaks_) breaks.emplace_back(program_->files[one.file], one.line);
  suspension_.is_set = false;  // the rest of a halted scan is not executed: it was of another program
  program_ = std::move(program);
  memory_ = std::move(memory);
  linked_.clear();
  pending_.reserve(program_->programs.size());
  breaks_.clear();
  for (const auto& [file, line] : breaks) (void)set_break(file, line);
  place_breaks();
  std::vector<Force> forces = std::move(forces_);
  forces_.clear();
  for (Force& kept : forces) {
    const auto variable = find(kept.path);
    if (!variable || variable->type->slots != kept.value.size()) continue;
    kept.place = variable->place;
    forces_.push_back(std::move(kept));
  }
  apply_forces();
}

std::expected<Machine::Variable, std::string> Machine::find(std::string_view path) const {
  const std::string whole(path);
  const auto wrong = [&](const std::string& what) { return std::unexpected("'" + whole + "': " + what); };
  const std::string_view first = name_at(path);
  const Symbol* symbol = symbol_named(*program_, first, false);
  if (symbol == nullptr) symbol = symbol_named(*program_, first, true);
  if (symbol == nullptr) return wrong("expected the name of a global variable or of a program");
  Variable found{symbol->type, symbol->place, symbol->is_constant};
  while (!path.empty()) {
    const char kind = path.front();
    path.remove_prefix(1);
    if (kind == '.') {
      const std::string_view name = name_at(path);
      const Member* const member = found.type->member(name);
      if (member == nullptr || member->kind == MemberKind::hidden)
        return wrong("there is no '" + std::string(name) + "' in it");
      if (member->kind == MemberKind::in_out)
        return wrong("'" + std::string(name) + "' is a variable of the caller (VAR_IN_OUT)");
      found = {member->type, found.place + member->offset, found.is_constant || member->is_constant};
      continue;
    }
    const std::size_t end = path.find(']');
    if (kind != '[' || end == std::string_view::npos) return wrong("expected '.name' or '[index]'");
    std::string_view indices = path.substr(0, end);
    path.remove_prefix(end + 1);
    while (true) {
      const std::size_t comma = std::min(indices.find(','), indices.size());
      const auto index = ascii::parse_number<std::int64_t>(ascii::trim(indices.substr(0, comma)));
      if (found.type->form != DataType::Form::array) return wrong("what stands before '[' is no array");
      if (!index || *index < found.type->low || *index > found.type->high)
        return wrong("expected an index from " + std::to_string(found.type->low) + " to " +
                     std::to_string(found.type->high));
      found.place += static_cast<std::uint32_t>(*index - found.type->low) * found.type->element->slots;
      found.type = found.type->element;
      if (comma == indices.size()) break;
      indices.remove_prefix(comma + 1);
    }
  }
  return found;
}

std::expected<std::string, std::string> Machine::read(std::string_view path) const {
  const auto variable = find(path);
  if (!variable) return std::unexpected(variable.error());
  return value_text(*variable->type, memory_.data() + variable->place);
}

std::expected<void, std::string> Machine::write(std::string_view path, std::string_view value) {
  const auto variable = find(path);
  if (!variable) return std::unexpected(variable.error());
  if (variable->is_constant) return std::unexpected("'" + std::string(path) + "' is a constant");
  if (auto error = parse_value(*variable->type, value, memory_.data() + variable->place))
    return std::unexpected(std::move(*error));
  return {};
}

bool Machine::write_slots(const Variable& variable, std::span<const Slot> value) {
  if (!is_value(*variable.type, value)) return false;
  std::ranges::copy(value, memory_.begin() + variable.place);
  apply_forces();
  return true;
}

std::expected<void, std::string> Machine::force(std::string_view path, std::string_view value) {
  const auto variable = find(path);
  if (!variable) return std::unexpected(variable.error());
  if (variable->is_constant) return std::unexpected("'" + std::string(path) + "' is a constant");
  std::vector<Slot> slots(variable->type->slots);
  if (auto error = parse_value(*variable->type, value, slots.data()))
    return std::unexpected(std::move(*error));
  std::erase_if(forces_, [&](const Force& force) { return force.place == variable->place; });
  forces_.push_back({std::string(path), variable->place, std::move(slots)});
  apply_forces();
  return {};
}

bool Machine::is_forced(std::string_view path) const {
  const auto variable = find(path);
  return variable &&
         std::ranges::any_of(forces_, [&](const Force& force) { return force.place == variable->place; });
}

std::expected<void, std::string> Machine::release(std::string_view path) {
  const auto variable = find(path);
  if (!variable) return std::unexpected(variable.error());
  if (std::erase_if(forces_, [&](const Force& force) { return force.place == variable->place; }) == 0)
    return std::unexpected("'" + std::string(path) + "' is not forced");
  return {};
}

}  // namespace canopus::program
