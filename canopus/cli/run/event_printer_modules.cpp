// Events and errors that modules report to their CPUs, as lines.

#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canopus/cli/run/event_printer.hpp"

namespace canopus::cli {

using Json = nlohmann::ordered_json;

namespace {

double rounded_seconds(can::Time time) {
  return static_cast<double>(time.time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
}

Json event(can::Time now, std::string_view kind) { return {{"t", rounded_seconds(now)}, {"event", kind}}; }

}  // namespace

void JsonPrinter::module_event(std::string_view plc, std::string_view source,
                               const module::ModuleEventRecord& record) {
  Json line = event(record.at, "module event");
  line["plc"] = plc;
  line["module"] = source;
  line["code"] = fmt::format("{:05X}", record.code);
  line["overview"] = record.overview;
  if (record.detail) line["detail"] = *record.detail;
  print(line, record.at);
}

void JsonPrinter::module_error(std::string_view plc, std::string_view source,
                               const module::ModuleErrorRecord& record) {
  Json line = event(record.at, "module error");
  line["plc"] = plc;
  line["module"] = source;
  line["code"] = fmt::format("{:04X}", record.code);
  line["class"] = module::name(record.error_class);
  line["overview"] = record.overview;
  for (const auto& detail : record.details) {
    if (!detail.name.empty()) line["details"][std::string(detail.name)] = detail.value;
  }
  print(line, record.at);
}

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
