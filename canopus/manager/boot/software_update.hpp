#pragma once
// "Check and update program software" [CiA 302-2, 302-3]: what 1F56:01 of the slave says is compared with
// 1F55H; if it differs, and an update is allowed, the program of 1F58H goes to the slave.
//
//   1F56:01 - equal: done
//            - differs - 1F51:01 read - [stop: 0] - clear: 3 - 1F50:01 written - 1F57:01 until not busy
//              - 1F56:01 compared again - start: 1 - 1F51:01 until it reads 1 - the boot from 1000H on
//
// A device restarts when its program is stopped or started, and may not answer while its flash memory is
// cleared or written: there, no answer is no failure.

#include <cstdint>

#include "canopus/manager/boot/boot_context.hpp"

namespace canopus::manager {

class SoftwareUpdate {
 public:
  explicit SoftwareUpdate(BootContext& boot) : boot_(&boot) {}

  /// Compares, if 1F81H says so.
  BootOutcome check(can::Time now);
  /// The transfer of one of its steps has ended.
  BootOutcome answered(can::Time now);
  /// The download begins again, with what the transfer now does otherwise.
  BootOutcome download(can::Time now);
  /// The slave's boot-up message in one of its steps, but software_version.
  BootOutcome boot_up(can::Time now);
  /// The slave restarted while its program was downloaded.
  [[nodiscard]] bool rebooted() const noexcept { return rebooted_; }
  /// The boot has ended: the next one may update anew.
  void forget() noexcept;

 private:
  BootOutcome version_answered(can::Time now);
  BootOutcome state_answered(can::Time now);
  BootOutcome control(BootStep step, std::uint8_t command, can::Time now);
  BootOutcome stopped(can::Time now);
  BootOutcome cleared(can::Time now);
  BootOutcome downloaded(can::Time now);
  BootOutcome flash_status_answered(can::Time now);
  BootOutcome verified(can::Time now);
  BootOutcome start_answered(can::Time now);
  BootOutcome run_answered(can::Time now);

  BootContext* boot_;
  std::uint8_t command_ = 0;  // what is written to 1F51H
  unsigned clear_attempts_ = 0;
  unsigned updates_ = 0;  // begun since the slave was booted last
  bool updated_ = false;  // since then, and the new program runs
  bool rebooted_ = false;
};

}  // namespace canopus::manager
