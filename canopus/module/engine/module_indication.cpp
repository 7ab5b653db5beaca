#include "canopus/module/engine/module_indication.hpp"

#include <utility>

#include "canopus/manager/boot/start_up_bits.hpp"

namespace canopus::module {

namespace {

// A frame is too short to be seen.
constexpr can::Duration traffic_afterglow = std::chrono::milliseconds(50);

LedPattern network_state_pattern(const LedSources& module) {
  if (!module.context.state.running()) return LedPattern::off;
  if (module.node.master().lss_active()) return LedPattern::flickering;
  if (!module.context.state.canopen_mode()) return module.layer2.online() ? LedPattern::on : LedPattern::off;
  switch (module.node.state()) {
    case canopen::NmtState::operational: return LedPattern::on;
    case canopen::NmtState::pre_operational: return LedPattern::blinking;
    case canopen::NmtState::stopped: return LedPattern::single_flash;
    case canopen::NmtState::initialising: break;
  }
  return LedPattern::off;
}

// The most severe cause wins.
LedPattern network_error_pattern(const LedSources& module) {
  if (!module.context.state.running()) return LedPattern::off;
  if (module.context.errors.has(ModuleError::bus_off)) return LedPattern::on;
  if (module.node.master().lss_active()) return LedPattern::flickering;
  if (module.node.any_failure()) return LedPattern::double_flash;
  if (error_counter(module.context.controller) >= warning_counter) return LedPattern::single_flash;
  if (module.context.errors.any()) return LedPattern::blinking;
  return LedPattern::off;
}

// [FX3U-CAN 1.2.2, 14.1]
LedPattern module_error_pattern(const LedSources& module) {
  if (!module.context.state.running()) return LedPattern::off;
  if (module.context.errors.has(ModuleError::bus_off) || module.cpu.has_fault() ||
      module.context.watchdog.expired())
    return LedPattern::on;
  if (module.node.master().lss_active()) return LedPattern::flickering;
  if (module.node.any_failure()) return LedPattern::double_flash;
  if (module.context.errors.has(ModuleError::error_passive)) return LedPattern::single_flash;
  return module.context.errors.any() ? LedPattern::blinking : LedPattern::off;
}

}  // namespace

std::vector<Led> leds_of(const LedSources& module, can::Time last_frame, can::Time now) {
  std::vector<Led> leds;
  for (const LedRow& row : module.context.model.leds) {
    Led& led = leds.emplace_back(row.name);
    if (module.context.state.phase == ModuleState::Phase::off) continue;
    const auto light = [&](bool on) { led.pattern = on ? LedPattern::on : LedPattern::off; };
    switch (row.use) {
      case LedUse::supply: light(module.context.diagnostics.worst() != ErrorClass::major); break;
      case LedUse::error:
        // Where module diagnostics show errors, their Clear Error puts it out; the error words stay [RJ71CN91 5.2].
        light(module.context.diagnostics.has_tables() ? module.context.diagnostics.worst().has_value()
                                                      : module.context.errors.any());
        if (module.context.diagnostics.worst() == ErrorClass::moderate) led.pattern = LedPattern::blinking;
        if (module.context.diagnostics.worst() == ErrorClass::major) led.pattern = LedPattern::off;
        led.error = true;
        break;
      case LedUse::network_state: led.pattern = network_state_pattern(module); break;
      case LedUse::traffic:
        light(module.context.state.running() && last_frame != can::Time{} &&
              now - last_frame < traffic_afterglow);
        break;
      case LedUse::access:
        light(module.context.state.last_access != can::Time{} &&
              now - module.context.state.last_access < traffic_afterglow);
        break;
      case LedUse::operational:
        light(module.context.state.running() && module.node.state() == canopen::NmtState::operational);
        break;
      case LedUse::interface:
        light(module.context.state.running() && !module.context.errors.has(ModuleError::bus_off));
        break;
      case LedUse::error_bits:
        light((module.context.errors.word() & row.bits) != 0);
        led.error = true;
        break;
      case LedUse::network_error:
      case LedUse::module_error:
        led.pattern =
            row.use == LedUse::network_error ? network_error_pattern(module) : module_error_pattern(module);
        // Flickers in turn with the one for the state.
        led.opposite = led.pattern == LedPattern::flickering;
        led.error = !led.opposite;
        break;
    }
  }
  return leds;
}

void ChangeLog::log_changes(can::Time now) {
  const bool online = !context_.state.canopen_mode() && layer2_.online();
  if (std::exchange(online_, online) != online) {
    context_.diagnostics.log(online ? ModuleEvent::online : ModuleEvent::offline, now);
  }
  const bool active = context_.state.running() && context_.state.canopen_mode() && node_.master().active();
  if (std::exchange(active_, active) != active) {
    const auto start_up = node_.node().dictionary().get<std::uint32_t>(0x1F80, 0, 0);
    if ((start_up & manager::start_up_bit::flying_master) != 0) {
      context_.diagnostics.log(ModuleEvent::flying_master, now, node_.master().active_master());
    }
  }
  constexpr std::array ends{std::pair{ModuleError::invalid_value, Diagnosis::invalid_value},
                            std::pair{ModuleError::bus_off, Diagnosis::bus_off},
                            std::pair{ModuleError::save_while_online, Diagnosis::save_while_online},
                            std::pair{ModuleError::queue_overflow, Diagnosis::queue_overflow},
                            std::pair{ModuleError::message_slot, Diagnosis::message_slot}};
  for (const auto& [error, diagnosis] : ends) {
    if (!context_.errors.shows(error)) context_.diagnostics.end(diagnosis);
  }
  if (context_.settings.error() || node_.has_damaged_files()) {
    context_.diagnostics.raise(Diagnosis::flash_data, now);
  } else {
    context_.diagnostics.end(Diagnosis::flash_data);
  }
}

}  // namespace canopus::module
