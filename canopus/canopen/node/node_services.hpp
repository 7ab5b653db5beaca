#pragma once
// The inside of a node: its services, and which frames and timers are whose. Only the source of the node includes this.

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "canopus/canopen/messages/emcy_consumer.hpp"
#include "canopus/canopen/messages/emcy_producer.hpp"
#include "canopus/canopen/messages/sync.hpp"
#include "canopus/canopen/messages/time_stamp.hpp"
#include "canopus/canopen/nmt/error_behaviour.hpp"
#include "canopus/canopen/nmt/heartbeat_consumer.hpp"
#include "canopus/canopen/nmt/heartbeat_producer.hpp"
#include "canopus/canopen/nmt/node_guarding.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/node/stored_parameters.hpp"
#include "canopus/canopen/pdo/rpdo.hpp"
#include "canopus/canopen/pdo/tpdo.hpp"
#include "canopus/canopen/sdo/sdo_channels.hpp"
#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

struct Node::Services final : NodeContext, WriteObserver {
  Services(std::shared_ptr<const DictionaryDescription> description, std::uint8_t id, can::Sink& frames,
           IdentifierFilter& node_filter, can::Alarm& alarm, const NodeOptions& node_options)
      : NodeContext(std::move(description), id, frames, node_filter, alarm, node_options), next_node_id(id) {
    dictionary.set_write_observer(this);
  }

  /// Node::attach().
  void attach(std::uint16_t first, std::uint16_t last, ObjectHandler& handler);
  void detach(const ObjectHandler& handler) noexcept;
  /// What the application has registered with `other` is registered here, too.
  void copy_state(const Services& other);

  void error_began(const CommunicationError& error, can::Time now) override {
    emcy_producer.error_began(error, now);
  }
  void error_ended(const CommunicationError& error, can::Time now) override {
    emcy_producer.error_ended(error, now);
  }
  void communication_error(can::Time now) override { enter(error_behaviour.after_error(state), now); }
  void object_written(const Entry& entry, can::Time now) override {
    // Mostly it concerns nothing, and this check saves no registers.
    const bool concerns_some =
        tpdos.may_have_event_of(entry) || stored_parameters.saves_at_once() || listener != nullptr;
    if (concerns_some) report_written(entry, now);
  }
  [[gnu::noinline]] void report_written(const Entry& entry, can::Time now) {
    if (tpdos.may_have_event_of(entry) && options.sdo_write_is_event && entry.index >= 0x2000) {
      tpdos.object_written(entry, now);
    }
    stored_parameters.object_written(entry);
    if (listener != nullptr) listener->object_written(entry, now);
  }

  void enter(NmtState wanted, can::Time now);
  void command(NmtCommand command, can::Time now);
  void reset(NmtCommand which, can::Time now);
  void initialize(NmtCommand which, can::Time now);
  void stop();
  void settle() {
    if (identifiers_changed) build_table();
  }
  void build_table();
  /// The services that most frames are for come first.
  void dispatch(ServiceKind kind, std::uint16_t number, const can::Frame& frame, can::Time now) {
    if (kind == ServiceKind::rpdo) return rpdos.receive(number, frame, sync_service.window_end(), now);
    if (kind == ServiceKind::sdo_server) {
      if (communicates()) sdo_channels.receive(number, frame, now);
      return;
    }
    dispatch_others(kind, number, frame, now);
  }
  void dispatch_others(ServiceKind kind, std::uint16_t number, const can::Frame& frame, can::Time now);
  /// Any frame, to every service that listens to it.
  void receive(const can::Frame& frame, can::Time now);
  void sync(std::uint8_t counter, can::Time now);
  void tick(TimerQueue::Number number, can::Time now);

  HeartbeatProducer heartbeat_producer{*this};
  NodeGuarding node_guarding{*this};
  Sync sync_service{*this};
  EmcyProducer emcy_producer{*this};
  TimeStamp time_stamp{*this};
  EmcyConsumer emcy_consumer{*this};
  ErrorBehaviour error_behaviour{*this};
  HeartbeatConsumer heartbeat_consumer{*this};
  Rpdos rpdos{*this};
  Tpdos tpdos{*this};
  SdoChannels sdo_channels{*this};
  StoredParameters stored_parameters{*this};
  TimerQueue::Number reset_timer = timers.add();
  NmtCommand pending_reset = NmtCommand::reset_communication;  // while reset_timer runs
  /// A handler of the application, and the objects it is called for.
  struct Registration {
    std::uint16_t first = 0;
    std::uint16_t last = 0;
    ObjectHandler* handler = nullptr;
    friend bool operator==(const Registration&, const Registration&) = default;
  };
  struct Registered {
    NodeDictionary::Attachments own;  // of the services
    std::vector<Registration> list;   // a later one takes the place of those before it
  };
  std::unique_ptr<Registered> registered;  // most nodes have none
  std::uint8_t next_node_id = 0;
  bool powered = false;
  bool receives_extended = false;
};

}  // namespace canopus::canopen
