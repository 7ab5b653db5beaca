#pragma once
// SDO requests of an application to the nodes of the network, over their default channels. Requests to one
// node queue up; different nodes are asked in parallel. Nothing blocks: the end of a request is a call, from
// inside which others may be made.
//
// The default channel of a node belongs to one client at a time; another user of it takes turns with this
// one through SdoChannelGate. A request that has begun is never interrupted.
//
// Memory: a queue and a client per node that was asked once; a request and its value until it ended.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/manager/sdo/node_alarms.hpp"

namespace canopus::manager {

/// How a request ended. The bytes are valid during the call.
struct SdoResult {
  std::uint8_t node_id = 0;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  canopen::AbortCode abort_code = canopen::AbortCode::none;  ///< timed_out: no answer
  std::span<const std::uint8_t> data{};                      ///< what was read
  bool size_indicated = true;                                ///< as SdoClient::is_size_indicated()
  const can::Frame* short_answer = nullptr;                  ///< as SdoClient::short_answer()
};

struct SdoRequestOptions {
  can::Duration time_out = canopen::SdoClient::default_time_out;  ///< for each answer
  canopen::SdoClient::Mode mode = canopen::SdoClient::Mode::segmented;
};

/// The other user of the default channels.
class SdoChannelGate {
 public:
  /// It has no transfer with this node.
  virtual bool channel_is_free(std::uint8_t node_id) = 0;
  /// A request has ended and the channel is free: for transfers that wait.
  virtual void channel_freed(std::uint8_t node_id, can::Time now) = 0;

 protected:
  ~SdoChannelGate() = default;
};

class SdoRequests final : private canopen::SdoClientListener {
 public:
  using Done = std::function<void(const SdoResult&, can::Time now)>;
  /// A busy channel is tried again after this, should channel_freed() not be called.
  static constexpr can::Duration busy_retry = std::chrono::milliseconds(10);

  SdoRequests(can::Sink& sink, SdoChannelGate& gate) : sink_(&sink), gate_(&gate) {}

  /// Reads an object of node 1..127. False: no such node-ID.
  bool upload(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub, Done done, can::Time now,
              const SdoRequestOptions& options = {});
  /// Writes it. The value is copied.
  bool download(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                std::span<const std::uint8_t> value, Done done, can::Time now,
                const SdoRequestOptions& options = {});
  /// All requests, begun or not, end with this code; those to one node, or to all (0).
  void cancel(std::uint8_t node_id, canopen::AbortCode code, can::Time now);

  /// A transfer with this node is running.
  [[nodiscard]] bool busy(std::uint8_t node_id) const noexcept {
    return node_id < channels_.size() && channels_[node_id] && channels_[node_id]->client.busy();
  }
  /// Requests to this node that have not ended.
  [[nodiscard]] std::size_t pending(std::uint8_t node_id) const noexcept {
    return node_id < channels_.size() && channels_[node_id] ? channels_[node_id]->queue.size() : 0;
  }
  /// The other user has ended a transfer: begins the next request, if one waits. True when it did.
  bool channel_freed(std::uint8_t node_id, can::Time now);

  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarms_.alarm(); }

 private:
  struct Request {
    std::uint16_t index;
    std::uint8_t sub;
    bool is_upload;
    SdoRequestOptions options;
    std::vector<std::uint8_t> value;
    Done done;
  };
  struct Channel {
    explicit Channel(can::Sink& sink) : client(sink) {}
    canopen::SdoClient client;
    std::deque<Request> queue;  // the first one is running while the client is busy
    bool ending = false;        // inside the call of Done
  };

  bool add(std::uint8_t node_id, Request request, can::Time now);
  bool begin(std::uint8_t node_id, can::Time now);
  void end(std::uint8_t node_id, canopen::AbortCode code, std::span<const std::uint8_t> data, can::Time now);
  void sdo_finished(canopen::SdoClient& client, can::Time now) override;

  can::Sink* sink_;
  SdoChannelGate* gate_;
  std::array<std::unique_ptr<Channel>, 128> channels_;
  NodeAlarms alarms_;  // of a channel: its client's, and when it is tried again
};

}  // namespace canopus::manager
