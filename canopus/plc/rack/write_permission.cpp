#include "canopus/plc/rack/write_permission.hpp"

#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc {

bool may_write(WritePermission permission, const Rack& rack) noexcept {
  if (permission == WritePermission::in_stop) return rack.cpu_state() == module::CpuState::stop;
  return permission == WritePermission::always;
}

}  // namespace canopus::plc
