#pragma once
// A CANopen node with an NMT master on it, each driven as it wants to be (nmt_master.hpp). What most programs
// that are a master derive from; configure() puts the network into the node's dictionary.

#include <algorithm>
#include <memory>
#include <utility>

#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/manager/nmt/nmt_master.hpp"

namespace canopus::manager {

/// An override calls the function of the base class first.
class MasterNode : public can::Participant, protected canopen::NodeListener {
 public:
  /// `sink` must outlive it.
  MasterNode(std::shared_ptr<const canopen::DictionaryDescription> description, std::uint8_t node_id,
             can::Sink& sink, const canopen::NodeOptions& node_options = {},
             const MasterOptions& master_options = {})
      : node_(std::move(description), node_id, sink, node_options), master_(node_, sink, master_options) {
    node_.set_listener(this);
    alarm().add_part(node_.alarm());
    alarm().add_part(master_.alarm());
  }

  /// The node starts, and with it the start-up of the network.
  void power_on(can::Time now) { node_.power_on(now); }
  /// Both are silent until the next power_on().
  void power_off(can::Time now) {
    master_.stop(now);
    node_.power_off();
  }
  [[nodiscard]] canopen::Node& node() noexcept { return node_; }
  [[nodiscard]] const canopen::Node& node() const noexcept { return node_; }
  [[nodiscard]] NmtMaster& master() noexcept { return master_; }
  [[nodiscard]] const NmtMaster& master() const noexcept { return master_; }

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override {
    node_.receive(frame, now);
    master_.receive(frame, now);
  }
  void transmitted(const can::Frame& frame, can::Time now) override {
    node_.transmitted(frame, now);
    master_.transmitted(frame, now);
  }
  void tick(can::Time now) override {
    if (node_.deadline() <= now) node_.tick(now);
    if (master_.deadline() <= now) master_.tick(now);
  }

 protected:
  /// What the dictionary holds beyond its defaults: called after each reset of the node, before the master
  /// starts.
  virtual void configure(canopen::ObjectDictionary& /*objects*/) {}

  // canopen::NodeListener
  void reset_requested(canopen::NmtCommand, can::Time now) override { master_.stop(now); }
  void reset_done(canopen::NmtCommand, can::Time now) override {
    configure(node_.dictionary());
    master_.start(now);
  }
  void nmt_state_changed(canopen::NmtState state, can::Time now) override {
    master_.own_state_changed(state, now);
  }
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) override {
    master_.heartbeat_received(node_id, state, now);
  }
  void heartbeat_lost(std::uint8_t node_id, can::Time now) override { master_.heartbeat_lost(node_id, now); }

 private:
  canopen::Node node_;
  NmtMaster master_;
};

}  // namespace canopus::manager
