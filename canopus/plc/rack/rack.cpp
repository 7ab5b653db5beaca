#include "canopus/plc/rack/rack.hpp"

#include <algorithm>
#include <utility>

#include "canopus/plc/cpu/device_points.hpp"

namespace canopus::plc {

namespace {

using module::CpuState;

constexpr std::size_t index(Device device) { return static_cast<std::size_t>(device); }

bool is_bit(Device device) { return device_info(device).is_bit; }

/// R and ZR are two names of the same words.
Device stored_as(Device device) { return device == Device::r ? Device::zr : device; }

std::uint16_t with_bit(std::uint16_t word, unsigned bit, bool on) {
  const auto mask = static_cast<std::uint16_t>(1U << bit);
  return static_cast<std::uint16_t>(on ? word | mask : word & ~mask);
}

std::uint16_t bcd(unsigned two_digits) {
  return static_cast<std::uint16_t>((two_digits / 10 % 10) << 4U | two_digits % 10);
}

std::uint16_t bcd_pair(unsigned high, unsigned low) {
  return static_cast<std::uint16_t>(bcd(high) << 8U | bcd(low));
}

}  // namespace

Rack::Rack(can::Timeline& timeline, const CpuModel& model)
    : timeline_(timeline),
      model_(model),
      clock_(std::chrono::local_days{std::chrono::year{2000} / std::chrono::January / 1}) {
  slot_of_block_.fill(empty);
  for (std::size_t device = 0; device < device_count; ++device) {
    if (device == index(Device::r)) continue;
    const std::uint32_t points = model.points[device];
    memory_[device].resize(is_bit(static_cast<Device>(device)) ? (points + 15) / 16 : points);
  }
  own_buffer_.resize(model.buffer_words);
  outputs_before_stop_.resize(memory_[index(Device::y)].size());
}

bool Rack::insert(std::uint16_t head_address, module::Module& module, can::Timeline::Handle handle) {
  // A module without signals still needs an address of its own for U\G.
  const std::size_t blocks = std::max(1U, (module.points() + 15) / 16);
  const std::size_t first = head_address / 16U;
  if (on_ || head_address % 16 != 0 || first + blocks > block_count || slots_.size() >= empty) return false;
  for (std::size_t block = first; block < first + blocks; ++block)
    if (slot_of_block_[block] != empty) return false;
  for (std::size_t block = first; block < first + blocks; ++block)
    slot_of_block_[block] = static_cast<std::uint8_t>(slots_.size());
  slots_.push_back({head_address, &module, module.buffer_memory(), module.signals(), handle});
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
  for (auto& words : memory_) std::ranges::fill(words, std::uint16_t{0});
  std::ranges::fill(own_buffer_, std::uint16_t{0});
  std::ranges::fill(outputs_before_stop_, std::uint16_t{0});
  on_ = true;
  state_ = state;
  stop_cause_ = StopCause::by_switch;
  paused_ = false;
  for (const Slot& slot : slots_) {
    slot.module->power_on(now);
    timeline_.refresh(slot.handle);
  }
  tell_cpu_state(now);
  for (RackListener* listener : listeners_) listener->supply_changed(true, now);
  refresh_modules();
}

void Rack::power_off(can::Time now) {
  on_ = paused_ = false;
  for (const Slot& slot : slots_) slot.module->power_off(now);
  for (RackListener* listener : listeners_) listener->supply_changed(false, now);
  refresh_modules();
}

// A listener may be the one whose deadline the timeline knows for a module.
void Rack::refresh_modules() {
  for (const Slot& slot : slots_) timeline_.refresh(slot.handle);
}

void Rack::set_cpu_state(CpuState state, can::Time now) {
  if (std::exchange(paused_, false) && state == CpuState::run) {
    for (RackListener* listener : listeners_) listener->cpu_paused(false, now);
    refresh_modules();
  }
  if (state == state_) return;
  state_ = state;
  stop_cause_ = StopCause::remote;
  auto& outputs = memory_[index(Device::y)];
  if (state == CpuState::stop) {
    outputs_before_stop_ = outputs;
    tell_cpu_state(now);
    for (std::uint32_t number = 0; number < model_.points_of(Device::y); ++number)
      if ((outputs[number / 16] >> (number % 16) & 1U) != 0) write_bit(Device::y, number, false, now);
  } else {
    tell_cpu_state(now);
    for (std::uint32_t number = 0; number < model_.points_of(Device::y); ++number)
      write_bit(Device::y, number, (outputs_before_stop_[number / 16] >> (number % 16) & 1U) != 0, now);
  }
  for (RackListener* listener : listeners_) listener->cpu_changed(state, now);
  refresh_modules();
}

void Rack::pause(can::Time now) {
  if (!on_ || state_ == CpuState::stop || std::exchange(paused_, true)) return;
  for (RackListener* listener : listeners_) listener->cpu_paused(true, now);
  refresh_modules();
}

void Rack::fail_cpu(can::Time now) {
  if (!on_) return;
  for (const Slot& slot : slots_) {
    slot.module->cpu_failed(now);
    timeline_.refresh(slot.handle);
  }
  set_cpu_state(CpuState::stop, now);
  stop_cause_ = StopCause::error;
}

void Rack::reset_cpu(can::Time now) {
  if (!on_) return;
  const CpuState state = state_;
  power_off(now);
  power_on(now, state);
}

void Rack::tell_cpu_state(can::Time now) {
  for (const Slot& slot : slots_) {
    slot.module->cpu_changed(state_, now);
    timeline_.refresh(slot.handle);
  }
}

void Rack::clear_devices(bool latched, can::Time now) {
  for (std::uint32_t number = 0; number < model_.points_of(Device::y); ++number)
    write_bit(Device::y, number, false, now);
  std::ranges::fill(outputs_before_stop_, std::uint16_t{0});
  for (std::size_t number = 0; number < device_count; ++number) {
    const auto device = static_cast<Device>(number);
    if (device == Device::sm || device == Device::sd || device == Device::zr || device == Device::z) continue;
    if (device == Device::l && !latched) continue;
    std::ranges::fill(memory_[number], std::uint16_t{0});
  }
}

void Rack::clear_latched() noexcept { std::ranges::fill(memory_[index(Device::l)], std::uint16_t{0}); }

void Rack::set_clock(std::chrono::local_seconds clock, can::Time now) noexcept {
  clock_ = clock;
  clock_set_ = now;
}

Rack::Access Rack::check(Device device, std::uint32_t first, std::uint32_t count) const noexcept {
  const std::uint32_t points = model_.points_of(device);
  if (points == 0) return std::unexpected(AccessError::no_device);
  if (first >= points || count > points - first) return std::unexpected(AccessError::out_of_range);
  return {};
}

Rack::Access Rack::check_buffer(std::uint16_t head_address, module::BufferAddress first,
                                std::uint32_t count) const noexcept {
  const Slot* slot = slot_of_point(head_address);
  if (slot == nullptr || !on_) return std::unexpected(AccessError::no_module);
  const module::BufferAddress size = slot->buffer == nullptr ? 0 : slot->buffer->buffer_memory_size();
  if (first >= size || count > size - first) return std::unexpected(AccessError::beyond_buffer);
  return {};
}

Rack::Access Rack::read_words(Device device, std::uint32_t first, std::span<std::uint16_t> words,
                              can::Time now) {
  const auto count = static_cast<std::uint32_t>(words.size());
  if (!is_bit(device)) {
    if (Access access = check(device, first, count); !access) return access;
    if (device == Device::sd) {
      for (std::uint32_t i = 0; i < count; ++i) words[i] = special_register(first + i, now);
    } else {
      std::ranges::copy(memory(device).subspan(first, count), words.begin());
    }
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
    std::ranges::copy(words, memory(device).subspan(first, count).begin());
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

Rack::Access Rack::read_buffer(std::uint16_t head_address, module::BufferAddress first,
                               std::span<std::uint16_t> words, can::Time now) {
  const auto count = static_cast<std::uint32_t>(words.size());
  if (Access access = check_buffer(head_address, first, count); !access) return access;
  const Slot& slot = *slot_of_point(head_address);
  for (std::uint32_t i = 0; i < count; ++i) words[i] = slot.buffer->read_word(first + i, now);
  timeline_.refresh(slot.handle);  // some words act when they are read
  return {};
}

Rack::Access Rack::write_buffer(std::uint16_t head_address, module::BufferAddress first,
                                std::span<const std::uint16_t> words, can::Time now) {
  const auto count = static_cast<std::uint32_t>(words.size());
  if (Access access = check_buffer(head_address, first, count); !access) return access;
  const Slot& slot = *slot_of_point(head_address);
  for (std::uint32_t i = 0; i < count; ++i) slot.buffer->write_word(first + i, words[i], now);
  timeline_.refresh(slot.handle);
  return {};
}

const Rack::Slot* Rack::slot_of_point(std::uint32_t point) const noexcept {
  if (point / 16 >= block_count) return nullptr;
  const std::uint8_t number = slot_of_block_[point / 16];
  return number == empty ? nullptr : &slots_[number];
}

std::span<std::uint16_t> Rack::memory(Device device) noexcept { return memory_[index(stored_as(device))]; }

std::uint16_t Rack::bit_block(Device device, std::uint32_t block, can::Time now) {
  if (device == Device::x) {
    if (const Slot* slot = slot_of_point(16 * block); slot != nullptr) {
      const std::uint32_t shift = 16 * block - slot->head;  // a module has at most 32 signals
      if (!on_ || shift >= 32 || slot->signals == nullptr) return 0;
      return static_cast<std::uint16_t>(slot->signals->inputs() >> shift);
    }
  }
  if (device == Device::sm) return special_relays(block, now);
  return memory_[index(device)][block];
}

void Rack::write_bit(Device device, std::uint32_t number, bool on, can::Time now) {
  std::uint16_t& block = memory_[index(device)][number / 16];
  block = with_bit(block, number % 16, on);
  if (device == Device::y) output_to_module(number, on, now);
}

void Rack::output_to_module(std::uint32_t number, bool on, can::Time now) {
  const Slot* slot = slot_of_point(number);
  if (slot == nullptr || slot->signals == nullptr || !on_) return;
  const unsigned signal = number - slot->head;
  if (signal >= std::min(slot->module->points(), 32U) ||
      (slot->signals->outputs() >> signal & 1U) == (on ? 1U : 0U))
    return;
  slot->signals->set_output(signal, on, now);
  timeline_.refresh(slot->handle);
}

std::uint16_t Rack::special_relays(std::uint32_t block, can::Time now) const noexcept {
  std::uint16_t word = memory_[index(Device::sm)][block];
  const bool run = state_ == CpuState::run;
  const auto half_period_odd = [now](std::chrono::milliseconds half) {
    return now.time_since_epoch() / half % 2 != 0;
  };
  using std::chrono::milliseconds;
  if (block == 203 / 16) {
    word = with_bit(word, 203 % 16, !run);     // SM203 CPU in STOP
    word = with_bit(word, 204 % 16, paused_);  // SM204 CPU in PAUSE
  } else if (block == 400 / 16) {
    word = with_bit(word, 0, true);                                  // SM400 always ON
    word = with_bit(word, 1, false);                                 // SM401 always OFF
    word = with_bit(word, 2, false);                                 // SM402 ON for the first scan: over
    word = with_bit(word, 3, run);                                   // SM403 ON after the first scan
    word = with_bit(word, 10, half_period_odd(milliseconds(50)));    // SM410 0.1 s clock
    word = with_bit(word, 11, half_period_odd(milliseconds(100)));   // SM411 0.2 s clock
    word = with_bit(word, 12, half_period_odd(milliseconds(500)));   // SM412 1 s clock
    word = with_bit(word, 13, half_period_odd(milliseconds(1000)));  // SM413 2 s clock
  }
  return word;
}

std::uint16_t Rack::special_register(std::uint32_t number, can::Time now) const noexcept {
  if (number == 203) {  // CPU state; in STOP and PAUSE with its cause
    constexpr unsigned in_stop = 2;
    constexpr unsigned in_pause = 3;
    if (paused_) return static_cast<std::uint16_t>(in_pause | static_cast<unsigned>(StopCause::remote) << 4U);
    if (state_ == CpuState::run) return 0;
    return static_cast<std::uint16_t>(in_stop | static_cast<unsigned>(stop_cause_) << 4U);
  }
  if (const auto points = device_points_register(model_, number)) return *points;
  if (number < 210 || number > 216) return memory_[index(Device::sd)][number];

  const auto at = clock_ + std::chrono::floor<std::chrono::seconds>(now - clock_set_);
  const auto midnight = std::chrono::floor<std::chrono::days>(at);
  const std::chrono::year_month_day date{midnight};
  const std::chrono::hh_mm_ss time{at - midnight};
  const auto year = static_cast<unsigned>(static_cast<int>(date.year()));
  const auto month = static_cast<unsigned>(date.month());
  const auto day = static_cast<unsigned>(date.day());
  const auto hour = static_cast<unsigned>(time.hours().count());
  const auto minute = static_cast<unsigned>(time.minutes().count());
  const auto second = static_cast<unsigned>(time.seconds().count());
  const unsigned weekday = std::chrono::weekday{midnight}.c_encoding();  // 0 is Sunday, as the CPU counts
  if (model_.bcd_clock) {
    switch (number) {
      case 210: return bcd_pair(year % 100, month);
      case 211: return bcd_pair(day, hour);
      case 212: return bcd_pair(minute, second);
      case 213: return bcd_pair(year / 100, weekday);
      default: return memory_[index(Device::sd)][number];
    }
  }
  switch (number) {
    case 210: return static_cast<std::uint16_t>(year);
    case 211: return static_cast<std::uint16_t>(month);
    case 212: return static_cast<std::uint16_t>(day);
    case 213: return static_cast<std::uint16_t>(hour);
    case 214: return static_cast<std::uint16_t>(minute);
    case 215: return static_cast<std::uint16_t>(second);
    default: return static_cast<std::uint16_t>(weekday);
  }
}

}  // namespace canopus::plc
