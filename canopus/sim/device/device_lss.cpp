#include "canopus/sim/device/device_lss.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "canopus/can/little_endian.hpp"

namespace canopus::sim {

namespace {

using Settings = DeviceLss::Settings;

// The contents of the store: the node-ID, and the bit rate in four bytes, lowest first.
constexpr std::size_t image_size = 5;

std::vector<std::uint8_t> encode(const Settings& settings) {
  std::vector<std::uint8_t> image{settings.node_id};
  can::append_value(image, settings.bit_rate, 4);
  return image;
}

std::optional<Settings> decode(std::span<const std::uint8_t> image) {
  if (image.size() != image_size) return std::nullopt;
  const Settings settings{.node_id = image[0], .bit_rate = can::load_as<std::uint32_t>(&image[1])};
  const bool is_node_id =
      (settings.node_id >= 1 && settings.node_id <= 127) || settings.node_id == lss::unconfigured;
  if (!is_node_id || std::ranges::find(can::bit_rates, settings.bit_rate) == std::end(can::bit_rates)) {
    return std::nullopt;
  }
  return settings;
}

lss::LssAddress address_of(const canopen::Node& node) {
  lss::LssAddress address;
  for (std::uint8_t part = 0; part < 4; ++part) {
    address.set_part(part, node.dictionary().get<std::uint32_t>(0x1018, static_cast<std::uint8_t>(part + 1)));
  }
  return address;
}

}  // namespace

std::optional<Settings> DeviceLss::stored(canopen::ParameterStore& store) { return decode(store.load()); }

DeviceLss::DeviceLss(canopen::Node& node, can::Controller& controller, Settings factory,
                     std::vector<std::uint32_t> bit_rates, canopen::ParameterStore* store)
    : node_(node),
      controller_(controller),
      bit_rates_(std::move(bit_rates)),
      store_(store),
      stored_(factory),
      slave_(controller, *this, address_of(node)) {
  node.set_sink(gate_);
}

void DeviceLss::power_on(can::Time) {
  is_on_ = true;
  gate_.open(true);
  if (store_ != nullptr) stored_ = stored(*store_).value_or(stored_);
  node_.set_node_id(stored_.node_id);
  slave_.start(stored_.node_id, stored_.bit_rate);
  if (controller_.bit_rate() != stored_.bit_rate) controller_.restart(stored_.bit_rate);
}

void DeviceLss::power_off() noexcept {
  is_on_ = false;
  slave_.alarm().cancel();  // power_on() restarts it
}

void DeviceLss::receive(const can::Frame& frame, can::Time now) {
  if (!is_on_) return;
  slave_.receive(frame, now);
  gate_.open(!slave_.silent());
}

void DeviceLss::tick(can::Time now) {
  if (!is_on_) return;
  slave_.tick(now);
  gate_.open(!slave_.silent());
}

void DeviceLss::node_id_assigned(std::uint8_t, can::Time now) {
  node_.command(canopen::NmtCommand::reset_communication, now);
}

bool DeviceLss::supports_bit_rate(std::uint32_t bit_rate) {
  return bit_rates_.empty() || std::ranges::find(bit_rates_, bit_rate) != bit_rates_.end();
}

void DeviceLss::change_bit_rate(std::uint32_t bit_rate, can::Time) {
  if (controller_.bit_rate() != bit_rate) controller_.restart(bit_rate);
}

lss::LssSlaveListener::Stored DeviceLss::store(std::uint8_t node_id, std::uint32_t bit_rate) {
  const Settings settings{node_id, bit_rate};
  if (store_ != nullptr && store_->save(encode(settings)) != canopen::AbortCode::none) return Stored::failed;
  stored_ = settings;
  return Stored::done;
}

// Pending values take effect after a reset [CiA 305]. The controller restarts, too: frames queued before are
// dropped.
void DeviceLss::reset_requested(canopen::NmtCommand, can::Time now) {
  controller_.abort_transmissions();
  node_.set_node_id(slave_.pending_node_id());
  change_bit_rate(slave_.pending_bit_rate(), now);
}

void DeviceLss::reset_done(canopen::NmtCommand, can::Time) {
  slave_.start(node_.node_id(), slave_.pending_bit_rate());
}

}  // namespace canopus::sim
