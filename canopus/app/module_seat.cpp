#include "canopus/app/module_seat.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace canopus::app {

namespace {

plc::BuiltInProgram::Task program_task(const ModuleSection& section) {
  plc::BuiltInProgram::Task task{.exchange = section.exchange, .online = section.online};
  for (const BufferSetting& word : section.writes) task.words.push_back({word.address, word.value});
  return task;
}

}  // namespace

ModuleSeat::ModuleSeat(const ModuleSection& section, std::string_view plc,
                       std::unique_ptr<module::NonVolatileMemory> memory,
                       std::unique_ptr<module::CommunicationModule> module, const BusWatch& watch,
                       PlantObserver& observer)
    : section_(section),
      plc_(plc),
      watch_(watch),
      name_(fmt::format("{} U{:X}", section.model, section.head / 16)),
      memory_(std::move(memory)),
      module_(std::move(module)),
      program_(*module_, module_->program_interface(), program_task(section)),
      observer_(observer) {
  status_.is_module = true;
  status_.plate = {section.bus, name_, section.node};
  watched_.resize(section.watch.size());
  module_->set_observer(this);
}

void ModuleSeat::collect_boots(std::vector<SlaveBoot>& all) const {
  for (const module::SlaveBootRecord& boot : module_->boots()) {
    all.push_back({watch_.plate(boot.node_id), status_.plate, boot.record});
  }
}

void ModuleSeat::powered(can::Time now) {
  status_.is_on = true;
  program_.powered(now);
  if (section_.fault_at) next_fault_ = can::later(now, *section_.fault_at);
  look(now);
}

void ModuleSeat::receive(const can::Frame& frame, can::Time now) {
  module_->receive(frame, now);
  look(now);
}

void ModuleSeat::transmitted(const can::Frame& frame, can::Time now) {
  if (status_.layer2 != module::Layer2State::inactive || is_pdo(frame)) ++status_.pdos;
  module_->transmitted(frame, now);
}

void ModuleSeat::controller_changed(can::Time now) {
  module_->controller_changed(now);
  look(now);
}

void ModuleSeat::tick(can::Time now) {
  if (module_->deadline() <= now) module_->tick(now);
  if (next_fault_ <= now) {
    next_fault_ = can::never;
    module_->inject(section_.fault, now);
  }
  program_.tick(now);
  look(now);
}

can::Time ModuleSeat::deadline() const noexcept {
  return std::min({module_->deadline(), program_.deadline(), next_fault_});
}

void ModuleSeat::signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now) {
  if (program_.signal_changed(kind, number, on, now)) return;  // its data exchanges are not news
  const char device = kind == module::SignalKind::input ? 'X' : 'Y';
  observer_.signal_changed(plc_, device, section_.head + number, on, now);
}

void ModuleSeat::buffer_written(std::uint32_t address, std::uint16_t value, can::Time now) {
  if (program_.buffer_written(address)) return;
  observer_.buffer_changed(plc_, section_.head, address, value, true, now);
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    if (section_.watch[i] == address) watched_[i] = value;
  }
}

void ModuleSeat::slave_boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) {
  BootSeen& seen = boots_seen_[node_id & 0x7F];
  const bool is_news = seen.step != record.step || seen.attempts != record.attempts;
  seen = {record.step, record.attempts};
  status_.plate.node_id = module_->node().node_id();
  if (is_news) observer_.slave_boot_went_on(watch_.plate(node_id), status_.plate, record, now);
}

void ModuleSeat::error_raised(std::string_view what, can::Time now) { observer_.error(name_, what, now); }

void ModuleSeat::look(can::Time now) {
  program_.look(now);
  status_.layer2 = module_->layer2_state();
  const bool canopen_mode = status_.layer2 == module::Layer2State::inactive;
  status_.plate.node_id = canopen_mode ? module_->node().node_id() : std::uint8_t{0};
  if (canopen_mode && module_->node().state() != status_.state) {
    status_.state = module_->node().state();
    observer_.nmt_state_changed(status_.plate, status_.state, now);
  }
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const std::uint16_t value = module_->buffer_memory()->read_word(section_.watch[i], now);
    if (value == watched_[i]) continue;
    watched_[i] = value;
    observer_.buffer_changed(plc_, section_.head, section_.watch[i], value, false, now);
  }
}

}  // namespace canopus::app
