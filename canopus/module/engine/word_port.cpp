#include "canopus/module/engine/word_port.hpp"

#include <algorithm>
#include <utility>

#include "canopus/module/engine/module_engine.hpp"

namespace canopus::module {

WordPort::WordPort(ModuleEngine& engine, BufferMemory& memory, std::span<const RequestWordRow> table)
    : engine_(engine), memory_(memory) {
  for (const RequestWordRow& row : table) {
    BufferArea* owner = memory.area(row.word);
    entries_.push_back({&row, owner == this ? behind(row.word) : owner});
    memory.attach(row.word, row.word, *this);
  }
}

std::unique_ptr<RequestPort> requests_by_words(ModuleEngine& engine) {
  return std::make_unique<WordPort>(engine, engine.memory(), engine.description().request_words);
}

BufferArea* WordPort::behind(BufferAddress address) const noexcept {
  const auto found = std::ranges::find(entries_, address, [](const Entry& entry) { return entry.row->word; });
  return found == entries_.end() ? nullptr : found->behind;
}

bool WordPort::means_something(const RequestWordRow& row) const noexcept {
  const ModuleState& state = engine_.state();
  const bool is_way_out = row.use == RequestUse::command || row.use == RequestUse::restart;
  const bool is_stuck = state.phase == ModuleState::Phase::stuck;
  return (!state.initializing() || (is_stuck && is_way_out)) && (row.modes & state.mode->bit) != 0;
}

std::uint16_t WordPort::read_word(BufferAddress address, can::Time now) const {
  std::uint16_t asked = 0;
  for (const Entry& entry : entries_) {
    const RequestWordRow& row = *entry.row;
    if (row.word != address || !means_something(row)) continue;
    if (row.use == RequestUse::online && online_wanted_) asked = row.bits.value_or(0);
  }
  const BufferArea* owner = behind(address);
  const std::uint16_t value = owner != nullptr ? owner->read_word(address, now) : memory_.word(address);
  return static_cast<std::uint16_t>(value | asked);
}

void WordPort::program_reads(BufferAddress address, can::Time now) {
  for (const Entry& entry : entries_) {
    const RequestWordRow& row = *entry.row;
    if (row.word == address && row.use == RequestUse::read_clock && means_something(row))
      engine_.read_clock(now);
  }
  if (BufferArea* owner = behind(address)) owner->program_reads(address, now);
}

WriteResult WordPort::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  for (const Entry& entry : entries_) {
    if (entry.row->word != address) continue;
    if (entry.row->use == RequestUse::data_exchange && engine_.exchanging()) return WriteResult::ignored;
  }
  BufferArea* owner = behind(address);
  if (owner == nullptr) memory_.store(address, value);
  const WriteResult result = owner != nullptr ? owner->write_word(address, value, now) : WriteResult::done;
  if (result != WriteResult::done) return result;
  written_ = true;
  word_ = address;
  value_ = value;
  return result;
}

void WordPort::serve(can::Time now) {
  engine_.clear_written_nmt_errors(now);
  if (!std::exchange(written_, false)) return;
  for (const Entry& entry : entries_) {
    if (entry.row->word == word_ && means_something(*entry.row)) act(*entry.row, value_, now);
  }
}

void WordPort::act(const RequestWordRow& row, std::uint16_t value, can::Time now) {
  const bool asks = !row.bits || (value & *row.bits) != 0;
  switch (row.use) {
    case RequestUse::online:
      online_wanted_ = asks;
      return asks ? engine_.go_online(now) : engine_.go_offline(now);
    case RequestUse::nmt_error:
      if (row.bits && (value & *row.bits) != *row.bits) engine_.clear_nmt_errors(now);
      return;
    default: break;
  }
  if (!asks) return;
  switch (row.use) {
    case RequestUse::data_exchange: return engine_.begin_exchange(now);
    case RequestUse::restart: return engine_.begin_restart(now);
    case RequestUse::command: return engine_.execute_command(now);
    case RequestUse::save_restore: return engine_.begin_save(now);
    case RequestUse::set_clock: return engine_.set_clock(now);
    case RequestUse::transmit_trigger: return engine_.request_trigger(true);
    default: return;
  }
}

void WordPort::initialization_begins(can::Time) { online_wanted_ = false; }

}  // namespace canopus::module
