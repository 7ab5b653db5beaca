#pragma once
// What the benches of the stack share: a bus without bits, a slave of the usual size, and a master that
// receives what the slaves send.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "canopus/canopen/node/node.hpp"

namespace canopus::bench {

/// A bus that carries frames in the order they were sent and takes no time: a frame sent while none is on its
/// way is delivered at once, inside send(); those sent meanwhile follow one after the other. Each goes to
/// everybody who wants its identifier (the acceptance filters of real controllers), the sender excepted, and first
/// to the nodes that hear everything.
class PassThroughBus {
 public:
  class Port final : public can::Sink {
   public:
    explicit Port(PassThroughBus& bus) : bus_(&bus) {}
    bool send(const can::Frame& frame) override {
      if (!bus_->delivering_) return bus_->deliver_(*bus_, frame, owner);
      if (bus_->end_ == bus_->waiting_.end()) return false;
      *bus_->end_++ = {frame, owner};
      return true;
    }
    can::Participant* owner = nullptr;

   private:
    PassThroughBus* bus_;
  };

  /// `wants(identifier)` of base identifiers; call compile() after the last one.
  template <typename Wants>
  void add(can::Participant& participant, Port& port, Wants wants) {
    port.owner = &participant;
    for (std::uint32_t identifier = 0; identifier <= can::max_base_identifier; ++identifier) {
      if (wants(identifier)) lists_[identifier].push_back(&participant);
    }
  }
  /// A node that every frame is handed to.
  void add_to_all(canopen::Node& node, Port& port) {
    port.owner = &node;
    receivers_of_all_.push_back(&node);
    deliver_ = &deliver_at_once<true>;
  }
  void compile() {
    hearers_.clear();
    for (const auto& list : lists_) hearers_.insert(hearers_.end(), list.begin(), list.end());
    can::Participant* const* next = hearers_.data();
    for (std::size_t identifier = 0; identifier < lists_.size(); ++identifier) {
      first_[identifier] = next;
      next += lists_[identifier].size();
    }
    first_.back() = next;
  }
  /// The time that frames arrive at from now on.
  void set_time(can::Time now) noexcept { now_ = now; }
  /// Frames carried so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

 private:
  struct Sent {
    can::Frame frame;
    can::Participant* from;
  };
  template <bool some_hear_all>
  void hand_out(const can::Frame& frame, const can::Participant* from) {
    ++frames_;
    if constexpr (some_hear_all) {
      for (canopen::Node* node : receivers_of_all_) {
        if (node != from) node->receive(frame, now_);
      }
    }
    can::Participant* const* const last = first_[frame.identifier + 1];
    for (auto hearer = first_[frame.identifier]; hearer != last; ++hearer) {
      if (*hearer != from) (*hearer)->receive(frame, now_);
    }
  }
  template <bool some_hear_all>
  [[gnu::noinline]] static bool deliver_at_once(PassThroughBus& bus, const can::Frame& frame,
                                                const can::Participant* from) {
    bus.delivering_ = true;
    bus.hand_out<some_hear_all>(frame, from);
    for (const Sent* next = bus.waiting_.data(); next != bus.end_;) {
      const Sent& sent = *next++;  // stays, until half of the places are taken again
      if (next == bus.end_ && next > &bus.waiting_[bus.waiting_.size() / 2])
        next = bus.end_ = bus.waiting_.data();
      bus.hand_out<some_hear_all>(sent.frame, sent.from);
    }
    bus.end_ = bus.waiting_.data();
    bus.delivering_ = false;
    return true;
  }
  /// A bus on which nobody hears all does not ask for those who do.
  bool (*deliver_)(PassThroughBus&, const can::Frame&, const can::Participant*) = &deliver_at_once<false>;
  can::Time now_{};
  std::uint64_t frames_ = 0;
  bool delivering_ = false;
  Sent* end_ = waiting_.data();  // of those that were sent while one was delivered
  std::array<std::vector<can::Participant*>, 2048> lists_;
  std::array<can::Participant* const*, 2049> first_{};  // of its hearers, in hearers_
  std::vector<can::Participant*> hearers_;
  std::vector<canopen::Node*> receivers_of_all_;
  std::array<Sent, 1200> waiting_;  // twice what all slaves say to one SYNC
};

inline void add_pdo(canopen::DictionaryBuilder& builder, std::uint16_t communication, std::uint32_t cob_id,
                    std::uint8_t type, bool adds_node_id, std::uint16_t object, unsigned first_sub) {
  using canopen::DataType;
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  builder.object(communication, canopen::ObjectCode::record, "PDO communication");
  builder.sub(communication, 1,
              {.name = "COB-ID", .value = canopen::little_endian(cob_id, 4), .adds_node_id = adds_node_id});
  builder.sub(communication, 2, {.name = "Type", .type = DataType::unsigned8, .value = {type}});
  builder.object(mapping, canopen::ObjectCode::record, "PDO mapping");
  builder.sub(mapping, 0, {.name = "Entries", .type = DataType::unsigned8, .value = {4}});
  for (unsigned i = 0; i < 4; ++i) {
    const std::uint32_t entry = std::uint32_t{object} << 16 | (first_sub + i) << 8 | 16;
    builder.sub(mapping, static_cast<std::uint8_t>(i + 1),
                {.name = "Entry", .value = canopen::little_endian(entry, 4)});
  }
}

inline void add_communication_objects(canopen::DictionaryBuilder& builder) {
  using canopen::DataType;
  builder.variable(0x1000, {.name = "Device type", .value = {0x91, 1, 0x0F, 0}});
  builder.variable(0x1001, {.name = "Error register", .type = DataType::unsigned8});
  builder.variable(0x1005, {.name = "COB-ID SYNC", .value = {0x80}});
  builder.variable(0x1006, {.name = "Communication cycle period"});
  builder.variable(0x1008,
                   {.name = "Name", .type = DataType::visible_string, .value = canopen::text("bench")});
  builder.variable(0x1014, {.name = "COB-ID EMCY", .value = {0x80}, .adds_node_id = true});
  builder.variable(0x1015, {.name = "Inhibit time EMCY", .type = DataType::unsigned16});
  builder.uniform(0x1018, canopen::ObjectCode::record, "Identity", 4, {.name = "Identity", .value = {7}});
  builder.variable(0x1017, {.name = "Producer heartbeat time", .type = DataType::unsigned16});
}

/// Objects of 4 bytes at 2100H that every slave has, and those that an SDO client reads and writes at random.
inline constexpr unsigned parameters = 20;
inline constexpr unsigned sdo_objects = 64;

/// A description of its own of a slave of the usual size: about 50 objects, four RPDOs and four TPDOs of four
/// U16 each (all of synchronous type 1), a DOMAIN at 2000H, UNSIGNED32 from 2100H on. TPDO n is on
/// 180H + n * 100H + node-ID.
inline std::shared_ptr<const canopen::DictionaryDescription> make_slave_description(
    unsigned count = parameters) {
  using canopen::DataType;
  canopen::DictionaryBuilder builder;
  add_communication_objects(builder);
  builder.variable(0x2000, {.name = "Domain", .type = DataType::domain});
  for (unsigned i = 0; i < count; ++i) {
    builder.variable(static_cast<std::uint16_t>(0x2100 + i), {.name = "Parameter"});
  }
  builder.uniform(0x6000, canopen::ObjectCode::array, "Inputs", 16,
                  {.name = "Input", .type = DataType::unsigned16, .tpdo_mappable = true});
  builder.uniform(0x6200, canopen::ObjectCode::array, "Outputs", 16,
                  {.name = "Output", .type = DataType::unsigned16, .rpdo_mappable = true});
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    add_pdo(builder, static_cast<std::uint16_t>(0x1400 + pdo), 0x200U + 0x100U * pdo, 1, true, 0x6200,
            4U * pdo + 1);
    add_pdo(builder, static_cast<std::uint16_t>(0x1800 + pdo), 0x40000180U + 0x100U * pdo, 1, true, 0x6000,
            4U * pdo + 1);
  }
  return builder.build();
}

/// The one description that all slaves share.
inline std::shared_ptr<const canopen::DictionaryDescription> slave_description() {
  static const auto description = make_slave_description();
  return description;
}

/// A master that receives the four TPDOs of the slaves with node-ID 2 .. slaves + 1 into its objects A000H+,
/// by RPDOs of synchronous type.
inline std::shared_ptr<const canopen::DictionaryDescription> master_description(unsigned slaves) {
  canopen::DictionaryBuilder builder;
  add_communication_objects(builder);
  for (unsigned i = 0; i < 4 * slaves; ++i) {
    const auto object = static_cast<std::uint16_t>(0xA000 + i);
    builder.uniform(object, canopen::ObjectCode::array, "Received", 4,
                    {.name = "Word", .type = canopen::DataType::unsigned16, .rpdo_mappable = true});
    add_pdo(builder, static_cast<std::uint16_t>(0x1400 + i), 0x180U + 0x100U * (i % 4) + 2 + i / 4, 1, false,
            object, 1);
  }
  return builder.build();
}

/// Which frames reach a node: those that it wants, as controllers with acceptance filters have it, or all.
enum class Delivery : std::uint8_t { routed, broadcast };

/// A node with its port on a pass-through bus.
struct NodeOnBus {
  NodeOnBus(PassThroughBus& bus, std::shared_ptr<const canopen::DictionaryDescription> description,
            std::uint8_t node_id, Delivery delivery = Delivery::routed)
      : port(bus), node(std::move(description), node_id, port) {
    node.power_on(can::Time{});
    node.command(canopen::NmtCommand::start, can::Time{});
    if (delivery == Delivery::broadcast) {
      bus.add_to_all(node, port);
    } else {
      bus.add(node, port, [&](std::uint32_t identifier) { return node.wants(identifier); });
    }
  }
  PassThroughBus::Port port;
  canopen::Node node;
};

}  // namespace canopus::bench
