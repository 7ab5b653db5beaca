#pragma once
// Scans a bus for nodes: reads 1000H of every node-ID, identity and name of those that answer, and determines
// the NMT states. The state comes from heartbeats and other masters' guarding; only a node that produces no
// heartbeat and is not guarded gets a guarding remote frame.
//
// Sixteen nodes are asked at a time, each over its default SDO channel, which no other client should be
// using. A node that does not answer gets one frame.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/canopen/service/nmt.hpp"

namespace canopus::client {

struct FoundNode {
  std::uint8_t node_id = 0;
  bool answers_sdo = false;  ///< false: only heartbeat, boot-up or guarding received, for example in Stopped
  std::optional<canopen::NmtState> state{};     ///< unknown: no error control
  std::optional<std::uint32_t> device_type{};   ///< 1000H
  std::optional<std::uint32_t> vendor{};        ///< 1018:01
  std::optional<std::uint32_t> product{};       ///< 1018:02
  std::optional<std::uint32_t> revision{};      ///< 1018:03
  std::optional<std::uint32_t> serial{};        ///< 1018:04
  std::optional<std::string> name{};            ///< 1008H
  std::optional<std::uint32_t> heartbeat_ms{};  ///< 1017H
  std::optional<std::uint32_t> guard_ms{};      ///< 100CH
};

class BusScan final : public can::Participant {
 public:
  static constexpr can::Duration longest_listening = std::chrono::seconds(3);

  /// Nodes first..last, 1..127. `time_out` for each answer.
  BusScan(can::Sink& sink, std::uint8_t first, std::uint8_t last, can::Duration time_out);
  ~BusScan() override;
  BusScan(const BusScan&) = delete;
  BusScan& operator=(const BusScan&) = delete;

  void start(can::Time now);
  [[nodiscard]] bool finished() const noexcept { return phase_ == Phase::finished; }
  /// Nodes that were asked to the end, of how many.
  [[nodiscard]] unsigned asked() const noexcept { return asked_; }
  [[nodiscard]] unsigned of() const noexcept { return last_ - first_ + 1U; }
  /// In order of node-IDs.
  [[nodiscard]] std::vector<FoundNode> found() const;

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;

 private:
  class NodeQuery;
  enum class Phase : std::uint8_t { idle, asking, listening, guarding, finished };

  void next_node(NodeQuery& query, can::Time now);
  void all_requested(can::Time now);
  void listened(can::Time now);
  [[nodiscard]] bool states_are_known() const;

  can::Sink* sink_;
  unsigned first_;
  unsigned last_;
  unsigned next_;
  unsigned asked_ = 0;
  can::Duration time_out_;
  Phase phase_ = Phase::idle;
  can::Alarm phase_end_;
  std::array<FoundNode, 128> nodes_{};
  std::vector<std::unique_ptr<NodeQuery>> queries_;
};

}  // namespace canopus::client
