#include "canopus/client/bus_scan.hpp"

#include <algorithm>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/sdo/uploaded_value.hpp"

namespace canopus::client {
namespace {

using canopen::AbortCode;
using canopen::NmtState;

constexpr std::size_t nodes_at_a_time = 16;
constexpr can::Duration guarding_answer = std::chrono::milliseconds(100);
/// Tolerance of the heartbeat time.
constexpr can::Duration heartbeat_slack = std::chrono::milliseconds(100);

struct Question {
  std::uint16_t index;
  std::uint8_t sub;
  std::size_t length;                               ///< bytes of its type; 0: a text
  std::optional<std::uint32_t> FoundNode::*answer;  ///< null: the name
};
constexpr std::array<Question, 8> questions{{
    {0x1000, 0, 4, &FoundNode::device_type},
    {0x1018, 1, 4, &FoundNode::vendor},
    {0x1018, 2, 4, &FoundNode::product},
    {0x1018, 3, 4, &FoundNode::revision},
    {0x1018, 4, 4, &FoundNode::serial},
    {0x1008, 0, 0, nullptr},
    {0x1017, 0, 2, &FoundNode::heartbeat_ms},
    {0x100C, 0, 2, &FoundNode::guard_ms},
}};

std::string text_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    if (byte == 0) break;
    text += byte < 0x20 || byte == 0x7F ? '?' : static_cast<char>(byte);
  }
  return text;
}

std::optional<NmtState> state_of(std::uint8_t byte) {
  switch (byte & 0x7FU) {
    case 0x00:  // boot-up: Pre-operational is what follows
    case 0x7F: return NmtState::pre_operational;
    case 0x04: return NmtState::stopped;
    case 0x05: return NmtState::operational;
    default: return std::nullopt;
  }
}

}  // namespace

/// All questions to one node after the other, then the next node.
class BusScan::NodeQuery final : public canopen::SdoClientListener {
 public:
  NodeQuery(BusScan& scan, can::Sink& sink) : client(sink), scan_(scan) {
    constexpr std::size_t longest_name = 1024;
    client.set_maximum_size(longest_name);
  }
  void begin(std::uint8_t node_id, can::Time now) {
    node_id_ = node_id;
    question_ = 0;
    client.set_server(node_id);
    send_request(now);
  }
  /// The first request without an answer: the node is not there, and gets no abort frame, as one to each of 120
  /// missing nodes would only fill the bus and its recordings.
  void tick(can::Time now) {
    const bool is_first = question_ == 0 && client.busy();
    if (!is_first || now < can::later(asked_at_, scan_.time_out_)) return client.tick(now);
    client.drop(AbortCode::timed_out);
    done(now);
  }
  void sdo_finished(canopen::SdoClient&, can::Time now) override {
    FoundNode& node = scan_.nodes_[node_id_];
    const AbortCode code = client.abort_code();
    if (code == AbortCode::none) {
      node.answers_sdo = true;
      store_result(node);
    } else if (code == AbortCode::timed_out) {
      return done(now);  // no node there, or lost during the transfer
    } else {
      node.answers_sdo = true;  // an abort is an answer
    }
    if (++question_ == questions.size()) return done(now);
    send_request(now);
  }

  canopen::SdoClient client;
  bool working = true;

 private:
  void send_request(can::Time now) {
    const Question& question = questions[question_];
    asked_at_ = now;
    if (!client.upload(question.index, question.sub, *this, now, scan_.time_out_)) done(now);
  }
  void done(can::Time now) {
    ++scan_.asked_;
    scan_.next_node(*this, now);
  }
  void store_result(FoundNode& node) {
    const Question& question = questions[question_];
    const auto bytes =
        canopen::uploaded_value(client.data(), client.is_size_indicated(), question.length).bytes;
    if (question.answer == nullptr) {
      node.name = text_of(bytes);
      return;
    }
    node.*question.answer = can::load_u32(bytes);
  }

  BusScan& scan_;
  std::uint8_t node_id_ = 0;
  std::size_t question_ = 0;
  can::Time asked_at_{};
};

BusScan::BusScan(can::Sink& sink, std::uint8_t first, std::uint8_t last, can::Duration time_out)
    : sink_(&sink), first_(first), last_(last), next_(first), time_out_(time_out) {
  alarm().add_part(phase_end_);
  for (unsigned id = 0; id < nodes_.size(); ++id) nodes_[id].node_id = static_cast<std::uint8_t>(id);
}

BusScan::~BusScan() = default;

void BusScan::start(can::Time now) {
  phase_ = Phase::asking;
  while (queries_.size() < nodes_at_a_time && next_ <= last_) {
    queries_.push_back(std::make_unique<NodeQuery>(*this, *sink_));
    alarm().add_part(queries_.back()->client.alarm());
    next_node(*queries_.back(), now);
  }
}

void BusScan::next_node(NodeQuery& query, can::Time now) {
  if (next_ <= last_) return query.begin(static_cast<std::uint8_t>(next_++), now);
  query.working = false;
  if (std::ranges::none_of(queries_, &NodeQuery::working)) all_requested(now);
}

// The responses of a guarded node are received within its guard time; a guarding frame of our own would
// disturb the master's toggle bit.
void BusScan::all_requested(can::Time now) {
  can::Duration longest{};
  for (const FoundNode& node : nodes_) {
    if (!node.answers_sdo || node.state) continue;
    const auto period = std::max(node.heartbeat_ms.value_or(0), node.guard_ms.value_or(0));
    if (period != 0)
      longest = std::max<can::Duration>(longest, std::chrono::milliseconds(period) + heartbeat_slack);
  }
  phase_ = Phase::listening;
  phase_end_ = can::later(now, std::min(longest, longest_listening));
  if (states_are_known()) phase_end_ = now;
}

void BusScan::listened(can::Time now) {
  bool asked = false;
  for (const FoundNode& node : nodes_) {
    if (!node.answers_sdo || node.state || node.heartbeat_ms.value_or(0) != 0) continue;
    asked = sink_->send(can::remote_frame(canopen::cob_id::error_control + node.node_id, 1)) || asked;
  }
  phase_ = asked ? Phase::guarding : Phase::finished;
  phase_end_ = asked ? can::later(now, guarding_answer) : can::never;
}

bool BusScan::states_are_known() const {
  return std::ranges::all_of(nodes_, [](const FoundNode& node) { return !node.answers_sdo || node.state; });
}

std::vector<FoundNode> BusScan::found() const {
  std::vector<FoundNode> list;
  std::ranges::copy_if(nodes_, std::back_inserter(list),
                       [](const FoundNode& node) { return node.answers_sdo || node.state; });
  return list;
}

void BusScan::receive(const can::Frame& frame, can::Time now) {
  if (frame.extended || frame.remote) return;
  const std::uint32_t node_id = frame.identifier & 0x7FU;
  if ((frame.identifier & ~0x7FU) == canopen::cob_id::error_control && node_id >= first_ &&
      node_id <= last_ && frame.length() == 1) {
    if (const auto state = state_of(frame.data[0])) nodes_[node_id].state = state;
    if ((phase_ == Phase::listening || phase_ == Phase::guarding) && states_are_known()) phase_end_ = now;
    return;
  }
  for (const auto& query : queries_) {
    if (query->client.receive(frame, now)) return;
  }
}

void BusScan::tick(can::Time now) {
  for (const auto& query : queries_) {
    if (query->client.deadline() <= now) query->tick(now);
  }
  if (now < phase_end_) return;
  if (phase_ == Phase::listening) {
    listened(now);
  } else if (phase_ == Phase::guarding) {
    phase_ = Phase::finished;
    phase_end_ = can::never;
  }
}

}  // namespace canopus::client
