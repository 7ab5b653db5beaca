#include "canopus/plc/rack/module_refresh.hpp"

#include <algorithm>
#include <utility>

namespace canopus::plc {

ModuleRefresh::ModuleRefresh(Rack& rack, can::Timeline& timeline, std::uint16_t head,
                             module::CommunicationModule& module, std::vector<Block> blocks, Timing timing,
                             const std::string& name)
    : rack_(rack),
      head_(head),
      module_(module),
      blocks_(std::move(blocks)),
      labels_(blocks_.size()),
      timing_(std::move(timing)) {
  timeline.add(*this, name);
  rack.add_listener(*this);
}

can::Time ModuleRefresh::next_after(can::Time now) const {
  if (!exchanges_) return can::never;
  if (timing_.at_end) return rack_.has_own_scan() ? can::never : rack_.scan().end_of(1, now);
  if (!programs_run_) return can::never;
  can::Time next = timing_.each_scan ? rack_.scan().end_of(1, now) : can::never;
  for (const can::Duration interval : timing_.intervals) {
    next = std::min(next, can::later(run_since_, ((now - run_since_) / interval + 1) * interval));
  }
  return next;
}

void ModuleRefresh::supply_changed(bool on, can::Time now) {
  const auto sends = [](const Block& block) { return block.to_module; };
  exchanges_ = on && std::ranges::any_of(blocks_, sends) && !std::ranges::all_of(blocks_, sends);
  if (on) labels_.assign(blocks_.size(), {});
  programs_run(on && rack_.cpu_state() == module::CpuState::run, now);
}

void ModuleRefresh::cpu_changed(module::CpuState state, can::Time now) {
  programs_run(state == module::CpuState::run, now);
}

void ModuleRefresh::cpu_paused(bool paused, can::Time now) { programs_run(!paused, now); }

void ModuleRefresh::programs_run(bool run, can::Time now) {
  programs_run_ = run;
  run_since_ = now;
  alarm() = next_after(now);
}

void ModuleRefresh::copy_to_module(std::size_t number, can::Time now) {
  const Block& block = blocks_[number];
  std::array<std::uint16_t, block_words> wanted = labels_[number], present{};
  if (block.device && !rack_.read_words(*block.device, block.number, wanted, now)) return;
  if (!rack_.read_buffer(head_, block.words, present, now)) return;
  for (std::uint32_t i = 0; i < block_words; ++i) {
    if (wanted[i] != present[i]) (void)rack_.write_buffer(head_, block.words + i, {&wanted[i], 1}, now);
  }
}

void ModuleRefresh::scan_ended(can::Time now) {
  if (exchanges_ && timing_.at_end) exchange(now);
}

// Of a rack with a scan of its own the rack's tick comes first: clients are answered before the next scan's programs.
void ModuleRefresh::tick(can::Time now) {
  if (deadline() > now) return;
  alarm() = next_after(now);
  exchange(now);
}

void ModuleRefresh::exchange(can::Time now) {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].to_module) copy_to_module(i, now);
  }
  module_.refresh(now);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Block& block = blocks_[i];
    if (block.to_module || !rack_.read_buffer(head_, block.words, labels_[i], now) || !block.device) continue;
    (void)rack_.write_words(*block.device, block.number, labels_[i], now);
  }
}

}  // namespace canopus::plc
