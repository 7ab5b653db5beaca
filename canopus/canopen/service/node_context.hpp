#pragma once
// What the services of one node share: the dictionary that configures them, where frames go, the node's
// timers and NMT state, and the two things they ask of the node as a whole (an emergency, 1029H).

#include <array>
#include <cstdint>
#include <memory>
#include <utility>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/service/identifier_filter.hpp"
#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/canopen/service/node_options.hpp"
#include "canopus/canopen/service/timer_queue.hpp"

namespace canopus::canopen {

class NodeListener;

/// Errors that a service of the node itself finds, and takes back when they are over.
struct CommunicationError {
  std::uint16_t code = 0;                      ///< emergency error code
  std::array<std::uint8_t, 5> manufacturer{};  ///< manufacturer-specific bytes
};

class alignas(64) NodeContext {
 public:
  NodeContext(std::shared_ptr<const DictionaryDescription> description, std::uint8_t id, can::Sink& frames,
              IdentifierFilter& node_filter, can::Alarm& alarm, const NodeOptions& node_options)
      : timers(alarm),
        node_id(id),
        sink(frames),
        dictionary(std::move(description), id),
        filter(node_filter),
        options(node_options) {}

  /// A communication error began: 1001H, 1003H and an EMCY message; sent later if 1015H forbids it now.
  virtual void error_began(const CommunicationError& error, can::Time now) = 0;
  /// One that had begun is over: when it was the last one, 1001H and an EMCY message with code 0000H.
  virtual void error_ended(const CommunicationError& error, can::Time now) = 0;
  /// 1029:01 decides about the NMT state.
  virtual void communication_error(can::Time now) = 0;

  /// Pre-operational or Operational: everything but PDOs may go.
  [[nodiscard]] bool communicates() const noexcept {
    return state == NmtState::operational || state == NmtState::pre_operational;
  }
  [[nodiscard]] bool is_operational() const noexcept { return state == NmtState::operational; }
  /// May SYNC and TIME be produced?
  [[nodiscard]] bool may_produce_time() const noexcept {
    return communicates() && (active_master || !options.sync_needs_active_master);
  }

  /// A service has other identifiers than the table says: until it is built anew, nothing is found in it.
  void change_identifiers() noexcept {
    identifiers_changed = true;
    table.close();
    filter.pass_all();
  }

  // From the next deadline of the timers to where the dictionary's values lie: what a node needs that sends, in one cache
  // line.
  TimerQueue timers;
  bool identifiers_changed = true;  // by change_identifiers() alone
  NmtState state = NmtState::initialising;
  std::uint8_t node_id = 0;
  bool active_master = false;
  std::uint32_t identifiers_revision = 0;  // counts the tables that were built
  can::Sink& sink;
  NodeListener* listener = nullptr;
  NodeDictionary dictionary;
  IdentifierTable table;
  IdentifierFilter& filter;  // the node's own, for every frame looks at it
  NodeOptions options;

 protected:
  ~NodeContext() = default;
};

/// `value` steps of `unit`, in whole steps of `resolution` but at least one; 0 stays 0.
[[nodiscard]] constexpr can::Duration in_steps(std::uint64_t value, can::Duration unit,
                                               can::Duration resolution) noexcept {
  if (value == 0) return {};
  const can::Duration exact = unit * static_cast<can::Duration::rep>(value);
  return exact < resolution ? resolution : exact / resolution * resolution;
}

}  // namespace canopus::canopen
