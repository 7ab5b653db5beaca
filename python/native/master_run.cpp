#include "master_run.hpp"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/client/sdo_transfer_on_bus.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/text/json.hpp"

#include "plant_parts.hpp"

namespace canopus::python {
namespace {

using manager::BootRecord;
using master::NetworkMaster;
using master::NetworkSlave;

constexpr unsigned last_node = 127;

std::string_view state_name(std::uint8_t state) {
  switch (state) {
    case manager::node_state::missing: return "missing";
    case manager::node_state::stopped: return "stopped";
    case manager::node_state::operational: return "operational";
    case manager::node_state::pre_operational: return "pre-operational";
    default: return "unknown";
  }
}

std::string_view name(NetworkMaster::Result result) {
  switch (result) {
    case NetworkMaster::Result::booted: return "booted";
    case NetworkMaster::Result::absent: return "absent";
    case NetworkMaster::Result::given_up: return "given up";
    case NetworkMaster::Result::left_to_the_active_master: return "left to the active master";
    case NetworkMaster::Result::failed: break;
  }
  return "failed";
}

std::string_view name(manager::ErrorControlEvent event) {
  switch (event) {
    case manager::ErrorControlEvent::heartbeat_lost: return "heartbeat lost";
    case manager::ErrorControlEvent::node_lost: return "no answer to guarding";
    case manager::ErrorControlEvent::unexpected_state: return "unexpected state";
  }
  return "";
}

std::string line_of(const text::Json& object) { return object.dump() + '\n'; }

void check_node(unsigned node) {
  if (node < 1 || node > last_node) throw PlantProblem(fmt::format("node {}: a node-ID is 1 to 127", node));
}

}  // namespace

master::NetworkFile network_of(const std::optional<std::string>& text, const std::string& path,
                               unsigned node) {
  if (!text) {
    check_node(node);
    return {.path = path, .node = static_cast<std::uint8_t>(node)};
  }
  master::NetworkReading reading = master::read_network(*text, path);
  if (!reading.errors.empty()) throw PlantProblem(joined(std::move(reading.errors), path));
  return std::move(reading.network);
}

MasterRun::MasterRun(const std::function<std::unique_ptr<MasterPlace>()>& join,
                     const master::NetworkFile& file)
    : place_(join()) {
  auto network = NetworkMaster::build(file, place_->sink(), *this);
  if (!network) throw PlantProblem(joined(std::move(network.error()), file.path));
  network_ = std::move(*network);
  alarm().add_part(network_->alarm());
  place_->join(*this);
  network_->power_on(place_->now());
}

MasterRun::~MasterRun() {
  if (place_ != nullptr) place_->leave();
}

void MasterRun::close() {
  if (place_ == nullptr) return;
  check_still();
  last_ = place_->now();
  place_->leave();
  network_.reset();
  place_.reset();
}

can::Time MasterRun::now() const { return place_ != nullptr ? place_->now() : last_; }

void MasterRun::check() const {
  if (place_ == nullptr) throw PlantProblem("the master is closed");
  place_->check();
}

void MasterRun::check_still() const {
  if (place_ != nullptr && place_->is_running()) throw PlantProblem("time passes just now");
}

void MasterRun::run_for(can::Duration duration) {
  check();
  (void)place_->drive([] { return false; }, can::later(now(), duration), check_signals_);
}

bool MasterRun::boot(can::Duration time_out) {
  check();
  return place_->drive([this] { return network_->start_up_over(); }, can::later(now(), time_out),
                       check_signals_);
}

std::string MasterRun::results() const {
  check();
  std::string lines;
  for (const NetworkSlave& slave : network_->slaves()) {
    const auto result = network_->result(slave);
    const BootRecord& record = network_->master().boot_record(slave.node);
    text::Json line{{"node", slave.node},
                    {"name", slave.name},
                    {"result", name(result)},
                    {"state", state_name(network_->master().node_state(slave.node))}};
    if (result == NetworkMaster::Result::failed) plant::add_boot(line, record, now());
    lines += line_of(line);
  }
  return lines;
}

std::string MasterRun::drain_events() {
  check_still();
  return std::exchange(events_, {});
}

std::string MasterRun::state(unsigned node) const {
  check();
  check_node(node);
  return std::string(state_name(network_->master().node_state(static_cast<std::uint8_t>(node))));
}

void MasterRun::command(unsigned node, std::uint8_t value) {
  check();
  constexpr std::uint8_t all_nodes = 0x80;
  if (node != 0) check_node(node);
  const auto code =
      network_->master().request_nmt(node == 0 ? all_nodes : static_cast<std::uint8_t>(node), value, now());
  if (code != canopen::AbortCode::none) {
    throw PlantProblem(fmt::format("node {}: {}", node, client::describe_abort(code, true, {})));
  }
}

SdoResult MasterRun::sdo(unsigned node, unsigned index, unsigned sub, const std::optional<std::string>& value,
                         can::Duration time_out, bool block) {
  check();
  check_node(node);
  if (index > 0xFFFF || sub > 0xFF) {
    throw PlantProblem(
        fmt::format("object {:X}:{:02X}: expected 0 to FFFFH, sub-index 0 to FFH", index, sub));
  }
  if (time_out <= 0ns) throw PlantProblem("the time-out is not above 0");
  /// Outlives this call when an exception ends it.
  const auto answer = std::make_shared<std::optional<SdoResult>>();
  const auto done = [answer, time_out](const manager::SdoResult& result, can::Time) {
    SdoResult& own = answer->emplace();
    own.abort_code = static_cast<std::uint32_t>(client::abort_on_bus(result.abort_code));
    if (result.abort_code != canopen::AbortCode::none) {
      const bool is_answer = result.abort_code != canopen::AbortCode::timed_out;
      own.reason = result.short_answer != nullptr
                       ? client::describe_short_answer(*result.short_answer)
                       : client::describe_abort(result.abort_code, is_answer, time_out);
    }
    own.size_indicated = result.size_indicated;
    own.data.assign(result.data.begin(), result.data.end());
  };
  const manager::SdoRequestOptions options{
      .time_out = time_out,
      .mode = block ? canopen::SdoClient::Mode::block : canopen::SdoClient::Mode::segmented};
  const auto to = static_cast<std::uint8_t>(node);
  const auto object = static_cast<std::uint16_t>(index);
  const auto part = static_cast<std::uint8_t>(sub);
  manager::NmtMaster& master = network_->master();
  const std::string& bytes = value ? *value : std::string();
  const std::span raw(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  const auto code = value ? master.write_object(to, object, part, raw, done, now(), options)
                          : master.read_object(to, object, part, done, now(), options);
  if (code != canopen::AbortCode::none) {
    throw PlantProblem("the master's own node is in reset or stopped: let time pass, or call boot()");
  }
  try {
    (void)place_->drive([&answer] { return answer->has_value(); }, can::never, check_signals_);
  } catch (...) {
    if (network_ != nullptr) master.cancel_requests(to, now());
    throw;
  }
  return **answer;
}

void MasterRun::send(const can::Frame& frame) {
  check();
  if (!place_->sink().send(frame)) throw PlantProblem("the transmit queue is full: let time pass");
}

std::size_t MasterRun::subscribe(std::uint32_t identifier, bool extended) {
  check();
  subscriptions_[++last_token_] = {.identifier = identifier, .extended = extended};
  return last_token_;
}

void MasterRun::unsubscribe(std::size_t token) {
  check_still();
  subscriptions_.erase(token);
}

std::optional<TimedFrame> MasterRun::receive_next(std::size_t token, can::Duration time_out) {
  check();
  const auto waits = [this, token] {
    const auto found = subscriptions_.find(token);
    return found != subscriptions_.end() && found->second.frames.empty();
  };
  if (waits() && time_out > 0ns) {
    (void)place_->drive([&waits] { return !waits(); }, can::later(now(), time_out), check_signals_);
  }
  const auto found = subscriptions_.find(token);
  if (found == subscriptions_.end() || found->second.frames.empty()) return std::nullopt;
  const TimedFrame frame = found->second.frames.front();
  found->second.frames.pop_front();
  return frame;
}

void MasterRun::receive(const can::Frame& frame, can::Time now) {
  network_->receive(frame, now);
  if (frame.remote) return;
  for (auto& [token, subscription] : subscriptions_) {
    if (subscription.identifier != frame.identifier || subscription.extended != frame.extended) continue;
    if (subscription.frames.size() >= most_frames) subscription.frames.pop_front();
    subscription.frames.push_back({now, frame, false});
  }
}

void MasterRun::event(const char* what, const NetworkSlave& slave, can::Time now, std::string more) {
  text::Json line{{"t", can::seconds(now)}, {"event", what}, {"node", slave.node}};
  if (!slave.name.empty()) line["name"] = slave.name;
  if (!more.empty()) line["what"] = std::move(more);
  events_ += line_of(line);
}

void MasterRun::slave_booted(const NetworkSlave& slave, can::Time now) { event("booted", slave, now); }
void MasterRun::slave_failed(const NetworkSlave& slave, const BootRecord& record, can::Time now) {
  event("failed", slave, now, manager::explain(record, now));
}
void MasterRun::state_changed(const NetworkSlave& slave, std::uint8_t state, can::Time now) {
  if (state != manager::node_state::unknown) event("state", slave, now, std::string(state_name(state)));
}
void MasterRun::error_control_event(const NetworkSlave& slave, manager::ErrorControlEvent what,
                                    can::Time now) {
  event("error control", slave, now, std::string(name(what)));
}
void MasterRun::error_control_resolved(const NetworkSlave& slave, can::Time now) {
  event("heard again", slave, now);
}

}  // namespace canopus::python
