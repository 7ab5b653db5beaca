#include "canopus/plant/catalogue/error_history.hpp"

#include <algorithm>
#include <ranges>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/interface/event_records.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/trace/decode/service_text.hpp"

namespace canopus::plant {
namespace {

using module::ErrorText;
using module::ErrorWords;

/// Empty: there is none.
std::string_view text_of(std::span<const ErrorText> texts, std::uint16_t code) {
  const auto found = std::ranges::find(texts, code, &ErrorText::code);
  return found == texts.end() ? std::string_view{} : found->meaning;
}

std::string shown_code(std::uint16_t code) { return fmt::format("{:04X}H", code); }

/// The lines of one row of the tables.
class RowReader {
 public:
  RowReader(const module::ErrorTables& tables, const ErrorWordReader& read, std::vector<ErrorLine>& lines)
      : tables_(tables), read_(read), lines_(lines) {}

  void add(const ErrorWords& row) {
    using Kind = ErrorWords::Kind;
    if (row.kind == Kind::command) return add_command(row);
    for (std::uint32_t address = row.first; address <= row.last; ++address) {
      const std::uint16_t value = read_(address);
      if (value == 0) continue;
      const std::uint32_t number = address - row.first + 1;
      switch (row.kind) {
        case Kind::bits: add_bits(row, place(address), value); break;
        case Kind::node_bits: add_bits(row, node(number, address), value); break;
        case Kind::node_pairs:
          add_bits(row, node(2 * number - 1, address), value & 0xFFU);
          add_bits(row, node(2 * number, address), value >> 8U, 8);
          break;
        case Kind::address:
          lines_.push_back({place(address), "", fmt::format("{} {}", row.name, place(value))});
          break;
        case Kind::codes: {
          const std::string_view text = text_of(row.texts, value);
          const std::string where =
              row.name.empty() ? place(address) : fmt::format("{} {}, {}", row.name, number, place(address));
          lines_.push_back(
              {where, shown_code(value), std::string(text.empty() ? "not in the manual" : text)});
          break;
        }
        case Kind::command: break;
      }
    }
  }

 private:
  [[nodiscard]] std::string place(std::uint32_t address) const {
    return fmt::format("{}{}", tables_.prefix, address);
  }

  [[nodiscard]] std::string node(std::uint32_t number, std::uint32_t address) const {
    return fmt::format("node {}, {}", number, place(address));
  }

  /// `first`: the number of the lowest of these bits in its word.
  void add_bits(const ErrorWords& row, const std::string& where, unsigned value, unsigned first = 0) {
    for (const ErrorText& text : row.texts) {
      if ((value >> text.code & 1U) != 0)
        lines_.push_back({fmt::format("{} bit {}", where, first + text.code), "", std::string(text.meaning)});
    }
  }

  void add_command(const ErrorWords& row) {
    constexpr std::uint16_t error = 0x000F, emergency_refused = 0x000C, sdo_error = 0x0003;
    const std::uint16_t result = read_(row.first);
    const std::string_view text = text_of(row.texts, result);
    if (text.empty()) return;
    std::string meaning = fmt::format("{}: {}", row.name, text);
    if (result == error || result == emergency_refused) {
      const std::uint16_t error_class = read_(row.first + 1);
      const std::string_view why = text_of(row.classes, error_class);
      meaning += fmt::format(", {}", why.empty() ? shown_code(error_class) : std::string(why));
      if (result == error && error_class == sdo_error) {
        const std::uint32_t code =
            static_cast<std::uint32_t>(read_(row.first + 4)) << 16U | read_(row.first + 3);
        meaning += fmt::format(" of node {}: {:08X}H {}", read_(row.first + 2), code,
                               canopen::describe(static_cast<canopen::AbortCode>(code)));
      }
    }
    lines_.push_back({place(row.first), shown_code(result), std::move(meaning)});
  }

  const module::ErrorTables& tables_;
  const ErrorWordReader& read_;
  std::vector<ErrorLine>& lines_;
};

bool is_of_mode(const ErrorWords& row, std::uint16_t function_mode) {
  const bool is_layer2 = function_mode == 11 || function_mode == 29;
  switch (row.when) {
    case ErrorWords::When::always: return true;
    case ErrorWords::When::canopen: return !is_layer2;
    case ErrorWords::When::layer2: return is_layer2;
  }
  return false;
}

/// "; data 4D 45 30 30 32 (ME002)"
std::string manufacturer_text(const canopen::Emergency& message) {
  const auto& bytes = message.manufacturer;
  if (std::ranges::all_of(bytes, [](std::uint8_t byte) { return byte == 0; })) return {};
  std::string text = fmt::format("; data {:02X}", fmt::join(bytes, " "));
  if (std::ranges::all_of(bytes, [](std::uint8_t byte) { return byte > 0x20 && byte < 0x7F; }))
    text += fmt::format(" ({})", std::string(bytes.begin(), bytes.end()));
  return text;
}

std::vector<ErrorLine> errors_now(const module::ErrorTables& tables, module::CommunicationModule& module,
                                  can::Time now) {
  std::vector<ErrorLine> lines;
  for (const module::ModuleErrorRecord& error : module.module_errors() | std::views::reverse) {
    std::string meaning = fmt::format("{} ({})", error.overview, module::name(error.error_class));
    for (const auto& detail : error.details) {
      if (!detail.name.empty())
        meaning += fmt::format("; {} {} ({:X}H)", detail.name, detail.value, detail.value);
    }
    lines.push_back({"module diagnostics", shown_code(error.code), std::move(meaning), error.at});
  }
  module::BufferMemoryAccess* const memory = module.buffer_memory();
  module::RegisterAccess* const registers = module.registers();
  const auto read = [&](std::uint32_t address) -> std::uint16_t {
    if (memory != nullptr) return memory->peek(address, now);
    return registers == nullptr ? std::uint16_t{0}
                                : registers->read_register(module::RegisterKind::special, address, now);
  };
  auto of_words = errors_in_words(tables, module.information().function_mode, read);
  std::ranges::move(of_words, std::back_inserter(lines));
  return lines;
}

std::vector<ErrorLine> events_of(const module::CommunicationModule& module) {
  std::vector<ErrorLine> lines;
  for (const module::ModuleEventRecord& event : module.event_history() | std::views::reverse) {
    std::string meaning(event.overview);
    if (event.detail) meaning += fmt::format("; {0} ({0:X}H)", *event.detail);
    lines.push_back({"", fmt::format("{:05X}", event.code), std::move(meaning), event.at});
  }
  return lines;
}

std::vector<ErrorLine> received_emergencies(const module::ErrorTables& tables,
                                            const module::CommunicationModule& module) {
  std::vector<ErrorLine> lines;
  for (const canopen::Emergency& message : module.emergency_history() | std::views::reverse) {
    lines.push_back({fmt::format("node {}", message.node_id), shown_code(message.code),
                     fmt::format("{}; error register {:02X}H{}", emergency_meaning(tables, message.code),
                                 message.error_register, manufacturer_text(message))});
  }
  return lines;
}

/// 1003H of the node inside, which has the newest at sub-index 01H [CiA 301 7.5.2.4].
std::vector<ErrorLine> sent_emergencies(const module::ErrorTables& tables,
                                        const module::CommunicationModule& module) {
  std::vector<ErrorLine> lines;
  const canopen::ObjectDictionary& objects = module.node().dictionary();
  const unsigned count = objects.get<std::uint8_t>(0x1003, 0, 0);
  for (unsigned sub = 1; sub <= count && sub < 0xFF; ++sub) {
    const auto field = objects.get<std::uint32_t>(0x1003, static_cast<std::uint8_t>(sub), 0);
    const auto code = static_cast<std::uint16_t>(field);
    std::string meaning = emergency_meaning(tables, code);
    if (field >> 16 != 0) meaning += fmt::format("; data {:02X} {:02X}", field >> 16 & 0xFFU, field >> 24);
    lines.push_back({fmt::format("1003:{:02X}", sub), shown_code(code), std::move(meaning)});
  }
  return lines;
}

}  // namespace

std::vector<ErrorLine> errors_in_words(const module::ErrorTables& tables, std::uint16_t function_mode,
                                       const ErrorWordReader& read) {
  std::vector<ErrorLine> lines;
  RowReader reader(tables, read, lines);
  for (const ErrorWords& row : tables.words) {
    if (is_of_mode(row, function_mode)) reader.add(row);
  }
  return lines;
}

std::string emergency_meaning(const module::ErrorTables& tables, std::uint16_t code) {
  const std::string_view own = text_of(tables.emergencies, code);
  if (!own.empty()) return std::string(own);
  const bool names_a_node =
      code > canopen::emcy_code::node_lost && code <= canopen::emcy_code::node_lost + 127;
  const std::string_view of_node = text_of(tables.emergencies, canopen::emcy_code::node_lost);
  if (names_a_node && !of_node.empty())
    return fmt::format("{} {}", of_node, code - canopen::emcy_code::node_lost);
  return std::string(trace::emcy_code_text(code));
}

std::vector<ErrorGroup> error_history(const CatalogueEntry& entry, module::CommunicationModule& module,
                                      can::Time now) {
  const module::ErrorTables& tables = *entry.errors;
  std::vector<ErrorGroup> groups;
  const auto add = [&groups](std::string_view title, std::vector<ErrorLine> lines) {
    if (!lines.empty()) groups.push_back({title, std::move(lines)});
  };
  add("errors now", errors_now(tables, module, now));
  add("emergencies received", received_emergencies(tables, module));
  add("emergencies sent (1003H)", sent_emergencies(tables, module));
  add("event history", events_of(module));
  return groups;
}

}  // namespace canopus::plant
