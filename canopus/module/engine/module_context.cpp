#include "canopus/module/engine/module_context.hpp"

#include <string>

namespace canopus::module {

ModuleContext::ModuleContext(const ModuleModel& the_model, const can::Controller& the_controller,
                             NonVolatileMemory& memory, const Profile& the_profile)
    : model(the_model),
      controller(the_controller),
      profile(the_profile),
      buffer(model.buffer_memory),
      settings(model, memory, buffer),
      watchdog(model.access_watchdog, buffer),
      errors(model.error_status, buffer),
      diagnostics(model.diagnostics) {
  state.mode = &model.function_modes.front();
}

void ModuleContext::report_word(BufferAddress address, std::uint16_t value, std::string_view what,
                                can::Time now) const {
  if (observer == nullptr) return;
  std::string text(model.data_sheet->word_prefix);
  text += std::to_string(address) + " = " + std::to_string(value);
  text += what;
  report(text, now);
}

}  // namespace canopus::module
