#include "canopus/program/retained.hpp"

#include <optional>
#include <string_view>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/program/variables.hpp"

namespace canopus::program {

namespace {

/// What stands before the next `end`, which is cut off with it.
std::string_view cut(std::string_view& text, char end) {
  const std::size_t at = std::min(text.find(end), text.size());
  const std::string_view first = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return first;
}

std::optional<std::vector<Slot>> slots_of(std::string_view text, std::size_t count) {
  std::vector<Slot> slots;
  while (!text.empty() && slots.size() < count) {
    const auto slot = ascii::parse_number<Slot>(cut(text, ' '), 16);
    if (!slot) return std::nullopt;
    slots.push_back(*slot);
  }
  if (!text.empty() || slots.size() != count) return std::nullopt;
  return slots;
}

/// Empty: it has its value. Else why not.
std::string restore_line(Machine& machine, std::string_view name, std::string_view type,
                         std::string_view value) {
  const auto variable = machine.find(name);
  if (!variable) return std::string(name) + " is no more";
  if (variable->type->name != type)
    return std::string(name) + " was " + std::string(type) + ", and is " + variable->type->name + " now";
  const auto slots = slots_of(value, variable->type->slots);
  if (variable->is_constant || !slots || !machine.write_slots(*variable, *slots))
    return std::string(name) + ": what was kept is no " + variable->type->name;
  return {};
}

}  // namespace

std::vector<std::uint8_t> retained_bytes(const Machine& machine) {
  std::vector<std::uint8_t> bytes;
  const auto add = [&](std::string_view text) { bytes.insert(bytes.end(), text.begin(), text.end()); };
  for_each_variable(machine.program(), [&](const SingleVariable& variable) {
    if (!variable.is_retained || variable.is_constant) return true;
    add(variable.name);
    add("\t");
    add(variable.type.name);
    char separator = '\t';
    for (std::uint32_t i = 0; i < variable.type.slots; ++i) {
      add({&separator, 1});
      add(ascii::hex(machine.value_at(variable.place)[i], 16));
      separator = ' ';
    }
    add("\n");
    return true;
  });
  return bytes;
}

std::vector<std::string> restore_retained(Machine& machine, std::span<const std::uint8_t> bytes) {
  std::vector<std::string> left_out;
  const std::string whole(bytes.begin(), bytes.end());
  std::string_view rest = whole;
  while (!rest.empty()) {
    std::string_view line = cut(rest, '\n');
    const std::string_view name = cut(line, '\t');
    const std::string_view type = cut(line, '\t');
    if (std::string trouble = restore_line(machine, name, type, line); !trouble.empty())
      left_out.push_back(std::move(trouble));
  }
  return left_out;
}

}  // namespace canopus::program
