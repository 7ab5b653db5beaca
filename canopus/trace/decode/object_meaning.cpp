#include "canopus/trace/decode/object_meaning.hpp"

#include <algorithm>
#include <array>

#include "canopus/trace/decode/object_facts.hpp"

namespace canopus::trace {
namespace {

struct MeaningRow {
  std::uint16_t first;
  std::uint16_t last;
  int sub;  // -1: the sub-indexes that have no row of their own
  std::string_view text;
  std::string_view source;
};

constexpr int other_subs = -1;

// By index; a sub-index before `other_subs`.
constexpr std::array meanings{
    MeaningRow{
        0x1000, 0x1000, other_subs,
        "The device profile in the low 16 bits (401: inputs and outputs, 402: drives, 406: encoders), what "
        "the device has of it in the others.",
        "CiA 301 7.5.2.1"},
    MeaningRow{
        0x1001, 0x1001, other_subs,
        "Which kinds of error are there: bit 0 any, 1 current, 2 voltage, 3 temperature, 4 communication, 5 "
        "of the device profile, 7 of the manufacturer. Goes out with each emergency.",
        "CiA 301 7.5.2.2"},
    MeaningRow{0x1002, 0x1002, other_subs, "The state of the device, in the manufacturer's own way.",
               "CiA 301 7.5.2.3"},
    MeaningRow{0x1003, 0x1003, 0, "How many errors are in the list; 0 written deletes them.",
               "CiA 301 7.5.2.4"},
    MeaningRow{0x1003, 0x1003, other_subs,
               "An error that occurred, the latest in 01H: emergency code in the low 16 bits, more of the "
               "manufacturer in the others.",
               "CiA 301 7.5.2.4"},
    MeaningRow{0x1005, 0x1005, other_subs,
               "The CAN-ID of SYNC; bit 30 set: this device sends it, every 1006H.", "CiA 301 7.5.2.5"},
    MeaningRow{0x1006, 0x1006, other_subs, "The time from one SYNC to the next; 0: none is sent.",
               "CiA 301 7.5.2.6"},
    MeaningRow{0x1007, 0x1007, other_subs,
               "How long after SYNC synchronous PDOs may be sent; later ones are left out. 0: no limit.",
               "CiA 301 7.5.2.7"},
    MeaningRow{0x1008, 0x1008, other_subs, "The name that the manufacturer gave the device.",
               "CiA 301 7.5.2.8"},
    MeaningRow{0x1009, 0x1009, other_subs, "The version of the hardware.", "CiA 301 7.5.2.9"},
    MeaningRow{0x100A, 0x100A, other_subs, "The version of the software.", "CiA 301 7.5.2.10"},
    MeaningRow{
        0x100C, 0x100C, other_subs,
        "How often the NMT master asks for the state (node guarding); with 100DH the life time, after which "
        "the device takes the master for lost. 0: no guarding.",
        "CiA 301 7.5.2.11"},
    MeaningRow{
        0x100D, 0x100D, other_subs,
        "How many guard times (100CH) the device waits for the master's question. 0: it does not wait.",
        "CiA 301 7.5.2.12"},
    MeaningRow{
        0x1010, 0x1010, 1,
        "Read: whether the device can store parameters. \"save\" (65766173H) written stores all of them.",
        "CiA 301 7.5.2.13"},
    MeaningRow{0x1010, 0x1010, 2,
               "\"save\" (65766173H) written stores the communication parameters, 1000H to 1FFFH.",
               "CiA 301 7.5.2.13"},
    MeaningRow{0x1010, 0x1010, 3,
               "\"save\" (65766173H) written stores the application's parameters, 6000H to 9FFFH.",
               "CiA 301 7.5.2.13"},
    MeaningRow{0x1010, 0x1010, other_subs,
               "\"save\" (65766173H) written stores parameters of the manufacturer's choice.",
               "CiA 301 7.5.2.13"},
    MeaningRow{
        0x1011, 0x1011, 1,
        "\"load\" (64616F6CH) written brings the factory settings of all parameters back, with the next "
        "reset.",
        "CiA 301 7.5.2.14"},
    MeaningRow{
        0x1011, 0x1011, 2,
        "\"load\" (64616F6CH) written brings those of the communication parameters back, with the next "
        "reset.",
        "CiA 301 7.5.2.14"},
    MeaningRow{
        0x1011, 0x1011, 3,
        "\"load\" (64616F6CH) written brings those of the application's parameters back, with the next "
        "reset.",
        "CiA 301 7.5.2.14"},
    MeaningRow{
        0x1011, 0x1011, other_subs,
        "\"load\" (64616F6CH) written brings factory settings of the manufacturer's choice back, with the "
        "next reset.",
        "CiA 301 7.5.2.14"},
    MeaningRow{0x1012, 0x1012, other_subs,
               "The CAN-ID of TIME; bit 31 set: the device takes it, bit 30 set: it sends it.",
               "CiA 301 7.5.2.15"},
    MeaningRow{0x1013, 0x1013, other_subs, "A time stamp of the device's clock that can be mapped into PDOs.",
               "CiA 301 7.5.2.16"},
    MeaningRow{
        0x1014, 0x1014, other_subs,
        "The CAN-ID of the device's emergencies, 80H plus its node-ID as a rule; bit 31 set: it sends none.",
        "CiA 301 7.5.2.17"},
    MeaningRow{0x1015, 0x1015, other_subs, "The least time from one emergency to the next.",
               "CiA 301 7.5.2.18"},
    MeaningRow{0x1016, 0x1016, 0, "How many heartbeats the device can watch.", "CiA 301 7.5.2.19"},
    MeaningRow{
        0x1016, 0x1016, other_subs,
        "A heartbeat that the device watches: node-ID in bits 16 to 23, the time within which it must come "
        "in ms in the low 16. Longer than the producer's own time (1017H there). 0: none.",
        "CiA 301 7.5.2.19"},
    MeaningRow{0x1017, 0x1017, other_subs, "How often the device sends its heartbeat; 0: it sends none.",
               "CiA 301 7.5.2.20"},
    MeaningRow{0x1018, 0x1018, 1, "The vendor of the device: its number from CiA.", "CiA 301 7.5.2.21"},
    MeaningRow{0x1018, 0x1018, 2, "Which device it is, by the manufacturer.", "CiA 301 7.5.2.21"},
    MeaningRow{0x1018, 0x1018, 3, "Which version: what it does on CANopen changes with the high 16 bits.",
               "CiA 301 7.5.2.21"},
    MeaningRow{0x1018, 0x1018, 4, "The number of this piece.", "CiA 301 7.5.2.21"},
    MeaningRow{0x1018, 0x1018, other_subs, "A number of identity of the manufacturer.", "CiA 301 7.5.2.21"},
    MeaningRow{0x1019, 0x1019, other_subs,
               "Up to which number SYNC counts, 2 to 240; 0: SYNC has no counter.", "CiA 301 7.5.2.22"},
    MeaningRow{0x1020, 0x1020, 1,
               "The day of the configuration, in days since 1984-01-01; changing a parameter sets it to 0.",
               "CiA 301 7.5.2.23"},
    MeaningRow{0x1020, 0x1020, 2,
               "The time of the configuration, in ms since midnight; changing a parameter sets it to 0.",
               "CiA 301 7.5.2.23"},
    MeaningRow{0x1021, 0x1021, other_subs, "The device's own EDS.", "CiA 301 7.5.2.24"},
    MeaningRow{0x1022, 0x1022, other_subs, "How the EDS of 1021H is packed; 0: as text.", "CiA 301 7.5.2.25"},
    MeaningRow{0x1028, 0x1028, other_subs,
               "The CAN-ID of another node's emergencies that the device takes; bit 31 set: none.",
               "CiA 301 7.5.2.31"},
    MeaningRow{
        0x1029, 0x1029, 1,
        "What the device does when it loses the bus or a heartbeat: 0 Pre-operational if it was Operational, "
        "1 no change, 2 Stopped.",
        "CiA 301 7.5.2.32"},
    MeaningRow{
        0x1029, 0x1029, other_subs,
        "What the device does on an error of its own: 0 Pre-operational if it was Operational, 1 no change, "
        "2 Stopped.",
        "CiA 301 7.5.2.32"},
    MeaningRow{0x102A, 0x102A, other_subs,
               "The least time from one NMT command to the next that the master sends.", "CiA 302-2"},
    MeaningRow{0x1200, 0x127F, 1, "The CAN-ID on which this SDO server is asked; bit 31 set: it is off.",
               "CiA 301 7.5.2.33"},
    MeaningRow{0x1200, 0x127F, 2, "The CAN-ID with which this SDO server answers; bit 31 set: it is off.",
               "CiA 301 7.5.2.33"},
    MeaningRow{0x1200, 0x127F, 3, "The node-ID of the client that asks.", "CiA 301 7.5.2.33"},
    MeaningRow{0x1280, 0x12FF, 1, "The CAN-ID on which this SDO client asks; bit 31 set: it is off.",
               "CiA 301 7.5.2.34"},
    MeaningRow{0x1280, 0x12FF, 2, "The CAN-ID on which it is answered; bit 31 set: it is off.",
               "CiA 301 7.5.2.34"},
    MeaningRow{0x1280, 0x12FF, 3, "The node-ID of the server that is asked.", "CiA 301 7.5.2.34"},
    MeaningRow{
        0x1400, 0x15FF, 1,
        "The CAN-ID that this RPDO takes; bit 31 set: it is off. Another CAN-ID is written to a PDO that is "
        "off.",
        "CiA 301 7.5.2.35"},
    MeaningRow{0x1400, 0x15FF, 2,
               "When what was received counts: 0 to 240 with the next SYNC, 254 and 255 at once.",
               "CiA 301 7.5.2.35"},
    MeaningRow{0x1400, 0x15FF, 5,
               "Within what time the PDO must come again; later is an error. 0: not watched.",
               "CiA 301 7.5.2.35"},
    MeaningRow{0x1600, 0x17FF, 0,
               "How many objects the PDO holds. 0 written first, the objects, then their number.",
               "CiA 301 7.5.2.36"},
    MeaningRow{
        0x1600, 0x17FF, other_subs,
        "Where the next bits of the PDO go: index, sub-index and length in bits, 60000108H is 8 bits for "
        "6000:01.",
        "CiA 301 7.5.2.36"},
    MeaningRow{
        0x1800, 0x19FF, 1,
        "The CAN-ID of this TPDO; bit 31 set: it is off; bit 30 set: it is not sent on a remote frame. "
        "Another CAN-ID is written to a PDO that is off.",
        "CiA 301 7.5.2.37"},
    MeaningRow{
        0x1800, 0x19FF, 2,
        "When it is sent: 0 with SYNC if something changed, 1 to 240 with every so many SYNCs, 252 and 253 "
        "when asked by a remote frame, 254 and 255 when something changed or the event timer ends.",
        "CiA 301 7.5.2.37"},
    MeaningRow{0x1800, 0x19FF, 3, "The least time from one to the next.", "CiA 301 7.5.2.37"},
    MeaningRow{0x1800, 0x19FF, 5, "It is sent after this time, if nothing changed before; 0: only then.",
               "CiA 301 7.5.2.37"},
    MeaningRow{0x1800, 0x19FF, 6, "With which number of a counting SYNC it begins; 0: with any.",
               "CiA 301 7.5.2.37"},
    MeaningRow{0x1A00, 0x1BFF, 0,
               "How many objects the PDO holds. 0 written first, the objects, then their number.",
               "CiA 301 7.5.2.38"},
    MeaningRow{
        0x1A00, 0x1BFF, other_subs,
        "Where the next bits of the PDO come from: index, sub-index and length in bits, 60000108H is 8 bits "
        "of 6000:01.",
        "CiA 301 7.5.2.38"},
    MeaningRow{0x1F20, 0x1F20, other_subs, "The DCF of a slave; its sub-index is the node-ID.", "CiA 302-3"},
    MeaningRow{
        0x1F22, 0x1F22, other_subs,
        "What the master writes into a slave before it starts it, as a concise DCF; its sub-index is the "
        "node-ID.",
        "CiA 302-3"},
    MeaningRow{
        0x1F25, 0x1F25, other_subs,
        "\"conf\" (666E6F63H) written configures this slave again; its sub-index is the node-ID, 80H: all.",
        "CiA 302-3"},
    MeaningRow{0x1F26, 0x1F26, other_subs,
               "The day of configuration that 1020:01 of this slave must have, else it is configured; its "
               "sub-index is the node-ID.",
               "CiA 302-3"},
    MeaningRow{0x1F27, 0x1F27, other_subs,
               "The time of configuration that 1020:02 of this slave must have, else it is configured; its "
               "sub-index is the node-ID.",
               "CiA 302-3"},
    MeaningRow{0x1F50, 0x1F50, other_subs, "A program of the device is downloaded here.", "CiA 302-3"},
    MeaningRow{0x1F51, 0x1F51, other_subs, "A program of the device: 0 stop, 1 start, 2 reset, 3 clear.",
               "CiA 302-3"},
    MeaningRow{0x1F56, 0x1F56, other_subs,
               "By which number a program of the device is distinguished from others.", "CiA 302-3"},
    MeaningRow{0x1F57, 0x1F57, other_subs, "Whether a download into the flash goes on, and how it ended.",
               "CiA 302-3"},
    MeaningRow{
        0x1F80, 0x1F80, other_subs,
        "Whether the device is the NMT master (bit 0), starts all nodes at once (1), does not start itself "
        "(2) or the slaves (3), resets all on the loss of a mandatory one (4), or stops them (6), takes part "
        "in the flying master (5).",
        "CiA 302-2"},
    MeaningRow{
        0x1F81, 0x1F81, other_subs,
        "A slave of the master: bit 0 it is one, 2 is booted, 3 is mandatory, 4 is not reset while "
        "operational, 5 software is checked, 6 may be updated, 7 defaults come back before; guarding in "
        "bits 8 to 31. Its sub-index is the node-ID.",
        "CiA 302-2"},
    MeaningRow{0x1F82, 0x1F82, other_subs,
               "The state of a node, read; a command to it, written: 4 stop, 5 start, 6 reset, 7 reset "
               "communication, 127 pre-operational. Its sub-index is the node-ID, 80H: all.",
               "CiA 302-2"},
    MeaningRow{
        0x1F83, 0x1F83, other_subs,
        "Whether a node is guarded; 1 written begins, 0 ends it. Its sub-index is the node-ID, 80H: all.",
        "CiA 302-2"},
    MeaningRow{0x1F84, 0x1F84, other_subs,
               "The device type that a slave must have; 0: any. Its sub-index is the node-ID.", "CiA 302-2"},
    MeaningRow{0x1F85, 0x1F85, other_subs,
               "The vendor that a slave must be of; 0: any. Its sub-index is the node-ID.", "CiA 302-2"},
    MeaningRow{0x1F86, 0x1F86, other_subs,
               "The product that a slave must be; 0: any. Its sub-index is the node-ID.", "CiA 302-2"},
    MeaningRow{0x1F87, 0x1F87, other_subs,
               "The revision that a slave must have; 0: any. Its sub-index is the node-ID.", "CiA 302-2"},
    MeaningRow{0x1F88, 0x1F88, other_subs,
               "The serial number that a slave must have; 0: any. Its sub-index is the node-ID.",
               "CiA 302-2"},
    MeaningRow{0x1F89, 0x1F89, other_subs, "How long the master waits for mandatory slaves; 0: for ever.",
               "CiA 302-2"},
    MeaningRow{0x1F90, 0x1F90, 0, "How many times of the flying master there are.", "CiA 302-2"},
    MeaningRow{0x1F90, 0x1F90, 1,
               "How long a flying master waits for an answer to its question for an active one.",
               "CiA 302-2"},
    MeaningRow{0x1F90, 0x1F90, 2,
               "How long a flying master waits after a reset before it looks for an active one.",
               "CiA 302-2"},
    MeaningRow{0x1F90, 0x1F90, 3,
               "The priority of the flying master: 0 high, 1 medium, 2 low; priority x priority time slot + "
               "node-ID x device time slot is what it waits in a negotiation.",
               "CiA 302-2"},
    MeaningRow{0x1F90, 0x1F90, 4,
               "The priority time slot of the negotiation: more than 127 device time slots.", "CiA 302-2"},
    MeaningRow{0x1F90, 0x1F90, 5, "The device time slot of the negotiation; it counts once for each node-ID.",
               "CiA 302-2"},
    MeaningRow{0x1F90, 0x1F90, 6, "How often the active flying master looks for a second one.", "CiA 302-2"},
    MeaningRow{0x1FA0, 0x1FCF, other_subs,
               "Objects that a multiplex PDO of the scanner sends when they change.", "CiA 301 7.5.2.39"},
    MeaningRow{0x1FD0, 0x1FFF, other_subs, "Where objects of a received multiplex PDO go.",
               "CiA 301 7.5.2.40"},
    MeaningRow{0x603F, 0x603F, other_subs, "The latest error of the drive, by the codes of emergencies.",
               "CiA 402-2"},
    MeaningRow{
        0x6040, 0x6040, other_subs,
        "The command to the drive: bit 0 switch on, 1 enable voltage, 2 quick stop (0 stops), 3 enable "
        "operation, 4 to 6 by mode, 7 fault reset (edge), 8 halt.",
        "CiA 402-2"},
    MeaningRow{
        0x6041, 0x6041, other_subs,
        "The state of the drive: bit 0 ready to switch on, 1 switched on, 2 operation enabled, 3 fault, 4 "
        "voltage enabled, 5 quick stop (0: stops), 6 switch on disabled, 7 warning, 9 remote, 10 target "
        "reached, 11 limit.",
        "CiA 402-2"},
    MeaningRow{
        0x605A, 0x605A, other_subs,
        "What quick stop does: 1 the ramp, 2 the quick stop ramp, then switch on disabled; 5 and 6 the same, "
        "and it stays in quick stop.",
        "CiA 402-2"},
    MeaningRow{
        0x6060, 0x6060, other_subs,
        "The mode that is wanted: 1 profile position, 2 velocity, 3 profile velocity, 4 torque, 6 homing, 7 "
        "interpolated, 8 to 10 cyclic synchronous position, velocity, torque.",
        "CiA 402-2"},
    MeaningRow{0x6061, 0x6061, other_subs, "The mode that is on, in the numbers of 6060H.", "CiA 402-2"},
    MeaningRow{0x6064, 0x6064, other_subs, "Where the drive is.", "CiA 402-2"},
    MeaningRow{0x606C, 0x606C, other_subs, "How fast the drive is.", "CiA 402-2"},
    MeaningRow{0x6077, 0x6077, other_subs, "The torque of the drive, in 0.1 % of the rated one.",
               "CiA 402-2"},
    MeaningRow{0x607A, 0x607A, other_subs, "Where the drive shall go in profile position.", "CiA 402-2"},
    MeaningRow{0x6081, 0x6081, other_subs, "How fast it goes there.", "CiA 402-2"},
    MeaningRow{0x6083, 0x6083, other_subs, "How fast its speed rises on the way.", "CiA 402-2"},
    MeaningRow{0x6084, 0x6084, other_subs, "How fast its speed falls at the end.", "CiA 402-2"},
    MeaningRow{0x6098, 0x6098, other_subs, "How the drive looks for its home.", "CiA 402-2"},
    MeaningRow{0x60FF, 0x60FF, other_subs, "The speed that is wanted in profile velocity.", "CiA 402-2"},
    MeaningRow{0x6502, 0x6502, other_subs, "The modes that the drive has: a bit each, bit 0 for mode 1.",
               "CiA 402-2"},
};

/// Objects whose sub-index 00H is the number of entries.
constexpr bool has_count(std::uint16_t index) noexcept {
  constexpr std::array arrays{0x1003, 0x1010, 0x1011, 0x1016, 0x1018, 0x1020, 0x1028, 0x1029};
  return std::ranges::find(arrays, index) != arrays.end() || (index >= 0x1200 && index <= 0x1BFF) ||
         (index >= 0x1F20 && index <= 0x1F57) || (index >= 0x1F81 && index <= 0x1F88) || index >= 0x1FA0;
}

constexpr bool meanings_are_sorted() {
  for (std::size_t i = 1; i < meanings.size(); ++i) {
    if (meanings[i].first < meanings[i - 1].first) return false;
    if (meanings[i].first == meanings[i - 1].first && meanings[i - 1].sub == other_subs) return false;
  }
  return true;
}
static_assert(meanings_are_sorted());

}  // namespace

ObjectMeaning object_meaning(std::uint16_t index, std::uint8_t sub) noexcept {
  const auto* row = std::ranges::upper_bound(meanings, index, {}, &MeaningRow::first);
  const MeaningRow* found = nullptr;
  while (row != meanings.begin()) {
    --row;
    if (index > row->last) break;
    if (row->sub == sub || (row->sub == other_subs && found == nullptr)) found = row;
  }
  if (found == nullptr) return {};
  if (sub == 0 && found->sub == other_subs && index < 0x2000 && has_count(index))
    return {.text = "How many sub-indexes the object has.", .source = found->source};
  return {.text = found->text, .unit = object_unit(index, sub), .source = found->source};
}

}  // namespace canopus::trace
