#include "canopus/module/engine/change_log.hpp"

#include <utility>

#include "canopus/manager/boot/start_up_bits.hpp"

namespace canopus::module {

void ChangeLog::look_at_parts(can::Time now) {
  const bool online = parts_.layer2_state() == Layer2State::online;
  if (std::exchange(online_, online) != online) {
    parts_.diagnostics.log(online ? ModuleEvent::online : ModuleEvent::offline, now);
  }
  const bool active = parts_.state.running() && parts_.state.canopen_mode() && parts_.master.active();
  if (std::exchange(active_, active) != active) {
    const auto start_up = parts_.node.dictionary().get<std::uint32_t>(0x1F80, 0, 0);
    if ((start_up & manager::start_up_bit::flying_master) != 0) {
      parts_.diagnostics.log(ModuleEvent::flying_master, now, parts_.master.active_master());
    }
  }
  if (!parts_.errors.shows(ModuleError::invalid_value)) parts_.diagnostics.end(Diagnosis::invalid_value);
  if (!parts_.errors.has(ModuleError::bus_off)) parts_.diagnostics.end(Diagnosis::bus_off);
  if (parts_.settings.error()) {
    parts_.diagnostics.raise(Diagnosis::flash_data, now);
  } else {
    parts_.diagnostics.end(Diagnosis::flash_data);
  }
}

}  // namespace canopus::module
