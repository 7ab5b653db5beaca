#include "canopus/plc/execution/program_execution.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "canopus/ascii/words.hpp"
#include "canopus/plc/execution/cpu_error.hpp"
#include "canopus/program/retained.hpp"

namespace canopus::plc {

namespace {

/// A battery keeps every value at every moment. A file is not written more often than this: what a process that is killed loses.
constexpr can::Duration save_interval = std::chrono::seconds(10);

}  // namespace

ProgramExecution::ProgramExecution(can::Timeline& timeline, Rack& rack, ProgramParts parts,
                                   FaultReport report)
    : rack_(rack),
      machine_(parts.program),
      sources_(std::move(parts.sources)),
      labels_(std::move(parts.labels)),
      tasks_(std::move(parts.tasks), *parts.program),
      devices_(rack),
      report_(std::move(report)),
      watchdog_(parts.watchdog),
      memory_(parts.memory) {
  if (memory_ != nullptr) {
    saved_ = memory_->read(retained_name).bytes;
    not_restored_ = program::restore_retained(machine_, saved_);
  }
  rack.add_listener(*this);
  timeline.add(*this, "fixed scans of a CPU");
}

bool ProgramExecution::is_running() const noexcept {
  return rack_.cpu_state() == module::CpuState::run && !rack_.is_paused();
}

void ProgramExecution::supply_changed(bool on, can::Time now) {
  alarm() = can::never;
  if (!on) return save_retained();
  devices_.supply_came_on();
  if (was_on_) machine_.warm_start();
  was_on_ = true;
  last_run_ = can::never;
  error_.reset();
  start(now);
}

// Labels get their initial values with RUN, as an iQ-R sets them (unverified for the other families).
void ProgramExecution::cpu_changed(module::CpuState state, can::Time now) {
  alarm() = can::never;
  if (state != module::CpuState::run) return;
  machine_.warm_start();
  error_.reset();
  start(now);
}

void ProgramExecution::start(can::Time now) {
  scan_times_ = {};
  tasks_.start(now);
  set_watchdog();
  if (is_running()) alarm() = tasks_.next_fixed_scan();
}

void ProgramExecution::set_watchdog() {
  const CpuFamily family = rack_.model().family;
  machine_.set_watchdog(
      std::min(instructions_within(family, watchdog_.value_or(default_watchdog(family))), most_instructions));
}

// RUN between two scans begins one at once, and one that a client asks for at an END is followed by the next scan anyway.
void ProgramExecution::scan_begins(can::Time now) {
  if (last_run_ == now) return;
  last_run_ = now;
  if (is_halted()) return;
  devices_.set_time(now);
  if (mode_ == Mode::single_scan) mode_ = Mode::halted;
  std::optional<program::Fault> fault;
  if (machine_.is_halted()) {
    fault = machine_.resume(now.time_since_epoch().count(), &devices_);
  } else {
    if (tasks_.next_fixed_scan() <= now) tick(now);
    if (!is_running() || machine_.is_halted()) return;
    fault = machine_.run(tasks_.scan_begins(devices_), now.time_since_epoch().count(), &devices_);
  }
  const can::Duration took = execution_time(rack_.model().family, machine_.executed());
  scan_times_.least = scan_times_.most == can::Duration{} ? took : std::min(scan_times_.least, took);
  scan_times_.most = std::max(scan_times_.most, took);
  scan_times_.now = took;
  ended(fault, now);
  if (now - saved_at_ < save_interval) return;
  saved_at_ = now;
  save_retained();
}

void ProgramExecution::tick(can::Time now) {
  devices_.set_time(now);
  const std::span<const std::uint32_t> programs = tasks_.fixed_scan(now);
  alarm() = tasks_.next_fixed_scan();
  if (is_halted() || machine_.is_halted() || !is_running()) return;
  ended(machine_.run(programs, now.time_since_epoch().count(), &devices_), now);
}

void ProgramExecution::ended(const std::optional<program::Fault>& fault, can::Time now) {
  if (machine_.is_halted()) mode_ = Mode::halted;
  if (!fault) return;
  const std::string text = fault_text(machine_.program(), *fault);
  const std::uint16_t code = error_code_of(rack_.model().family, fault->code);
  rack_.fail_cpu(now, {code, fault->code == program::FaultCode::watchdog});
  error_ = Error{fault->position, text, code, now};
  report_(text, now);
}

void ProgramExecution::change(std::shared_ptr<const program::Program> program,
                              std::vector<ProgramSource> sources, std::vector<DeviceLabel> labels) {
  labels_ = std::move(labels);
  machine_.change(std::move(program));
  sources_ = std::move(sources);
  tasks_.change(machine_.program());
}

const DeviceLabel* ProgramExecution::label(std::string_view name) const noexcept {
  const auto found = std::ranges::find_if(
      labels_, [&](const DeviceLabel& label) { return ascii::equal_ignoring_case(label.name, name); });
  return found == labels_.end() ? nullptr : &*found;
}

void ProgramExecution::save_retained() {
  if (memory_ == nullptr || !was_on_) return;
  std::vector<std::uint8_t> bytes = program::retained_bytes(machine_);
  if (bytes == saved_) return;
  if (memory_->write(retained_name, bytes)) saved_ = std::move(bytes);
}

}  // namespace canopus::plc
