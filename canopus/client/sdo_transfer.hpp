#pragma once
// SDO transfers with one node, one at a time, and what became of them in words. It waits for nothing: its owner passes the frames
// of the bus and the ticks on, and looks whether the transfer has ended.

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::client {

/// Why a frame was not sent: there is no place for it.
inline constexpr std::string_view bus_takes_no_frame = "the bus takes no frame";

/// Why a transfer failed.
struct SdoFailure {
  canopen::AbortCode code = canopen::AbortCode::none;  ///< none: the bus, `reason` says what
  std::string reason;  ///< "abort 06020000H: object does not exist", "no answer within 500.0 ms"
};

/// How a transfer went.
struct SdoSpeed {
  enum class Form : std::uint8_t { expedited, segmented, block };
  std::size_t bytes = 0;
  can::Duration time{};  ///< from the request to the last answer
  Form form = Form::expedited;
  bool size_indicated = true;  ///< false: read expedited without the number of bytes; all four are kept

  /// In kB/s, 1000 bytes each; 0: it took no time.
  [[nodiscard]] double rate() const noexcept;
};
[[nodiscard]] std::string_view name(SdoSpeed::Form form) noexcept;
/// "70000 bytes in 1.23 s, 56.9 kB/s, segmented"
[[nodiscard]] std::string describe(const SdoSpeed& speed);

class SdoTransfer final : private canopen::SdoClientListener {
 public:
  /// Gets how many bytes have passed, of how many (0 = not known), every now and then.
  using Progress = std::function<void(std::size_t bytes, std::size_t of)>;

  /// `block`: block transfers, also of values that would fit into one frame; a server that does otherwise is
  /// a failure.
  SdoTransfer(can::Sink& bus, std::uint8_t node_id, can::Duration time_out, bool block);

  /// What read() takes, in bytes; at first SdoClient::default_maximum_size.
  void set_limit(std::size_t bytes) noexcept { client_.set_maximum_size(bytes); }
  void set_progress(Progress progress) { progress_ = std::move(progress); }

  /// Starts a transfer. False: the bus takes no frame. The bytes of `value` stay valid until its end.
  [[nodiscard]] bool read(text::ObjectName object, can::Time now);
  [[nodiscard]] bool write(text::ObjectName object, std::span<const std::uint8_t> value, can::Time now);
  /// Ends it with an abort frame, without a call of the listener.
  void cancel();

  [[nodiscard]] bool is_finished() const noexcept { return is_finished_; }
  /// The value that was read (once), or nothing of one that was written; or why it failed. Of a transfer that has ended.
  [[nodiscard]] std::expected<std::vector<std::uint8_t>, SdoFailure> result();
  /// Of the last transfer that succeeded.
  [[nodiscard]] const SdoSpeed& speed() const noexcept { return speed_; }

  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return client_.alarm(); }

 private:
  class Collector final : public canopen::ByteSink {
   public:
    explicit Collector(const Progress& progress) : progress_(progress) {}
    canopen::AbortCode write(std::span<const std::uint8_t> bytes) override;
    std::vector<std::uint8_t> bytes{};

   private:
    const Progress& progress_;
  };
  class Source final : public canopen::ByteSource {
   public:
    Source(std::span<const std::uint8_t> bytes, const Progress& progress)
        : rest_(bytes), size_(bytes.size()), progress_(progress) {}
    std::expected<std::size_t, canopen::AbortCode> read(std::span<std::uint8_t> into) override;

   private:
    std::span<const std::uint8_t> rest_;
    std::size_t size_;
    const Progress& progress_;
  };

  void sdo_finished(canopen::SdoClient& client, can::Time now) override;
  void begin(can::Time now);
  void conclude();
  [[nodiscard]] canopen::SdoClient::Mode mode() const;

  can::Duration time_out_;
  bool block_;
  Progress progress_;
  canopen::SdoClient client_;
  Collector collector_{progress_};
  std::optional<Source> source_;
  SdoSpeed speed_;
  std::optional<std::size_t> written_;  // bytes of a download
  can::Time begun_{};
  std::optional<can::Time> ended_;
  bool is_finished_ = false;
  bool is_expedited_ = false;  // the answer to an upload, or the download
  bool aborted_by_server_ = false;
  bool switched_ = false;  // asked for blocks, the server answered an upload expedited or in segments
};

/// The words for an abort code; `aborted_by_server`: it came over the bus. `limit`: the client's, which a value exceeds
/// where the code is SdoClient::buffer_too_small.
[[nodiscard]] std::string describe_abort(canopen::AbortCode code, bool aborted_by_server,
                                         can::Duration time_out,
                                         std::size_t limit = canopen::SdoClient::default_maximum_size);

/// "its answer has 7 bytes, expected 8: 43 00 10 00 92 01 02" [CiA 301 7.2.4.3]
[[nodiscard]] std::string describe_short_answer(const can::Frame& answer);

/// As the server got the code: 05040005H for SdoClient::buffer_too_small, which is never on a bus.
[[nodiscard]] canopen::AbortCode abort_on_bus(canopen::AbortCode code) noexcept;

}  // namespace canopus::client
