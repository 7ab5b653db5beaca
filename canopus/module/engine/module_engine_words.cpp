// The PLC's side of the engine: words, data exchange, saving, clock.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/interface/slave_boot_record.hpp"

namespace canopus::module {

std::uint16_t ModuleEngine::program_read(BufferAddress address, can::Time now) {
  if (context_.state.phase == Phase::off) return 0;
  note_access(address, now);
  return context_.buffer.program_read(address, now);
}

// A module that stays in its initialization takes commands, which reset the object dictionary, and the restart.
bool ModuleEngine::is_writable_while_stuck(BufferAddress address) const noexcept {
  const auto restarts = [address](const RequestWordRow& row) {
    return row.word == address && row.use == RequestUse::restart;
  };
  return node_.is_command_word(address) || std::ranges::any_of(context_.model.request_words, restarts);
}

void ModuleEngine::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  if (!context_.state.works()) return;
  note_access(address, now);
  const bool allowed =
      !initializing() || (context_.state.phase == Phase::stuck && is_writable_while_stuck(address));
  const bool was_good = !context_.errors.has(ModuleError::invalid_value);
  const WriteResult result = allowed ? context_.buffer.write(address, value, now) : WriteResult::refused;
  context_.errors.record(result, address);
  if (was_good && context_.errors.has(ModuleError::invalid_value)) {
    context_.diagnostics.raise(Diagnosis::invalid_value, now, {context_.errors.invalid_address()});
  }
  if (result == WriteResult::done) {
    check_words();
    if (!context_.settings.word_written(address))
      context_.report("the memory of settings could not be written", now);
    if (!context_.watchdog.expired()) node_.release_commands(now);
    if (context_.observer != nullptr) context_.observer->buffer_written(address, value, now);
    context_.port->serve(now);
    // An error whose cause is still there comes again when it is cleared [FX2N-32CAN 4.2.7]: after serve(), or #29 bit
    // 10 of an FX3U-CAN would stay ON.
    if (context_.model.error_status && address == context_.model.error_status->status)
      controller_changed(now);
  } else if (result != WriteResult::ignored) {
    context_.report_word(address, value,
                         !allowed ? ": ignored, the module is starting"
                         : result == WriteResult::invalid
                             ? ": not a value this word accepts"
                             : ": ignored, the word is read-only while the module is online",
                         now);
  }
  update(now);
}

// Groups of words that were found wrong may be good now.
void ModuleEngine::check_words() {
  if (context_.errors.is_wrong(WordGroup::clock) && !node_.wrong_clock_word())
    context_.errors.found_good(WordGroup::clock);
  if (context_.errors.is_wrong(WordGroup::layer2) && !layer2_.slots().setting_error())
    context_.errors.found_good(WordGroup::layer2);
}

// A value out of range changes nothing; the request is answered all the same, so that the program can read
// the error status.
void ModuleEngine::set_clock(can::Time now) {
  if (const auto wrong = node_.set_clock(now)) {
    context_.errors.found_wrong(WordGroup::clock, *wrong);
    context_.diagnostics.raise(Diagnosis::invalid_value, now, {*wrong});
    context_.report("the time stamp words are not a date and time", now);
  } else {
    context_.errors.found_good(WordGroup::clock);
  }
  context_.port->done(Request::set_clock, now);
}

void ModuleEngine::read_clock(can::Time now) {
  node_.show_clock(now);
  check_words();
  context_.port->done(Request::read_clock, now);
}

void ModuleEngine::begin_exchange(can::Time now) {
  exchange_.begin(context_.state.canopen_mode(), now, context_.profile.exchange_time);
}

// [RJ71CN91 App. 1 YF] Node errors are cleared with the others where the model says so: those of all nodes.
void ModuleEngine::hold_clear_errors(bool held, can::Time now) {
  const bool had_bad_value = context_.errors.has(ModuleError::invalid_value);
  context_.errors.hold_clear(held);
  context_.diagnostics.hold_clear(held);
  if (held && context_.state.phase != Phase::off) context_.diagnostics.log(ModuleEvent::errors_cleared, now);
  if (!held && !had_bad_value && context_.errors.has(ModuleError::invalid_value)) {
    context_.diagnostics.raise(Diagnosis::invalid_value, now, {context_.errors.invalid_address()});
  }
  if (!held) find_errors_again(now);
  if (!context_.model.error_status || !context_.model.error_status->clears_node_failures) return;
  node_.hold_clear_all_failures(held);
  if (!held || context_.state.phase == Phase::off || initializing() || !context_.state.canopen_mode()) return;
  node_.clear_failures(0, now);
}

// Those whose cause is still there.
void ModuleEngine::find_errors_again(can::Time now) {
  if (context_.errors.has(ModuleError::bus_off)) context_.diagnostics.raise(Diagnosis::bus_off, now);
  if (context_.errors.has(ModuleError::save_while_online))
    context_.diagnostics.raise(Diagnosis::save_while_online, now);
  if (context_.errors.has(ModuleError::message_slot))
    context_.diagnostics.raise(Diagnosis::message_slot, now, {layer2_.slots().first_slot_error()});
}

void ModuleEngine::hold_clear_nmt_errors(bool held, can::Time now) {
  node_.hold_clear_failures(held);
  if (held && context_.state.phase != Phase::off)
    context_.diagnostics.log(ModuleEvent::node_failures_cleared, now);
  if (held && !initializing() && context_.state.canopen_mode()) clear_nmt_errors(now);
}

void ModuleEngine::hold_clear_emergencies(bool held, can::Time now) {
  node_.hold_clear_emergencies(held);
  if (held) context_.diagnostics.log(ModuleEvent::emergencies_cleared, now);
}

void ModuleEngine::clear_nmt_errors(can::Time now) { node_.clear_selected_failures(now); }

void ModuleEngine::clear_written_nmt_errors(can::Time now) { node_.clear_written_failures(now); }

void ModuleEngine::execute_command(can::Time now) { node_.execute_command(now); }

// [RJ71CN91 App. 1 Y1F] A request that is refused is not answered.
void ModuleEngine::begin_save(can::Time now) {
  if (context_.model.settings.saves_offline_only && layer2_.online()) {
    if (!std::exchange(save_is_refused_, true)) {
      context_.report("nothing is saved or restored while Layer 2 is online", now);
      context_.diagnostics.raise(Diagnosis::save_while_online, now);
    }
    return;
  }
  context_.settings.begin_save(can::later(now, context_.profile.save_time));
  node_.occupy_store(context_.settings.save_deadline());
}

// What the program has restored before counts: later it would change the words of slots that work already.
void ModuleEngine::go_online(can::Time now) {
  if (context_.settings.save_deadline() != can::never && context_.settings.restores()) end_save(now);
  apply_layer2_bit_rate();
  layer2_.go_online(now);
}

// [RJ71CN91 App. 1 Y3, App. 2 G24] The bit rate is what its word has now; bus-off is left.
void ModuleEngine::apply_layer2_bit_rate() {
  if (layer2_.online() || !layer2_.slots().rules().online_applies_bit_rate) return;
  const std::uint16_t bit_rate = context_.settings.bit_rate();
  const bool is_off = context_.controller.error_state() == can::ErrorState::bus_off;
  if (bit_rate == context_.state.bit_rate && !is_off) return;
  context_.state.bit_rate = bit_rate;
  controller_.restart(bit_rate * 1000U);
}

// They have their factory settings.
void ModuleEngine::end_bad_settings() {
  const auto bad_words = context_.errors.bad_words();
  for (const BufferAddress address : std::vector(bad_words.begin(), bad_words.end())) {
    const BufferRow* row = context_.buffer.row(address, WordAccess::write);
    if (row != nullptr && row->stored == Stored::yes) context_.errors.record(WriteResult::done, address);
  }
  check_words();
}

void ModuleEngine::end_save(can::Time now) {
  if (!context_.settings.end_save()) context_.report("the flash memory could not be written", now);
  if (context_.settings.saves()) context_.diagnostics.log(ModuleEvent::saved, now);
  if (context_.settings.restores()) {
    context_.diagnostics.log(ModuleEvent::restored, now);
    node_.words_restored(now);
    end_bad_settings();
  }
  context_.port->done(Request::save_restore, now);
}

std::vector<SlaveBootRecord> ModuleEngine::boots() const {
  std::vector<SlaveBootRecord> boots;
  for (std::uint8_t node_id = 1; node_id <= 127; ++node_id) {
    const manager::BootRecord& record = node_.master().boot_record(node_id);
    if (record.step != manager::BootStep::idle || record.halted_by != 0) boots.push_back({node_id, record});
  }
  return boots;
}

}  // namespace canopus::module
