// The PLC's side of the engine: words, data exchange, saving, clock.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/interface/slave_boot_record.hpp"

namespace canopus::module {

std::uint16_t ModuleEngine::program_read(BufferAddress address, can::Time now) {
  if (parts_.state.phase == Phase::off) return 0;
  note_access(address, now);
  return parts_.buffer.program_read(address, now);
}

// A module that stays in its initialization takes commands, which reset the object dictionary, and the restart.
bool ModuleEngine::is_writable_while_stuck(BufferAddress address) const noexcept {
  const auto restarts = [address](const RequestWordRow& row) {
    return row.word == address && row.use == RequestUse::restart;
  };
  return parts_.command.owns(address) || std::ranges::any_of(parts_.model.request_words, restarts);
}

void ModuleEngine::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  if (!parts_.state.works()) return;
  note_access(address, now);
  const bool allowed = !parts_.state.initializing() ||
                       (parts_.state.phase == Phase::stuck && is_writable_while_stuck(address));
  const bool was_good = !parts_.errors.has(ModuleError::invalid_value);
  const WriteResult result = allowed ? parts_.buffer.write(address, value, now) : WriteResult::refused;
  parts_.errors.record(result, address);
  if (was_good && parts_.errors.has(ModuleError::invalid_value)) {
    parts_.diagnostics.raise(Diagnosis::invalid_value, now, {parts_.errors.invalid_address()});
  }
  if (result == WriteResult::done) {
    look_at_words();
    if (!parts_.settings.word_written(address))
      parts_.report("the memory of settings could not be written", now);
    if (!parts_.watchdog.expired()) parts_.command.release(now);
    if (parts_.observer != nullptr) parts_.observer->buffer_written(address, value, now);
    parts_.port->serve(now);
    // An error whose cause is still there comes again when it is cleared [FX2N-32CAN 4.2.7]: after serve(), or #29 bit
    // 10 of an FX3U-CAN would stay ON.
    if (parts_.model.error_status && address == parts_.model.error_status->status) controller_changed(now);
  } else if (result != WriteResult::ignored) {
    parts_.report_word(
        address, value,
        result == WriteResult::invalid ? ": not a value this word accepts" : ": not to be written now", now);
  }
  update(now);
}

// Groups of words that were found wrong may be good now.
void ModuleEngine::look_at_words() {
  if (parts_.errors.is_wrong(WordGroup::clock) && !parts_.time_stamp.wrong_word())
    parts_.errors.found_good(WordGroup::clock);
  if (parts_.errors.is_wrong(WordGroup::layer2) && !parts_.layer2.setting_error())
    parts_.errors.found_good(WordGroup::layer2);
}

// A value out of range changes nothing; the request is answered all the same, so that the program can look at
// the error status.
void ModuleEngine::set_clock(can::Time now) {
  if (const auto wrong = parts_.time_stamp.set_from_words(now)) {
    parts_.errors.found_wrong(WordGroup::clock, *wrong);
    parts_.diagnostics.raise(Diagnosis::invalid_value, now, {*wrong});
    parts_.report("the time stamp words are not a date and time", now);
  } else {
    parts_.errors.found_good(WordGroup::clock);
  }
  parts_.port->done(Request::set_clock, now);
}

void ModuleEngine::read_clock(can::Time now) {
  parts_.time_stamp.show(now);
  look_at_words();
  parts_.port->done(Request::read_clock, now);
}

void ModuleEngine::begin_exchange(can::Time now) {
  parts_.exchange.begin(parts_.state.canopen_mode(), now, parts_.profile.exchange_time);
}

// [RJ71CN91 App. 1 YF] Node errors are cleared with the others where the model says so: those of all nodes.
void ModuleEngine::hold_clear_errors(bool held, can::Time now) {
  const bool had_bad_value = parts_.errors.has(ModuleError::invalid_value);
  parts_.errors.hold_clear(held);
  parts_.diagnostics.hold_clear(held);
  if (held && parts_.state.phase != Phase::off) parts_.diagnostics.log(ModuleEvent::errors_cleared, now);
  if (!held && !had_bad_value && parts_.errors.has(ModuleError::invalid_value)) {
    parts_.diagnostics.raise(Diagnosis::invalid_value, now, {parts_.errors.invalid_address()});
  }
  if (!held) find_errors_again(now);
  if (!parts_.model.error_status || !parts_.model.error_status->clears_node_failures) return;
  parts_.nmt_status.hold_clear_all(held);
  if (!held || parts_.state.phase == Phase::off || parts_.state.initializing() ||
      !parts_.state.canopen_mode())
    return;
  parts_.nmt_status.clear_life_guarding(0);
  parts_.master.clear_error_control(0, now);
}

// Those whose cause is still there.
void ModuleEngine::find_errors_again(can::Time now) {
  if (parts_.errors.has(ModuleError::bus_off)) parts_.diagnostics.raise(Diagnosis::bus_off, now);
  if (parts_.errors.has(ModuleError::save_while_online))
    parts_.diagnostics.raise(Diagnosis::save_while_online, now);
  if (parts_.errors.has(ModuleError::message_slot))
    parts_.diagnostics.raise(Diagnosis::message_slot, now, {parts_.layer2.first_slot_error()});
}

void ModuleEngine::hold_clear_nmt_errors(bool held, can::Time now) {
  parts_.nmt_status.hold_clear(held);
  if (held && parts_.state.phase != Phase::off)
    parts_.diagnostics.log(ModuleEvent::node_failures_cleared, now);
  if (held && !parts_.state.initializing() && parts_.state.canopen_mode()) clear_nmt_errors(now);
}

void ModuleEngine::hold_clear_emergencies(bool held, can::Time now) {
  parts_.emergencies.hold_clear(held);
  if (held) parts_.diagnostics.log(ModuleEvent::emergencies_cleared, now);
}

void ModuleEngine::clear_nmt_errors(can::Time now) {
  const std::uint8_t node = parts_.nmt_status.node_to_clear();
  parts_.nmt_status.clear_life_guarding(node);
  parts_.master.clear_error_control(node, now);
}

void ModuleEngine::clear_written_nmt_errors(can::Time now) {
  const std::bitset<128> nodes = parts_.nmt_status.take_cleared();
  if (nodes.none()) return;
  for (std::uint8_t node = 1; node < nodes.size(); ++node) {
    if (!nodes.test(node)) continue;
    parts_.nmt_status.clear_life_guarding(node);
    parts_.master.clear_error_control(node, now);
  }
}

void ModuleEngine::execute_command(can::Time now) {
  parts_.command.execute(parts_.state.mode->bit, now, parts_.profile.command_time);
}

// [RJ71CN91 App. 1 Y1F] A request that is refused is not answered.
void ModuleEngine::begin_save(can::Time now) {
  if (parts_.model.settings.saves_offline_only && parts_.layer2.online()) {
    if (!std::exchange(save_is_refused_, true)) {
      parts_.report("nothing is saved or restored while Layer 2 is online", now);
      parts_.diagnostics.raise(Diagnosis::save_while_online, now);
    }
    return;
  }
  parts_.settings.begin_save(can::later(now, parts_.profile.save_time));
  parts_.concise_dcfs.occupy(parts_.settings.save_deadline());
}

// What the program has restored before counts: later it would change the words of slots that work already.
void ModuleEngine::go_online(can::Time now) {
  if (parts_.settings.save_deadline() != can::never && parts_.settings.restores()) end_save(now);
  layer2_bus_.go_online(now);
}

// They have their factory settings.
void ModuleEngine::end_bad_settings() {
  const auto bad_words = parts_.errors.bad_words();
  for (const BufferAddress address : std::vector(bad_words.begin(), bad_words.end())) {
    const BufferRow* row = parts_.buffer.row(address, WordAccess::write);
    if (row != nullptr && row->stored == Stored::yes) parts_.errors.record(WriteResult::done, address);
  }
  look_at_words();
}

void ModuleEngine::end_save(can::Time now) {
  if (!parts_.settings.end_save()) parts_.report("the flash memory could not be written", now);
  if (parts_.settings.saves()) parts_.diagnostics.log(ModuleEvent::saved, now);
  if (parts_.settings.restores()) {
    parts_.diagnostics.log(ModuleEvent::restored, now);
    parts_.network_settings.apply();
    parts_.time_stamp.correction_changed(now);
    end_bad_settings();
  }
  parts_.port->done(Request::save_restore, now);
}

std::vector<SlaveBootRecord> ModuleEngine::boots() const {
  std::vector<SlaveBootRecord> boots;
  for (std::uint8_t node_id = 1; node_id <= 127; ++node_id) {
    const manager::BootRecord& record = parts_.master.boot_record(node_id);
    if (record.step != manager::BootStep::idle) boots.push_back({node_id, record});
  }
  return boots;
}

}  // namespace canopus::module
