// Setup of a device's generated values, scripts and playbacks, before power-on.

#include <algorithm>
#include <cmath>
#include <utility>

#include "canopus/eds/problems.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/sim/device/device.hpp"

namespace canopus::sim {

using canopen::Entry;

Device::Device(std::shared_ptr<const eds::DeviceFile> file, std::uint8_t node_id, can::Sink& sink,
               DeviceOptions options)
    : file_(std::move(file)),
      node_(file_->dictionary, node_id, sink, options.node),
      sample_interval_(std::max<can::Duration>(options.sample_interval, std::chrono::microseconds(1))) {
  node_.set_listener(this);
  alarm().add_part(node_.alarm());
}

std::optional<std::string> Device::add_behaviour(const Behaviour& behaviour) {
  const canopen::DictionaryDescription& description = *file_->dictionary;
  const auto find = [&](std::uint16_t index, std::uint8_t sub, Entry& entry) -> std::optional<std::string> {
    const std::string shown = eds::object_text(index, sub);
    entry = description.find(index, sub);
    if (!entry) return "the device has no object " + shown;
    if (!eds::is_number(entry.description->type)) {
      return shown + " is of type " + std::string(eds::name(entry.description->type)) + ", not a number";
    }
    return std::nullopt;
  };
  Entry target;
  if (auto problem = find(behaviour.index, behaviour.sub, target)) return problem;
  const std::uint8_t length = target.description->length;
  Motion motion{.target = target,
                .mask = ~std::uint64_t{0} >> (64 - 8 * length),
                .places = canopen::value_mask_of(target.offset, length),
                .generator = {behaviour, bounds(target.description->type, description.limits(target))}};
  for (const Playback& playback : playbacks_) {
    if (std::ranges::any_of(playback.entries(),
                            [&](const Entry& entry) { return same(entry, motion.target); }))
      return eds::object_text(behaviour.index, behaviour.sub) + " is played back from a file already";
  }
  const std::string shown = eds::object_text(behaviour.index, behaviour.sub);
  if (application_ && application_->owns(behaviour.index, behaviour.sub))
    return shown + " is moved by the device itself";
  switch (behaviour.kind) {
    case Behaviour::Kind::echo:
      if (auto problem = find(behaviour.source_index, behaviour.source_sub, motion.source)) return problem;
      if (motion.source.description->type != motion.target.description->type) {
        return shown + " is of type " + std::string(eds::name(motion.target.description->type)) +
               ", its source " + eds::object_text(behaviour.source_index, behaviour.source_sub) +
               " of type " + std::string(eds::name(motion.source.description->type)) +
               ": an echo needs equal types";
      }
      break;
    case Behaviour::Kind::counter:
      if (!(behaviour.step > 0) || !std::isfinite(behaviour.step)) return "step must be greater than 0";
      [[fallthrough]];
    case Behaviour::Kind::sine:
    case Behaviour::Kind::ramp:
    case Behaviour::Kind::noise:
      if (behaviour.period <= can::Duration::zero()) return "period must be greater than 0";
      if (!(behaviour.low <= behaviour.high)) return "low must not be greater than high";
      [[fallthrough]];
    case Behaviour::Kind::constant:
      if (!std::isfinite(behaviour.low) || !std::isfinite(behaviour.high))
        return "low and high must be finite";
      break;
  }
  samples_ =
      samples_ || (behaviour.kind != Behaviour::Kind::echo && behaviour.kind != Behaviour::Kind::constant);
  echoes_ = echoes_ || behaviour.kind == Behaviour::Kind::echo;
  motions_.push_back(motion);
  next_change_ = {};
  update_fast_path();
  return std::nullopt;
}

void Device::update_fast_path() noexcept {
  has_fast_path_ = samples_ && !echoes_ && !application_ && playbacks_.empty() && script_.empty() &&
                   forcing_.all().empty() && !lss_;
  is_watched_ =
      !application_ && playbacks_.empty() &&
      std::ranges::all_of(motions_, [](const Motion& motion) { return motion.target.index >= 0x2000; });
  set_alarm();
}

std::expected<Entry, std::string> Device::process_value(std::uint16_t index, std::uint8_t sub) const {
  const std::string shown = eds::object_text(index, sub);
  const Entry entry = file_->dictionary->find(index, sub);
  if (!entry) return std::unexpected("the device has no object " + shown);
  if (index < 0x2000) {
    return std::unexpected(shown + " configures the node; expected a process value, 2000H to FFFFH");
  }
  if (sub == 0 && file_->dictionary->find(index)->highest_sub != 0) {
    return std::unexpected(shown + " is the number of sub-indexes; expected one of them");
  }
  if (!eds::is_number(entry.description->type)) {
    return std::unexpected(shown + " is of type " + std::string(eds::name(entry.description->type)) +
                           ", not a number");
  }
  return entry;
}

std::optional<std::string> Device::add_playback(Playback playback) {
  const auto moves = [&](const Entry& entry) {
    return std::ranges::any_of(motions_, [&](const Motion& motion) { return same(motion.target, entry); }) ||
           std::ranges::any_of(playbacks_, [&](const Playback& other) {
             return std::ranges::any_of(other.entries(), [&](const Entry& its) { return same(its, entry); });
           });
  };
  for (const Entry& entry : playback.entries()) {
    const std::string shown = eds::object_text(entry.index, entry.sub);
    if (const auto value = process_value(entry.index, entry.sub); !value) return value.error();
    if (moves(entry)) return shown + " moves already, by a behaviour or another file";
    if (application_ && application_->owns(entry.index, entry.sub))
      return shown + " is moved by the device itself";
  }
  playbacks_.push_back(std::move(playback));
  update_fast_path();
  return std::nullopt;
}

void Device::enable_lss(can::Controller& controller, canopen::ParameterStore* store) {
  lss_ = std::make_unique<DeviceLss>(node_, controller,
                                     DeviceLss::Settings{node_.node_id(), controller.bit_rate()},
                                     file_->device.bit_rates, store);
  alarm().add_part(lss_->alarm());
  update_fast_path();
}

}  // namespace canopus::sim
