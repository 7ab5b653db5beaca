#include "canopus/plant/events/boot_report.hpp"

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/text/json.hpp"

namespace canopus::plant {

using manager::BootError;
using manager::BootStep;

void add_boot(text::Json& line, const manager::BootRecord& record, can::Time now) {
  line["step"] = manager::facts(record.step).text;
  line["since"] = static_cast<double>(record.since.time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
  const bool names_object =
      facts(record.step == BootStep::failed ? record.failed_step : record.step).asks_object ||
      record.step == BootStep::presence_pause;
  if (names_object && record.index != 0) {
    line["object"] = canopen::object_text(record.index, record.sub);
  }
  if (record.attempts != 0) line["attempts"] = record.attempts;
  if (record.error == BootError::none) {
    if (record.halted_by != 0) line["reason"] = manager::explain(record, now);
    return;
  }
  line["error"] = std::string(1, manager::letter(record.error));
  if (record.abort_code != canopen::AbortCode::none) {
    line["abort"] = fmt::format("{:08X}", static_cast<std::uint32_t>(record.abort_code));
  } else if (record.expected != record.received) {
    line["expected"] = record.expected;
    line["received"] = record.received;
  }
  line["reason"] = manager::explain(record, now);
}

}  // namespace canopus::plant
