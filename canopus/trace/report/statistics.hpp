#pragma once
// Figures of a trace: load, cycle times per identifier, heartbeats that were lost, SDO latencies, emergencies.
// Is given records and what the decoder made of them; keeps what grows with the number of nodes and
// identifiers, not with the length of the trace.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/trace/decode/decoder.hpp"

namespace canopus::trace {

/// Lowest, highest and mean of a time, and its scatter.
class TimeFigures {
 public:
  void add(can::Duration value) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] can::Duration min() const noexcept { return min_; }
  [[nodiscard]] can::Duration max() const noexcept { return max_; }
  [[nodiscard]] can::Duration mean() const noexcept;
  /// Standard deviation.
  [[nodiscard]] can::Duration deviation() const noexcept;

 private:
  std::uint64_t count_ = 0;
  can::Duration min_ = can::Duration::max();
  can::Duration max_{};
  double mean_ = 0;     // ns
  double squares_ = 0;  // sum of squared distances from the mean
};

/// Frames of one identifier on one channel.
struct IdentifierFigures {
  std::uint64_t frames = 0;
  std::uint64_t bits = 0;  ///< with stuff bits and intermission
  TimeFigures cycle{};     ///< from frame to frame; remote frames do not count
  can::Time last{};
  std::string who{};      ///< "TPDO1 of 3 (encoder)"
  std::string signals{};  ///< of a PDO, as its mapping has them: "Position value, 6000:01"; empty: not known
};

struct NodeFigures {
  std::string name{};
  std::uint64_t boot_ups = 0;
  std::uint64_t emergencies = 0;
  std::uint64_t malformed = 0;  ///< messages
  std::uint64_t heartbeats = 0;
  std::uint64_t lost_heartbeats = 0;       ///< that should have come in the gaps
  can::Duration producer_time{};           ///< 0: not known
  bool producer_time_is_measured = false;  ///< from no file or object: the most usual gap
  TimeFigures heartbeat_cycle{};
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t aborts = 0;
  std::uint64_t unanswered = 0;
  std::uint64_t unfinished = 0;  ///< and overtaken
  std::uint64_t probes = 0;      ///< reads of 1000:00 that had no answer, as a scan makes them
  TimeFigures sdo{};             ///< from request to end, of those that were done
  std::optional<can::Time> last_heartbeat{};
  std::vector<can::Duration> gaps{};  ///< the first ones, where the producer time is not known
};

struct ChannelFigures {
  std::string name{};
  std::uint64_t frames = 0;
  std::uint64_t error_frames = 0;
  std::uint64_t bits = 0;
  std::uint64_t busiest_bits = 0;  ///< within one second, counted from the trace's first frame
  std::map<std::uint32_t, IdentifierFigures> identifiers{};  ///< key_of()
  std::map<std::uint8_t, NodeFigures> nodes{};
  /// Node-IDs that a scan asked for 1000:00 in vain, and that sent no heartbeat, EMCY or SDO answer; they are none of `nodes`.
  std::vector<std::uint8_t> absent{};
  std::uint64_t second_bits = 0;  // of the second that is under way
  std::int64_t second = 0;
};

/// An emergency, or something else that happened once.
struct TraceEvent {
  can::Time time{};
  std::uint16_t channel = 0;
  std::uint8_t node = 0;
  std::string node_name{};
  std::string text{};
  bool is_probe = false;  ///< a read of 1000:00 without an answer
};

class Statistics {
 public:
  /// Malformed messages, emergencies, and aborted and unanswered SDOs that are kept one by one.
  static constexpr std::size_t most_events = 1000;
  /// Identifiers of a channel that are counted one by one.
  static constexpr std::size_t most_identifiers = 65536;

  /// Every record, before the decoder has it.
  void record(const TraceRecord& record, std::string_view channel);
  /// Every message of the decoder, each frame or transfer once.
  void message(const Message& message, const Decoder& decoder);
  /// At the end.
  void finish();

  [[nodiscard]] can::Time begin() const noexcept { return begin_.value_or(can::Time{}); }
  [[nodiscard]] can::Duration duration() const noexcept { return end_ - begin(); }
  [[nodiscard]] const std::map<std::uint16_t, ChannelFigures>& channels() const noexcept { return channels_; }
  [[nodiscard]] const std::array<std::uint64_t, service_count>& services() const noexcept {
    return services_;
  }
  /// Malformed messages, by service; the first of them one by one, with identifier and service in their text.
  [[nodiscard]] const std::array<std::uint64_t, service_count>& malformed_services() const noexcept {
    return malformed_services_;
  }
  [[nodiscard]] const std::vector<TraceEvent>& malformed() const noexcept { return malformed_; }
  [[nodiscard]] const std::vector<TraceEvent>& emergencies() const noexcept { return emergencies_; }
  [[nodiscard]] const std::vector<TraceEvent>& failures() const noexcept { return failures_; }

 private:
  static void count_identifier(ChannelFigures& channel, const Message& message, std::uint64_t bits);
  void heartbeat(NodeFigures& node, const Message& message, const Decoder& decoder);
  void transfer(NodeFigures& node, const Message& message);
  void set_absent_nodes_apart();
  void count_malformed(ChannelFigures& channel, const Message& message);
  static void note(std::vector<TraceEvent>& list, const Message& message, std::string text);

  std::optional<can::Time> begin_;
  can::Time end_{};
  std::map<std::uint16_t, ChannelFigures> channels_;
  std::array<std::uint64_t, service_count> services_{};
  std::array<std::uint64_t, service_count> malformed_services_{};
  std::vector<TraceEvent> malformed_;
  std::vector<TraceEvent> emergencies_;
  std::vector<TraceEvent> failures_;
};

/// Share of the time that the bus carried these bits, 0..1 and more when the rate is too low.
[[nodiscard]] double load(std::uint64_t bits, can::Duration duration, std::uint32_t bit_rate) noexcept;

}  // namespace canopus::trace
