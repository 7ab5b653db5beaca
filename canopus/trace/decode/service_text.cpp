#include "canopus/trace/decode/service_text.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/trace/decode/value_text.hpp"
#include "canopus/trace/decode/value_words.hpp"

namespace canopus::trace {
namespace {

struct Words {
  std::uint16_t code;
  std::string_view text;
};

// Whole codes first, then classes by their high byte, then by their first digit [CiA 301 7.2.7.1, CiA 401].
constexpr std::array codes{
    Words{0x0000, "no error, or error reset"},
    Words{0x2310, "current at outputs too high"},
    Words{0x2320, "short circuit at outputs"},
    Words{0x2330, "load dump at outputs"},
    Words{0x3110, "mains voltage too high"},
    Words{0x3120, "mains voltage too low"},
    Words{0x3210, "internal voltage too high"},
    Words{0x3220, "internal voltage too low"},
    Words{0x3310, "output voltage too high"},
    Words{0x3320, "output voltage too low"},
    Words{0x8110, "CAN overrun, objects lost"},
    Words{0x8120, "CAN in error passive mode"},
    Words{0x8130, "life guard or heartbeat error"},
    Words{0x8140, "recovered from bus-off"},
    Words{0x8150, "CAN-ID collision"},
    Words{0x8210, "PDO not processed: too short"},
    Words{0x8220, "PDO too long"},
    Words{0x8230, "DAM-MPDO not processed: destination object not available"},
    Words{0x8240, "unexpected SYNC data length"},
    Words{0x8250, "RPDO timeout"},
};
constexpr std::array high_bytes{
    Words{0x00, "no error, or error reset"},
    Words{0x10, "generic error"},
    Words{0x20, "current"},
    Words{0x21, "current, device input side"},
    Words{0x22, "current inside the device"},
    Words{0x23, "current, device output side"},
    Words{0x30, "voltage"},
    Words{0x31, "mains voltage"},
    Words{0x32, "voltage inside the device"},
    Words{0x33, "output voltage"},
    Words{0x40, "temperature"},
    Words{0x41, "ambient temperature"},
    Words{0x42, "device temperature"},
    Words{0x50, "device hardware"},
    Words{0x60, "device software"},
    Words{0x61, "internal software"},
    Words{0x62, "user software"},
    Words{0x63, "data set"},
    Words{0x70, "additional modules"},
    Words{0x80, "monitoring"},
    Words{0x81, "communication"},
    Words{0x82, "protocol error"},
    Words{0x90, "external error"},
    Words{0xF0, "additional functions"},
    Words{0xFF, "device specific"},
};
constexpr std::array<std::string_view, 16> first_digits{
    "unknown",     "generic error",   "current",         "voltage",
    "temperature", "device hardware", "device software", "additional modules",
    "monitoring",  "external error",  "unknown",         "unknown",
    "unknown",     "unknown",         "unknown",         "additional functions or device specific"};

void join(std::string& list, std::string_view more, std::string_view between = ", ") {
  if (!list.empty()) list += between;
  list += more;
}

/// One of several words by a bit.
struct Bit {
  unsigned bit;
  std::string_view text;
};

/// SocketCAN's classes [linux/can/error.h].
constexpr std::array error_classes{
    Bit{0x001, "transmission timed out"},
    Bit{0x002, "arbitration lost"},
    Bit{0x004, "controller"},
    Bit{0x008, "protocol violation"},
    Bit{0x010, "transceiver"},
    Bit{0x020, "no acknowledgement"},
    Bit{0x040, "bus-off"},
    Bit{0x080, "bus error"},
    Bit{0x100, "controller restarted"},
};
constexpr std::array controller_states{
    Bit{0x01, "receive overflow"},   Bit{0x02, "transmit overflow"},     Bit{0x04, "receive warning"},
    Bit{0x08, "transmit warning"},   Bit{0x10, "receive error passive"}, Bit{0x20, "transmit error passive"},
    Bit{0x40, "error active again"},
};
constexpr std::array violations{
    Bit{0x01, "single bit"},
    Bit{0x02, "frame format"},
    Bit{0x04, "bit stuffing"},
    Bit{0x08, "dominant bit"},
    Bit{0x10, "recessive bit"},
    Bit{0x20, "overload"},
    Bit{0x40, "active error announcement"},
    Bit{0x80, "on transmission"},
};

template <typename Table>
std::string bits_text(const Table& table, unsigned value) {
  std::string text;
  for (const Bit& bit : table) {
    if ((value & bit.bit) != 0) join(text, bit.text);
  }
  return text;
}

}  // namespace

std::string_view nmt_command_name(std::uint8_t command) noexcept {
  switch (static_cast<canopen::NmtCommand>(command)) {
    case canopen::NmtCommand::start: return "start";
    case canopen::NmtCommand::stop: return "stop";
    case canopen::NmtCommand::enter_pre_operational: return "enter pre-operational";
    case canopen::NmtCommand::reset_node: return "reset node";
    case canopen::NmtCommand::reset_communication: return "reset communication";
  }
  return "";
}

std::string_view emcy_code_text(std::uint16_t code) noexcept {
  const auto* const whole = std::ranges::find(codes, code, &Words::code);
  if (whole != codes.end()) return whole->text;
  const auto* const by_class = std::ranges::find(high_bytes, code >> 8, &Words::code);
  if (by_class != high_bytes.end()) return by_class->text;
  return first_digits[code >> 12];
}

std::string error_register_text(std::uint8_t error_register) {
  return value_words(nullptr, 0x1001, 0, error_register).text();
}

std::string emcy_text(const can::Frame& frame) {
  const auto number = can::load_as<std::uint16_t>(frame.data.data());
  std::string text = fmt::format("{:04X}H {}; error register {:02X}H: {}", number, emcy_code_text(number),
                                 frame.data[2], error_register_text(frame.data[2]));
  const auto rest = frame.bytes().subspan(3);
  if (std::ranges::any_of(rest, [](std::uint8_t byte) { return byte != 0; }))
    text += "; " + hexadecimal(rest);
  return text;
}

std::string_view flying_master_name(std::uint32_t identifier) noexcept {
  switch (identifier) {
    case 0x071: return "active NMT master";
    case 0x072: return "negotiation request";
    case 0x073: return "detect active NMT master";
    case 0x074: return "NMT master capable device";
    case 0x075: return "detect NMT master capable devices";
    case 0x076: return "force negotiation";
    default: return "";
  }
}

std::string error_frame_text(const can::Frame& frame) {
  std::string text;
  for (const Bit& kind : error_classes) {
    if ((frame.identifier & kind.bit) == 0) continue;
    join(text, kind.text, "; ");
    std::string more;
    if (kind.bit == 0x002 && frame.data[0] != 0) more = fmt::format("bit {}", frame.data[0]);
    if (kind.bit == 0x004) more = bits_text(controller_states, frame.data[1]);
    if (kind.bit == 0x008) more = bits_text(violations, frame.data[2]);
    if (kind.bit == 0x010 && frame.data[4] != 0) more = fmt::format("status {:02X}H", frame.data[4]);
    if (!more.empty()) text += ": " + more;
  }
  if (text.empty()) text = "error of unknown class";
  if (frame.data[6] != 0 || frame.data[7] != 0)
    text += fmt::format(" (TEC {}, REC {})", frame.data[6], frame.data[7]);
  return text;
}

}  // namespace canopus::trace
