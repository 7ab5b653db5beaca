#pragma once
// "Check configuration" [CiA 302-2, 302-3; ME3CAN1-Q 4.8.12]: the slave's defaults are restored, if 1F81H and
// 1F8AH say so; if 1020H does not read what 1F26H and 1F27H expect, its concise DCF is downloaded.
//
//   [1011H written - reset - boot-up] - no concise DCF, or 1020:01 and :02 as expected: done
//                                     - else: each entry of the concise DCF in turn
//
// An abort ends the boot; one of a read-only object where MasterOptions::configuration_skips_read_only is false.

#include "canopus/manager/boot/boot_context.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"

namespace canopus::manager {

class SlaveConfiguration {
 public:
  explicit SlaveConfiguration(BootContext& boot) : boot_(&boot) {}

  /// From the restore on.
  BootOutcome begin(can::Time now);
  /// From the comparison on: the slave's defaults are restored.
  BootOutcome compare(can::Time now);
  /// The download alone.
  BootOutcome download(can::Time now);
  /// The transfer of one of its steps has ended.
  BootOutcome answered(can::Time now);

 private:
  BootOutcome restored(can::Time now);
  BootOutcome mark_answered(can::Time now);
  BootOutcome next_entry(can::Time now);
  BootOutcome entry_answered(can::Time now);

  BootContext* boot_;
  ConciseDcfReader file_;
};

}  // namespace canopus::manager
