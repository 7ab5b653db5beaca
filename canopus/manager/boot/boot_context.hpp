#pragma once
// What the parts of one slave's boot share: whose boot it is, how far it is, and the transfer of its present
// step.

#include <cstdint>
#include <expected>

#include "canopus/manager/boot/boot_host.hpp"
#include "canopus/manager/boot/boot_transfer.hpp"

namespace canopus::manager {

/// What a part returns when it was begun, or an answer came.
enum class StepResult : std::uint8_t {
  wait,           ///< for an answer or a time
  go_on,          ///< it is done: the next part
  from_presence,  ///< the boot begins again with 1000H
  from_start,     ///< the boot begins again as after an unexpected boot-up message
};
/// That, or the error that ends the boot.
using BootOutcome = std::expected<StepResult, BootError>;

struct BootContext {
  BootContext(std::uint8_t id, BootHost& the_host, can::Sink& sink, BootTransferListener& listener)
      : node_id(id), host(the_host), transfer(id, the_host, sink, record, listener) {}

  /// The boot is at this step. `limit`: how long it may take, 0 = no limit.
  void enter(BootStep step, can::Time now, can::Duration limit = {}) {
    record.step = step;
    record.since = now;
    transfer.forget();
    step_end = limit > can::Duration{} ? later(now, limit) : can::never;
    if (!facts(step).asks_object) host.boot_went_on(node_id, record, now);
  }
  /// Reads this object, as this step.
  void request(BootStep step, std::uint16_t index, std::uint8_t sub, can::Time now) {
    enter(step, now);
    transfer.read(index, sub, now);
  }
  [[nodiscard]] std::uint32_t assignment() const { return host.assignment(node_id); }
  /// Entry of the slave in an array of this node's dictionary, 1F84H for example.
  [[nodiscard]] std::uint32_t expected(std::uint16_t index) const {
    return host.dictionary().get<std::uint32_t>(index, node_id);
  }
  [[nodiscard]] bool was_answered() const noexcept { return record.abort_code == canopen::AbortCode::none; }
  [[nodiscard]] bool was_silent() const noexcept {
    return record.abort_code == canopen::AbortCode::timed_out;
  }

  std::uint8_t node_id;
  BootHost& host;
  BootRecord record;
  BootTransfer transfer;
  can::Alarm step_end;    // of the present step
  bool answered = false;  // an SDO, since the slave was reset
};

}  // namespace canopus::manager
