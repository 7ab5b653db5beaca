#include "canopus/plant/module_in_rack.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/module/interface/event_records.hpp"
#include "canopus/module/interface/slave_boot_record.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/slave_boot.hpp"

namespace canopus::plant {

namespace {

using module::StartUp;

constexpr module::BufferAddress command_words = 67;

plc::BuiltInProgram::Task program_task(const ModuleSection& section,
                                       const module::ProgramInterface& interface) {
  plc::BuiltInProgram::Task task{
      .exchange = section.exchange, .online = section.online, .recover = section.recover};
  for (const BufferSetting& word : section.writes) task.words.push_back({word.address, word.value});
  // Of a command's words the code is the last one where it is what executes the command.
  const module::ProgramCommand& command = interface.command;
  if (command.execute.kind == module::ProgramRequest::Kind::write) {
    const auto code = std::ranges::find(task.words, command.first, &plc::BuiltInProgram::Word::address);
    const auto behind = std::ranges::find_if(code, task.words.end(), [&](const auto& word) {
      return word.address >= command.first + command_words;
    });
    if (code != task.words.end()) std::rotate(code, code + 1, behind);
  }
  return task;
}

/// A program has had its chance by then.
constexpr can::Duration start_patience = std::chrono::milliseconds(200);

}  // namespace

ModuleInRack::ModuleInRack(const ModuleSection& section, std::string_view plc, plc::Rack& rack,
                           std::unique_ptr<module::NonVolatileMemory> memory,
                           std::unique_ptr<module::CommunicationModule> module, const NodeRegistry& watch,
                           PlantObserver& observer)
    : section_(section),
      plc_(plc),
      watch_(watch),
      name_(shown_name(section)),
      memory_(std::move(memory)),
      module_(std::move(module)),
      rack_(rack),
      program_(rack, section.head, *module_, module_->program_interface(),
               program_task(section, module_->program_interface())),
      exchange_watch_(*module_, module_->program_interface(), section.head),
      observer_(observer) {
  status_.is_module = true;
  status_.label = {section.bus, name_, section.node};
  watched_.resize(section.watch.size());
  module_->set_observer(this);
  rack_.add_listener(*this);
  for (can::Alarm* part : {&module_->alarm(), &program_.alarm(), &exchange_watch_.alarm(), &next_fault_,
                           &next_download_, &after_stop_due_}) {
    alarm().add_part(*part);
  }
}

void ModuleInRack::collect_boots(std::vector<SlaveBoot>& all) const {
  for (const module::SlaveBootRecord& boot : module_->boots()) {
    all.push_back({watch_.label(boot.node_id), status_.label, with_bit_rate(boot.node_id, boot.record)});
  }
}

manager::BootRecord ModuleInRack::with_bit_rate(std::uint8_t node_id, manager::BootRecord record) const {
  record.wrong_bit_rate = watch_.wrong_bit_rate(node_id);
  return record;
}

void ModuleInRack::supply_changed(bool on, can::Time now) {
  if (on && download_again_ && next_download_ == can::never)
    next_download_ = can::later(now, download_again_->second);
  if (on && section_.fault_at) next_fault_ = can::later(now, *std::exchange(section_.fault_at, std::nullopt));
  status_.is_on = on;
  after_stop_ = AfterStop::nothing;
  after_stop_due_ = can::never;
  exchange_watch_.forget();
  program_.supply_changed(on, now);
  update(now);
}

void ModuleInRack::cpu_changed(module::CpuState state, can::Time now) {
  if (state == module::CpuState::stop) exchange_watch_.forget();
  program_.cpu_changed(state, now);
  const bool was_operational = status_.state == canopen::NmtState::operational;
  if (state == module::CpuState::stop && was_operational) {
    after_stop_ = AfterStop::stopped;
    out_of_operation_since_ = now;
  } else if (state == module::CpuState::run &&
             (after_stop_ == AfterStop::stopped || module_->start_up() == StartUp::waits_for_own_start)) {
    after_stop_ = AfterStop::not_started;
    after_stop_due_ = now + start_patience;
  }
  update(now);
}

void ModuleInRack::cpu_paused(bool paused, can::Time now) {
  if (paused) exchange_watch_.forget();
  program_.cpu_paused(paused, now);
  update(now);
}

ModuleStatus ModuleInRack::module_status(can::Time now) const {
  ModuleStatus status{.label = status_.label,
                      .plc = plc_,
                      .head = section_.head,
                      .is_on = status_.is_on,
                      .cpu = rack_.cpu_state(),
                      .leds = module_->leds(now),
                      .information = module_->information(),
                      .start_up = module_->start_up()};
  if (const module::SignalAccess* signals = module_->signals()) {
    status.inputs = signals->inputs() & ~own_inputs_;
    status.outputs = signals->outputs() & ~own_outputs_;
  }
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    status.words.push_back({section_.watch[i], watched_[i]});
  }
  return status;
}

std::optional<ModuleTrouble> ModuleInRack::trouble(can::Time now) const {
  std::string text = exchange_watch_.trouble(now);
  const bool works_by_registers = module_->registers() != nullptr;  // in RUN and STOP
  if (rack_.cpu_state() == module::CpuState::stop && status_.is_on && !works_by_registers) {
    text = "no process data exchange: the CPU is in STOP";
  } else if (rack_.is_paused() && section_.exchange) {
    text = "the built-in PLC program stands still: the CPU is in PAUSE";
  } else if (after_stop_ == AfterStop::reported) {
    text = not_started();
  }
  if (text.empty()) return std::nullopt;
  return ModuleTrouble{status_.label, std::move(text)};
}

// [ME3CAN1-Q 4.7, 4.8.8]
std::string ModuleInRack::not_started() const {
  const std::string_view state = canopen::name(status_.state);
  if (module_->start_up() == StartUp::none) {
    return fmt::format(
        "no process data exchange: {} since the CPU's STOP, and RUN alone does not change that. To "
        "recover, start the node by the network's NMT master",
        state);
  }
  return fmt::format(
      "no process data exchange: {} since the CPU's STOP, and RUN alone does not change that. To "
      "recover, write 05H to 1F82:{:02X} of the module (request NMT, Start remote node to itself), or "
      "restart it",
      state, status_.label.node_id);
}

void ModuleInRack::receive(const can::Frame& frame, can::Time now) {
  module_->receive(frame, now);
  // Most frames on a bus carry process data, and change no state of the module.
  if (module_->change_count() != changes_seen_ || !watched_.empty()) update(now);
}

void ModuleInRack::transmitted(const can::Frame& frame, can::Time now) {
  if (status_.layer2 != module::Layer2State::inactive || is_pdo(frame)) ++status_.pdos;
  module_->transmitted(frame, now);
}

void ModuleInRack::controller_changed(can::Time now) {
  module_->controller_changed(now);
  update(now);
}

void ModuleInRack::tick(can::Time now) {
  if (module_->deadline() <= now) module_->tick(now);
  if (next_fault_ <= now) {
    next_fault_ = can::never;
    module_->inject(section_.fault, now);
  }
  if (next_download_ <= now) {
    next_download_ = can::never;
    const auto [download, after] = *std::exchange(download_again_, std::nullopt);
    (void)find_module(section_.model)->download(*module_, download, now);
  }
  program_.tick(now);
  exchange_watch_.tick(now);
  if (after_stop_due_ <= now) check_after_stop(now);
  update(now);
}

void ModuleInRack::signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now) {
  const bool is_own = program_.signal_changed(kind, number, on, now);
  exchange_watch_.signal_changed(kind, number, on, is_own, now);
  std::uint32_t& own = kind == module::SignalKind::input ? own_inputs_ : own_outputs_;
  const std::uint32_t bit = std::uint32_t{1} << number;
  own = is_own && on ? own | bit : own & ~bit;
  if (is_own) return;  // its data exchanges are not news
  const char device = kind == module::SignalKind::input ? 'X' : 'Y';
  observer_.on({now, SignalChange{plc_, device, section_.head + number, on}});
}

void ModuleInRack::buffer_written(std::uint32_t address, std::uint16_t value, can::Time now) {
  exchange_watch_.buffer_written(address, value, now);
  if (program_.buffer_written(address)) return;
  observer_.on({now, BufferChange{plc_, section_.head, address, value, true}});
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    if (section_.watch[i] == address) watched_[i] = value;
  }
}

void ModuleInRack::slave_boot_went_on(std::uint8_t node_id, const manager::BootRecord& record,
                                      can::Time now) {
  BootSeen& seen = boots_seen_[node_id & 0x7F];
  const bool is_new = seen.step != record.step || seen.attempts != record.attempts;
  seen = {record.step, record.attempts};
  status_.label.node_id = module_->node().node_id();
  if (is_new)
    observer_.on({now, SlaveBootStep{watch_.label(node_id), status_.label, with_bit_rate(node_id, record)}});
}

void ModuleInRack::event_logged(const module::ModuleEventRecord& record) {
  observer_.on({record.at, ModuleEvent{plc_, name_, record}});
}

void ModuleInRack::module_error(const module::ModuleErrorRecord& record) {
  observer_.on({record.at, ModuleError{plc_, name_, record}});
}

void ModuleInRack::error_raised(std::string_view what, can::Time now) {
  observer_.on({now, Failure{name_, std::string(what)}});
}

void ModuleInRack::update(can::Time now) {
  changes_seen_ = module_->change_count();
  program_.update(now);
  exchange_watch_.update(now);
  if (const auto text = exchange_watch_.next_report()) error_raised(*text, now);
  update_state(now);
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const std::uint16_t value = module_->buffer_memory()->peek(section_.watch[i], now);
    if (value == watched_[i]) continue;
    watched_[i] = value;
    observer_.on({now, BufferChange{plc_, section_.head, section_.watch[i], value, false}});
  }
}

void ModuleInRack::update_state(can::Time now) {
  status_.layer2 = module_->layer2_state();
  const bool canopen_mode = status_.layer2 == module::Layer2State::inactive;
  status_.label.node_id = canopen_mode ? module_->node().node_id() : std::uint8_t{0};
  if (!canopen_mode || module_->node().state() == status_.state) return;
  status_.state = module_->node().state();
  observer_.on({now, NmtStateChange{status_.label, status_.state}});
  // An initialization in RUN is followed by a start-up; one in STOP is held up by it.
  if (status_.state == canopen::NmtState::operational ||
      (status_.state == canopen::NmtState::initialising && rack_.cpu_state() == module::CpuState::run)) {
    after_stop_ = AfterStop::nothing;
    after_stop_due_ = can::never;
  }
}

// Slaves that are still being booted come first, and the module goes Operational after them by itself.
void ModuleInRack::check_after_stop(can::Time now) {
  if (module_->start_up() == StartUp::booting) {
    after_stop_due_ = now + start_patience;
    return;
  }
  after_stop_due_ = can::never;
  after_stop_ = AfterStop::reported;
  error_raised(not_started(), now);
}

}  // namespace canopus::plant
