#include "canopus/program/program.hpp"

namespace canopus::program {

namespace {

std::string range_text(const Fault& fault) {
  return std::to_string(fault.low) + " to " + std::to_string(fault.high);
}

std::string cause(const Fault& fault) {
  switch (fault.code) {
    case FaultCode::none: return "no error";
    case FaultCode::division_by_zero: return "division by zero";
    case FaultCode::index_out_of_range:
      return "array index " + std::to_string(fault.value) + " is outside of " + range_text(fault);
    case FaultCode::value_out_of_range:
      return "value " + std::to_string(fault.value) + " is outside of " + range_text(fault);
    case FaultCode::no_value: return "the text is no value of the type that it is converted to";
    case FaultCode::device_out_of_range:
      return std::string(fault.device) + ": the CPU or the module has no such device";
    case FaultCode::no_module: return std::string(fault.device) + ": there is no module";
    case FaultCode::watchdog: return "the scan takes too long: a loop may not end";
    case FaultCode::call_depth: return "too many nested calls";
    case FaultCode::reported: return std::string(fault.reason);
  }
  return {};
}

}  // namespace

std::string fault_text(const Program& program, const Fault& fault) {
  if (fault.position.line == 0 || fault.position.file >= program.files.size()) return cause(fault);
  return program.files[fault.position.file] + ':' + std::to_string(fault.position.line) + ':' +
         std::to_string(fault.position.column) + ": " + cause(fault);
}

}  // namespace canopus::program
