#include "canopus/canopen/node/node.hpp"

#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>
#include <vector>

#include "canopus/canopen/nmt/nmt_slave.hpp"
#include "canopus/canopen/node/node_services.hpp"
#include "canopus/canopen/service/frame_of.hpp"
#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {

void Node::Services::attach(std::uint16_t first, std::uint16_t last, ObjectHandler& handler) {
  if (!registered) registered = std::make_unique<Registered>(dictionary.attachments());
  auto& list = registered->list;
  list.reserve(list.size() + 1);
  dictionary.attach(first, last, handler);
  const Registration registration{first, last, &handler};
  std::erase(list, registration);
  list.push_back(registration);
}

void Node::Services::detach(const ObjectHandler& handler) noexcept {
  if (!registered) return;
  std::erase_if(registered->list, [&](const Registration& known) { return known.handler == &handler; });
  dictionary.restore(registered->own);
  for (const auto& [first, last, remaining] : registered->list) dictionary.attach(first, last, *remaining);
}

void Node::Services::copy_state(const Services& other) {
  if (other.registered) {
    for (const auto& [first, last, handler] : other.registered->list) attach(first, last, *handler);
  }
  listener = other.listener;
  stored_parameters.set_store(other.stored_parameters.store());
  identifiers_revision = other.identifiers_revision + 1;
}

void Node::Services::stop() {
  state = NmtState::initialising;
  heartbeat_producer.stop();
  node_guarding.stop();
  sync_service.stop();
  time_stamp.stop();
  emcy_producer.stop();
  heartbeat_consumer.stop();
  rpdos.stop();
  tpdos.stop();
  sdo_channels.stop();
  timers.stop_all();
  change_identifiers();
}

// Initialisation: new values, then the services read them, then the boot-up message ends it.
void Node::Services::initialize(NmtCommand which, can::Time now) {
  stop();
  node_id = next_node_id;
  const bool whole = which == NmtCommand::reset_node;
  if (whole) {
    dictionary.reset(node_id);
  } else {
    dictionary.reset_communication(node_id);
  }
  if (listener != nullptr) listener->defaults_loaded(which, now);
  stored_parameters.apply(0x0000, whole ? 0xFFFF : 0x1FFF);
  if (listener != nullptr) listener->reset_done(which, now);
  if (node_id < 1 || node_id > 127) return;  // not configured: stays in Initialisation
  sink.send(can::data_frame(cob_id::error_control + node_id, {0x00}));
  state = NmtState::pre_operational;
  sdo_channels.start();
  heartbeat_producer.start(now);
  node_guarding.start();
  sync_service.start(now);
  time_stamp.start();
  emcy_producer.start();
  heartbeat_consumer.start();
  const bool has_defaults = dictionary.description().has_default_pdos(dictionary.block(), node_id);
  const std::uint8_t defaults_of = has_defaults ? node_id : std::uint8_t{0};
  rpdos.start(defaults_of);
  tpdos.start(defaults_of, now);
  if (listener != nullptr) listener->nmt_state_changed(state, now);
}

void Node::Services::reset(NmtCommand which, can::Time now) {
  if (options.reset_time == can::Duration{}) return initialize(which, now);
  const bool is_second = timers.runs(reset_timer);
  stop();
  if (!is_second || which == NmtCommand::reset_node) pending_reset = which;
  timers.set(reset_timer, can::later(now, options.reset_time));
}

void Node::Services::enter(NmtState wanted, can::Time now) {
  if (wanted == state || state == NmtState::initialising) return;
  const bool was_operational = is_operational();
  state = wanted;
  if (was_operational) {
    rpdos.leave_operational();
    tpdos.leave_operational();
  }
  if (state == NmtState::stopped) sdo_channels.stop();
  sync_service.state_changed(now);
  if (listener != nullptr) listener->nmt_state_changed(state, now);
  if (is_operational()) tpdos.enter_operational(now);
}

void Node::Services::command(NmtCommand command, can::Time now) {
  if (!powered) return;
  switch (command) {
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      if (listener != nullptr) listener->reset_requested(command, now);
      reset(command, now);
      return;
    case NmtCommand::start:
      if (listener != nullptr && !listener->may_become_operational()) return;
      break;
    case NmtCommand::stop:
    case NmtCommand::enter_pre_operational: break;
  }
  enter(state_after(command, state), now);
}

void Node::Services::build_table() {
  identifiers_changed = false;
  ++identifiers_revision;
  std::vector<IdentifierTable::Route> routes;
  if (state != NmtState::initialising) {
    routes.push_back({cob_id::nmt, ServiceKind::nmt, 0});
    routes.push_back({IdentifierTable::key(cob_id::error_control + node_id, false, true),
                      ServiceKind::node_guard_request, 0});
    sdo_channels.list_identifiers(routes);
    sync_service.list_identifiers(routes);
    time_stamp.list_identifiers(routes);
    rpdos.list_identifiers(routes);
    tpdos.list_identifiers(routes);
    emcy_consumer.list_identifiers(routes);
    heartbeat_consumer.list_identifiers(routes);
  }
  table.build(routes);
  receives_extended = false;
  filter.clear();
  for (const auto& route : routes) {
    receives_extended = receives_extended || (route.key >> 29 & 1) != 0;
    filter.add(route.key);
  }
}

void Node::Services::receive(const can::Frame& frame, can::Time now) {
  settle();
  table.for_each(IdentifierTable::key(frame),
                 [&](ServiceKind kind, std::uint16_t number) { dispatch(kind, number, frame, now); });
}

void Node::Services::sync(std::uint8_t counter, can::Time now) {
  tpdos.sync(counter, now);  // first, so that the values of the cycle before go out
  if (is_operational()) rpdos.sync(now);
  if (listener != nullptr) listener->sync_received(counter, now);
}

void Node::Services::dispatch_others(ServiceKind kind, std::uint16_t number, const can::Frame& frame,
                                     can::Time now) {
  switch (kind) {
    case ServiceKind::sync:
      if (sync_service.receive(frame, now)) sync(sync_service.counter(), now);
      return;
    case ServiceKind::heartbeat: return heartbeat_consumer.receive(number, frame, now);
    case ServiceKind::nmt:
      if (active_master && options.active_master_commands_itself) return;
      if (const auto wanted = nmt_command_for(frame, node_id, active_master)) command(*wanted, now);
      return;
    case ServiceKind::node_guard_request: return node_guarding.receive(heartbeat_producer.is_active(), now);
    case ServiceKind::emcy: return emcy_consumer.receive(static_cast<std::uint8_t>(number), frame, now);
    case ServiceKind::time_stamp: return time_stamp.receive(frame, now);
    case ServiceKind::tpdo_request: return tpdos.requested(number, now);
    case ServiceKind::several: return receive(frame, now);
    case ServiceKind::none:
    case ServiceKind::rpdo:
    case ServiceKind::sdo_server:
    case ServiceKind::sam_mpdo: return;
  }
}

void Node::Services::tick(TimerQueue::Number number, can::Time now) {
  const auto is_one_of = [number](TimerQueue::Number first, std::size_t count) {
    return number >= first && number < first + count;
  };
  if (is_one_of(tpdos.first_timer(), tpdos.size())) {
    tpdos.tick(static_cast<std::uint16_t>(number - tpdos.first_timer()), now);
  } else if (number == heartbeat_producer.timer()) {
    heartbeat_producer.tick(now);
  } else if (number == sync_service.timer()) {
    if (sync_service.tick(now)) sync(sync_service.counter(), now);
  } else if (number == node_guarding.timer()) {
    node_guarding.tick(heartbeat_producer.is_active(), now);
  } else if (number == emcy_producer.timer()) {
    emcy_producer.tick(now);
  } else if (is_one_of(sdo_channels.first_timer(), sdo_channels.size())) {
    sdo_channels.tick(static_cast<std::uint16_t>(number - sdo_channels.first_timer()), now);
  } else if (number == reset_timer) {
    initialize(pending_reset, now);
  } else if (is_one_of(rpdos.first_timer(), rpdos.size())) {
    rpdos.tick(static_cast<std::uint16_t>(number - rpdos.first_timer()), now);
  } else {
    heartbeat_consumer.tick(static_cast<std::uint16_t>(number - heartbeat_consumer.first_timer()), now);
  }
}

Node::Node(std::shared_ptr<const DictionaryDescription> description, std::uint8_t node_id, can::Sink& sink,
           NodeOptions options)
    : context_(nullptr),
      services_(
          std::make_unique<Services>(std::move(description), node_id, sink, filter_, alarm(), options)) {
  context_ = services_.get();
}

Node::~Node() = default;

void Node::set_listener(NodeListener* listener) noexcept { services_->listener = listener; }

void Node::power_on(can::Time now) {
  services_->powered = true;
  services_->initialize(NmtCommand::reset_node, now);
}

void Node::power_off() {
  services_->powered = false;
  services_->stop();
}

void Node::describe(std::shared_ptr<const DictionaryDescription> description, const NodeOptions& options) {
  rebuild(std::move(description), services_->sink, options);
}

void Node::set_sink(can::Sink& sink) {
  rebuild(services_->dictionary.shared_description(), sink, services_->options);
}

// The services read the dictionary when they are made: with another one come other services.
void Node::rebuild(std::shared_ptr<const DictionaryDescription> description, can::Sink& sink,
                   const NodeOptions& options) {
  assert(!services_->powered);
  auto services = std::make_unique<Services>(std::move(description), services_->next_node_id, sink, filter_,
                                             alarm(), options);
  services->copy_state(*services_);
  // Nothing throws from here on.
  filter_.pass_all();
  alarm().cancel();
  services_ = std::move(services);
  context_ = services_.get();
}

void Node::attach(std::uint16_t first, std::uint16_t last, ObjectHandler& handler) {
  services_->attach(first, last, handler);
}

void Node::detach(const ObjectHandler& handler) noexcept { services_->detach(handler); }

void Node::set_node_id(std::uint8_t node_id) noexcept { services_->next_node_id = node_id; }

void Node::command(NmtCommand command, can::Time now) { services_->command(command, now); }
void Node::communication_error(can::Time now) { services_->communication_error(now); }

void Node::set_active_master(bool active, can::Time now) {
  services_->active_master = active;
  services_->sync_service.state_changed(now);
}

bool Node::emergency(std::uint16_t code, std::uint8_t error_register,
                     std::span<const std::uint8_t, 5> manufacturer, can::Time now) {
  return services_->emcy_producer.raise(code, error_register, manufacturer, now);
}
void Node::forget_error(std::uint16_t code, std::span<const std::uint8_t, 5> manufacturer, can::Time now) {
  services_->emcy_producer.forget(code, manufacturer, now);
}
void Node::pause_heartbeat(bool paused, can::Time now) { services_->heartbeat_producer.pause(paused, now); }
bool Node::emergency_reset(can::Time now) { return services_->emcy_producer.reset(now); }

unsigned Node::values_changed(ValueMask places, can::Time now) {
  return services_->tpdos.values_changed(places, now);
}
bool Node::tpdo_event(std::uint16_t number, can::Time now) { return services_->tpdos.event(number, now); }
bool Node::send_destination_mpdo(std::uint16_t number, std::uint8_t node_id, std::uint16_t index,
                                 std::uint8_t sub, std::span<const std::uint8_t> value, can::Time now) {
  return services_->tpdos.send_to(number, node_id, index, sub, value, now);
}
bool Node::send_source_mpdo(std::uint16_t index, std::uint8_t sub, can::Time now) {
  return services_->tpdos.send_from(index, sub, now);
}
void Node::set_parameter_store(ParameterStore* store) noexcept {
  services_->stored_parameters.set_store(store);
}
bool Node::send_time(const TimeOfDay& time, can::Time) { return services_->time_stamp.send(time); }

std::optional<SdoClientChannel> Node::sdo_client_channel(std::uint8_t number) const {
  return services_->sdo_channels.client(number);
}

bool Node::wants(std::uint32_t base_identifier) const {
  services_->settle();
  return services_->table.contains(IdentifierTable::key(base_identifier, false, false)) ||
         services_->table.contains(IdentifierTable::key(base_identifier, false, true));
}
std::vector<std::uint32_t> Node::wanted_identifiers() const {
  services_->settle();
  std::vector<std::uint32_t> identifiers;
  services_->table.for_each_key([&](std::uint32_t key) {
    constexpr std::uint32_t remote = 1U << 30;
    if ((key & ~remote) <= can::max_base_identifier) identifiers.push_back(key & ~remote);
  });
  std::ranges::sort(identifiers);
  const auto twice = std::ranges::unique(identifiers);
  identifiers.erase(twice.begin(), twice.end());
  return identifiers;
}
bool Node::wants_extended() const {
  services_->settle();
  return services_->receives_extended;
}
void Node::settle() const { services_->settle(); }

// What nearly all frames are comes first, and every call is the last thing that is done: nothing has to be
// kept.
void Node::receive_passed(const can::Frame& frame, can::Time now) {
  Services& services = *services_;
  if (!is_base_data(frame)) return services.receive(frame, now);
  const IdentifierTable::Slot* slot = services.table.find(frame.identifier);
  if (slot != nullptr) return services.dispatch(slot->found, slot->number, frame, now);
  if (services.identifiers_changed) services.receive(frame, now);
}

void Node::tick(can::Time now) {
  Services& services = *services_;
  // What a timer starts anew for this very moment waits for the next call: no endless loop.
  for (std::size_t left = services.timers.size(); left != 0 && services.timers.next() <= now; --left) {
    services.tick(services.timers.pop(), now);
  }
}

}  // namespace canopus::canopen
