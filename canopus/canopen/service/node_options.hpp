#pragma once
// How a node behaves where CiA 301 leaves a choice or a device's manual differs from it.

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/stored_length.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/emcy_code.hpp"

namespace canopus::canopen {

struct NodeOptions {
  // --- NMT
  /// From an NMT reset to the boot-up message; meanwhile the node receives and sends nothing.
  can::Duration reset_time{};

  // --- PDO
  /// An event of an event-driven TPDO during its inhibit time (its event timer's end included): sent when the
  /// inhibit time ends (CiA 301) or forgotten [ME3CAN1-Q 4.6.5 cases 2 and 5].
  bool dismiss_events_during_inhibit = false;
  /// Values count as changed until a TPDO has sent them once; else only against what they were when the TPDO
  /// became valid or the node entered Operational [ME3CAN1-Q 4.6.5 case 1].
  bool unsent_values_are_changed = true;
  /// Send all valid event-driven TPDOs once on entering Operational.
  bool send_tpdos_on_start = true;
  /// Values written through SDO to mapped objects cause events of the TPDOs that hold them.
  bool sdo_write_is_event = true;
  /// Bit 30 of a TPDO's COB-ID always reads 1 (no RTR); writing 0 has no effect [ME3CAN1-Q 4.6.5].
  bool tpdo_rtr_bit_is_constant = false;
  /// Bit 30 of the COB-IDs of RPDOs and emergency consumers is fixed at 0, as bits 11 to 29 are: 06090030H
  /// [FX3U-CAN 5.6.5, 5.6.13; RJ71CN91 App. 3 1400H, 1028H].
  bool reserved_bit_30_is_zero = false;
  /// A restricted identifier that PDOs may have all the same [FX3U-CAN Tab. 5.8: 180H].
  std::uint32_t permitted_pdo_identifier = no_identifier;
  /// Transmission types FCH and FDH of TPDOs exist; else they are refused with 06090030H.
  bool rtr_transmission_types = true;
  /// Transmission type FFH exists; else it is refused with 06090030H [ME3CAN1-Q 4.6.5].
  bool profile_event_transmission_type = true;
  /// Inhibit times (PDO and EMCY) count in steps of this: a value other than 0 that is shorter acts as one
  /// step, a fraction is dropped [ME3CAN1-Q 4.6.5: 1 ms].
  can::Duration inhibit_time_resolution = std::chrono::microseconds(100);
  /// The event timer of an RPDO watches one that is event-driven (FEH, FFH), and no synchronous one [FX3U-CAN 5.6.5].
  bool rpdo_timer_for_events_alone = false;
  /// The identifier of a PDO may change while it is valid [CiA DS-301 V3; FX2N-32CAN 7.3.3].
  bool pdo_identifiers_may_change = false;
  /// Configurable COB-IDs may have 29-bit identifiers (bit 29); else 06090030H.
  bool extended_identifiers = true;

  // --- NMT
  /// As the active NMT master the node takes no NMT command from the bus, not even one for itself [RJ71CN91 1.2 Node
  /// control]; else none to all nodes.
  bool active_master_commands_itself = false;

  // --- SYNC, TIME
  /// Produce SYNC and TIME only while Node::set_active_master(true) [ME3CAN1-Q 4.6.6, 4.6.9].
  bool sync_needs_active_master = false;
  /// 1006H counts in steps of this, as inhibit_time_resolution [ME3CAN1-Q 4.6.6: 1 ms].
  can::Duration sync_period_resolution = std::chrono::microseconds(1);

  // --- EMCY
  /// Writing 0 to 1003:00 clears 1001H, too [ME3CAN1-Q 4.6.3].
  bool history_clears_error_register = false;
  /// Errors count as there until 1003H is emptied: that clears 1001H, too, and sends code 0000H [RJ71CN91 1.7]. Else code
  /// 0000H is sent when what caused them is over.
  bool errors_end_with_history = false;
  /// The two manufacturer bytes that 1003H keeps stand there as they are printed, the first one high: 4D45H for "ME"
  /// [RJ71CN91 App. 3 1003H].
  bool history_has_first_byte_high = false;
  /// Reading a sub-index of 1003H above the number of entries gives 0, instead of abort code 08000024H.
  bool empty_history_reads_zero = false;
  /// A lost heartbeat is reported with 8F00H + node-ID of the lost node, a life guarding event with 8F00H + own
  /// node-ID, instead of 8130H [ME3CAN1-Q 8.2.1].
  bool guarding_emergency_names_node = false;
  /// Emergency code 8250H carries the RPDO's number, counted from 1, low byte first, and the text "PDO", last letter first
  /// [FX3U-CAN 6.23]; else zeros.
  bool rpdo_time_out_names_pdo = false;
  /// Emergency code of a SYNC of the wrong length; modules that do not know 8240H say 8200H
  /// [ME3CAN1-Q 8.2.1].
  std::uint16_t sync_length_error = emcy_code::sync_length;

  /// A dictionary without 1014H sends EMCY with the pre-defined COB-ID, one without 1028H receives those of all nodes [CiA
  /// DS-301 V3; FX2N-32CAN 5.3.2].
  bool predefined_emergency = false;
  /// What 1029:01 counts as where it is missing [CiA 301 7.5.2.32].
  std::uint8_t error_behaviour = 0;

  // --- Stored parameters
  /// 1010H saves also between "load" at 1011H and the reset that restores: the present values count again.
  /// Else 08000022H. [ME3CAN1-Q 4.6.11 knows no such refusal]
  bool save_before_restored = false;
  /// How the stored values lie in the ParameterStore.
  StoredLength stored_length = StoredLength::four_bytes;

  // --- SDO server
  /// A transfer whose client is silent for so long is aborted with 05040000H; 0 = never.
  can::Duration sdo_server_time_out = std::chrono::seconds(1);
  /// Longest value of variable length that a download may bring, in bytes; more: 05040005H.
  std::size_t sdo_maximum_download = 1U << 20;
  /// SDO requests with a DLC below 8 count if they have the bytes that their command needs, as many devices in the field have
  /// it; else they are ignored [CiA 301 7.2.4.3: 8 bytes].
  bool accepts_short_sdo_requests = false;
};

}  // namespace canopus::canopen
