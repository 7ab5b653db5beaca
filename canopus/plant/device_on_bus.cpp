#include "canopus/plant/device_on_bus.hpp"

#include <algorithm>
#include <utility>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/service/device_profile.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/file/process_value.hpp"

namespace canopus::plant {

namespace {

sim::DeviceOptions options_of(const eds::DeviceFile& file, const DeviceSection& section) {
  sim::DeviceOptions options;
  options.node.accepts_short_sdo_requests = section.short_sdo_requests;
  options.node.permitted_pdo_identifier =
      canopen::permitted_pdo_identifier(eds::identity(file).device_type.value_or(0));
  return options;
}

}  // namespace

DeviceOnBus::DeviceOnBus(std::shared_ptr<const eds::DeviceFile> file, const DeviceSection& section,
                         std::uint8_t node_id, can::Port& port, PlantObserver& observer)
    : port_(port),
      start_(can::Time{} + section.start),
      device_(file, node_id, port, options_of(*file, section)),
      observer_(observer) {
  const std::string& product = device_.file().device.product_name;
  name_ = !section.name.empty() ? section.name : product;
  status_.label = {section.bus, name_, node_id};
  device_.set_listener(this);
  device_.set_force_listener(this);
  alarm().add_part(device_.alarm());
  alarm() = start_;
  if (section.start > can::Duration{}) port.set_power(false);
}

void DeviceOnBus::warn(std::string_view sentence, can::Time now) {
  const NodeLabel& label = status_.label;
  observer_.on({now, Warning{fmt::format("{} node {} ({})", label.bus, label.node_id, label.name),
                             std::string(sentence)}});
}

void DeviceOnBus::set_store(std::unique_ptr<store::ParameterFile> store) {
  store_ = std::move(store);
  device_.node().set_parameter_store(store_.get());
}

void DeviceOnBus::enable_lss(std::unique_ptr<store::ParameterFile> store) {
  lss_store_ = std::move(store);
  device_.enable_lss(port_, lss_store_.get());
}

DeviceOnBus::InitialNode DeviceOnBus::initial_node() {
  std::uint8_t node_id = status_.label.node_id;
  if (lss_store_) {
    if (const auto stored = sim::DeviceLss::stored(*lss_store_)) node_id = stored->node_id;
  }
  const auto& description = device_.file().dictionary;
  InitialNode node{.node_id = node_id, .objects = canopen::ObjectDictionary(description, node_id)};
  if (store_ == nullptr) return node;
  // A node without a bus decides which values of the store are valid.
  struct Nowhere final : can::Sink {
    bool send(const can::Frame&) override { return true; }
  } nowhere;
  canopen::Node scratch(description, node_id, nowhere);
  scratch.set_parameter_store(store_.get());
  scratch.power_on({});
  std::ranges::copy(scratch.dictionary().block(), node.objects.block().begin());
  return node;
}

void DeviceOnBus::power_on(can::Time now) {
  if (now < start_ || is_unplugged_) return;
  status_.is_on = true;
  alarm().cancel();
  port_.set_power(true);
  bit_rate_ = port_.bit_rate();
  device_.power_on(now);
  update(now);
}

void DeviceOnBus::unplug() {
  is_unplugged_ = true;
  alarm().cancel();
  alarm().remove_part(device_.alarm());
  device_.power_off();
  port_.set_power(false);
  status_.is_on = false;
  status_.state = canopen::NmtState::initialising;
}

void DeviceOnBus::plug_in(can::Time now) {
  is_unplugged_ = false;
  alarm().add_part(device_.alarm());
  alarm() = start_;
  power_on(now);
}

void DeviceOnBus::receive(const can::Frame& frame, can::Time now) {
  if (!status_.is_on) return;
  device_.receive(frame, now);
  update(now);
}

void DeviceOnBus::transmitted(const can::Frame& frame, can::Time) {
  if (is_pdo(frame)) ++status_.pdos;
}

void DeviceOnBus::controller_changed(can::Time now) {
  device_.controller_changed(now);
  update(now);
}

void DeviceOnBus::tick(can::Time now) {
  if (!status_.is_on && start_ <= now) return power_on(now);
  device_.tick(now);
  if (status_.is_on) update(now);
}

ForcedObject DeviceOnBus::forced_object(const canopen::Entry& entry, can::Time until) const {
  return {.device = status_.label,
          .object = canopen::object_text(entry.index, entry.sub),
          .name = device_.file().dictionary->name(entry),
          .type = entry.description->type,
          .value = device_.node().dictionary().get<std::uint64_t>(entry),
          .until = until};
}

void DeviceOnBus::value_forced(const sim::Forcing::Force& force, can::Time now) {
  observer_.on({now, ObjectForced{forced_object(force.entry, force.until)}});
}

void DeviceOnBus::value_released(const canopen::Entry& entry, can::Time now) {
  observer_.on({now, ObjectReleased{forced_object(entry)}});
}

// The controller restarts, too: frames queued before are dropped.
void DeviceOnBus::reset_requested(canopen::NmtCommand, can::Time) { port_.abort_transmissions(); }

void DeviceOnBus::update_state(can::Time now) {
  if (device_.lss() != nullptr) update_lss(now);
  if (device_.node().identifiers_revision() != accepted_revision_) accept();
  if (device_.node().state() == status_.state) return;
  status_.state = device_.node().state();
  observer_.on({now, NmtStateChange{status_.label, status_.state}});
}

void DeviceOnBus::update_lss(can::Time now) {
  const std::uint8_t node_id = device_.node().node_id();
  if (node_id == status_.label.node_id && port_.bit_rate() == bit_rate_) return;
  bit_rate_ = port_.bit_rate();
  if (node_id != status_.label.node_id) watch_->renumber(status_, node_id);
  observer_.on({now, LssSetting{status_.label, bit_rate_}});
}

/// Shows the controller which identifiers the node does something with: the bus then leaves out the others.
void DeviceOnBus::accept() {
  const canopen::Node& node = device_.node();
  accepted_revision_ = node.identifiers_revision();
  can::Acceptance acceptance;
  acceptance.base.reset();
  for (const std::uint32_t identifier : node.wanted_identifiers()) acceptance.base.set(identifier);
  if (device_.lss() != nullptr) acceptance.base.set(lss::from_master);
  acceptance.extended = node.wants_extended();
  port_.accept(acceptance);
}

}  // namespace canopus::plant
