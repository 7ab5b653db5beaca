// The engineering tools' side: what the CPU gives the module of theirs (parameters when it starts, refresh while it runs), and
// what they show of it.

#include <algorithm>
#include <string>
#include <utility>

#include "canopus/module/engine/module_engine.hpp"

namespace canopus::module {

namespace {

// Detail of Diagnosis::extension_parameter; the manual prints no values.
constexpr std::uint32_t wrong_mode = 1;
constexpr std::uint32_t no_room = 2;

}  // namespace

bool ModuleEngine::parameter_word(BufferAddress address, std::uint16_t value) {
  return takes_parameters() && context_.settings.parameter_word(address, value);
}

canopen::AbortCode ModuleEngine::parameter_object(std::uint16_t index, std::uint8_t sub,
                                                  std::span<const std::uint8_t> value) {
  if (!takes_parameters()) return canopen::AbortCode::cannot_store;
  return context_.settings.parameter_object(index, sub, value);
}

bool ModuleEngine::parameter_concise_dcf(std::uint8_t node_id, std::vector<std::uint8_t> file) {
  const manager::ConfigurationOptions& limits = node_.configuration_limits();
  auto& files = context_.settings.parameters().concise_dcfs;
  if (!takes_parameters() || (limits.maximum_size != 0 && file.size() > limits.maximum_size)) return false;
  if (!files.contains(node_id) && files.size() >= limits.maximum_files) return false;
  files[node_id] = std::move(file);
  return true;
}

// [RJ71CN91 2.4] The configuration tool has nothing for a module in a Layer 2 mode: what it has written is wrong there.
void ModuleEngine::load_parameters(can::Time now) {
  const ModuleParameters& parameters = context_.settings.parameters();
  const bool takes_files = std::exchange(takes_files_, false);
  if (parameters.empty()) return;
  if (!context_.state.canopen_mode()) {
    context_.report("the CPU has parameters of the configuration tool, which are for the CANopen mode", now);
    return context_.diagnostics.raise(Diagnosis::extension_parameter, now, {wrong_mode});
  }
  if (!takes_files || parameters.concise_dcfs.empty()) return;
  bool changed = false;
  if (!node_.merge_configurations(parameters.concise_dcfs, changed)) {
    context_.report("the concise DCFs of the CPU's parameters find no room beside those in 1F22H", now);
    context_.diagnostics.raise(Diagnosis::extension_parameter, now, {no_room});
  }
  if (changed) context_.diagnostics.log(ModuleEvent::saved, now);
}

void ModuleEngine::refresh(can::Time now) {
  if (!context_.state.running() || !context_.state.canopen_mode()) return;
  exchange_.refresh(now);
  update(now);
}

std::vector<canopen::Emergency> ModuleEngine::emergency_history() const {
  std::vector<canopen::Emergency> messages;
  for (const auto& part : {node_.received_emergencies().stack(), node_.received_emergencies().ring()}) {
    for (const EmergencyBuffer::Received& received : part) messages.push_back(received.message);
  }
  return messages;
}

ModuleInformation ModuleEngine::information() const {
  const ModuleState& state = context_.state;
  if (state.phase == Phase::off) return {};
  ModuleInformation shown{.function_mode = state.mode->value};
  const auto modes = context_.model.data_sheet->modes;
  const auto mode = std::ranges::find(modes, std::to_string(state.mode->value), &FunctionMode::value);
  if (mode != modes.end()) shown.function_mode_name = mode->name;
  if (state.canopen_mode()) shown.node_id = node_.node().node_id();
  if (layer2_state() != Layer2State::offline) shown.bit_rate = state.bit_rate * 1000U;
  return shown;
}

}  // namespace canopus::module
