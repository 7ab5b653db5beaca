#include "canopus/plc/rack/module_refresh.hpp"

#include <algorithm>
#include <array>

namespace canopus::plc {

ModuleRefresh::ModuleRefresh(Rack& rack, can::Timeline& timeline, std::uint16_t head,
                             module::CommunicationModule& module, can::Timeline::Handle module_handle,
                             std::vector<Block> blocks, const std::string& name)
    : rack_(rack),
      timeline_(timeline),
      head_(head),
      module_(module),
      module_handle_(module_handle),
      blocks_(std::move(blocks)),
      handle_(timeline.add(*this, name)) {
  rack.add_listener(*this);
}

ModuleRefresh::~ModuleRefresh() { timeline_.remove(handle_); }

void ModuleRefresh::supply_changed(bool on, can::Time now) {
  const auto sends = [](const Block& block) { return block.to_module; };
  const bool both = std::ranges::any_of(blocks_, sends) && !std::ranges::all_of(blocks_, sends);
  is_on_ = on && both;
  next_ = is_on_ && !rack_.has_own_scan() ? rack_.scan().end_of(1, now) : can::never;
  timeline_.refresh(handle_);
}

void ModuleRefresh::copy_to_module(const Block& block, can::Time now) {
  std::array<std::uint16_t, block_words> wanted{}, present{};
  if (!rack_.read_words(block.device, block.number, wanted, now)) return;
  if (!rack_.read_buffer(head_, block.words, present, now)) return;
  for (std::uint32_t i = 0; i < block_words; ++i) {
    if (wanted[i] != present[i]) (void)rack_.write_buffer(head_, block.words + i, {&wanted[i], 1}, now);
  }
}

void ModuleRefresh::scan_ended(can::Time now) {
  if (is_on_) exchange(now);
}

void ModuleRefresh::tick(can::Time now) {
  if (next_ > now) return;
  next_ = rack_.scan().end_of(1, now);
  exchange(now);
}

void ModuleRefresh::exchange(can::Time now) {
  for (const Block& block : blocks_) {
    if (block.to_module) copy_to_module(block, now);
  }
  module_.refresh(now);
  timeline_.refresh(module_handle_);
  for (const Block& block : blocks_) {
    if (block.to_module) continue;
    std::array<std::uint16_t, block_words> words{};
    if (rack_.read_buffer(head_, block.words, words, now)) {
      (void)rack_.write_words(block.device, block.number, words, now);
    }
  }
}

}  // namespace canopus::plc
