#pragma once
// The frames of one SDO channel, followed from request to end [CiA 301 7.2.4.3]: expedited, segmented and
// block transfers. It only listens: lost frames are inferred from the confirmations.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/trace/decode/message.hpp"

namespace canopus::trace {

/// One frame of a channel.
struct SdoFrame {
  std::string_view kind = "unknown";
  std::optional<std::uint16_t> index{};  ///< that the frame has; or that of its transfer
  std::uint8_t sub = 0;
  std::vector<std::uint8_t> data{};  ///< of the object
  bool length_unstated =
      false;  ///< expedited without a length: `data` has 4 bytes, as many as the type count
  std::optional<std::uint32_t> size{};  ///< announced
  std::optional<std::uint32_t> abort_code{};
  std::optional<std::uint8_t> sequence{};  ///< block segment, or the last one confirmed
  std::optional<std::uint8_t> block_size{};
  std::optional<bool> toggle{};
  std::optional<bool> expected_toggle{};  ///< where it is another one [CiA 301 7.2.4.3.3]
  bool last = false;                      ///< of a segment
};

/// A transfer that has ended.
struct SdoTransfer {
  bool is_read = false;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  TransferEnd end = TransferEnd::done;
  std::vector<std::uint8_t> data{};  ///< the first most_sdo_data bytes
  bool length_unstated = false;
  std::uint64_t size = 0;
  bool is_block = false;
  bool is_joined = false;  ///< it began before the trace: its object and first bytes are not known
  std::optional<std::uint32_t> announced{};   ///< size
  std::optional<std::size_t> short_answer{};  ///< bytes of an answer with fewer than 8, which is none
  std::optional<std::uint32_t> abort_code{};
  bool aborted_by_client = false;
  std::uint32_t frames = 0;
  can::Time begin{};
  can::Time last{};
};

/// Most bytes that are kept of a long value.
inline constexpr std::size_t most_sdo_data = 65536;

class SdoFollower {
 public:
  /// The next frame, of 8 bytes. At most one transfer ends by being overtaken and one by the frame itself.
  struct Step {
    SdoFrame frame{};
    std::optional<SdoTransfer> overtaken{};
    std::optional<SdoTransfer> ended{};
  };
  [[nodiscard]] Step follow(const can::Frame& frame, bool from_client, can::Time now);

  /// A request whose answer has not come.
  [[nodiscard]] bool awaits_answer() const noexcept { return phase_ == Phase::initiated; }
  [[nodiscard]] bool is_of(std::uint16_t index, std::uint8_t sub) const noexcept {
    return transfer_.index == index && transfer_.sub == sub;
  }
  /// The next frame of this side is a segment of a block: its first byte is a number, not a command.
  [[nodiscard]] bool expects_block_segment(bool from_client) const noexcept {
    return phase_ == Phase::block_segments && transfer_.is_read != from_client;
  }
  void note_short_answer(std::size_t bytes) noexcept { transfer_.short_answer = bytes; }

  /// Ends what is under way: unanswered or unfinished.
  [[nodiscard]] std::optional<SdoTransfer> give_up();
  [[nodiscard]] bool is_active() const noexcept { return phase_ != Phase::idle; }
  [[nodiscard]] can::Time last() const noexcept { return transfer_.last; }
  [[nodiscard]] const can::Frame& last_frame() const noexcept { return last_frame_; }

 private:
  enum class Phase : std::uint8_t {
    idle,
    initiated,     // request without answer yet
    segments,      // segmented, the client's turn
    segment_sent,  // the server's
    block_start,   // block upload: initiate answered, start comes
    block_segments,
    block_end,  // all segments confirmed
    block_end_sent,
  };
  void client_frame(const can::Frame& frame, can::Time now, Step& step);
  void server_frame(const can::Frame& frame, Step& step);
  void client_block_upload(const can::Frame& frame, can::Time now, Step& step);
  void client_block_download(const can::Frame& frame, can::Time now, Step& step);
  void server_block_upload(const can::Frame& frame, Step& step);
  void server_block_download(const can::Frame& frame, Step& step);
  void begin(const can::Frame& frame, bool is_read, bool is_block, can::Time now, Step& step);
  void initiate_download(const can::Frame& frame, can::Time now, Step& step);
  void initiate_upload_answer(const can::Frame& frame, Step& step);
  void segment(const can::Frame& frame, Step& step);
  void check_toggle(Step& step) const;
  void join(bool is_read);
  [[nodiscard]] bool block_segment(const can::Frame& frame, Step& step);
  void confirm(const can::Frame& frame, bool is_read, Step& step);
  void end_of_block(const can::Frame& frame, Step& step);
  void append(std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool answers(const can::Frame& frame, Step& step) const;
  void finish(Step& step, TransferEnd how);

  Phase phase_ = Phase::idle;
  SdoTransfer transfer_;
  can::Frame last_frame_;
  can::Time now_{};
  bool expedited_ = false;
  bool toggle_ = false;  // of the next segment
  bool last_segment_ = false;
  bool last_in_block_ = false;
  std::uint8_t block_size_ = 127;
  std::vector<std::array<std::uint8_t, 7>> block_;  // segments of the sub-block, in order
};

}  // namespace canopus::trace
