#include "canopus/plc/rack/rack.hpp"

#include <algorithm>
#include <utility>

#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/word_bytes.hpp"

namespace canopus::plc {

namespace {

using module::CpuState;

constexpr std::size_t index(Device device) { return static_cast<std::size_t>(device); }

bool is_bit(Device device) { return device_info(device).is_bit; }

/// R and ZR are two names of the same words.
Device stored_as(Device device) { return device == Device::r ? Device::zr : device; }

}  // namespace

Rack::Rack(can::Timeline& timeline, const CpuModel& model, std::optional<can::Duration> scan)
    : model_(model), refreshes_by_scan_(scan.has_value()) {
  condition_.scan = Scan(scan.value_or(Scan::default_period));
  condition_.clock = std::chrono::local_days{std::chrono::year{2000} / std::chrono::January / 1};
  slot_of_block_.fill(empty);
  for (std::size_t device = 0; device < device_count; ++device) {
    if (device == index(Device::r)) continue;
    std::uint32_t points = model.end_of(static_cast<Device>(device));
    if (device == index(Device::zr)) points = std::max(points, model.points_of(Device::r));
    if (is_bit(static_cast<Device>(device)))
      bits_[device].resize(points);
    else
      words_[device].resize(points);
  }
  own_buffer_.resize(model.buffer_words);
  outputs_before_stop_.resize(bits_of(Device::y).size());
  if (scan) timeline.add(*this, "scans of a CPU");
}

bool Rack::insert(std::uint16_t head_address, module::Module& module) {
  // A module without signals still needs an address of its own for U\G.
  const FamilyInfo& family = family_info(model_.family);
  const std::size_t blocks = family.modules_have_points ? std::max(1U, (module.points() + 15) / 16) : 1;
  const std::size_t first = head_address / 16U;
  const std::size_t number = family.modules_have_points ? head_address : first;
  if (on_ || head_address % 16 != 0 || number < family.place.first || number > family.place.last)
    return false;
  if (first + blocks > block_count || slots_.size() >= empty) return false;
  for (std::size_t block = first; block < first + blocks; ++block)
    if (slot_of_block_[block] != empty) return false;
  for (std::size_t block = first; block < first + blocks; ++block)
    slot_of_block_[block] = static_cast<std::uint8_t>(slots_.size());
  module::SignalAccess* const signals = family.modules_have_points ? module.signals() : nullptr;
  slots_.push_back({head_address, &module, module.buffer_memory(), signals, module.registers()});
  return true;
}

module::Module* Rack::module_at(std::uint16_t head_address) const noexcept {
  const Slot* slot = slot_of_point(head_address);
  return slot != nullptr && slot->head == head_address ? slot->module : nullptr;
}

std::vector<Rack::ProductListRow> Rack::product_list() const {
  std::vector<ProductListRow> rows;
  for (const Slot& slot : slots_) {
    rows.push_back({static_cast<unsigned>(rows.size()), slot.head, slot.module->product()});
  }
  return rows;
}

void Rack::power_on(can::Time now, CpuState state) {
  for (DeviceWords& words : words_) words.clear();
  for (DeviceBits& bits : bits_) bits.clear();
  std::ranges::fill(own_buffer_, std::uint16_t{0});
  std::ranges::fill(outputs_before_stop_, std::uint8_t{0});
  on_ = true;
  condition_.state = state;
  condition_.stop_cause = StopCause::by_switch;
  condition_.is_paused = false;
  condition_.error.reset();
  condition_.scan.start(now);
  if (state == CpuState::run) condition_.scan.run(now);
  alarm() = refreshes_by_scan_ ? condition_.scan.end_of(1, now) : can::never;
  for (const Slot& slot : slots_) {
    slot.module->power_on(now);
  }
  notify_cpu_state(now);
  for (RackListener* listener : listeners_) listener->supply_changed(true, now);
  for (Slot& slot : slots_) slot.inputs = inputs_of(slot);
  begin_scan(now);
}

void Rack::power_off(can::Time now) {
  on_ = condition_.is_paused = false;
  condition_.scan.stop(now);
  alarm() = can::never;
  for (const Slot& slot : slots_) slot.module->power_off(now);
  for (RackListener* listener : listeners_) listener->supply_changed(false, now);
  end_processing_.answer(now);  // there is no END any more
}

// X first: a module's response to a Y is visible in the next scan, as behind the filters of a real one.
// Clients read and write between the two, so their X and buffer memory are of one moment, and so are their Y
// and what they write there.
void Rack::tick(can::Time now) {
  if (deadline() > now) return;
  alarm() = condition_.scan.end_of(1, now);
  for (RackListener* listener : listeners_) listener->scan_ended(now);
  for (Slot& slot : slots_) slot.inputs = inputs_of(slot);
  end_processing_.answer(now);
  for (const Slot& slot : slots_) outputs_to_module(slot, now);
  begin_scan(now);
}

/// In their order, and those alone that differ: a scan seldom changes any.
void Rack::outputs_to_module(const Slot& slot, can::Time now) {
  if (slot.signals == nullptr || !on_) return;
  const std::uint32_t points = std::min(slot.module->points(), 32U);
  const std::uint32_t end = std::min(slot.head + points, model_.points_of(Device::y));
  std::uint32_t outputs = slot.signals->outputs();
  for (std::uint32_t number = slot.head; number < end; ++number) {
    const std::uint32_t signal = number - slot.head;
    const bool on = output(number);
    if ((outputs >> signal & 1U) == (on ? 1U : 0U)) continue;
    slot.signals->set_output(signal, on, now);
    outputs = slot.signals->outputs();  // it may have changed others
  }
}

void Rack::begin_scan(can::Time now) {
  if (!refreshes_by_scan_ || !on_ || condition_.state != CpuState::run || condition_.is_paused) return;
  for (RackListener* listener : listeners_) listener->scan_begins(now);
}

std::uint32_t Rack::inputs_of(const Slot& slot) const noexcept {
  return on_ && slot.signals != nullptr ? slot.signals->inputs() : 0;
}

Rack::Access Rack::refresh(Device device, std::uint32_t first, std::uint32_t count, can::Time now) {
  if (Access refused = check(device, first, count); !refused) return refused;
  for (Slot& slot : slots_) {
    if (slot.signals == nullptr) continue;
    const std::uint32_t inputs = inputs_of(slot);
    for (std::uint32_t signal = 0; signal < std::min(slot.module->points(), 32U); ++signal) {
      const std::uint32_t number = slot.head + signal;
      if (number < first || number - first >= count) continue;
      const std::uint32_t mask = 1U << signal;
      if (device == Device::x) slot.inputs = (slot.inputs & ~mask) | (inputs & mask);
      if (device == Device::y) output_to_module(number, output(number), now);
    }
  }
  return {};
}

bool Rack::output(std::uint32_t number) const noexcept { return bits_of(Device::y)[number]; }

void Rack::set_output(std::uint32_t number, bool on, can::Time now) {
  bits_of(Device::y).set(number, on);
  output_to_module(number, on, now);
}

void Rack::set_cpu_state(CpuState state, can::Time now) {
  if (std::exchange(condition_.is_paused, false) && state == CpuState::run) {
    condition_.scan.resume(now);
    for (RackListener* listener : listeners_) listener->cpu_paused(false, now);
  }
  if (state == condition_.state) return;
  condition_.state = state;
  condition_.stop_cause = StopCause::remote;
  if (state == CpuState::stop) {
    condition_.scan.stop(now);
    outputs_before_stop_ = bits_of(Device::y).all();
    notify_cpu_state(now);
    for (std::uint32_t number = 0; number < model_.points_of(Device::y); ++number)
      if (output(number)) set_output(number, false, now);
  } else {
    condition_.error.reset();
    condition_.scan.run(now);
    notify_cpu_state(now);
    for (std::uint32_t number = 0; number < model_.points_of(Device::y); ++number)
      set_output(number, outputs_before_stop_[number] != 0, now);
  }
  for (RackListener* listener : listeners_) listener->cpu_changed(state, now);
  if (state == CpuState::run) begin_scan(now);
}

void Rack::pause(can::Time now) {
  if (!on_ || condition_.state == CpuState::stop || std::exchange(condition_.is_paused, true)) return;
  condition_.scan.stop(now);
  for (RackListener* listener : listeners_) listener->cpu_paused(true, now);
}

void Rack::fail_cpu(can::Time now, CpuError error) {
  if (!on_) return;
  for (const Slot& slot : slots_) {
    slot.module->cpu_failed(now);
  }
  set_cpu_state(CpuState::stop, now);
  condition_.stop_cause = StopCause::error;
  error.time = now;
  condition_.error = error;
}

void Rack::reset_cpu(can::Time now) {
  if (!on_) return;
  // The RUN/STOP switch determines the state after power-on; a remote STOP or an error is cleared.
  const bool is_switched_off =
      condition_.state == CpuState::stop && condition_.stop_cause == StopCause::by_switch;
  const CpuState state = is_switched_off ? CpuState::stop : CpuState::run;
  power_off(now);
  power_on(now, state);
}

void Rack::notify_cpu_state(can::Time now) {
  for (const Slot& slot : slots_) {
    slot.module->cpu_changed(condition_.state, now);
  }
}

void Rack::clear_devices(bool latched, can::Time now) {
  for (std::uint32_t number = 0; number < model_.points_of(Device::y); ++number)
    set_output(number, false, now);
  std::ranges::fill(outputs_before_stop_, std::uint8_t{0});
  for (std::size_t number = 0; number < device_count; ++number) {
    const auto device = static_cast<Device>(number);
    if (device == Device::sm || device == Device::sd || device == Device::zr || device == Device::z) continue;
    if (device == Device::hg) continue;  // buffer memory
    if (device == Device::l && !latched) continue;
    const std::uint32_t points = model_.points_of(device);  // special ones stay
    bits_[number].clear(points);
    words_[number].clear(std::min<std::size_t>(points, words_[number].size()));
  }
}

void Rack::clear_latched() noexcept { bits_of(Device::l).clear(); }

void Rack::set_clock(std::chrono::local_seconds clock, can::Time now) noexcept {
  condition_.clock = clock;
  condition_.clock_set = now;
}

Rack::Access Rack::check(Device device, std::uint32_t first, std::uint32_t count) const noexcept {
  if (model_.points_of(device) == 0) return std::unexpected(AccessError::no_device);
  if (!model_.has(device, first, count)) return std::unexpected(AccessError::out_of_range);
  return {};
}

Rack::Access Rack::read_words(Device device, std::uint32_t first, std::span<std::uint16_t> words,
                              can::Time now) {
  const auto count = static_cast<std::uint32_t>(words.size());
  if (!is_bit(device)) {
    if (Access access = check(device, first, count); !access) return access;
    words_of(device).read(first, words);
    if (device == model_.special_register()) {
      for (std::uint32_t i = 0; i < count; ++i)
        words[i] = special_register(model_, condition_, first + i, now).value_or(words[i]);
    }
    read_registers(device, first, words, now);
    return {};
  }
  if (Access access = check(device, first, 16 * count); !access) return access;
  const unsigned shift = first % 16;
  std::uint32_t block = first / 16;
  std::uint32_t low = bit_block(device, block, now);
  for (std::uint16_t& word : words) {
    if (shift == 0) {
      word = static_cast<std::uint16_t>(low);
      if (&word != &words.back()) low = bit_block(device, ++block, now);
      continue;
    }
    const std::uint32_t high = bit_block(device, ++block, now);
    word = static_cast<std::uint16_t>((high << 16U | low) >> shift);
    low = high;
  }
  return {};
}

Rack::Access Rack::write_words(Device device, std::uint32_t first, std::span<const std::uint16_t> words,
                               can::Time now) {
  const auto count = static_cast<std::uint32_t>(words.size());
  if (!is_bit(device)) {
    if (Access access = check(device, first, count); !access) return access;
    words_of(device).write(first, words);
    write_registers(device, first, words, now);
    return {};
  }
  if (Access access = check(device, first, 16 * count); !access) return access;
  for (std::uint32_t i = 0; i < count; ++i)
    for (unsigned bit = 0; bit < 16; ++bit)
      write_bit(device, first + 16 * i + bit, (words[i] >> bit & 1U) != 0, now);
  return {};
}

Rack::Access Rack::read_bits(Device device, std::uint32_t first, std::span<std::uint8_t> bits,
                             can::Time now) {
  if (!is_bit(device)) return std::unexpected(AccessError::wrong_unit);
  const auto count = static_cast<std::uint32_t>(bits.size());
  if (Access access = check(device, first, count); !access) return access;
  std::uint16_t block = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t number = first + i;
    if (i == 0 || number % 16 == 0) block = bit_block(device, number / 16, now);
    bits[i] = static_cast<std::uint8_t>(block >> (number % 16) & 1U);
  }
  return {};
}

Rack::Access Rack::write_bits(Device device, std::uint32_t first, std::span<const std::uint8_t> bits,
                              can::Time now) {
  if (!is_bit(device)) return std::unexpected(AccessError::wrong_unit);
  const auto count = static_cast<std::uint32_t>(bits.size());
  if (Access access = check(device, first, count); !access) return access;
  for (std::uint32_t i = 0; i < count; ++i) write_bit(device, first + i, bits[i] != 0, now);
  return {};
}

const Rack::Slot* Rack::slot_of_point(std::uint32_t point) const noexcept {
  if (point / 16 >= block_count) return nullptr;
  const std::uint8_t number = slot_of_block_[point / 16];
  return number == empty ? nullptr : &slots_[number];
}

DeviceWords& Rack::words_of(Device device) noexcept { return words_[index(stored_as(device))]; }

bool Rack::is_module_input(Device device, std::uint32_t number) const noexcept {
  return device == Device::x && family_info(model_.family).modules_have_points &&
         slot_of_point(number) != nullptr;
}

std::uint8_t* Rack::bit_in_memory(Device device, std::uint32_t number) noexcept {
  if (!is_bit(device) || !check(device, number, 1) || is_module_input(device, number)) return nullptr;
  if (device == Device::y && !refreshes_by_scan_) return nullptr;  // a write is a signal at once
  // Special relays, which an FX3 has behind its other M.
  if (device == model_.special_relay() && (device != Device::m || number >= model_.points_of(device)))
    return nullptr;
  return &bits_of(device).at(number);
}

std::uint16_t* Rack::words_in_memory(Device device, std::uint32_t first, std::uint32_t count) {
  if (is_bit(device) || !check(device, first, count) || is_module_register(device, first, count))
    return nullptr;
  if (device == model_.special_register() && (device != Device::d || first >= model_.points_of(device)))
    return nullptr;
  return words_of(device).at(first, count);
}

std::uint16_t Rack::bit_block(Device device, std::uint32_t block, can::Time now) {
  if (is_module_input(device, 16 * block)) {
    const Slot& slot = *slot_of_point(16 * block);
    const std::uint32_t shift = 16 * block - slot.head;  // a module has at most 32 signals
    if (shift >= 32) return 0;
    return static_cast<std::uint16_t>((refreshes_by_scan_ ? slot.inputs : inputs_of(slot)) >> shift);
  }
  const std::uint16_t word = bits_of(device).block(block);
  return device == model_.special_relay() ? special_relays(model_, condition_, block, word, now) : word;
}

void Rack::write_bit(Device device, std::uint32_t number, bool on, can::Time now) {
  bits_of(device).set(number, on);
  if (device == Device::y && !refreshes_by_scan_) output_to_module(number, on, now);
}

void Rack::output_to_module(std::uint32_t number, bool on, can::Time now) {
  const Slot* slot = slot_of_point(number);
  if (slot == nullptr || slot->signals == nullptr || !on_) return;
  const unsigned signal = number - slot->head;
  if (signal >= std::min(slot->module->points(), 32U) ||
      (slot->signals->outputs() >> signal & 1U) == (on ? 1U : 0U))
    return;
  slot->signals->set_output(signal, on, now);
}

}  // namespace canopus::plc
