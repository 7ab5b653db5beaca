#include "canopus/module/engine/change_log.hpp"

#include <array>
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
  constexpr std::array ends{std::pair{ModuleError::invalid_value, Diagnosis::invalid_value},
                            std::pair{ModuleError::bus_off, Diagnosis::bus_off},
                            std::pair{ModuleError::save_while_online, Diagnosis::save_while_online},
                            std::pair{ModuleError::queue_overflow, Diagnosis::queue_overflow},
                            std::pair{ModuleError::message_slot, Diagnosis::message_slot}};
  for (const auto& [error, diagnosis] : ends) {
    if (!parts_.errors.shows(error)) parts_.diagnostics.end(diagnosis);
  }
  if (parts_.settings.error()) {
    parts_.diagnostics.raise(Diagnosis::flash_data, now);
  } else {
    parts_.diagnostics.end(Diagnosis::flash_data);
  }
}

}  // namespace canopus::module
