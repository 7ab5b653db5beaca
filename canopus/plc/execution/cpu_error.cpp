#include "canopus/plc/execution/cpu_error.hpp"

#include <array>

namespace canopus::plc {

namespace {

using program::FaultCode;

struct Row {
  FaultCode code;
  std::uint16_t q;
  std::uint16_t iqr;
  std::uint16_t fx3;
};

constexpr std::array rows = {
    Row{FaultCode::division_by_zero, 4100, 0x3400, 6706},
    Row{FaultCode::value_out_of_range, 4100, 0x3401, 6706},
    Row{FaultCode::no_value, 4100, 0x3401, 6706},
    Row{FaultCode::index_out_of_range, 4101, 0x2820, 6706},
    Row{FaultCode::device_out_of_range, 4101, 0x2820, 6706},
    Row{FaultCode::no_module, 2110, 0x2801, 6708},
    Row{FaultCode::watchdog, 5001, 0x3000, 6105},
    Row{FaultCode::call_depth, 4210, 0x3361, 6702},
};

}  // namespace

std::uint16_t error_code_of(CpuFamily family, FaultCode code) noexcept {
  for (const Row& row : rows) {
    if (row.code != code) continue;
    switch (family) {
      case CpuFamily::q: return row.q;
      case CpuFamily::iqr:
      case CpuFamily::fx5: return row.iqr;
      case CpuFamily::fx3: return row.fx3;
      case CpuFamily::as300: break;
    }
  }
  return 0;
}

}  // namespace canopus::plc
