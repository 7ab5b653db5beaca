#pragma once
// Times and limits that a module's manual gives as "about" or leaves open. The defaults are those of the
// ME3CAN1-Q and the RJ71CN91 where their manuals print one.

#include <chrono>

#include "canopus/can/time.hpp"

namespace canopus::module {

struct Profile {
  /// Request of a restart to its end [ME3CAN1-Q 3.3.2, RJ71CN91 App. 1: approx. 6 s].
  can::Duration restart_time = std::chrono::seconds(6);
  /// How long a restart is shown as completed before its request, still there, counts as the next one. Not
  /// printed.
  can::Duration restart_repeat_time = std::chrono::milliseconds(500);
  /// Supply on to the end of initialization. Not printed.
  can::Duration power_on_time = std::chrono::seconds(1);
  /// An NMT reset to the boot-up message, the end of initialization. Not printed.
  can::Duration nmt_reset_time = std::chrono::milliseconds(10);
  /// Request of a data exchange to its end. Not printed.
  can::Duration exchange_time = std::chrono::milliseconds(1);
  /// Shortest time that a command takes; the command word reads FFFFH meanwhile. Not printed.
  can::Duration command_time = std::chrono::milliseconds(1);
  /// Request to save or restore to its end. Not printed.
  can::Duration save_time = std::chrono::milliseconds(100);
  /// Unit of parameter D of a Layer 2 slot: the table says 10 ms, the text 1 ms [ME3CAN1-Q 3.6.2].
  can::Duration layer2_cycle_unit = std::chrono::milliseconds(10);
  /// Layer 2 receive processing: time per message, and messages that may wait for it. Not printed.
  can::Duration layer2_message_time = std::chrono::microseconds(100);
  unsigned layer2_waiting_messages = 8;
  /// How long the flash memory takes no concise DCF after one was deleted. Not printed.
  can::Duration erase_time = std::chrono::seconds(2);
};

}  // namespace canopus::module
