#include "canopus/plc/melsec/end_code.hpp"

#include "canopus/ascii/hex.hpp"

namespace canopus::plc::melsec {

std::string_view end_code_text(std::uint16_t code) noexcept {
  switch (code) {
    case 0x0000: return "completed";
    case 0x0050: return "unknown subheader";
    case 0x0055: return "writing while the CPU runs is not enabled";
    case 0x4013: return "not possible while the CPU is in RUN";
    case 0x4030: return "the CPU does not have this device, or not for this command";
    case 0x4031: return "device number beyond the CPU's last one";
    case 0x4041: return "beyond the module's buffer memory";
    case 0x4043: return "no module at this start I/O number";
    case 0x4080: return "wrong request data";
    case 0x408B: return "the CPU does not take this remote request";
    case 0xC050: return "ASCII text that is no number";
    case 0xC051: return "number of bit points out of range";
    case 0xC052: return "number of word points out of range";
    case 0xC053: return "number of random bit points out of range";
    case 0xC054: return "number of random word points out of range";
    case 0xC056: return "beyond the maximum address";
    case 0xC058: return "the length does not fit the text";
    case 0xC059: return "unknown command or subcommand";
    case 0xC05B: return "this device cannot be read or written so";
    case 0xC05C: return "wrong request, such as single bits of a word device";
    case 0xC05D: return "monitoring without registration";
    case 0xC05F: return "the request is for another station or CPU";
    case 0xC060: return "bit data must be 0 or 1";
    case 0xC061: return "the length does not fit the request";
    case 0xC06F: return "binary request to an ASCII connection or the reverse";
    case 0xC070: return "this device extension is not possible here";
    case 0xC200: return "wrong remote password";
    case 0xC201: return "locked by a remote password";
    case 0xC810: return "wrong remote password";
    case 0xC816: return "too many wrong remote passwords: locked out for a while";
    default: break;
  }
  if (code >= 0x4000 && code <= 0x4FFF) return "error detected by the CPU";
  if (code >= 0x7000 && code <= 0x7FFF) return "error detected by a module";
  if (code >= 0xC000 && code <= 0xCFFF) return "error detected by the Ethernet port";
  return "unknown end code";
}

namespace {

std::string_view end_code_1e_text(std::uint8_t code, std::uint8_t abnormal_code) {
  switch (code) {
    case 0x50: return "unknown command";
    case 0x54: return "ASCII text that is no number";
    case 0x55: return "writing while the CPU runs is not enabled";
    case 0x56: return "the CPU does not have this device";
    case 0x57: return "too many points, or beyond the CPU's last one";
    case 0x58: return "device number beyond the CPU's last one, or a word device in bits";
    case 0x5B: break;
    case 0x60: return "no answer from the CPU";
    default: return "unknown end code";
  }
  switch (abnormal_code) {
    case 0x10: return "the request is for another PC number";
    case 0x11: return "no communication between CPU and Ethernet module";
    case 0x12: return "no module with this number";
    case 0x18: return "remote RUN or STOP is not possible";
    default: return "error detected by the CPU";
  }
}

std::string hexadecimal(std::uint8_t value) { return ascii::hex(value, 2) + 'H'; }

}  // namespace

std::string describe_end_code_1e(std::uint8_t end_code, std::uint8_t abnormal_code) {
  std::string text = hexadecimal(end_code);
  if (end_code == 0x5B) text += ' ' + hexadecimal(abnormal_code);
  return (text += ": ") += end_code_1e_text(end_code, abnormal_code);
}

}  // namespace canopus::plc::melsec
