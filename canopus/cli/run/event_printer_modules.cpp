// Errors of module diagnostics, as lines for people.

#include <string_view>

#include <fmt/format.h>

#include "canopus/cli/run/event_printer.hpp"

namespace canopus::cli {

void LinePrinter::module_error(std::string_view, std::string_view source,
                               const module::ModuleErrorRecord& record) {
  latest_ = record.at;
  errors_.line("{:>12.6f}  {}: {}", can::seconds(record.at), source, describe(record));
}

std::string describe(const module::ModuleErrorRecord& record) {
  std::string text =
      fmt::format("error {:04X}H ({}): {}", record.code, module::name(record.error_class), record.overview);
  std::string_view separator = "; ";
  for (const auto& detail : record.details) {
    if (detail.name.empty()) continue;
    text += fmt::format("{}{} {}", separator, detail.name, detail.value);
    separator = ", ";
  }
  return text;
}

}  // namespace canopus::cli
