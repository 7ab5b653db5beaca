#include "canopus/plc/melsec/end_code.hpp"

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

}  // namespace canopus::plc::melsec
