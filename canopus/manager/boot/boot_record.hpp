#pragma once
// What is known of one slave's way through "boot slave": the step it is at, what was asked, what came back.
// Enough to answer "why is my slave stuck?" without a bus trace.

#include <cstdint>
#include <string>
#include <string_view>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"

namespace canopus::manager {

/// Result of a slave's boot, with the letter CiA 302-2 gives it.
enum class BootError : char {
  none = 0,
  not_assigned = 'A',            ///< 1F81H bit 0 is 0
  no_answer = 'B',               ///< 1000H was not answered, or with an abort
  device_type = 'C',             ///< 1000H differs from 1F84H
  vendor = 'D',                  ///< 1018:01 differs from 1F85H, or could not be read
  no_heartbeat_state = 'E',      ///< keep alive: no heartbeat with the state
  no_guarding_state = 'F',       ///< keep alive: the guarding remote frame was not answered
  software_not_described = 'G',  ///< 1F55H is 0, or 1F56H could not be read
  software_not_allowed = 'H',    ///< an update is needed but not allowed
  software_download = 'I',       ///< the program download failed, or the new program is not the expected one
  configuration = 'J',           ///< the configuration download failed
  no_error_control = 'K',        ///< no heartbeat (or guarding answer) at the start of error control
  already_operational = 'L',     ///< found Operational and left so: no failure
  product = 'M',                 ///< 1018:02 differs from 1F86H
  revision = 'N',                ///< 1018:03 differs from 1F87H
  serial = 'O',                  ///< 1018:04 differs from 1F88H
};

/// 'A'..'O', or '-' for none.
[[nodiscard]] constexpr char letter(BootError error) noexcept {
  return error == BootError::none ? '-' : static_cast<char>(error);
}
/// True for none and already_operational.
[[nodiscard]] constexpr bool is_success(BootError error) noexcept {
  return error == BootError::none || error == BootError::already_operational;
}
/// "device type differs from 1F84H", ...
[[nodiscard]] std::string_view describe(BootError error) noexcept;

/// Where a slave's boot is [CiA 302-2 boot slave; ME3CAN1-Q 4.8.6].
enum class BootStep : std::uint8_t {
  idle,                   ///< never started, or given up because the start-up was stopped
  wait_after_reset,       ///< the slave was reset: its boot-up message or the end of the wait
  presence,               ///< 1000H is asked
  presence_pause,         ///< not answered: asked again after a pause
  identity,               ///< 1018:01..04 are asked
  state_by_heartbeat,     ///< keep alive: its heartbeat is awaited
  state_by_guarding,      ///< keep alive: its guarding answer is awaited
  boot_up_after_reset,    ///< keep alive, but not Operational: reset, its boot-up message is awaited
  software_version,       ///< 1F56:01 is asked
  program_state,          ///< an update is due: 1F51:01 is asked
  program_stop,           ///< 1F51:01 = 0 is written
  program_clear,          ///< 1F51:01 = 3 is written
  program_download,       ///< 1F50:01 is being written
  program_flash,          ///< 1F57:01 is asked until the flash memory is not busy
  program_verify,         ///< 1F56:01 is asked again
  program_start,          ///< 1F51:01 = 1 is written
  program_started,        ///< 1F51:01 is asked until it reads 1
  restore,                ///< 1011H is written
  boot_up_after_restore,  ///< its boot-up message after the restore is awaited
  configuration_date,     ///< 1020:01 is asked
  configuration_time,     ///< 1020:02 is asked
  configuration,          ///< the concise DCF is being written
  heartbeat_start,        ///< error control: its heartbeat is awaited
  guarding_start,         ///< error control: its guarding answer is awaited
  booted,                 ///< done
  failed,                 ///< ended with an error; begins again with the slave's next boot-up message
};
/// Which of the procedures of CiA 302 a step belongs to.
enum class BootPhase : std::uint8_t { boot, software, configuration, error_control };

/// What is to be known of a step.
struct BootStepFacts {
  BootStep step;
  BootPhase phase;
  bool asks_object;       ///< the step is one SDO transfer, or several
  BootError error;        ///< what a failure of the step is, where nothing else decides it
  std::string_view text;  ///< "checking its identity"
};
[[nodiscard]] const BootStepFacts& facts(BootStep step) noexcept;

/// A node of the bus with another bit rate than the bus, as far as the owner of a master knows one.
struct WrongBitRate {
  std::uint8_t node_id = 0;    ///< 0: none is known
  std::uint32_t bit_rate = 0;  ///< bit/s
  std::uint32_t of_bus = 0;
};

struct BootRecord {
  static constexpr std::uint8_t whole_answer = 8;  ///< bytes of an SDO frame [CiA 301 7.2.4.3]

  BootStep step = BootStep::idle;
  BootStep failed_step = BootStep::idle;  ///< the step that led to `error`
  BootError error = BootError::none;      ///< result, or the latest reason for another attempt
  std::uint16_t index = 0;                ///< object asked or written last, 0 = none
  std::uint8_t sub = 0;
  std::uint32_t expected = 0;  ///< of a comparison that failed
  std::uint32_t received = 0;
  std::uint32_t attempts = 0;  ///< requests for 1000H since the boot of this slave began
  std::uint32_t bytes = 0;     ///< program_download: handed to the SDO transfer so far
  std::uint32_t size = 0;      ///< program_download: bytes of the program, 0 = not known
  can::Time since{};           ///< when the present step began
  canopen::AbortCode abort_code = canopen::AbortCode::none;  ///< of the last SDO; timed_out: no answer
  std::uint8_t answer_length = whole_answer;  ///< of the last SDO's answer; fewer bytes: it failed for that
  WrongBitRate wrong_bit_rate{};
  /// The mandatory slave whose failed boot ended the start-up before this slave was started; 0: none. The step is then
  /// `booted`, or `idle` if this boot was given up.
  std::uint8_t halted_by = 0;
};

/// Where the boot is, in a few words: "checking its identity, 1018:02", "failed (D, vendor-ID differs from
/// 1F85H)".
[[nodiscard]] std::string describe(const BootRecord& record);
/// One or two sentences: where the boot is, and what to check when it does not go on.
[[nodiscard]] std::string explain(const BootRecord& record, can::Time now);
/// The same, after "Node 5: ".
[[nodiscard]] std::string explain(const BootRecord& record, std::uint8_t node_id, can::Time now);

}  // namespace canopus::manager
