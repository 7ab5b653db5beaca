#pragma once
// A slave's boot as fields of a JSON line, the same in `canopus run --json` and `canopus master --json`.

#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/text/json.hpp"

namespace canopus::plant {

/// Adds to `line`: step (words), since (seconds), and as far as the step has them object ("1018:02"),
/// attempts, expected and received (of a comparison that failed), error (CiA 302 letter), abort ("05040000"),
/// reason (sentences: the fault, and what to check).
void add_boot(text::Json& line, const manager::BootRecord& record, can::Time now);

}  // namespace canopus::plant
