#include "canopus/manager/boot/boot_record.hpp"

#include <array>
#include <cstdio>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/hex.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"

namespace canopus::manager {

std::string_view describe(BootError error) noexcept {
  switch (error) {
    case BootError::none: return "no error";
    case BootError::not_assigned: return "not assigned in 1F81H";
    case BootError::no_answer: return "no answer to 1000H";
    case BootError::device_type: return "device type differs from 1F84H";
    case BootError::vendor: return "vendor-ID differs from 1F85H";
    case BootError::no_heartbeat_state: return "keep alive: no heartbeat";
    case BootError::no_guarding_state: return "keep alive: no guarding answer";
    case BootError::software_not_described: return "software version not described";
    case BootError::software_not_allowed: return "software update needed but not allowed";
    case BootError::software_download: return "program download failed";
    case BootError::configuration: return "configuration failed";
    case BootError::no_error_control: return "error control did not start";
    case BootError::already_operational: return "was already Operational";
    case BootError::product: return "product code differs from 1F86H";
    case BootError::revision: return "revision number differs from 1F87H";
    case BootError::serial: return "serial number differs from 1F88H";
  }
  return "unknown error";
}

namespace {

// clang-format off
constexpr auto steps = [] {
  using enum BootStep;
  // The errors of `identity` and `boot_up_after_reset` depend on more than the step: BootSlave::error_of_step().
  return std::to_array<BootStepFacts>({
      {idle,                  BootPhase::boot,          false, BootError::no_answer,              "not being booted"},
      {wait_after_reset,      BootPhase::boot,          false, BootError::no_answer,              "waiting for its boot-up message after the reset"},
      {presence,              BootPhase::boot,          true,  BootError::no_answer,              "asking for 1000H"},
      {presence_pause,        BootPhase::boot,          false, BootError::no_answer,              "no answer to 1000H, waiting to ask again"},
      {identity,              BootPhase::boot,          true,  BootError::vendor,                 "checking its identity"},
      {state_by_heartbeat,    BootPhase::boot,          false, BootError::no_heartbeat_state,     "waiting for a heartbeat to learn its state"},
      {state_by_guarding,     BootPhase::boot,          false, BootError::no_guarding_state,      "waiting for a guarding answer to learn its state"},
      {boot_up_after_reset,   BootPhase::boot,          false, BootError::no_heartbeat_state,     "waiting for its boot-up message after Reset communication"},
      {software_version,      BootPhase::software,      true,  BootError::software_not_described, "comparing its software version"},
      {program_state,         BootPhase::software,      true,  BootError::software_download,      "asking whether its program runs"},
      {program_stop,          BootPhase::software,      true,  BootError::software_download,      "stopping its program"},
      {program_clear,         BootPhase::software,      true,  BootError::software_download,      "clearing its program"},
      {program_download,      BootPhase::software,      true,  BootError::software_download,      "downloading its program"},
      {program_flash,         BootPhase::software,      true,  BootError::software_download,      "waiting for its flash memory"},
      {program_verify,        BootPhase::software,      true,  BootError::software_download,      "comparing the software version of its new program"},
      {program_start,         BootPhase::software,      true,  BootError::software_download,      "starting its program"},
      {program_started,       BootPhase::software,      true,  BootError::software_download,      "waiting for its program to run"},
      {restore,               BootPhase::configuration, true,  BootError::configuration,          "restoring its defaults"},
      {boot_up_after_restore, BootPhase::configuration, false, BootError::configuration,          "waiting for its boot-up message after the restore"},
      {configuration_date,    BootPhase::configuration, true,  BootError::configuration,          "comparing its configuration date and time"},
      {configuration_time,    BootPhase::configuration, true,  BootError::configuration,          "comparing its configuration date and time"},
      {configuration,         BootPhase::configuration, true,  BootError::configuration,          "writing its configuration"},
      {heartbeat_start,       BootPhase::error_control, false, BootError::no_error_control,       "waiting for its first heartbeat"},
      {guarding_start,        BootPhase::error_control, false, BootError::no_error_control,       "waiting for its first guarding answer"},
      {booted,                BootPhase::boot,          false, BootError::no_answer,              "booted"},
      {failed,                BootPhase::boot,          false, BootError::no_answer,              "failed"},
  });
}();
// clang-format on
static_assert([] {
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (static_cast<std::size_t>(steps[i].step) != i) return false;
  return steps.size() == static_cast<std::size_t>(BootStep::failed) + 1;
}());

}  // namespace

const BootStepFacts& facts(BootStep step) noexcept { return steps[static_cast<std::size_t>(step)]; }

namespace {

std::string hex(std::uint32_t value, int digits) { return ascii::hex(value, digits) + 'H'; }

std::string object(const BootRecord& record) { return canopen::object_text(record.index, record.sub); }

std::string comparison(const BootRecord& record) {
  return object(record) + " reads " + hex(record.received, 8) + ", expected " + hex(record.expected, 8) + ".";
}

std::string abort_text(const BootRecord& record) {
  if (record.abort_code == canopen::AbortCode::timed_out) return "no answer (time-out)";
  if (record.answer_length < BootRecord::whole_answer)
    return "an answer of " + ascii::counted(record.answer_length, "byte") + ", expected 8";
  return "abort " + hex(static_cast<std::uint32_t>(record.abort_code), 8) + ", " +
         std::string(canopen::describe(record.abort_code));
}

// 1F57H, bits 1 to 7 [CiA 302-3].
std::string_view flash_status_text(std::uint32_t status) {
  switch (status >> 1 & 0x7F) {
    case 0: return "no error";
    case 1: return "there is no valid program";
    case 2: return "the format of the program is not known";
    case 3: return "the program is damaged (format or CRC)";
    case 4: return "the flash memory was not cleared before";
    case 5: return "the flash memory could not be written";
    case 6: return "an address of the program is wrong";
    case 7: return "the flash memory is protected";
    case 63: return "an error that is not specified";
    default: return "a code of the manufacturer";
  }
}

std::string download_advice(const BootRecord& record) {
  const bool aborted = record.abort_code != canopen::AbortCode::none;
  switch (record.failed_step) {
    case BootStep::software_version:
      return comparison(record) + " It was updated and started, and yet reports another version.";
    case BootStep::program_download:
      if (record.index == 0) return "There is no program for it in 1F58H.";
      return object(record) + ": " + abort_text(record) + ", after " + std::to_string(record.bytes) +
             " bytes. Check that the program was made for this device.";
    case BootStep::program_flash:
      if (record.received != 0 && (record.received & 1) == 0) {
        return object(record) + " reads " + hex(record.received, 8) + ": " +
               std::string(flash_status_text(record.received)) + ".";
      }
      return "The flash memory of the device was busy for too long.";
    case BootStep::program_verify:
      if (!aborted) return comparison(record) + " Check that 1F55H is the version of the program in 1F58H.";
      break;
    case BootStep::program_started:
      if (!aborted) return "The new program does not start. Check that it was made for this device.";
      break;
    default: break;
  }
  return object(record) + ": " + abort_text(record) + ". Check that the device takes programs over CANopen.";
}

/// "once", "3 times"
std::string attempts_text(std::uint32_t count) {
  return count == 1 ? "once" : std::to_string(count) + " times";
}

std::string asked(const BootRecord& record) {
  return "Asked " + attempts_text(record.attempts) + " without an answer.";
}

std::string wrong_bit_rate_text(const WrongBitRate& wrong) {
  const auto kbit = [](std::uint32_t rate) { return std::to_string(rate / 1000) + " kbit/s"; };
  const std::string who =
      wrong.node_id > 127 ? " A device without a node-ID" : " Node " + std::to_string(wrong.node_id);
  return who + " has " + kbit(wrong.bit_rate) + ", the bus " + kbit(wrong.of_bus) +
         ": no frame of this bus is valid until they are the same.";
}

// What is wrong, if the record knows, and what a person can check.
std::string advice(const BootRecord& record) {
  const bool aborted = record.abort_code != canopen::AbortCode::none;
  switch (record.error) {
    case BootError::none:
    case BootError::already_operational: return {};
    case BootError::not_assigned: return "Set bit 0 of its 1F81H entry to make it a slave of this master.";
    case BootError::no_answer:
      if (aborted && record.abort_code != canopen::AbortCode::timed_out) {
        return "The device answers 1000H with " + abort_text(record) +
               ". Check whether it is a CANopen device and whether its SDO server is free.";
      }
      if (record.wrong_bit_rate.node_id != 0)
        return asked(record) + wrong_bit_rate_text(record.wrong_bit_rate);
      return asked(record) +
             " Check that the device is powered and connected, has this node-ID and "
             "this bit rate, and that the bus is terminated.";
    case BootError::device_type:
      return comparison(record) + " Another device has this node-ID, or 1F84H is set wrongly.";
    case BootError::vendor:
    case BootError::product:
    case BootError::revision:
    case BootError::serial: {
      const std::string entry = record.error == BootError::vendor     ? "1F85H"
                                : record.error == BootError::product  ? "1F86H"
                                : record.error == BootError::revision ? "1F87H"
                                                                      : "1F88H";
      if (aborted) {
        return object(record) + ": " + abort_text(record) + ". Set " + entry +
               " to 0 if the device has no such "
               "identity entry.";
      }
      return comparison(record) + " Check the device, or its " + entry + " entry.";
    }
    case BootError::no_heartbeat_state:
      return "1016H watches this node, but no heartbeat came. Check its producer heartbeat time 1017H.";
    case BootError::no_guarding_state:
      return "It did not answer the guarding remote frame. Check that it supports node guarding, or let it "
             "produce a heartbeat and watch it with 1016H.";
    case BootError::configuration:
      if (record.index == 0) return "Its concise DCF in 1F22H is damaged. Write it again.";
      return object(record) + ": " + abort_text(record) +
             ". Check that the configuration was made for this device and this version of it.";
    case BootError::no_error_control:
      if (record.failed_step == BootStep::guarding_start) {
        return "It did not answer the guarding remote frame. Check that it supports node guarding, or clear "
               "its guard time in 1F81H.";
      }
      return "1016H watches this node, but no heartbeat came within its time. Check its producer heartbeat "
             "time 1017H: it must be shorter than the consumer time.";
    case BootError::software_not_described:
      if (record.index == 0) return "1F81H bit 5 is set, but 1F55H holds no version to compare with.";
      return object(record) + ": " + abort_text(record) +
             ". Clear bit 5 of its 1F81H entry if the device has "
             "no such object.";
    case BootError::software_not_allowed:
      return comparison(record) +
             " Set bit 6 of its 1F81H entry and clear bit 4 to have it updated, or set "
             "1F55H to the version it has.";
    case BootError::software_download: return download_advice(record);
  }
  return {};
}

}  // namespace

std::string describe(const BootRecord& record) {
  std::string text(facts(record.step).text);
  switch (record.step) {
    case BootStep::identity:
    case BootStep::configuration:
      if (record.index != 0) text += ", " + object(record);
      break;
    case BootStep::presence_pause: text += " (asked " + attempts_text(record.attempts) + ")"; break;
    case BootStep::failed:
      text += " (" + std::string(1, letter(record.error)) + ", " + std::string(describe(record.error)) + ")";
      break;
    case BootStep::program_download:
      text += ", " + std::to_string(record.bytes);
      if (record.size != 0) text += " of " + std::to_string(record.size);
      text += " bytes";
      break;
    default: break;
  }
  return text;
}

std::string explain(const BootRecord& record, can::Time now) {
  const bool advice_counts = record.step == BootStep::presence_pause;  // the requests
  std::string text = advice_counts ? std::string(facts(record.step).text) : describe(record);
  if (record.step != BootStep::idle) {
    char duration[32];
    std::snprintf(duration, sizeof duration, "%.1f", seconds(now) - seconds(record.since));
    const bool has_ended = record.step == BootStep::booted || record.step == BootStep::failed;
    text += has_ended ? ", " + std::string(duration) + " s ago" : ", for " + std::string(duration) + " s";
  }
  text += ".";
  if (record.halted_by != 0) {
    text += " Not started: the boot of the mandatory slave " + std::to_string(record.halted_by) +
            " failed, which ended the start-up.";
  }
  const std::string more = advice(record);
  return more.empty() ? text : text + " " + more;
}

std::string explain(const BootRecord& record, std::uint8_t node_id, can::Time now) {
  return "Node " + std::to_string(node_id) + ": " + explain(record, now);
}

}  // namespace canopus::manager
