#include "canopus/module/engine/module_indication.hpp"

#include <utility>

#include "canopus/manager/boot/start_up_bits.hpp"

namespace canopus::module {

namespace {

// A frame is too short to be seen.
constexpr can::Duration traffic_afterglow = std::chrono::milliseconds(50);

LedPattern network_state_pattern(const ModuleContext& parts) {
  if (!parts.state.running()) return LedPattern::off;
  if (parts.master.lss_active()) return LedPattern::flickering;
  if (!parts.state.canopen_mode()) return parts.layer2.online() ? LedPattern::on : LedPattern::off;
  switch (parts.node.state()) {
    case canopen::NmtState::operational: return LedPattern::on;
    case canopen::NmtState::pre_operational: return LedPattern::blinking;
    case canopen::NmtState::stopped: return LedPattern::single_flash;
    case canopen::NmtState::initialising: break;
  }
  return LedPattern::off;
}

// The most severe cause wins.
LedPattern network_error_pattern(const ModuleContext& parts) {
  if (!parts.state.running()) return LedPattern::off;
  if (parts.errors.has(ModuleError::bus_off)) return LedPattern::on;
  if (parts.master.lss_active()) return LedPattern::flickering;
  if (parts.nmt_status.any_failure()) return LedPattern::double_flash;
  if (error_counter(parts.controller) >= warning_counter) return LedPattern::single_flash;
  if (parts.errors.any()) return LedPattern::blinking;
  return LedPattern::off;
}

// [FX3U-CAN 1.2.2, 14.1]
LedPattern module_error_pattern(const ModuleContext& parts) {
  if (!parts.state.running()) return LedPattern::off;
  if (parts.errors.has(ModuleError::bus_off) || parts.state.cpu_fault || parts.watchdog.expired())
    return LedPattern::on;
  if (parts.master.lss_active()) return LedPattern::flickering;
  if (parts.nmt_status.any_failure()) return LedPattern::double_flash;
  if (parts.errors.has(ModuleError::error_passive)) return LedPattern::single_flash;
  return parts.errors.any() ? LedPattern::blinking : LedPattern::off;
}

}  // namespace

std::vector<Led> leds_of(const ModuleContext& parts, can::Time last_frame, can::Time now) {
  std::vector<Led> leds;
  for (const LedRow& row : parts.model.leds) {
    Led& led = leds.emplace_back(row.name);
    if (parts.state.phase == ModuleState::Phase::off) continue;
    const auto light = [&](bool on) { led.pattern = on ? LedPattern::on : LedPattern::off; };
    switch (row.use) {
      case LedUse::supply: light(parts.diagnostics.worst() != ErrorClass::major); break;
      case LedUse::error:
        // Where module diagnostics show errors, their Clear Error puts it out; the error words stay [RJ71CN91 5.2].
        light(parts.diagnostics.has_tables() ? parts.diagnostics.worst().has_value() : parts.errors.any());
        if (parts.diagnostics.worst() == ErrorClass::moderate) led.pattern = LedPattern::blinking;
        if (parts.diagnostics.worst() == ErrorClass::major) led.pattern = LedPattern::off;
        led.error = true;
        break;
      case LedUse::network_state: led.pattern = network_state_pattern(parts); break;
      case LedUse::traffic:
        light(parts.state.running() && last_frame != can::Time{} && now - last_frame < traffic_afterglow);
        break;
      case LedUse::access:
        light(parts.state.last_access != can::Time{} && now - parts.state.last_access < traffic_afterglow);
        break;
      case LedUse::operational:
        light(parts.state.running() && parts.node.state() == canopen::NmtState::operational);
        break;
      case LedUse::interface: light(parts.state.running() && !parts.errors.has(ModuleError::bus_off)); break;
      case LedUse::error_bits:
        light((parts.errors.word() & row.bits) != 0);
        led.error = true;
        break;
      case LedUse::network_error:
      case LedUse::module_error:
        led.pattern =
            row.use == LedUse::network_error ? network_error_pattern(parts) : module_error_pattern(parts);
        // Flickers in turn with the one for the state.
        led.opposite = led.pattern == LedPattern::flickering;
        led.error = !led.opposite;
        break;
    }
  }
  return leds;
}

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
