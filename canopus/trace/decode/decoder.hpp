#pragma once
// The protocol analyser: gets the records of a trace, one by one, and returns what they mean. It reads no
// file and no clock; the same object works on a file of any length and on a bus. What it keeps is bounded.

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/trace/decode/bus_knowledge.hpp"
#include "canopus/trace/decode/message.hpp"
#include "canopus/trace/decode/names.hpp"
#include "canopus/trace/decode/object_facts.hpp"
#include "canopus/trace/decode/sdo_channel.hpp"

namespace canopus::trace {

struct DecoderOptions {
  /// Emit every frame of SDO, and frames that were recorded twice.
  bool frames = false;
  /// Emit SDO transfers as they end.
  bool transfers = true;
  /// An SDO transfer in which nothing happens for so long has ended.
  can::Duration sdo_time_out = std::chrono::seconds(10);
};

class Decoder {
 public:
  using Sink = std::function<void(const Message&)>;
  explicit Decoder(Names names = {}, DecoderOptions options = {});
  ~Decoder();

  /// The next record. The sink is called for it, not at all, or several times, and not afterwards.
  void receive(const TraceRecord& record, std::string_view channel, const Sink& sink);
  /// At the end: SDO transfers that are still under way.
  void finish(const Sink& sink);

  /// Nodes as they were given.
  [[nodiscard]] const Names& names() const noexcept { return names_; }
  /// The knowledge about a channel so far; nullptr before its first record.
  [[nodiscard]] const BusKnowledge* knowledge(std::uint16_t channel) const;

 private:
  struct Channel;
  Channel& channel_of(const TraceRecord& record, std::string_view name);
  bool is_copy(Channel& channel, const TraceRecord& record, const Sink& sink);
  void decode(Channel& channel, Message& message);
  void decode_nmt(Message& message) const;
  void decode_error_control(Channel& channel, Message& message) const;
  void decode_emcy(Message& message) const;
  void decode_pdo(Channel& channel, Message& message, const PdoFacts& pdo);
  void decode_mpdo(Channel& channel, Message& message) const;
  void decode_signals(Channel& channel, Message& message, const PdoFacts& pdo);
  void receive_sdo(Channel& channel, Message& message, const SdoSide& side, const Sink& sink);
  void emit_transfer(Channel& channel, std::uint8_t server, const Message& at, SdoTransfer transfer,
                     const Sink& sink);
  void emit_ended(Channel& channel, std::uint8_t server, std::vector<EndedSdoTransfer> ended,
                  const Sink& sink);
  void expire(Channel& channel, can::Time now, const Sink& sink);
  void name_node(const Channel& channel, Message& message) const;

  Names names_;
  DecoderOptions options_;
  std::map<std::uint16_t, std::unique_ptr<Channel>> channels_;
};

}  // namespace canopus::trace
