#include "canopus/canopen/nmt/node_guarding.hpp"

#include <utility>

#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {

NodeGuarding::NodeGuarding(NodeContext& node) : node_(node), timer_(node.timers.add()) {
  node.dictionary.attach(0x100C, 0x100D, *this);
}

void NodeGuarding::start() {
  stop();
  toggle_ = false;
  guarded_ = false;
  occurred_ = false;
  running_ = false;
}

void NodeGuarding::stop() { node_.timers.stop(timer_); }

void NodeGuarding::set_running(bool running, can::Time now) {
  if (running_ == running) return;
  running_ = running;
  if (node_.listener != nullptr) node_.listener->life_guarding_running(running, now);
}

void NodeGuarding::restart(can::Time now) {
  const auto guard_time = std::chrono::milliseconds(node_.dictionary.get<std::uint16_t>(0x100C, 0));
  const auto life_time = guard_time * node_.dictionary.get<std::uint8_t>(0x100D, 0);
  const bool runs = life_time.count() != 0;
  missed_ = false;
  life_end_ = runs ? can::later(now, life_time) : can::never;
  node_.timers.set(timer_, runs ? can::later(now, guard_time) : can::never);
  set_running(runs, now);
}

void NodeGuarding::receive(bool heartbeat, can::Time now) {
  if (heartbeat || node_.state == NmtState::initialising) return;
  const auto answer =
      static_cast<std::uint8_t>(static_cast<std::uint8_t>(node_.state) | (toggle_ ? 0x80 : 0x00));
  if (node_.sink.send(can::data_frame(cob_id::error_control + node_.node_id, {answer}))) toggle_ = !toggle_;
  guarded_ = true;
  restart(now);
  if (!occurred_) return;
  occurred_ = false;
  node_.error_ended({emcy_code::life_guard_or_heartbeat, {node_.node_id}}, now);
  if (node_.listener != nullptr) node_.listener->life_guarding_event(false, now);
}

void NodeGuarding::miss(can::Time now) {
  if (std::exchange(missed_, true)) return;
  if (node_.listener != nullptr) node_.listener->life_guarding_missed(now);
}

void NodeGuarding::tick(bool heartbeat, can::Time now) {
  if (heartbeat) {
    guarded_ = false;
    set_running(false, now);
    return stop();
  }
  miss(now);
  if (now < life_end_) return node_.timers.set(timer_, life_end_);
  set_running(false, now);
  occurred_ = true;
  const bool named = node_.options.guarding_emergency_names_node;
  const auto code = static_cast<std::uint16_t>(named ? emcy_code::node_lost + node_.node_id
                                                     : emcy_code::life_guard_or_heartbeat);
  node_.error_began({code, {named ? std::uint8_t{0} : node_.node_id}}, now);
  if (node_.listener != nullptr) node_.listener->life_guarding_event(true, now);
  node_.communication_error(now);
}

void NodeGuarding::after_write(ObjectDictionary&, const Entry&, can::Time now) {
  if (guarded_ && !occurred_) restart(now);
}

}  // namespace canopus::canopen
